"""The answers to requests about a single pose."""

from __future__ import annotations

from typing import Any

from pydantic import Field

from ikplan.documents import Booleans, Matrix, Vector
from ikplan.documents.certificate import Result
from ikplan.documents.poses import PostureReport

__all__ = ["FkResult", "IkBatchSolution", "IkSolution", "RefusedPose"]


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
    posture: PostureReport | None = Field(
        None, description="How far the solution keeps to `ik.posture`; null: none was given."
    )

    @classmethod
    def quick(cls, fields: dict[str, Any]) -> IkSolution:
        """Return a solution with all of its fields, in a third of the time of ``model_construct``.

        Args:
            fields: Every field but ``posture``, of its type.
        """
        fields["posture"] = None
        made = cls.__new__(cls)
        object.__setattr__(made, "__dict__", fields)
        object.__setattr__(made, "__pydantic_fields_set__", _SOLUTION_FIELDS)
        object.__setattr__(made, "__pydantic_extra__", None)
        object.__setattr__(made, "__pydantic_private__", None)
        return made


_SOLUTION_FIELDS = set(IkSolution.model_fields)


class RefusedPose(Result):
    """A pose without a solution."""

    pose: int = Field(description="Its index.")
    reason: str = Field(description="Why there is none, in words.")


class IkBatchSolution(Result):
    """Joint values for many poses of one robot; row k belongs to pose k."""

    q: Matrix = Field(
        description="Joint values, shape (n, dof) [rad or m]; of a pose without a solution, the "
        "best found."
    )
    solved: Booleans = Field(description="Whether each pose has a solution, shape (n,).")
    position_error: Vector = Field(description="Distance of each from its pose, shape (n,) [m].")
    orientation_error: Vector | None = Field(
        description="Rotation of each from its pose, shape (n,) [rad]; null: no orientations were "
        "asked for."
    )
    evaluations: int = Field(description="Forward-kinematics evaluations spent.")
    refused: list[RefusedPose] = Field(
        [], description="Why poses have no solution; empty without verdicts."
    )
