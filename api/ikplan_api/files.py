"""Answering with files, or with 304 where the asker has them."""

from __future__ import annotations

from pathlib import Path

from fastapi import Request, Response
from starlette.staticfiles import StaticFiles

__all__ = ["file_answer"]

_FILES = StaticFiles()


def file_answer(request: Request, path: Path, media_type: str, cache_control: str) -> Response:
    """Answer with a file that exists, with an ETag.

    Args:
        request: The request; its If-None-Match and If-Modified-Since count.
        path: The file.
        media_type: What it holds.
        cache_control: How long it may be kept.
    """
    answer = _FILES.file_response(path, path.stat(), request.scope)
    answer.headers["cache-control"] = cache_control
    if answer.status_code == 200:
        answer.headers["content-type"] = media_type
    return answer
