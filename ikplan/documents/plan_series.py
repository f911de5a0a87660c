"""The document of what a plan does over time beside its samples: torques, deviation, clearance."""

from __future__ import annotations

from pydantic import Field

from ikplan.documents.base import Matrix, Vector
from ikplan.documents.certificate import Result

__all__ = ["PlanSeries"]


class PlanSeries(Result):
    """Measures of a plan over time, by the certificate's own means."""

    time: Vector = Field(description="Times of the samples, shape (m,) [s].")
    torque: Matrix | None = Field(
        description="Joint torques with gravity and payload, shape (m, dof) [N m or N]; null: the "
        "robot's inertias have no source."
    )
    torque_limit: list[float | None] = Field(
        description="Their limits [N m or N]; null: none is known."
    )
    deviation: list[float | None] = Field(
        description="Distance of the tool from its path, or outside the box of freedom about it, "
        "length m [m]; null: no tool path is followed there."
    )
    deviation_limit: float = Field(description="The position tolerance of the path [m].")
    turn: list[float | None] = Field(
        description="The same of its orientation, length m [rad]; null: none is asked for there."
    )
    turn_limit: float = Field(description="The orientation tolerance of the path [rad].")
    clearance_time: Vector = Field(description="Times at which distances are measured [s].")
    clearance: list[float | None] = Field(
        description="Least distance between bodies then, 0 where they touch [m]; null: no pair."
    )
    clearance_limit: float = Field(description="The clearance asked for [m].")
