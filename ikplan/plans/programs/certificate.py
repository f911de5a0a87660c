"""The certificate of a thinned program: what holds if a controller interpolates as it names.

SI units: metres, radians, seconds.
"""

from __future__ import annotations

from typing import Literal

from pydantic import Field

from ikplan.documents.certificate import Result

__all__ = ["ProgramCertificate", "ProgramInterpolation"]

ProgramInterpolation = Literal["blended", "spline", "waypoints"]
"""What a controller does between the points of a program.

"blended": moves linear in the joints at constant speed, each corner rounded by parabolas of the
joints over half of the shorter move beside it; half of the first and of the last move is spent on
speeding up and slowing down. "spline": the cubic splines of the joints through the points, twice
continuously differentiable, at rest at both ends. "waypoints": from each point to the next the
motion of limited jerk that Ruckig makes, in a time, with the point's velocity and no acceleration
at its ends.
"""


class ProgramCertificate(Result):
    """What holds of a program's motion, for the interpolation that it names and no other."""

    interpolation: ProgramInterpolation = Field(
        description='What the controller does between points: "blended", "spline" or "waypoints".'
    )
    points: int = Field(description="Points of the program, the first one included.")
    duration: float = Field(description="Time that the program takes [s].")
    time_factor: float = Field(
        description="By how much that is longer than the plan, for the joint limits; >= 1."
    )
    tolerance: float = Field(description="Largest distance from the plan's path asked for [m].")
    max_path_deviation: float = Field(
        description="Largest distance of the tool from the plan's path, at any time [m]."
    )
    max_orientation_deviation: float = Field(
        description="Largest rotation of the tool from the plan's, where it is nearest [rad]."
    )
    max_joint_deviation: float = Field(
        description="Largest distance of a joint from the plan's, where the tool is nearest [rad]."
    )
    max_time_shift: float = Field(
        description="How early or late the tool passes a place of the path at most, between points "
        "that are passed in time [s]."
    )
    velocity_limit_ratio: float = Field(description="Largest joint speed over its limit; <= 1.")
    acceleration_limit_ratio: float = Field(
        description="Largest joint acceleration over its limit; <= 1."
    )
