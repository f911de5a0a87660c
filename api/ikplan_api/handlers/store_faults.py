"""The answer where the store cannot be read or written now."""

from __future__ import annotations

from ikplan.errors import ServiceUnavailable
from ikplan_api.store.plan_store import StoreFault

__all__ = ["unavailable"]


def unavailable(error: StoreFault) -> ServiceUnavailable:
    """Return what a client is told: when to ask again, and nothing of the store itself."""
    return ServiceUnavailable(
        "the store of the service fails now; try again later",
        status_code=ServiceUnavailable.status,
        retry_after_s=error.retry_after_s,
    )
