"""How far a plan is that a service makes."""

from __future__ import annotations

from typing import Literal

from pydantic import BaseModel, Field

__all__ = ["PlanStatus"]


class PlanStatus(BaseModel):
    """How far a plan is."""

    id: str = Field(description="Id of the plan.")
    state: Literal["queued", "running", "finished", "failed", "cancelled"] = Field(
        description="What becomes of it."
    )
    stage: str | None = Field(
        None, description="What is being done: ik, planning, timing or certificate."
    )
    done: int = Field(0, description="Waypoints that are done.")
    total: int = Field(0, description="Waypoints that it has to do; 0: it does not count them.")

    @property
    def ended(self) -> bool:
        """Whether nothing will change any more."""
        return self.state not in ("queued", "running")
