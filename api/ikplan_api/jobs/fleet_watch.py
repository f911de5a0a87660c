"""A job of any replica, as it is watched from this one."""

from __future__ import annotations

import asyncio
import json
from collections.abc import AsyncIterator
from typing import Any

from ikplan.documents.status import PlanStatus
from ikplan_api.store.plan_store import StoreFault
from ikplan_api.store.postgres.queue import JobRow
from ikplan_api.store.postgres.store import PostgresStore

__all__ = ["FleetWatch"]

_LOOK_S = 1.0
"""Time without a notification after which the row is read [s]."""
_AGAIN_S = 0.5


class FleetWatch:
    """A job in progress.

    Args:
        store: The store.
        key: Owner and plan id.
        row: What is known of it.
    """

    def __init__(self, store: PostgresStore, key: tuple[str, str], row: JobRow) -> None:
        self._store = store
        self._key = key
        self._status = row.status
        self._problem: dict[str, Any] | None = None

    @property
    def status(self) -> PlanStatus:
        """Its progress when it was looked for, or last told of."""
        return self._status

    @property
    def problem(self) -> dict[str, Any] | None:
        """The problem document, once it failed."""
        return self._problem

    async def watch(self) -> AsyncIterator[PlanStatus]:
        """Yield the status now and after every change, until the end.

        The row is the truth; notifications tell of changes between two looks at it.
        """
        told: PlanStatus | None = None
        with self._store.changes.of(self._key) as changes:
            change: dict[str, Any] | None = None
            while True:
                if change is None:
                    try:
                        await self._look()
                    except StoreFault:  # the job goes on, and so does who watches it
                        await asyncio.sleep(_AGAIN_S)
                        continue
                else:
                    self._hear(change)
                if self._status != told:
                    told = self._status
                    yield told
                if told.ended:
                    return
                try:
                    async with asyncio.timeout(_LOOK_S):
                        change = await changes.get()
                except TimeoutError:
                    change = None

    def _hear(self, change: dict[str, Any]) -> None:
        self._status = PlanStatus(
            id=self._key[1],
            state=change["state"],
            stage=change.get("stage"),
            done=change.get("done", 0),
            total=change.get("total", 0),
        )
        if self._status.ended:
            # As far as it is told, the stage is that in which it ended.
            self._problem = change.get("problem")

    async def _look(self) -> None:
        owner, plan_id = self._key
        row = await self._store.queue.look(plan_id, owner)
        if row is not None:
            self._status = row.status
            self._problem = None if row.problem is None else json.loads(row.problem)
            return
        found = await self._store.plans.get(plan_id, owner)
        state = "cancelled" if found is None else "finished"
        self._status = self._status.model_copy(update={"state": state})
