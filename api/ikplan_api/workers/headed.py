"""A document with a head: a line of JSON before it, so that the document is copied but not read."""

from __future__ import annotations

import json
from typing import Any

__all__ = ["headed", "split_head"]


def headed(head: Any, document: bytes) -> bytes:
    """Return a document with a head before it."""
    return json.dumps(head).encode() + b"\n" + document


def split_head(message: bytes) -> tuple[Any, bytes]:
    """Return the head and the document of a message."""
    end = message.index(b"\n")
    return json.loads(message[:end]), message[end + 1 :]
