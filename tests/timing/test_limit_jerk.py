"""Jerk-limited motions that are given up as soon as another one is known to be shorter."""

from __future__ import annotations

import numpy as np
import pytest

from ikplan.arrays import Array
from ikplan.joint_path import JointPath
from ikplan.limits import JointLimits
from ikplan.timing import limit_jerk as room
from ikplan.timing.engines.engine import Check
from ikplan.timing.jerk.double_s import double_s_duration
from ikplan.timing.jerk.jerk import smooth_span
from ikplan.timing.jerk.least_duration import least_duration
from ikplan.timing.jerk.smoothed import Smoothed
from ikplan.timing.limit_jerk import NotShorter, limit_jerk
from ikplan.timing.problem import SpanProblem
from ikplan.timing.time_joint_path import passing_jumps, time_before_jerk, time_joint_path

from .cases import make_limits
from .test_jerk import with_jerk


def stops(seed: int, count: int = 9, dof: int = 4) -> tuple[JointPath, JointLimits]:
    """A path of spans from rest to rest, straight and bent by turns."""
    rng = np.random.default_rng(seed)
    limits = with_jerk(make_limits(dof, seed=seed), 10.0 ** rng.uniform(0.5, 1.8))
    q = rng.uniform(-0.5, 0.5, (count, dof))
    rests = [k for k in range(count) if k % 3 != 1]
    return JointPath.through(q, limits, rest_at=rests), limits


def smoothed_of(monkeypatch: pytest.MonkeyPatch) -> list[SpanProblem]:
    """The spans that are smoothed from now on."""
    asked: list[SpanProblem] = []

    def noted(problem: SpanProblem, check: Check) -> Smoothed:
        asked.append(problem)
        return smooth_span(problem, check)

    monkeypatch.setattr(room, "smooth_span", noted)
    return asked


@pytest.mark.parametrize("seed", range(6))
def test_a_lower_bound_is_below_the_motion_and_meets_closed_forms(seed: int) -> None:
    path, limits = stops(seed)
    timed = time_joint_path(path, limits)
    assert limits.jerk is not None
    for span, smoothed, first in zip(
        timed.spans, timed.smoothed, timed.path.rest_knots[:-1], strict=True
    ):
        by_jerk, without = least_duration(span.problem, span.x)
        assert 0.0 < without < smoothed.duration
        assert 0.0 < by_jerk < smoothed.duration * (1.0 + 1e-9)
        last = timed.path.rest_knots[timed.path.rest_knots.index(first) + 1]
        if (
            last == first + 1
        ):  # a straight line: close, unless one joint bounds the speed, another the jerk
            assert max(by_jerk, without) > 0.95 * smoothed.duration


def test_one_joint_takes_at_least_the_double_s_profile() -> None:
    low, high = np.array([-9.0]), np.array([9.0])
    limits = JointLimits(
        low, high, np.array([1.5]), np.array([4.0]), ("a",), jerk=np.array([20.0]),
        acceleration_lower=np.array([-3.0]),
    )  # fmt: skip
    for q, up, down in (([[0.0], [2.0]], 4.0, 3.0), ([[2.0], [0.0]], 3.0, 4.0)):
        begun = time_before_jerk(JointPath.through(q, limits), limits)
        by_jerk, _ = least_duration(begun.spans[0].problem, begun.spans[0].x)
        assert by_jerk == pytest.approx(double_s_duration(2.0, 1.5, up, down, 20.0), rel=1e-12)


@pytest.mark.parametrize("seed", range(4))
def test_a_motion_that_is_short_enough_is_the_same_as_without_a_bound(seed: int) -> None:
    path, limits = stops(seed)
    free = time_joint_path(path, limits)
    begun = time_before_jerk(path, limits)
    assert not begun.jerk_limited
    held = limit_jerk(begun, most=free.duration * (1.0 + 1e-12))

    def arrays(timed: object) -> list[Array]:
        return [getattr(timed, name) for name in ("node_times", "s", "sdot", "sddot")]

    assert all(np.array_equal(a, b) for a, b in zip(arrays(held), arrays(free), strict=True))


def test_a_longer_motion_is_given_up_before_all_of_it_is_found(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    path, limits = stops(1, count=30)
    begun = time_before_jerk(path, limits)
    duration = limit_jerk(begun).duration
    asked = smoothed_of(monkeypatch)
    for share, most in ((0.6, 0), (0.97, len(begun.spans) // 2), (0.9999, len(begun.spans))):
        asked.clear()
        with pytest.raises(NotShorter):
            limit_jerk(begun, most=share * duration)
        assert len(asked) <= most
    assert len(begun.spans) > 15


def test_a_motion_passes_the_places_where_only_jerk_limits_ask_for_a_rest() -> None:
    # A spline held inside the position limits: its curvature jumps where it is bent.
    limits = with_jerk(make_limits(2), 20.0)
    top = float(limits.upper[0])
    q = np.array([[0.0, 0.0], [top - 1e-3, 0.3], [top - 1e-3, 0.6], [0.0, 0.9], [-0.5, 0.0]])
    path = JointPath.through(q, limits)
    begun = time_before_jerk(path, limits)
    assert len(begun.spans) > 1
    passed = passing_jumps(begun, path.s_knots[list(path.rest_knots)])
    assert len(passed.spans) == 1
    smooth = make_limits(2)
    free = time_joint_path(path, smooth)
    assert passed.duration < begun.duration
    assert passed.duration == pytest.approx(free.duration, rel=6e-3)
    same = passing_jumps(begun, begun.path.s_knots[list(begun.path.rest_knots)])
    assert same is begun
