"""First build of uploaded robots, each in a disposable process with bounded memory."""

from __future__ import annotations

import asyncio
import json
import os
import sys
from typing import Any

from ikplan.errors import InvalidRobot, ServiceUnavailable, error_from_problem

__all__ = ["RobotBuilder"]

_CAPACITY = 8
"""Uploads that may be built or wait at the same time; further ones are refused."""
_RETRY_AFTER_S = 2.0


class RobotBuilder:
    """Builds uploaded robots, one at a time, each in a process of its own.

    Args:
        max_bytes: Address space of the process [bytes].
        timeout_s: Time limit of a build [s].
    """

    def __init__(self, max_bytes: int, timeout_s: float) -> None:
        self._max_bytes = max_bytes
        self._timeout_s = timeout_s
        self._one_at_a_time = asyncio.Semaphore(1)
        self._pending = 0

    async def build(self, document: bytes, *, name: str) -> dict[str, Any]:
        """Build a robot; return its description as in ``GET /v1/robots/{name}``.

        Args:
            document: The upload in canonical form.
            name: Id of the robot, for messages.

        Raises:
            InvalidRobot: The description is invalid, or its build exceeds the memory or the time.
            ServiceUnavailable: Too many uploads at the same time.
        """
        if self._pending >= _CAPACITY:
            raise ServiceUnavailable(
                f"{self._pending} robots are being built; try again in {_RETRY_AFTER_S:g} s",
                status_code=ServiceUnavailable.status,
                retry_after_s=_RETRY_AFTER_S,
            )
        self._pending += 1
        try:
            async with self._one_at_a_time:
                return await self._build(document, name)
        finally:
            self._pending -= 1

    async def _build(self, document: bytes, name: str) -> dict[str, Any]:
        process = await asyncio.create_subprocess_exec(
            *(sys.executable, "-m", "ikplan_api.robots.build_robot"),
            *(str(self._max_bytes), str(max(1, round(self._timeout_s)))),
            stdin=asyncio.subprocess.PIPE,
            stdout=asyncio.subprocess.PIPE,
            stderr=asyncio.subprocess.DEVNULL,
            # Every thread would reserve address space of its own.
            env={**os.environ, "OMP_NUM_THREADS": "1", "OPENBLAS_NUM_THREADS": "1"},
        )
        try:
            async with asyncio.timeout(self._timeout_s):
                output, _ = await process.communicate(document)
        except TimeoutError as error:
            raise InvalidRobot(
                f"{name}: the build takes longer than {self._timeout_s:g} s", robot=name
            ) from error
        finally:
            if process.returncode is None:
                process.kill()
                await process.wait()
        if process.returncode != 0:
            raise InvalidRobot(
                f"{name}: the build takes more than {self._max_bytes >> 20} MiB of memory or "
                f"{self._timeout_s:g} s, or crashes",
                robot=name,
            )
        verdict = json.loads(output)
        if "problem" in verdict:
            raise error_from_problem(verdict["problem"])
        info: dict[str, Any] = verdict["info"]
        return info
