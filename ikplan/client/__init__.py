"""The service's client: a synchronous and an asynchronous twin over one base.

Nothing here needs Pinocchio or a compiler.
"""

from __future__ import annotations

from ikplan.client.asynchronous import AsyncClient
from ikplan.client.jobs import AsyncPlanJob, PlanJob
from ikplan.client.synchronous import Client

__all__ = ["AsyncClient", "AsyncPlanJob", "Client", "PlanJob"]
