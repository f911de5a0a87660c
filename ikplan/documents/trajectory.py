"""The documents of a trajectory: its samples, waypoints, measures over time, and what it cost."""

from __future__ import annotations

from typing import Literal

from pydantic import Field

from ikplan.documents import Matrix, Vector
from ikplan.documents.certificate import Result

__all__ = [
    "EventResult",
    "MoveReport",
    "ObjectiveReport",
    "OrderReport",
    "PlanSeries",
    "Stats",
    "Trajectory",
    "WaypointResults",
]


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
    """The timed samples; time strictly increases, and the ends rest or move as asked for."""

    time: Vector = Field(description="Sample times, shape (m,) [s].")
    q: Matrix = Field(description="Joint values, shape (m, dof) [rad or m].")
    dq: Matrix = Field(description="Joint velocities, shape (m, dof) [rad/s or m/s].")
    ddq: Matrix = Field(description="Joint accelerations, shape (m, dof) [rad/s^2 or m/s^2].")


class EventResult(Result):
    """When an event is, and where the tool is then."""

    name: str = Field(description="Its name.")
    segment: int | None = Field(description="The segment that was asked for.")
    time: float = Field(description="When it is, since the begin of the motion [s].")
    position: Vector = Field(description="Position of the tool then, in the base, shape (3,) [m].")
    q: Vector = Field(description="Joint values then, shape (dof,) [rad or m].")
    position_error: float | None = Field(
        description="Distance from the place asked for [m]; null: a time was asked for."
    )


class MoveReport(Result):
    """What was found for one move around obstacles."""

    field: str = Field(description="The move in the request, such as `path.segments[2]`.")
    length: float = Field(description="Joint distance along it [rad or m].")
    found_length: float = Field(
        description="That of the way first found, before it was shortened [rad or m]."
    )
    least_length: float = Field(
        description="That of the straight joint motion between its ends, which none can undercut "
        "[rad or m]."
    )
    corners: int = Field(description="Corners of the shortened way.")
    stops: int = Field(description="Corners at which the motion stops, being too narrow to round.")
    samples: int = Field(description="Samples drawn in the search; 0: a straight motion was free.")


class OrderReport(Result):
    """The order found for a path whose order is free."""

    parts: list[int] = Field(
        description="Numbers of the segments of the request, or of its waypoints where it has "
        "those, in the order in which they are passed."
    )
    waypoints: list[int] = Field(
        description="For each row of `waypoints`, which row it would be in the given order."
    )
    duration: float = Field(description="How long the motion takes [s].")
    given_duration: float | None = Field(
        description="How long it takes in the given order [s]; null: it has no plan in that order."
    )
    gain: float | None = Field(
        description="By which share of it the motion is faster; 0: the given order is kept."
    )
    length: float = Field(description="Joint distance along the motion [rad or m].")
    given_length: float | None = Field(
        description="That of the motion in the given order [rad or m]."
    )


class ObjectiveReport(Result):
    """What an objective other than least joint motion gains."""

    objective: Literal["time"] = Field(description="What was made least.")
    duration: float = Field(description="Time of the motion [s].")
    length: float = Field(description="Joint distance along it [rad or m].")
    least_motion_duration: float = Field(
        description="Time of the motion that moves the joints least [s]."
    )
    least_motion_length: float = Field(description="Joint distance along that one [rad or m].")
    gain: float = Field(description="By which share of it the motion is faster; never below 0.")


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


class Stats(Result):
    """What the plan cost; outside the id and the byte-for-byte promise."""

    ik_evaluations: int = Field(description="Forward-kinematics evaluations of the IK solvers.")
    moves: list[MoveReport] = Field([], description="The moves around obstacles, in order.")
    seconds: dict[str, float] = Field(description="Wall-clock time of each stage [s].")
