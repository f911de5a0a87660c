"""Limits, paths and judgements shared by the tests of the timing."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import ArrayLike

from ikplan.joint_path import JointPath
from ikplan.limits import JointLimits
from ikplan.timing import Samples, TimedPath, on_grid, sample, time_joint_path


def make_limits(dof: int, *, seed: int = 0, box: float = 3.0) -> JointLimits:
    rng = np.random.default_rng(seed)
    return JointLimits(
        lower=np.full(dof, -box),
        upper=np.full(dof, box),
        velocity=rng.uniform(1.0, 3.0, dof),
        acceleration=rng.uniform(5.0, 20.0, dof),
        joint_names=tuple(f"joint{i}" for i in range(dof)),
    )


def time_and_sample(
    waypoints: ArrayLike, limits: JointLimits, rate_hz: float = 250.0, rest_at: Sequence[int] = ()
) -> tuple[TimedPath, Samples]:
    """Time the joint path through waypoints, to end at a sample, and sample it."""
    path = JointPath.through(waypoints, limits, rest_at=rest_at)
    timed = on_grid(time_joint_path(path, limits), rate_hz)
    return timed, sample(timed, rate_hz)


def assert_keeps_limits(timed: TimedPath, limits: JointLimits) -> None:
    time = np.append(np.arange(0.0, timed.duration, 1e-4), timed.duration)
    q, dq, ddq = timed.evaluate(time)
    span = np.where(np.isfinite(limits.upper), limits.upper - limits.lower, 1.0)
    assert ((limits.lower - q) <= 1e-6 * span).all()
    assert ((q - limits.upper) <= 1e-6 * span).all()
    assert (dq <= limits.velocity * (1 + 1e-6)).all()
    assert (dq >= limits.velocity_lower * (1 + 1e-6)).all()
    assert (ddq <= limits.acceleration * (1 + 1e-6)).all()
    assert (ddq >= limits.acceleration_lower * (1 + 1e-6)).all()


def assert_meets_waypoints(timed: TimedPath, waypoints: np.ndarray) -> None:
    q, dq, _ = timed.evaluate(timed.times)
    scale = max(1.0, np.abs(waypoints).max())
    length = np.linalg.norm(np.diff(waypoints, axis=0), axis=1).sum()
    assert np.abs(q - waypoints).max() <= 1e-9 * length + 1e-14 * scale
    assert np.array_equal(q[0], waypoints[0])
    assert np.array_equal(q[-1], waypoints[-1])
    assert np.abs(dq[[0, -1]]).max() == 0.0


DOF = 6
RNG = np.random.default_rng(1)
TURN = np.linspace(0.0, 4.0 * np.pi, 20)[:, None]
CASES = {
    "helix": np.sin(TURN + np.arange(DOF)) * 0.5,
    "line": np.outer(np.linspace(0, 1, 7), np.arange(1.0, DOF + 1)) / DOF,
    "two points": RNG.uniform(-2, 2, (2, DOF)),
    "random": RNG.uniform(-3, 3, (30, DOF)),
    "walk": np.cumsum(RNG.normal(0, 0.01, (400, DOF)), axis=0),
    "duplicates": np.repeat(RNG.uniform(-2, 2, (6, DOF)), 3, axis=0),
    "near duplicates": np.repeat(RNG.uniform(-2, 2, (6, DOF)), 2, axis=0)
    + RNG.normal(0, 1e-8, (12, DOF)),
    "there and back": np.array([[0.0] * DOF, [1.0] * DOF, [0.0] * DOF]),
    "between the limits": np.array([[3.0] * DOF, [-3.0] * DOF, [3.0] * DOF, [2.9] * DOF]),
    "motion of 1e-9": np.array([[1.0] * DOF, [1.0 + 1e-9] * DOF]),
    "motion of one ulp": np.array([[1.0] * DOF, [np.nextafter(1.0, 2.0)] * DOF]),
    "one joint": np.array([[0.0] * DOF, [1.0] + [0.0] * (DOF - 1)]),
    "one waypoint": np.full((1, DOF), 0.3),
    "no motion": np.full((4, DOF), 0.3),
}
