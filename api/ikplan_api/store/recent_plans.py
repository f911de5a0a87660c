"""Bounded cache of the most recently used plans."""

from __future__ import annotations

from collections import OrderedDict

__all__ = ["RecentPlans"]


class RecentPlans:
    """The most recently used plans, in memory.

    Args:
        max_plans: Largest number of plans.
        max_bytes: Largest total size [bytes]; a plan larger than this is not stored.
    """

    def __init__(self, max_plans: int, max_bytes: int) -> None:
        self._max_plans = max_plans
        self._max_bytes = max_bytes
        self._plans: OrderedDict[str, bytes] = OrderedDict()
        self._bytes = 0

    def put(self, plan_id: str, document: bytes) -> None:
        """Store a plan and evict the least recently used ones."""
        self.delete(plan_id)
        if len(document) > self._max_bytes:
            return
        self._plans[plan_id] = document
        self._bytes += len(document)
        while len(self._plans) > self._max_plans or self._bytes > self._max_bytes:
            _, oldest = self._plans.popitem(last=False)
            self._bytes -= len(oldest)

    def get(self, plan_id: str) -> bytes | None:
        """Return a plan, or None if it is not stored."""
        if plan_id in self._plans:
            self._plans.move_to_end(plan_id)
        return self._plans.get(plan_id)

    def delete(self, plan_id: str) -> bool:
        """Delete a plan; return whether it was stored."""
        document = self._plans.pop(plan_id, None)
        self._bytes -= len(document or b"")
        return document is not None
