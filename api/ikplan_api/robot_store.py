"""Where uploaded robots are kept."""

from __future__ import annotations

from collections import OrderedDict
from typing import NamedTuple, Protocol

__all__ = ["MemoryRobotStore", "RobotStore", "StoredRobot"]


class StoredRobot(NamedTuple):
    """An uploaded robot.

    Attributes:
        document: The upload in canonical form, as the workers get it.
        info: What ``GET /v1/robots/{name}`` answers.
    """

    document: bytes
    info: bytes


class RobotStore(Protocol):
    """Uploaded robots by id."""

    async def put(self, name: str, robot: StoredRobot) -> bool:
        """Keep a robot; return whether it is new.

        Raises:
            StoreFault: It cannot be kept.
        """

    async def get(self, name: str) -> StoredRobot | None:
        """Return a robot, or None if it is not kept."""

    async def delete(self, name: str) -> bool:
        """Forget a robot; return whether it was kept.

        Raises:
            StoreFault: It cannot be forgotten.
        """

    async def names(self) -> list[str]:
        """Return the names of all robots kept, sorted."""


class MemoryRobotStore:
    """Keeps the robots used last, in memory, bounded in number and in size.

    Args:
        max_robots: Most robots kept.
        max_bytes: Size of all robots kept [bytes].
    """

    def __init__(self, max_robots: int, max_bytes: int) -> None:
        self._max_robots = max_robots
        self._max_bytes = max_bytes
        self._robots: OrderedDict[str, StoredRobot] = OrderedDict()
        self._bytes = 0

    async def put(self, name: str, robot: StoredRobot) -> bool:
        """Keep a robot; those unused for longest make room for it."""
        new = not await self.delete(name)
        self._robots[name] = robot
        self._bytes += _size(robot)
        while len(self._robots) > self._max_robots or self._bytes > self._max_bytes:
            _, oldest = self._robots.popitem(last=False)
            self._bytes -= _size(oldest)
        return new

    async def get(self, name: str) -> StoredRobot | None:
        """Return a robot, or None if it is not kept."""
        if name in self._robots:
            self._robots.move_to_end(name)
        return self._robots.get(name)

    async def delete(self, name: str) -> bool:
        """Forget a robot; return whether it was kept."""
        robot = self._robots.pop(name, None)
        if robot is None:
            return False
        self._bytes -= _size(robot)
        return True

    async def names(self) -> list[str]:
        """Return the names of all robots kept, sorted."""
        return sorted(self._robots)


def _size(robot: StoredRobot) -> int:
    return len(robot.document) + len(robot.info)
