"""Where finished plans are kept."""

from __future__ import annotations

from collections import OrderedDict
from typing import Protocol

__all__ = ["MemoryStore", "PlanStore"]


class PlanStore(Protocol):
    """Finished plans by id, as the bytes that were answered."""

    async def put(self, plan_id: str, document: bytes) -> None:
        """Keep a plan."""

    async def get(self, plan_id: str) -> bytes | None:
        """Return a plan, or None if it is not kept."""


class MemoryStore:
    """Keeps the plans used last, in memory, bounded in number and in size.

    Args:
        max_plans: Most plans kept.
        max_bytes: Size of all plans kept [bytes]; a larger plan is not kept at all.
    """

    def __init__(self, max_plans: int, max_bytes: int) -> None:
        self._max_plans = max_plans
        self._max_bytes = max_bytes
        self._plans: OrderedDict[str, bytes] = OrderedDict()
        self._bytes = 0

    async def put(self, plan_id: str, document: bytes) -> None:
        """Keep a plan; those unused for longest make room for it."""
        self._bytes -= len(self._plans.pop(plan_id, b""))
        if len(document) > self._max_bytes:
            return
        self._plans[plan_id] = document
        self._bytes += len(document)
        while len(self._plans) > self._max_plans or self._bytes > self._max_bytes:
            _, oldest = self._plans.popitem(last=False)
            self._bytes -= len(oldest)

    async def get(self, plan_id: str) -> bytes | None:
        """Return a plan, or None if it is not kept."""
        if plan_id in self._plans:
            self._plans.move_to_end(plan_id)
        return self._plans.get(plan_id)
