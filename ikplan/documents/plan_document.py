"""The document of a plan: what is kept, sent and read back."""

from __future__ import annotations

from typing import Literal

import numpy as np
from pydantic import Field

from ikplan.arrays import Array
from ikplan.documents.certificate import Certificate, Result
from ikplan.documents.controller import ControllerInfo
from ikplan.documents.poses import PostureReport
from ikplan.documents.timing_report import MotionPolynomials, TimingReport
from ikplan.documents.trajectory import (
    EventResult,
    ObjectiveReport,
    OrderReport,
    Stats,
    Trajectory,
    WaypointResults,
)

__all__ = ["PlanDocument"]


class PlanDocument(Result):
    """A certified joint trajectory, as data."""

    id: str = Field(description="Hash of the canonical request, the robot and the version.")
    version: str = Field(description="Version of ikplan that made the plan.")
    robot: str = Field(description="Name of the robot.")
    joint_names: list[str] = Field(description="Names of the columns of q, dq and ddq.")
    joint_units: list[Literal["rad", "m"]] = Field(
        description='Unit of each column of q: "rad" for a turning joint, "m" for a sliding one.'
    )
    waypoints: WaypointResults
    order: OrderReport | None = Field(
        None, description="The order found; null: the path was passed as it is written."
    )
    objective: ObjectiveReport | None = Field(
        None, description="What `ik.objective` gains; null: least joint motion was asked for."
    )
    trajectory: Trajectory
    certificate: Certificate
    timing: TimingReport | None = Field(
        None, description="Why the motion takes as long as it does; null: not told."
    )
    motion: MotionPolynomials | None = Field(
        None, description='The motion as polynomials; only with sampling.form "polynomial".'
    )
    posture: PostureReport | None = Field(
        None, description="How far the motion keeps to `ik.posture`; null: none was given."
    )
    controller: ControllerInfo | None = Field(
        None, description="The robot's controller; null: none is known."
    )
    events: list[EventResult] = Field([], description="When the events asked for are.")
    stats: Stats

    @property
    def duration(self) -> float:
        """Time of the last sample [s]."""
        return float(self.trajectory.time[-1])

    @property
    def time(self) -> Array:
        """Sample times, shape (m,) [s]."""
        return np.asarray(self.trajectory.time)

    @property
    def q(self) -> Array:
        """Joint values, shape (m, dof) [rad or m]."""
        return np.asarray(self.trajectory.q)

    @property
    def dq(self) -> Array:
        """Joint velocities, shape (m, dof) [rad/s or m/s]."""
        return np.asarray(self.trajectory.dq)

    @property
    def ddq(self) -> Array:
        """Joint accelerations, shape (m, dof) [rad/s^2 or m/s^2]."""
        return np.asarray(self.trajectory.ddq)
