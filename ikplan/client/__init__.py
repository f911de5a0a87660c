"""The service's client: a synchronous and an asynchronous twin over one base.

Nothing here needs Pinocchio or a compiler.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from ikplan._lazy import on_first_use

if TYPE_CHECKING:
    from ikplan.client.asynchronous import AsyncClient
    from ikplan.client.jobs import AsyncPlanJob, PlanJob
    from ikplan.client.synchronous import Client
else:
    __getattr__ = on_first_use(
        __name__,
        {
            "AsyncClient": "asynchronous",
            "AsyncPlanJob": "jobs",
            "Client": "synchronous",
            "PlanJob": "jobs",
        },
    )

__all__ = ["AsyncClient", "AsyncPlanJob", "Client", "PlanJob"]
