"""Claims whose figures are known in closed form: arms of slides, or of one turning joint."""

from __future__ import annotations

import itertools
import math
from typing import Any

import numpy as np

from ikplan.certificate import Claim
from ikplan.documents.limits import LimitOptions
from ikplan.documents.path import PathRequest
from ikplan.limits.motion_limits import MotionLimits
from ikplan.robots import Robot
from tests.kinematics.synthetic import Joint, robot_of

V, A, RATE = 0.5, 2.0, 100.0
"""Limits on the velocity [m/s or rad/s] and the acceleration, and the samples a second."""

slide = robot_of([Joint("prismatic", axis=(1.0, 0.0, 0.0))]).with_limits([V], [A])
"""The tool is at (q, 0, 0)."""
wheel = robot_of([Joint("revolute")], tip=Joint("fixed", xyz=(0.4, 0.0, 0.0))).with_limits([V], [A])
"""The tool is at 0.4 m about the z axis, turned by q."""
gantry = robot_of(
    [Joint("prismatic", axis=(1.0, 0.0, 0.0)), Joint("prismatic", axis=(0.0, 1.0, 0.0))]
).with_limits([V, V], [A, A])
"""The tool is at (q1, q2, 0)."""
turntable = robot_of([Joint("prismatic", axis=(1.0, 0.0, 0.0)), Joint("revolute")]).with_limits(
    [V, V], [A, A]
)
"""The tool is at (q1, 0, 0), turned by q2 about z."""

Stop = float | tuple[float, ...]


def rest_to_rest(*stops: Stop) -> tuple[np.ndarray, ...]:
    """Samples of a motion from stop to stop, within the limits, and when each is passed.

    Each way is straight and has a trapezoid of speed in closed form whose parts take whole sample
    periods.

    Returns:
        Times, shape (m,); positions, velocities and accelerations, shape (m, dof); times of the
        stops after the first.
    """
    period, ramp = 1.0 / RATE, math.ceil(V / A * RATE)
    places = np.array(stops).reshape(len(stops), -1)
    still = np.zeros_like(places[0])
    rows, passed = [(0.0, places[0], still, still)], []
    for a, b in itertools.pairwise(places):
        hold = math.ceil(float(np.abs(b - a).max()) / V * RATE)
        speed = (b - a) / ((ramp + hold) * period)
        rate = speed / (ramp * period)
        for count, v0, acceleration in (
            (ramp, 0.0, rate),
            (hold, speed, still),
            (ramp, speed, -rate),
        ):
            t0, q0, *_ = rows[-1]
            for t in period * np.arange(1, count + 1):
                q = q0 + v0 * t + 0.5 * acceleration * t * t
                rows.append((t0 + t, q, v0 + acceleration * t, acceleration))
        rows[-1] = (rows[-1][0], b, still, rows[-1][3])
        passed.append(rows[-1][0])
    rows[0] = (*rows[0][:3], rows[1][3])
    time, q, dq, ddq = (np.array(column) for column in zip(*rows, strict=True))
    return time, q, dq, ddq, np.array(passed)


def claim(robot: Robot, *stops: Stop, **fields: Any) -> Claim:
    """The claim of a motion from rest to rest; its waypoints are joint values."""
    time, q, dq, ddq, passed = rest_to_rest(*stops)
    waypoints = np.array(stops[1:]).reshape(-1, robot.dof)
    known = {"path": None, "q_start": q[0], "waypoint_q": waypoints, "waypoint_time": passed}
    known["limits"] = MotionLimits.of(robot, LimitOptions())
    return Claim(**{"robot": robot, "time": time, "q": q, "dq": dq, "ddq": ddq, **known, **fields})


def through(*waypoints: dict[str, Any], **more: Any) -> PathRequest:
    """A path of waypoints, by joint motion."""
    return PathRequest.model_validate({"waypoints": list(waypoints), **more})
