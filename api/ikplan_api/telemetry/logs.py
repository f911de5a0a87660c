"""Log format: one JSON object a line, or plain text, each with the request's id."""

from __future__ import annotations

import contextvars
import logging
import os
import sys

from pythonjsonlogger.json import JsonFormatter

__all__ = ["RequestFilter", "formatter", "request_id"]

request_id: contextvars.ContextVar[str] = contextvars.ContextVar("request_id", default="")
"""Id of the request that the running code serves."""


class RequestFilter(logging.Filter):
    """Adds the request's id to every record and removes uvicorn's coloured message."""

    def filter(self, record: logging.LogRecord) -> bool:
        """Add the id; keep every record."""
        record.request_id = request_id.get()
        record.__dict__.pop("color_message", None)  # uvicorn's, with escape codes
        return True


class _TextFormatter(logging.Formatter):
    def format(self, record: logging.LogRecord) -> str:
        text = super().format(record)
        known = getattr(record, "request_id", "")
        return f"{text} [{known}]" if known else text


def formatter() -> logging.Formatter:
    """Return the formatter of ``IKPLAN_LOG_FORMAT``; default: text on a terminal, else JSON."""
    chosen = os.environ.get("IKPLAN_LOG_FORMAT", "auto")
    if chosen == "text" or (chosen != "json" and sys.stderr.isatty()):
        return _TextFormatter("%(levelname)s: %(message)s")
    return JsonFormatter(
        ["levelname", "name", "message", "request_id"],
        rename_fields={"levelname": "level", "name": "logger"},
        timestamp="time",
    )
