"""Who builds an uploaded robot for the first time: a disposable process with little memory."""

from __future__ import annotations

import asyncio
import json
import os
import sys
from typing import Any

from ikplan.errors import InvalidRobot, ServiceUnavailable, error_from_problem

__all__ = ["RobotBuilder"]

_ROOM = 8
"""Uploads that may be built or wait at the same time."""
_RETRY_AFTER_S = 2.0


class RobotBuilder:
    """Builds uploaded robots, one at a time, each in a process that ends with it.

    Args:
        max_bytes: Address space of the process [bytes].
        timeout_s: How long it may take [s].
    """

    def __init__(self, max_bytes: int, timeout_s: float) -> None:
        self._max_bytes = max_bytes
        self._timeout_s = timeout_s
        self._turn = asyncio.Semaphore(1)
        self._taken = 0

    async def build(self, document: bytes, *, name: str) -> dict[str, Any]:
        """Return what there is to tell of a robot, as ``GET /v1/robots/{name}`` does.

        Args:
            document: The upload in canonical form.
            name: Its id, for messages.

        Raises:
            InvalidRobot: The description makes no sense, or takes too much memory or time.
            ServiceUnavailable: Too many uploads at the same time.
        """
        if self._taken >= _ROOM:
            raise ServiceUnavailable(
                f"{self._taken} robots are being built; try again in {_RETRY_AFTER_S:g} s",
                status_code=ServiceUnavailable.status,
                retry_after_s=_RETRY_AFTER_S,
            )
        self._taken += 1
        try:
            async with self._turn:
                return await self._build(document, name)
        finally:
            self._taken -= 1

    async def _build(self, document: bytes, name: str) -> dict[str, Any]:
        process = await asyncio.create_subprocess_exec(
            *(sys.executable, "-m", "ikplan_api.build_robot"),
            *(str(self._max_bytes), str(max(1, round(self._timeout_s)))),
            stdin=asyncio.subprocess.PIPE,
            stdout=asyncio.subprocess.PIPE,
            stderr=asyncio.subprocess.DEVNULL,
            # Threads would each take address space of their own.
            env={**os.environ, "OMP_NUM_THREADS": "1", "OPENBLAS_NUM_THREADS": "1"},
        )
        try:
            said, _ = await asyncio.wait_for(process.communicate(document), self._timeout_s)
        except TimeoutError as error:
            raise InvalidRobot(
                f"{name}: building it takes longer than {self._timeout_s:g} s", robot=name
            ) from error
        finally:
            if process.returncode is None:
                process.kill()
                await process.wait()
        if process.returncode != 0:
            raise InvalidRobot(
                f"{name}: building it takes more than {self._max_bytes >> 20} MiB of memory or "
                f"{self._timeout_s:g} s, or ends the program that tries",
                robot=name,
            )
        verdict = json.loads(said)
        if "problem" in verdict:
            raise error_from_problem(verdict["problem"])
        info: dict[str, Any] = verdict["info"]
        return info
