"""Interface of a store for uploaded robots, and one in memory."""

from __future__ import annotations

from collections import OrderedDict
from typing import NamedTuple, Protocol

__all__ = ["MemoryRobotStore", "RobotStore", "StoredRobot"]


class StoredRobot(NamedTuple):
    """An uploaded robot.

    Attributes:
        document: The upload in canonical form, as the workers receive it.
        info: The response of ``GET /v1/robots/{name}``.
    """

    document: bytes
    info: bytes


class RobotStore(Protocol):
    """Uploaded robots by id."""

    async def put(self, name: str, robot: StoredRobot) -> bool:
        """Store a robot; return whether it is new.

        Raises:
            StoreFault: The write fails.
        """

    async def get(self, name: str) -> StoredRobot | None:
        """Return a robot, or None if it is not stored."""

    async def delete(self, name: str) -> bool:
        """Delete a robot; return whether it was stored.

        Raises:
            StoreFault: The write fails.
        """

    async def names(self) -> list[str]:
        """Return the names of all stored robots, sorted."""


class MemoryRobotStore:
    """Keeps the most recently used robots in memory, bounded in number and size.

    Args:
        max_robots: Largest number of robots.
        max_bytes: Largest total size [bytes].
    """

    def __init__(self, max_robots: int, max_bytes: int) -> None:
        self._max_robots = max_robots
        self._max_bytes = max_bytes
        self._robots: OrderedDict[str, StoredRobot] = OrderedDict()
        self._bytes = 0

    async def put(self, name: str, robot: StoredRobot) -> bool:
        """Store a robot and evict the least recently used ones."""
        new = not await self.delete(name)
        self._robots[name] = robot
        self._bytes += _size(robot)
        while len(self._robots) > self._max_robots or self._bytes > self._max_bytes:
            _, oldest = self._robots.popitem(last=False)
            self._bytes -= _size(oldest)
        return new

    async def get(self, name: str) -> StoredRobot | None:
        """Return a robot, or None if it is not stored."""
        if name in self._robots:
            self._robots.move_to_end(name)
        return self._robots.get(name)

    async def delete(self, name: str) -> bool:
        """Delete a robot; return whether it was stored."""
        robot = self._robots.pop(name, None)
        if robot is None:
            return False
        self._bytes -= _size(robot)
        return True

    async def names(self) -> list[str]:
        """Return the names of all stored robots, sorted."""
        return sorted(self._robots)


def _size(robot: StoredRobot) -> int:
    return len(robot.document) + len(robot.info)
