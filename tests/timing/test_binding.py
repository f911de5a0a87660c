"""Which limit binds, what a wider one would bring, rest points, asymmetric limits, the ladder."""

from __future__ import annotations

import numpy as np
import pytest

from ikplan.errors import InvalidRequest, TimingFailed
from ikplan.joint_path import JointPath
from ikplan.limits import JointLimits
from ikplan.timing import binding, time_joint_path, what_if
from ikplan.timing.engines.compiled_engine import CompiledEngine
from ikplan.timing.engines.engine import EngineFailed
from ikplan.timing.engines.rows import StageRows
from ikplan.timing.engines.toppra_engine import ToppraEngine

from .cases import assert_keeps_limits, make_limits

NAMES = ("a", "b")
LINE = JointLimits([-99, -99], [99, 99], [1.0, 5.0], [2.0, 50.0], NAMES)  # type: ignore[arg-type]


def test_a_trapezoid_is_bound_by_acceleration_then_by_velocity() -> None:
    # Joint a moves 4: half a second up, half down, at 1 for 3.5 s between; joint b is idle.
    timed = time_joint_path(JointPath.through([[0.0, 0.0], [4.0, 0.1]], LINE), LINE)
    shares = {(s.limit, s.joint): s.share for s in binding(timed).summary()}
    assert set(shares) == {("velocity", "a"), ("acceleration", "a")}
    assert shares["velocity", "a"] == pytest.approx(3.5 / 4.5, abs=0.01)
    assert shares["acceleration", "a"] == pytest.approx(1.0 / 4.5, abs=0.01)
    assert binding(timed).sentence() == (
        "78 % of the time a velocity, 22 % of the time a acceleration"
    )


def test_some_limit_binds_nearly_everywhere() -> None:
    limits = make_limits(5)
    rng = np.random.default_rng(5)
    timed = time_joint_path(JointPath.through(rng.uniform(-2, 2, (12, 5)), limits), limits)
    found = binding(timed)
    assert found.dt.sum() == pytest.approx(timed.duration, rel=1e-12)
    assert found.dt[found.ratio > 0.97].sum() > 0.95 * timed.duration
    assert found.ratio.max() <= 1.0


def test_a_path_of_no_length_is_bound_by_nothing() -> None:
    found = binding(time_joint_path(JointPath.through([[0.0, 0.0]], LINE), LINE))
    assert found.summary() == []


def test_what_if_agrees_with_timing_again() -> None:
    limits = make_limits(4)
    rng = np.random.default_rng(2)
    path = JointPath.through(rng.uniform(-2, 2, (8, 4)), limits)
    timed = time_joint_path(path, limits)
    first = binding(timed).summary()[0]
    guess = what_if(timed, first.limit, first.joint)
    wider = getattr(limits, first.limit).copy()
    wider[limits.joint_names.index(first.joint or "")] *= 1.1
    fields = {"velocity": limits.velocity, "acceleration": limits.acceleration}
    fields[first.limit] = wider
    again = time_joint_path(
        path, JointLimits(limits.lower, limits.upper, joint_names=limits.joint_names, **fields)
    )
    assert guess.saved > 0.0
    assert guess.duration == pytest.approx(timed.duration - guess.saved)
    assert guess.duration == pytest.approx(again.duration, rel=2e-3)


def test_what_if_of_an_idle_limit_saves_nothing() -> None:
    timed = time_joint_path(JointPath.through([[0.0, 0.0], [4.0, 0.1]], LINE), LINE)
    assert what_if(timed, "velocity", "b").saved == pytest.approx(0.0, abs=1e-9)


@pytest.mark.parametrize(
    ("limit", "joint", "factor"),
    [("velocity", "c", 1.1), ("torque", "a", 1.1), ("velocity", "a", 0.0)],
)
def test_what_if_of_nonsense_is_refused(limit: str, joint: str, factor: float) -> None:
    timed = time_joint_path(JointPath.through([[0.0, 0.0], [4.0, 0.1]], LINE), LINE)
    with pytest.raises(InvalidRequest):
        what_if(timed, limit, joint, factor)


def test_asymmetric_limits_hold_each_way() -> None:
    limits = JointLimits(
        [-9.0],  # type: ignore[arg-type]
        [9.0],  # type: ignore[arg-type]
        [2.0],  # type: ignore[arg-type]
        [4.0],  # type: ignore[arg-type]
        ("j",),
        velocity_lower=[-1.0],  # type: ignore[arg-type]
        acceleration_lower=[-8.0],  # type: ignore[arg-type]
    )
    there = time_joint_path(JointPath.through([[0.0], [6.0]], limits), limits)
    back = time_joint_path(JointPath.through([[6.0], [0.0]], limits), limits)
    # Up at 4, down at 8, speed 2 there; up at 8, down at 4, speed 1 back.
    assert there.duration == pytest.approx(0.5 + 0.25 + (6.0 - 0.5 - 0.25) / 2.0, rel=3e-3)
    assert back.duration == pytest.approx(0.125 + 0.25 + (6.0 - 0.0625 - 0.125), rel=3e-3)
    assert_keeps_limits(there, limits)
    assert_keeps_limits(back, limits)


def test_a_limit_that_is_much_narrower_one_way_does_not_bind_the_other_way() -> None:
    limits = JointLimits([-99], [99], [0.5], [9.0], ("j",), velocity_lower=[-6.0])  # type: ignore[arg-type]
    back = time_joint_path(JointPath.through([[30.0], [0.0]], limits), limits)
    assert back.duration == pytest.approx(6.0 / 9.0 + 30.0 / 6.0, rel=3e-3)
    assert_keeps_limits(back, limits)


CORNERS = np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [2.0, 1.0]])


def test_exact_corners_come_to_rest_and_the_lines_between_stay_straight() -> None:
    timed = time_joint_path(JointPath.through(CORNERS, LINE, rest_at=[1, 2]), LINE)
    q, dq, _ = timed.evaluate(timed.times)
    assert np.abs(dq).max() < 1e-12
    assert np.abs(q - CORNERS).max() < 1e-12
    q, dq, _ = timed.evaluate(np.linspace(timed.times[0], timed.times[1], 50))
    assert np.abs(q[:, 1]).max() == 0.0
    assert np.abs(dq[1:-1, 0]).min() > 0.0
    assert_keeps_limits(timed, LINE)


def test_a_smooth_path_does_not_stop_at_its_waypoints() -> None:
    timed = time_joint_path(JointPath.through(CORNERS, LINE), LINE)
    _, dq, _ = timed.evaluate(timed.times[1:-1])
    assert np.linalg.norm(dq, axis=1).min() > 0.1


def test_a_straight_path_of_many_points_takes_no_longer_than_its_ends() -> None:
    ends = np.array([[0.0, 0.0], [4.0, 0.1]])
    many = ends[0] + np.linspace(0.0, 1.0, 60)[:, None] * (ends[1] - ends[0])
    durations = [time_joint_path(JointPath.through(w, LINE), LINE).duration for w in (ends, many)]
    assert durations[1] == pytest.approx(durations[0], rel=1e-3)


@pytest.mark.parametrize("seed", range(6))
def test_both_engines_find_the_same_motion(seed: int) -> None:
    limits = make_limits(6, seed=seed)
    q = np.random.default_rng(seed).uniform(-2, 2, (3 + 4 * seed, 6))
    path = JointPath.through(q, limits)
    durations = [
        time_joint_path(path, limits, engine=engine).duration
        for engine in (ToppraEngine(), CompiledEngine())
    ]
    assert durations[0] == pytest.approx(durations[1], rel=1e-4)


class Failing:
    """An engine that gives up."""

    calls = 0

    def solve(self, rows: StageRows) -> np.ndarray:
        self.calls += 1
        raise EngineFailed(len(rows.a) // 2)


def test_an_engine_that_fails_is_tried_on_finer_grids_and_then_told_with_the_place() -> None:
    engine = Failing()
    path = JointPath.through(CORNERS, LINE)
    with pytest.raises(TimingFailed) as error:
        time_joint_path(path, LINE, engine=engine)
    assert engine.calls == 3
    assert error.value.joint in NAMES
    assert error.value.limit == "acceleration"
    assert error.value.position == pytest.approx(0.5, abs=0.2)


def test_the_compiled_engine_stands_in_where_toppra_fails(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(ToppraEngine, "solve", Failing.solve)
    monkeypatch.setattr(ToppraEngine, "calls", 0, raising=False)
    timed = time_joint_path(JointPath.through(CORNERS, LINE), LINE)
    assert timed.spans[0].engine == "CompiledEngine"
    assert_keeps_limits(timed, LINE)


def test_limits_of_another_number_of_joints_are_refused() -> None:
    with pytest.raises(InvalidRequest, match="3 joints"):
        time_joint_path(JointPath.through(CORNERS, LINE), make_limits(3))
