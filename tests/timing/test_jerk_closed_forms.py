"""Jerk-limited moves along straight lines, held to closed forms."""

from __future__ import annotations

import math

import numpy as np
import pytest
from numpy.typing import NDArray

from ikplan.joint_path import JointPath
from ikplan.limits import JointLimits
from ikplan.timing import TimedPath, time_joint_path

Array = NDArray[np.float64]


def shortest(distance: float, v: float, up: float, down: float, jerk: float) -> float:
    """The least duration from rest to rest, the peak of the speed found by bisection."""

    def turning(peak: float) -> float:
        return sum(
            peak / a + a / jerk if peak * jerk >= a * a else 2.0 * math.sqrt(peak / jerk)
            for a in (up, down)
        )

    low, high = 0.0, v
    if 0.5 * v * turning(v) <= distance:
        return turning(v) + distance / v - 0.5 * turning(v)
    for _ in range(200):
        middle = 0.5 * (low + high)
        low, high = (middle, high) if 0.5 * middle * turning(middle) < distance else (low, middle)
    return turning(high)


def limits_of(v: Array, up: Array, down: Array, jerk: Array) -> JointLimits:
    n = len(v)
    return JointLimits(
        np.full(n, -1e6), np.full(n, 1e6), v, up, tuple("abcdefgh"[:n]), -v, -down, jerk
    )


def random_limits(rng: np.random.Generator, n: int) -> JointLimits:
    v, up, down, jerk = (
        np.exp(rng.uniform(np.log(low), np.log(high), n))
        for low, high in ((0.3, 5.0), (2.0, 30.0), (2.0, 30.0), (10.0, 1000.0))
    )
    return limits_of(v, up, down, jerk)


def timed_line(q: Array, limits: JointLimits) -> TimedPath:
    return time_joint_path(JointPath.through([np.zeros(len(q)), q], limits), limits)


def assert_keeps_limits(timed: TimedPath, limits: JointLimits) -> None:
    t = np.linspace(0.0, timed.duration, 3001)
    _, dq, ddq = timed.evaluate(t)
    assert limits.jerk is not None
    jerk = np.diff(ddq, axis=0) / np.diff(t)[:, None]
    assert (np.abs(dq) <= limits.velocity).all()
    assert (ddq <= limits.acceleration).all()
    assert (ddq >= limits.acceleration_lower).all()
    assert (np.abs(jerk) <= limits.jerk * (1.0 + 1e-6)).all()


@pytest.mark.parametrize("seed", range(30))
def test_a_move_of_one_joint_takes_as_long_as_the_closed_form(seed: int) -> None:
    rng = np.random.default_rng([1, seed])
    limits, distance = random_limits(rng, 1), float(np.exp(rng.uniform(-5.0, 2.0)))
    assert limits.jerk is not None
    for way in (distance, -distance):
        up, down = limits.acceleration[0], -limits.acceleration_lower[0]
        pair = (up, down) if way > 0.0 else (down, up)
        best = shortest(distance, limits.velocity[0], *pair, limits.jerk[0])
        timed = timed_line(np.array([way]), limits)
        assert best * (1.0 - 1e-9) <= timed.duration <= best * (1.0 + 1e-7)
        assert_keeps_limits(timed, limits)


@pytest.mark.parametrize("seed", range(15))
def test_a_straight_move_of_several_joints_takes_as_long_as_the_strictest_limits(
    seed: int,
) -> None:
    rng = np.random.default_rng([2, seed])
    n = int(rng.integers(2, 8))
    limits, q = random_limits(rng, n), rng.uniform(-3.0, 3.0, n)
    q[int(rng.integers(n))] = 0.0  # one stands still, and limits nothing
    assert limits.jerk is not None
    moving = q != 0.0
    way = np.abs(q[moving])
    up, down = limits.acceleration[moving], -limits.acceleration_lower[moving]
    ahead = q[moving] > 0.0
    best = shortest(
        1.0,
        float((limits.velocity[moving] / way).min()),
        float((np.where(ahead, up, down) / way).min()),
        float((np.where(ahead, down, up) / way).min()),
        float((limits.jerk[moving] / way).min()),
    )
    timed = timed_line(q, limits)
    assert best * (1.0 - 1e-9) <= timed.duration <= best * (1.0 + 1e-7)
    assert_keeps_limits(timed, limits)


@pytest.mark.parametrize(
    ("distance", "v", "a", "jerk", "duration"),
    [
        (9.0, 20.0, 180.0, 1900.0, 0.655848),  # ruckig issue 27, scaled as its maintainer says
        (2.0, 1.0, 100.0, 1.0, 4.0),  # the acceleration limit is not reached
        (20.0, 100.0, 1.0, 1.0, 10.0),  # the velocity limit is not reached
        (10.0, 1.0, 1.0, 1.0, 12.0),  # all are
    ],
)
def test_known_moves_take_as_long_as_their_optimum(
    distance: float, v: float, a: float, jerk: float, duration: float
) -> None:
    limits = limits_of(*(np.array([x]) for x in (v, a, a, jerk)))
    assert timed_line(np.array([distance]), limits).duration == pytest.approx(duration, rel=1e-6)


@pytest.mark.parametrize("seed", range(8))
def test_a_line_that_bends_a_hair_is_near_the_closed_form(seed: int) -> None:
    # Too bent for the closed form of a line, so that the numerical method is held to it.
    rng = np.random.default_rng([3, seed])
    limits = random_limits(rng, 2)
    limits = limits_of(
        limits.velocity[[0, 0]],
        limits.acceleration[[0, 0]],
        -limits.acceleration_lower[[0, 0]],
        np.array([0.1, 1.0]) * 10.0 * np.asarray(limits.acceleration[0]),
    )
    assert limits.jerk is not None
    distance = float(np.exp(rng.uniform(-2.0, 1.0)))
    path = JointPath.through([[0.0, 0.0], [0.5 * distance, 1e-6 * distance], [distance, 0.0]])
    timed = time_joint_path(path, limits)
    best = shortest(
        distance,
        limits.velocity[0],
        limits.acceleration[0],
        -limits.acceleration_lower[0],
        limits.jerk[0],
    )
    assert best * (1.0 - 1e-3) <= timed.duration <= 1.01 * best
    assert_keeps_limits(timed, limits)


def test_a_path_passed_backwards_takes_as_long_as_forwards() -> None:
    q = np.random.default_rng(4).uniform(-1.0, 1.0, (8, 4))
    limits = limits_of(*(np.full(4, x) for x in (1.5, 5.0, 5.0, 40.0)))
    there, back = (
        time_joint_path(JointPath.through(rows, limits), limits).duration for rows in (q, q[::-1])
    )
    assert there == pytest.approx(back, rel=5e-3)


@pytest.mark.parametrize("k", [0.1, 7.0])
def test_limits_of_a_faster_clock_divide_the_duration(k: float) -> None:
    q = np.random.default_rng(5).uniform(-1.0, 1.0, (6, 3))
    slow, fast = (
        limits_of(*(np.full(3, x) for x in (1.5 * f, 5.0 * f**2, 5.0 * f**2, 40.0 * f**3)))
        for f in (1.0, k)
    )
    durations = [time_joint_path(JointPath.through(q, x), x).duration for x in (slow, fast)]
    assert durations[0] == pytest.approx(k * durations[1], rel=1e-4)
