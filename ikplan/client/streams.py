"""What a service tells bit by bit: events, and the lines of a batch."""

from __future__ import annotations

import json
from collections.abc import Iterable, Mapping
from typing import Any

from httpx_sse import ServerSentEvent
from pydantic import BaseModel, ValidationError

from ikplan.client.wire import encode
from ikplan.documents.status import PlanStatus
from ikplan.errors import IkplanError, InvalidRequest, ServiceUnavailable, error_from_problem
from ikplan.plans.plan import Plan

__all__ = ["BATCH", "batch_body", "read_event", "read_line"]

BATCH = "application/x-ndjson"


def batch_body(requests: Iterable[Mapping[str, Any] | BaseModel | bytes]) -> bytes:
    """Return the lines of a batch.

    Raises:
        InvalidRequest: A request cannot be written as JSON, or is blank.
    """
    return b"\n".join(_line_of(request) for request in requests)


def _line_of(request: Mapping[str, Any] | BaseModel | bytes) -> bytes:
    if not isinstance(request, bytes):
        return encode(request)
    if not request.strip():
        raise InvalidRequest("a line of a batch cannot be blank", allowed="JSON")
    return request.replace(b"\n", b" ")  # in JSON a line break is no more than a space


def read_event(event: ServerSentEvent, url: str) -> PlanStatus | IkplanError:
    """Return what an event of a plan says: how far it is, or why it failed.

    Raises:
        ServiceUnavailable: It is no event of ours.
    """
    try:
        if event.event == "failed":
            return error_from_problem(json.loads(event.data), url=url)
        return PlanStatus.model_validate_json(event.data)
    except (ValidationError, ValueError, AttributeError) as error:
        raise _foreign(url) from error


def read_line(line: str, url: str) -> Plan | IkplanError:
    """Return what a line of a batch says: a plan, or why there is none.

    Raises:
        ServiceUnavailable: It is no line of ours.
    """
    try:
        answer = json.loads(line)
        if "plan" in answer:
            return Plan.load(answer["plan"])
        return error_from_problem(answer["problem"], url=url)
    except (ValidationError, ValueError, TypeError, KeyError, AttributeError) as error:
        raise _foreign(url) from error


def _foreign(url: str) -> ServiceUnavailable:
    return ServiceUnavailable(f"{url} sent an unexpected answer: is it an ikplan service?", url=url)
