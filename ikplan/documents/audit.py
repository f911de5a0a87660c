"""What a service tells of who planned what."""

from __future__ import annotations

from pydantic import BaseModel, Field

__all__ = ["Audit", "AuditEntry"]


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
