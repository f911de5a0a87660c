"""What the log looks like: one JSON object a line, or text for people, with the request's id."""

from __future__ import annotations

import contextvars
import logging
import os
import sys

from pythonjsonlogger.json import JsonFormatter

__all__ = ["RequestFilter", "formatter", "request_id"]

request_id: contextvars.ContextVar[str] = contextvars.ContextVar("request_id", default="")
"""Id of the request on whose behalf the code runs."""


class RequestFilter(logging.Filter):
    """Adds the request's id to whatever is logged."""

    def filter(self, record: logging.LogRecord) -> bool:
        """Add the id; let everything pass."""
        record.request_id = request_id.get()
        return True


class _TextFormatter(logging.Formatter):
    def format(self, record: logging.LogRecord) -> str:
        text = super().format(record)
        known = getattr(record, "request_id", "")
        return f"{text} [{known}]" if known else text


def formatter() -> logging.Formatter:
    """Return the formatter that ``IKPLAN_LOG_FORMAT`` names: for a terminal text, else JSON."""
    chosen = os.environ.get("IKPLAN_LOG_FORMAT", "auto")
    if chosen == "text" or (chosen != "json" and sys.stderr.isatty()):
        return _TextFormatter("%(levelname)s: %(message)s")
    return JsonFormatter(
        ["levelname", "name", "message", "request_id"],
        rename_fields={"levelname": "level", "name": "logger"},
        timestamp="time",
    )
