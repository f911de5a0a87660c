"""What a service lists of the plans that it keeps."""

from __future__ import annotations

from typing import Literal

from pydantic import BaseModel, Field

__all__ = ["Outcome", "PlanList", "PlanSummary"]

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
