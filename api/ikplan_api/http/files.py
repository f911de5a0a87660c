"""File responses with ETag and 304."""

from __future__ import annotations

from pathlib import Path

from fastapi import Request, Response
from starlette.staticfiles import StaticFiles

__all__ = ["file_response"]

_FILES = StaticFiles()


def file_response(request: Request, path: Path, media_type: str, cache_control: str) -> Response:
    """Return an existing file with an ETag, or 304 if the client has it.

    Args:
        request: The request, with If-None-Match or If-Modified-Since.
        path: The file.
        media_type: Media type of the file.
        cache_control: The header Cache-Control.
    """
    answer = _FILES.file_response(path, path.stat(), request.scope)
    answer.headers["cache-control"] = cache_control
    if answer.status_code == 200:
        answer.headers["content-type"] = media_type
    return answer
