"""The tangential acceleration of the tool, beside the norm of all of it."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import ikplan
from ikplan.certificate.limits import tool_acceleration_ratios
from ikplan.documents.plan_request import PlanRequest
from tests.present import present

UR5 = ikplan.load_robot("ur5")
START = [0.4, -1.2, 1.5, -0.8, -1.2, 0.3]
SPEED, ACCELERATION, RADIUS, ANGLE = 0.15, 0.1, 0.1, 3.0


def arc(limit: Any, **more: Any) -> dict[str, Any]:
    centre = np.add(UR5.fk(START).translation, [-RADIUS, 0.0, 0.0]).tolist()
    segment = {"type": "arc", "centre": centre, "angle": ANGLE, **more}
    return {
        "robot": "ur5",
        "start": START,
        "path": {"segments": [segment]},
        "limits": {"tool_speed": SPEED, "tool_acceleration": limit, "jerk": False},
        "scene": {"self_collision": False},
        "sampling": {"rate_hz": 1000},
    }


def speeds(plan: ikplan.Plan) -> np.ndarray:
    rows = zip(plan.q, plan.dq, strict=True)
    return np.array([np.linalg.norm((UR5.jacobian(q) @ dq)[:3]) for q, dq in rows])


def test_an_arc_takes_the_time_of_its_trapezoid() -> None:
    plan = ikplan.plan(arc({"tangential": ACCELERATION}))
    length = RADIUS * ANGLE
    exact = length / SPEED + SPEED / ACCELERATION
    assert plan.duration == pytest.approx(exact, rel=3e-3)
    speed = speeds(plan)
    rate = np.diff(speed) / np.diff(plan.time)
    assert np.abs(rate).max() <= ACCELERATION * 1.001
    assert np.abs(rate).max() >= ACCELERATION * 0.995
    # The centripetal share, v^2 / r, is more than twice as large.
    assert speed.max() ** 2 / RADIUS > 2.0 * ACCELERATION
    assert plan.certificate.tool_acceleration_ratio == pytest.approx(1.0, abs=2e-3)
    assert "tool_tangential_acceleration" in {b.limit for b in present(plan.timing).binding}


def test_the_norm_counts_the_centripetal_share_and_both_may_be_asked() -> None:
    norm = ikplan.plan(arc(ACCELERATION))
    both = ikplan.plan(arc({"linear": 2.0 * ACCELERATION, "tangential": ACCELERATION}))
    tangential = ikplan.plan(arc({"tangential": ACCELERATION}))
    assert speeds(norm).max() ** 2 / RADIUS <= ACCELERATION * 1.05
    assert speeds(both).max() ** 2 / RADIUS <= 2.0 * ACCELERATION * 1.05
    assert tangential.duration < both.duration < norm.duration


def test_a_segment_may_have_one_of_its_own() -> None:
    own = {"tool_acceleration": {"tangential": 0.5 * ACCELERATION}}
    plan = ikplan.plan(arc({"tangential": ACCELERATION}, limits=own))
    rate = np.diff(speeds(plan)) / np.diff(plan.time)
    assert np.abs(rate).max() <= 0.5 * ACCELERATION * 1.001
    (part,) = plan.certificate.segments
    assert 0.99 < present(part.tool_acceleration_ratio) <= 1.0 + 1e-9


def test_the_certificate_measures_how_the_speed_changes() -> None:
    """Against differences of the speeds of a motion that no tangential limit slows."""
    plan = ikplan.plan(arc(None))
    ratios = tool_acceleration_ratios(
        UR5, plan.q, plan.dq, plan.ddq, (np.inf, np.inf), tangential=1.0
    )
    measured = np.abs(np.gradient(speeds(plan), plan.time))
    middle = slice(5, -5)
    smooth = np.abs(np.diff(plan.ddq, axis=0)).max(axis=1) < 0.05
    inside = np.flatnonzero(smooth[4:-5] & smooth[5:-4]) + 5
    np.testing.assert_allclose(ratios[inside], measured[inside], atol=2e-2)
    assert ratios[middle].max() > 0.1


def test_requests_without_it_keep_their_ids() -> None:
    def identity(limit: Any) -> str:
        document = {
            "robot": "ur5",
            "path": {"waypoints": [{"position": [0.4, 0.1, 0.4]}]},
            "limits": {"tool_acceleration": limit},
        }
        return PlanRequest.model_validate(document).content_hash()

    assert identity({"linear": 0.5}) == "32b6d0d84491843325527d948998eda4"
    assert identity({"linear": 0.5, "tangential": 0.5}) != identity({"linear": 0.5})
