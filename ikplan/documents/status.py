"""What a service tells of its plans: how far one is, which there are, and who planned what."""

from __future__ import annotations

from typing import Literal

from pydantic import BaseModel, Field

__all__ = ["Audit", "AuditEntry", "Outcome", "PlanList", "PlanStatus", "PlanSummary"]


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


Outcome = Literal["finished", "failed", "unfinished"]
"""What became of a request for a plan."""


class PlanSummary(BaseModel):
    """One plan or job of a list."""

    id: str = Field(description="Id of the plan.")
    outcome: Outcome = Field(
        description="`finished`: the plan is stored; `failed`: the job ended with a problem; "
        "`unfinished`: the job waits or is in progress."
    )
    kind: Literal["plan", "time"] = Field(
        description="`plan`: planned from a tool path; `time`: a timed joint path."
    )
    robot: str | None = Field(description="Name of the robot; null: stored by an older version.")
    time: str = Field(
        description="When the plan was stored, or the job was accepted (RFC 3339, UTC)."
    )
    bytes: int | None = Field(description="Size of the plan in JSON; null: there is none.")
    problem: str | None = Field(None, description="Type of the problem of a failed job.")


class PlanList(BaseModel):
    """Plans and jobs, the newest first."""

    plans: list[PlanSummary]
    next: str | None = Field(
        description="Value of the query parameter `after` for the next page; null: this is the "
        "last one."
    )


class AuditEntry(BaseModel):
    """One action on a plan."""

    time: str = Field(description="When (RFC 3339, UTC).")
    owner: str = Field(description="Name of the key; empty: no keys, or keys that share the store.")
    action: str = Field(
        description="`accepted`: a job; `claimed`: a replica began it; `finished`: its plan is "
        "stored; `failed`; `late`: the end of a lost claim was refused; `deleted`."
    )
    id: str = Field(description="Id of the plan.")
    robot: str = Field(description="Name of the robot; empty: unknown.")
    replica: str = Field("", description="The replica; empty: there is one service.")
    attempt: int = Field(0, description="Number of the claim; 0: there is one service.")


class Audit(BaseModel):
    """Actions, the newest first."""

    entries: list[AuditEntry]
    next: int | None = Field(
        description="Value of the query parameter `before` for the next page; null: the last one."
    )
