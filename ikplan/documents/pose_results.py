"""The answers to requests about a single pose."""

from __future__ import annotations

from pydantic import Field

from ikplan.documents import Vector
from ikplan.documents.certificate import Result

__all__ = ["FkResult", "IkSolution"]


class FkResult(Result):
    """A tool pose in the robot's base."""

    position: Vector = Field(description="Tool position in the base, shape (3,) [m].")
    quaternion_xyzw: Vector = Field(description="Tool orientation in the base, shape (4,).")


class IkSolution(Result):
    """Joint values that bring the tool to a pose."""

    q: Vector = Field(description="Joint values, shape (dof,) [rad or m].")
    position_error: float = Field(description="Distance from the target [m].")
    orientation_error: float | None = Field(
        description="Rotation from the target [rad]; null: no orientation was asked for."
    )
    elongation: float = Field(description="Joint distance from the start [rad or m].")
    evaluations: int = Field(description="Forward-kinematics evaluations spent.")
