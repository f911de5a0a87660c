"""The motion of a proof is the motion that a plan hands out."""

from __future__ import annotations

import numpy as np
import pytest

import ikplan
from ikplan.certificate.clearance import JointCurve
from ikplan.certificate.clearance.bounds import joint_ranges, joint_values
from ikplan.errors import InvalidRequest

Q = [
    [0.0, -1.2, 1.0, 0.0, 0.5, 0.0],
    [0.6, -1.0, 0.7, 0.3, 0.5, 1.0],
    [0.1, -1.4, 0.2, 0.3, 0.0, 1.0],
]


def planned(form: str, jerk: float | bool) -> ikplan.Plan:
    return ikplan.time_request(
        {
            "robot": "ur5",
            "waypoints": Q,
            "limits": {"jerk": jerk},
            "sampling": {"rate_hz": 100.0, "form": form},
        }
    )


@pytest.fixture(scope="module", params=[False, 200.0], ids=["acceleration", "jerk"])
def exact(request: pytest.FixtureRequest) -> ikplan.Plan:
    return planned("polynomial", request.param)


def test_polynomials_pass_where_the_plan_is_at_any_time(exact: ikplan.Plan) -> None:
    assert exact.motion is not None
    curve = JointCurve.of_motion(exact.motion)
    assert curve.duration == pytest.approx(exact.duration)
    for t in np.linspace(0.0, exact.duration, 57):
        low, high = curve.window(float(t), float(t))
        assert high - low <= 1e-9
        np.testing.assert_allclose(curve.at(low), exact.at(float(t))[0], atol=1e-9)


def test_windows_of_polynomials_hold_every_instant_in_them(exact: ikplan.Plan) -> None:
    assert exact.motion is not None
    curve = JointCurve.of_motion(exact.motion)
    rng = np.random.default_rng(1)
    for _ in range(20):
        begin, end = np.sort(rng.uniform(0.0, exact.duration, 2))
        low, high = curve.window(float(begin), float(end))
        for t in np.linspace(begin, end, 9):
            u, _ = curve.window(float(t), float(t))
            assert low - 1e-9 <= u <= high + 1e-9


def test_times_of_polynomials_are_those_of_their_places(exact: ikplan.Plan) -> None:
    assert exact.motion is not None
    curve = JointCurve.of_motion(exact.motion)
    for u in np.linspace(0.0, len(curve.controls), 41):
        np.testing.assert_allclose(exact.at(curve.time(float(u)))[0], curve.at(float(u)), atol=1e-7)


def test_cubics_between_samples_are_those_of_playback() -> None:
    plan = planned("samples", False)
    curve = JointCurve.of_samples(plan.time, plan.q, plan.dq)
    for t in np.linspace(0.0, plan.duration, 97):
        u, _ = curve.window(float(t), float(t))
        np.testing.assert_allclose(curve.at(u), plan.at(float(t))[0], atol=1e-12)
        assert curve.time(u) == pytest.approx(float(t), abs=1e-12)


def test_joint_values_stay_in_the_ranges_of_every_interval() -> None:
    rng = np.random.default_rng(2)
    controls = rng.standard_normal((7, 4, 3))
    controls[1:, 0] = controls[:-1, 3]
    low, high = controls.min(axis=1), controls.max(axis=1)
    q, delta, at = np.zeros(3), np.zeros(3), np.zeros(3)
    for _ in range(300):
        a, b = np.sort(rng.uniform(0.0, 7.0, 2))
        if rng.random() < 0.3:
            b = min(a + 1e-3, 7.0)
        joint_values(controls, float(0.5 * (a + b)), q)
        joint_ranges(controls, low, high, float(a), float(b), q, delta)
        for u in np.linspace(a, b, 13):
            joint_values(controls, float(u), at)
            assert (np.abs(at - q) <= delta + 1e-12).all()
        if b - a < 2e-3:
            assert delta.max() < 0.1


def test_a_motion_of_one_sample_stands_still() -> None:
    curve = JointCurve.of_samples(np.zeros(1), np.ones((1, 2)), np.zeros((1, 2)))
    assert curve.duration == 0.0
    np.testing.assert_allclose(curve.at(0.7), [1.0, 1.0])


@pytest.mark.parametrize(
    ("time", "q"),
    [([0.0, 0.0], [[0.0], [1.0]]), ([0.0], [[0.0], [1.0]]), ([0.0, 1.0], [[0.0], [np.nan]])],
)
def test_samples_that_are_no_motion_are_refused(time: list[float], q: list[list[float]]) -> None:
    rows = np.array(q)
    with pytest.raises(InvalidRequest):
        JointCurve.of_samples(np.array(time), rows, np.zeros_like(rows))


def test_a_motion_that_leaves_its_path_is_refused(exact: ikplan.Plan) -> None:
    assert exact.motion is not None
    beyond = exact.motion.model_copy(update={"node_s": exact.motion.node_s + 0.1})
    with pytest.raises(InvalidRequest, match="leaves its path"):
        JointCurve.of_motion(beyond)
