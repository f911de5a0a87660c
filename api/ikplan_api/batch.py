"""Many requests in one: each line is planned by itself, and answered in its place."""

from __future__ import annotations

import asyncio
import json
import logging
from collections import deque
from collections.abc import AsyncIterator
from typing import Any

from fastapi import Request

from ikplan.errors import IkplanError, InvalidRequest
from ikplan_api.board import PlanBoard
from ikplan_api.problems import Refusal, http_problem, plain, request_id_of
from ikplan_api.uploads import robot_document

__all__ = ["NDJSON", "answer_lines", "split_lines"]

_log = logging.getLogger("ikplan.service")

NDJSON = "application/x-ndjson"
"""Media type of JSON lines."""


def split_lines(body: bytes, most: int) -> list[bytes]:
    """Return the lines of a batch that are not blank.

    Args:
        body: The batch.
        most: Most lines there may be.

    Raises:
        InvalidRequest: There is none.
        Refusal: 413, there are more.
    """
    lines = [line for line in body.split(b"\n") if line.strip()]
    if not lines:
        raise InvalidRequest(
            "a batch has at least one line, a request in JSON", allowed="JSON lines"
        )
    if len(lines) > most:
        error = InvalidRequest(
            f"the batch has {len(lines)} requests, more than {most}",
            allowed=f"at most {most} requests",
        )
        raise Refusal(error, status=413)
    return lines


async def answer_lines(request: Request, lines: list[bytes], at_once: int) -> AsyncIterator[bytes]:
    """Answer the lines of a batch, each with a line, in their order, as soon as they are known.

    Args:
        request: The request that brought them.
        lines: The lines.
        at_once: How many may be under way or wait to be sent.
    """
    under_way: deque[asyncio.Task[bytes]] = deque()
    left = enumerate(lines)
    try:
        while True:
            while len(under_way) < at_once and (line := next(left, None)) is not None:
                under_way.append(asyncio.create_task(_answer_line(request, *line)))
            if not under_way:
                return
            answer = await under_way[0]
            under_way.popleft()
            yield answer
    finally:
        # Whoever asked may have left: what is under way is no longer wanted.
        for task in under_way:
            task.cancel()


async def _answer_line(request: Request, index: int, line: bytes) -> bytes:
    board: PlanBoard = request.app.state.board
    try:
        robot = await robot_document(request, line)
        job = await board.identify("plan", line, robot, patient=True)
        plan = await board.make(job, patient=True)
    except IkplanError as error:
        return _failed(request, index, plain(error.to_problem()))
    except Exception:
        _log.exception("line %d of a batch failed", index)
        return _failed(request, index, http_problem(500, "an unexpected fault of the service"))
    # The plan is JSON on one line already.
    return b'{"index": %d, "status": 200, "plan": %b}\n' % (index, plan)


def _failed(request: Request, index: int, problem: dict[str, Any]) -> bytes:
    problem = {**problem, "instance": f"urn:ikplan:request:{request_id_of(request)}"}
    answer = {"index": index, "status": problem["status"], "problem": problem}
    return json.dumps(answer, allow_nan=False).encode() + b"\n"
