"""The result documents: plans, their certificates, and single FK and IK answers."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray
from pydantic import BaseModel, ConfigDict, Field

from ikplan.documents import Matrix, Vector
from ikplan.documents.timing_report import PathMotion, TimingReport

if TYPE_CHECKING:
    from collections.abc import Mapping

    from ikplan.documents.limits import LimitOptions
    from ikplan.playback import Moment

__all__ = [
    "Certificate",
    "FkResult",
    "IkSolution",
    "LimitPlace",
    "Plan",
    "SegmentCertificate",
    "Stats",
    "Trajectory",
    "WaypointResults",
]


class _Result(BaseModel):
    # Results of a newer service may carry more than this version knows: a client ignores it.
    model_config = ConfigDict(frozen=True, extra="ignore", arbitrary_types_allowed=True)


class LimitPlace(_Result):
    """Where a limit is approached most."""

    joint: str = Field(description="Name of the joint.")
    time: float = Field(description="Time of the sample [s].")


class SegmentCertificate(_Result):
    """What the check measured on a segment that has limits of its own; null: not limited there."""

    field: str = Field(description="What of the request asks for them.")
    begin: float = Field(description="When the segment begins [s].")
    end: float = Field(description="When it ends [s].")
    velocity_limit_ratio: float | None = Field(
        None, description="Largest joint speed over its limit; <= 1; null: no sample falls in it."
    )
    velocity_limit_at: LimitPlace | None = Field(None, description="Where.")
    acceleration_limit_ratio: float | None = Field(
        None, description="Largest joint acceleration over its limit; <= 1."
    )
    acceleration_limit_at: LimitPlace | None = Field(None, description="Where.")
    jerk_limit_ratio: float | None = Field(
        None, description="Largest joint jerk between samples over its limit; <= 1."
    )
    jerk_limit_at: LimitPlace | None = Field(None, description="Where.")
    torque_limit_ratio: float | None = Field(
        None, description="Largest joint torque over its limit; <= 1."
    )
    torque_limit_at: LimitPlace | None = Field(None, description="Where.")
    tool_speed_ratio: float | None = Field(
        None, description="Largest linear or angular tool speed over its limit; <= 1."
    )
    tool_speed_time: float | None = Field(None, description="Time of that sample [s].")
    tool_acceleration_ratio: float | None = Field(
        None, description="Largest linear or angular tool acceleration over its limit; <= 1."
    )
    tool_acceleration_time: float | None = Field(None, description="Time of that sample [s].")


class Certificate(_Result):
    """What an independent check by Pinocchio measured on the finished samples."""

    valid: bool = Field(description="Every promise is kept; a plan without it is never returned.")
    max_position_error: float | None = Field(
        description="Largest distance at a waypoint [m]; null: the waypoints are joint values."
    )
    max_orientation_error: float | None = Field(
        description="Largest rotation at a waypoint [rad]; null: no waypoint gives an orientation."
    )
    max_path_deviation: float | None = Field(
        description="Largest distance from the path between waypoints [m]; null for joint paths."
    )
    max_orientation_deviation: float | None = Field(
        description="Largest rotation from the path between waypoints [rad]; null for joint paths."
    )
    max_path_deviation_time: float | None = Field(None, description="When [s].")
    max_orientation_deviation_time: float | None = Field(None, description="When [s].")
    position_limit_ratio: float = Field(
        description="Largest distance from mid-range over half the range, of any joint; <= 1."
    )
    position_limit_at: LimitPlace | None = Field(description="Where; null: no joint has limits.")
    velocity_limit_ratio: float = Field(description="Largest joint speed over its limit; <= 1.")
    velocity_limit_at: LimitPlace = Field(description="Where.")
    acceleration_limit_ratio: float = Field(
        description="Largest joint acceleration over its limit; <= 1."
    )
    acceleration_limit_at: LimitPlace = Field(description="Where.")
    jerk_limited: bool = Field(
        False, description="Whether jerks are limited; if not, accelerations may jump."
    )
    jerk_limit_ratio: float | None = Field(
        None, description="Largest joint jerk between samples over its limit; null: no limit."
    )
    jerk_limit_at: LimitPlace | None = Field(None, description="Where.")
    torque_limit_ratio: float | None = Field(
        None,
        description="Largest joint torque over its limit, gravity and payload included; null: no "
        "limit.",
    )
    torque_limit_at: LimitPlace | None = Field(None, description="Where.")
    tool_speed_ratio: float | None = Field(
        None,
        description="Largest linear or angular tool speed over its limit; null: no limit.",
    )
    tool_speed_time: float | None = Field(None, description="Time of that sample [s].")
    tool_acceleration_ratio: float | None = Field(
        None,
        description="Largest linear or angular tool acceleration over its limit; null: no limit.",
    )
    tool_acceleration_time: float | None = Field(None, description="Time of that sample [s].")
    segments: list[SegmentCertificate] = Field(
        [], description="The same of each segment that has limits of its own."
    )
    min_singular_value: float = Field(
        description="Smallest singular value of the tool Jacobian on the samples [m and rad]."
    )
    min_singular_value_time: float = Field(description="Time of that sample [s].")
    elongation_sum: float = Field(
        description="Sum over the waypoints of the joint distance from the one before [rad or m]."
    )
    elongation_lower_bound: float = Field(
        description="No joint motion that passes the waypoints as exactly can be shorter "
        "[rad or m]."
    )


class WaypointResults(_Result):
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


class Trajectory(_Result):
    """The timed samples; time strictly increases, the motion begins and ends at rest."""

    time: Vector = Field(description="Sample times, shape (m,) [s].")
    q: Matrix = Field(description="Joint values, shape (m, dof) [rad or m].")
    dq: Matrix = Field(description="Joint velocities, shape (m, dof) [rad/s or m/s].")
    ddq: Matrix = Field(description="Joint accelerations, shape (m, dof) [rad/s^2 or m/s^2].")


class Stats(_Result):
    """What the plan cost; outside the id and the byte-for-byte promise."""

    ik_evaluations: int = Field(description="Forward-kinematics evaluations of the IK solvers.")
    seconds: dict[str, float] = Field(description="Wall-clock time of each stage [s].")


class Plan(_Result):
    """A certified joint trajectory."""

    id: str = Field(description="Hash of the canonical request, the robot and the version.")
    version: str = Field(description="Version of ikplan that made the plan.")
    robot: str = Field(description="Name of the robot.")
    joint_names: list[str] = Field(description="Names of the columns of q, dq and ddq.")
    joint_units: list[Literal["rad", "m"]] = Field(
        description='Unit of each column of q: "rad" for a turning joint, "m" for a sliding one.'
    )
    waypoints: WaypointResults
    trajectory: Trajectory
    certificate: Certificate
    timing: TimingReport | None = Field(
        None, description="Why the motion takes as long as it does; null: not told."
    )
    motion: PathMotion | None = Field(
        None, description='The motion as polynomials; only with sampling.form "polynomial".'
    )
    stats: Stats

    @property
    def duration(self) -> float:
        """Time of the last sample [s]."""
        return float(self.trajectory.time[-1])

    @property
    def time(self) -> NDArray[np.float64]:
        """Sample times, shape (m,) [s]."""
        return np.asarray(self.trajectory.time)

    @property
    def q(self) -> NDArray[np.float64]:
        """Joint values, shape (m, dof) [rad or m]."""
        return np.asarray(self.trajectory.q)

    @property
    def dq(self) -> NDArray[np.float64]:
        """Joint velocities, shape (m, dof) [rad/s or m/s]."""
        return np.asarray(self.trajectory.dq)

    @property
    def ddq(self) -> NDArray[np.float64]:
        """Joint accelerations, shape (m, dof) [rad/s^2 or m/s^2]."""
        return np.asarray(self.trajectory.ddq)

    def at(self, t: ArrayLike) -> Moment:
        """Evaluate the motion at any times.

        Exact where the plan has its motion as polynomials (``sampling.form`` "polynomial"),
        otherwise exact at the samples and between them by the cubics that have their positions
        and velocities, with accelerations linear between those of the samples.

        Args:
            t: A time, or times of shape (m,) [s]; clipped to [0, duration].

        Returns:
            Joint positions, velocities and accelerations, each of shape (dof,) or (m, dof).

        Raises:
            InvalidRequest: A time is not a finite number.
        """
        from ikplan.playback import evaluate

        return evaluate(self, t)

    def save(self, path: str | Path, format: str | None = None) -> None:
        """Write the plan to a file.

        Args:
            path: The file.
            format: "json", "csv", "npz", "ros" or "urscript"; None: the one that the suffix
                names (.json, .csv, .npz, .ros.json, .script).

        Raises:
            InvalidRequest: No such format, or the format cannot hold a plan for this robot.
            OSError: The file cannot be written.
        """
        from ikplan.export import save

        save(self, Path(path), format)

    def plot(self, path: str | Path) -> None:
        """Draw joint positions, velocities against their limits, and the tool's path.

        Args:
            path: Image file; the suffix (png, svg, pdf) names the format.
        """
        from ikplan.figures.plan import plot_plan

        plot_plan(self, Path(path))

    def plot_timing(
        self, path: str | Path, limits: Mapping[str, Any] | LimitOptions | None = None
    ) -> None:
        """Draw what the motion uses of its limits, the tool's speed and the phase plane.

        Args:
            path: Image file; the suffix (png, svg, pdf) names the format.
            limits: The limits of the request, which a plan does not tell; None: the robot's own.
        """
        from ikplan.figures.timing import plot_timing

        plot_timing(self, Path(path), limits=limits)

    @classmethod
    def load(cls, document: Mapping[str, Any] | str | bytes) -> Plan:
        """Read a plan back from its JSON document or mapping."""
        if isinstance(document, str | bytes):
            return cls.model_validate_json(document)
        return cls.model_validate(document)


class FkResult(_Result):
    """A tool pose in the robot's base."""

    position: Vector = Field(description="Tool position in the base, shape (3,) [m].")
    quaternion_xyzw: Vector = Field(description="Tool orientation in the base, shape (4,).")


class IkSolution(_Result):
    """Joint values that bring the tool to a pose."""

    q: Vector = Field(description="Joint values, shape (dof,) [rad or m].")
    position_error: float = Field(description="Distance from the target [m].")
    orientation_error: float | None = Field(
        description="Rotation from the target [rad]; null: no orientation was asked for."
    )
    elongation: float = Field(description="Joint distance from the start [rad or m].")
    evaluations: int = Field(description="Forward-kinematics evaluations spent.")
