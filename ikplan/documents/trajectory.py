"""The documents of a trajectory: its samples, its waypoints and what it cost."""

from __future__ import annotations

from pydantic import Field

from ikplan.documents import Matrix, Vector
from ikplan.documents.certificate import Result

__all__ = ["Stats", "Trajectory", "WaypointResults"]


class WaypointResults(Result):
    """One row for each waypoint asked for."""

    q: Matrix = Field(description="Joint values, shape (n, dof) [rad or m].")
    time: Vector = Field(description="When the waypoint is passed, shape (n,) [s].")
    position_error: Vector = Field(description="Distance from the waypoint, shape (n,) [m].")
    orientation_error: list[float | None] = Field(
        description="Rotation from the waypoint, length n [rad]; null where none is asked for."
    )
    elongation: Vector = Field(
        description="Joint distance from the waypoint before, or the start, shape (n,) [rad or m]."
    )


class Trajectory(Result):
    """The timed samples; time strictly increases, the motion begins and ends at rest."""

    time: Vector = Field(description="Sample times, shape (m,) [s].")
    q: Matrix = Field(description="Joint values, shape (m, dof) [rad or m].")
    dq: Matrix = Field(description="Joint velocities, shape (m, dof) [rad/s or m/s].")
    ddq: Matrix = Field(description="Joint accelerations, shape (m, dof) [rad/s^2 or m/s^2].")


class Stats(Result):
    """What the plan cost; outside the id and the byte-for-byte promise."""

    ik_evaluations: int = Field(description="Forward-kinematics evaluations of the IK solvers.")
    seconds: dict[str, float] = Field(description="Wall-clock time of each stage [s].")
