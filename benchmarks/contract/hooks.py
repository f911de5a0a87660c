"""What schemathesis has to know of the service: JSON lines, and what its document cannot say."""

from __future__ import annotations

import json
from typing import Any

import schemathesis

__all__ = ["EXCLUDED", "MEDIA_TYPES"]

MEDIA_TYPES = ("application/x-ndjson", "application/jsonl", "application/json-lines")
EXCLUDED = ("positive_data_acceptance",)
"""Checks left out: whether a request makes sense depends on its robot, its joints above all, which
no JSON schema can say; the service answers 422 and why."""


@schemathesis.serializer(*MEDIA_TYPES)
def write_lines(_: schemathesis.SerializationContext, value: Any) -> bytes:
    """Write a batch: text as it is, anything else as one line."""
    return value.encode(errors="replace") if isinstance(value, str) else json.dumps(value).encode()


@schemathesis.deserializer(*MEDIA_TYPES)
def read_lines(_: schemathesis.DeserializationContext, response: schemathesis.Response) -> Any:
    """Read the answer to a batch: its first line, which is what the document describes."""
    return json.loads(response.content.split(b"\n", 1)[0])
