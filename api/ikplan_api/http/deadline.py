"""The deadline that a client sets for an answer."""

from __future__ import annotations

import asyncio
import math
from collections.abc import AsyncIterator
from contextlib import asynccontextmanager

from fastapi import Request

from ikplan.documents.json_text import shortened
from ikplan.errors import InvalidRequest, ServiceUnavailable

__all__ = ["DEADLINE", "late", "within_deadline"]

DEADLINE = "ikplan-deadline"
"""Request header: the time after which the answer is of no use [s]."""


@asynccontextmanager
async def within_deadline(request: Request) -> AsyncIterator[float]:
    """End work at the deadline of its request.

    Args:
        request: The request; without the header there is no deadline.

    Yields:
        The time that the request leaves; infinite without a deadline [s].

    Raises:
        InvalidRequest: The header is not a time.
        ServiceUnavailable: The deadline passed.
    """
    text = request.headers.get(DEADLINE)
    if text is None:
        yield math.inf
        return
    deadline_s = _seconds(text)
    try:
        async with asyncio.timeout(deadline_s):
            yield deadline_s
    except TimeoutError as error:
        raise late("the request is not finished", deadline_s, 1.0) from error


def late(why: str, deadline_s: float, wait_s: float) -> ServiceUnavailable:
    """Return the refusal of a request that does not make its deadline."""
    return ServiceUnavailable(
        f"{why}, and its deadline is {deadline_s:g} s",
        status_code=ServiceUnavailable.status,
        retry_after_s=float(max(1, math.ceil(wait_s))),
    )


def _seconds(text: str) -> float:
    try:
        seconds = float(text)
    except ValueError:
        seconds = math.nan
    if not 0.0 < seconds <= 1e6:  # NaN is refused, too
        raise InvalidRequest(
            f"the header Ikplan-Deadline is {shortened(text)!r}; give a time in seconds",
            field="",
            allowed="a time above 0 [s]",
        )
    return seconds
