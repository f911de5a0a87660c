"""Batches: every line is a request of its own, answered in order."""

from __future__ import annotations

import asyncio
import json
import logging
from collections import deque
from collections.abc import AsyncIterator
from typing import Any

from fastapi import Request

from ikplan.documents.json_text import json_ready
from ikplan.errors import IkplanError, InvalidRequest
from ikplan_api.handlers.store_faults import unavailable
from ikplan_api.http.body import too_long
from ikplan_api.http.owner import owner_of
from ikplan_api.http.problems import Refusal, http_problem, request_id_of
from ikplan_api.jobs.job_service import JobService
from ikplan_api.robots.uploads import named_robot
from ikplan_api.scenes.uploads import with_stored_scene
from ikplan_api.store.plan_store import StoreFault

__all__ = ["NDJSON", "plan_lines", "split_lines"]

_log = logging.getLogger("ikplan.service")

NDJSON = "application/x-ndjson"
"""Media type of JSON lines."""
_LONGEST_BLANK = 2**20
"""Longest line that is passed over if it is blank [bytes]."""


def split_lines(body: bytes, max_lines: int) -> list[bytes]:
    """Return the lines of a batch that are not blank.

    Args:
        body: The batch.
        max_lines: Largest number of lines.

    Raises:
        InvalidRequest: The batch is empty.
        Refusal: 413, it has too many lines.
    """
    # Counted first: a body of line feeds would be split into as many lines as it has bytes.
    if body.count(b"\n") > 2 * max_lines:
        error = InvalidRequest(
            f"the batch has more than {2 * max_lines} lines, blank ones included",
            allowed=f"at most {max_lines} requests",
        )
        raise Refusal(error, status=413)
    lines = [line for line in body.split(b"\n") if not _is_blank(line)]
    if not lines:
        raise InvalidRequest(
            "a batch needs at least one line with a request in JSON", allowed="JSON lines"
        )
    if len(lines) > max_lines:
        error = InvalidRequest(
            f"the batch has {len(lines)} requests, more than {max_lines}",
            allowed=f"at most {max_lines} requests",
        )
        raise Refusal(error, status=413)
    return lines


def _is_blank(line: bytes) -> bool:
    # A longer one is refused by itself, and looking at every byte of it would take 0.1 s.
    return len(line) <= _LONGEST_BLANK and not line.strip()


async def plan_lines(
    request: Request, lines: list[bytes], concurrency: int
) -> AsyncIterator[bytes]:
    """Yield a response line for every line of a batch, in order and as soon as possible.

    Args:
        request: The HTTP request.
        lines: The lines of the batch.
        concurrency: Largest number of lines in progress or waiting to be sent.
    """
    running: deque[asyncio.Task[bytes]] = deque()
    remaining = enumerate(lines)
    try:
        while True:
            while len(running) < concurrency and (line := next(remaining, None)) is not None:
                running.append(asyncio.create_task(_plan_line(request, *line)))
            if not running:
                return
            response_line = await running[0]
            running.popleft()
            yield response_line
    finally:
        # If the client has disconnected, the rest is no longer needed.
        for task in running:
            task.cancel()


async def _plan_line(request: Request, index: int, line: bytes) -> bytes:
    jobs: JobService = request.app.state.plan_jobs
    longest: int = request.app.state.settings.max_body_bytes
    try:
        if len(line) > longest:
            raise too_long(longest)
        line = await with_stored_scene(request, line)
        robot, known = await named_robot(request, "plan", line)
        job = await jobs.identify(
            "plan", line, robot, known, owner=owner_of(request), wait_if_full=True
        )
        plan = await jobs.run(job, wait_if_full=True)
    except IkplanError as error:
        return _failed(request, index, json_ready(error.to_problem()))
    except Refusal as refusal:
        problem = {**refusal.error.to_problem(), "status": refusal.status}
        return _failed(request, index, json_ready(problem))
    except StoreFault as fault:
        _log.error("the store failed: %s", fault)
        return _failed(request, index, json_ready(unavailable(fault).to_problem()))
    except Exception:
        _log.exception("line %d of a batch failed", index)
        return _failed(request, index, http_problem(500, "unexpected error in the service"))
    # The plan is already JSON on one line.
    return b'{"index": %d, "status": 200, "plan": %b}\n' % (index, plan)


def _failed(request: Request, index: int, problem: dict[str, Any]) -> bytes:
    problem = {**problem, "instance": f"urn:ikplan:request:{request_id_of(request)}"}
    answer = {"index": index, "status": problem["status"], "problem": problem}
    return json.dumps(answer, allow_nan=False).encode() + b"\n"
