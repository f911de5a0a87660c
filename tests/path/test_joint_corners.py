"""Corners between joint motions and tool paths, rounded within a ball."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import ikplan
from ikplan import Certificate, CertificateViolated, InvalidRequest, Plan, load_robot
from ikplan.certificate import Claim, certify
from ikplan.documents.limits import LimitOptions
from ikplan.documents.plan_request import PlanRequest
from ikplan.limits.motion_limits import MotionLimits
from tests.measured import off_polyline

UR5 = load_robot("ur5")
START = np.array([0.2, -1.3, 1.5, -1.8, -1.57, 0.3])
CORNER = np.array([0.5, -1.1, 1.4, -1.7, -1.5, 0.1])
RADIUS = 0.05


def pose(q: Any, away: Any = (0.0, 0.0, 0.0)) -> dict[str, Any]:
    from pinocchio import Quaternion

    T = UR5.fk(q)
    turned = Quaternion(T.rotation).normalized().coeffs().tolist()
    return {"position": np.add(T.translation, away).tolist(), "quaternion_xyzw": turned}


def request(*segments: dict[str, Any], **more: Any) -> dict[str, Any]:
    return {
        "robot": "ur5",
        "start": START.tolist(),
        "path": {"segments": list(segments)},
        "scene": {"self_collision": False},
        **more,
    }


def joint(q: Any, **more: Any) -> dict[str, Any]:
    return {"type": "joint", "q": list(q), **more}


def line(away: Any, q: Any = CORNER, **more: Any) -> dict[str, Any]:
    return {"type": "line", "to": pose(q, away), **more}


AWAY = [0.0, 0.2, 0.1]
ORDERS = {
    "joint motion, line": [joint(CORNER, blend=RADIUS), line(AWAY)],
    "joint motion to a pose, line": [
        {"type": "joint", "to": pose(CORNER), "blend": RADIUS},
        line(AWAY),
    ],
    "line, joint motion": [
        {"type": "line", "to": pose(START, AWAY), "blend": RADIUS},
        joint(CORNER),
    ],
    "joint motion, arc": [
        joint(CORNER, blend=RADIUS),
        {
            "type": "arc",
            "via": pose(CORNER, [0.05, 0.1, 0.0])["position"],
            "to": pose(CORNER, [0.0, 0.2, 0.0]),
        },
    ],
}


@pytest.mark.parametrize("order", ORDERS)
def test_the_corner_is_passed_in_its_ball_without_a_stop_and_sooner(order: str) -> None:
    segments = ORDERS[order]
    plan = ikplan.plan(request(*segments))
    exact = ikplan.plan(request(*({k: v for k, v in s.items() if k != "blend"} for s in segments)))
    assert plan.certificate.valid
    assert len(exact.certificate.stops) == 1
    assert plan.certificate.stops == []
    assert plan.duration < exact.duration
    p = UR5.poses(plan.q)[1]
    corner = UR5.fk(exact.waypoints.q[0]).translation
    assert np.linalg.norm(p - corner, axis=1).min() <= RADIUS
    if "arc" in order:
        return
    # Off the line only where the tool is in the ball, or on the joint motion.
    begin, end = (START, [AWAY]) if order.startswith("line") else (CORNER, [AWAY])
    ends = [UR5.fk(begin).translation, np.add(UR5.fk(begin).translation, end[0])]
    off = off_polyline(p, ends)
    away = np.linalg.norm(p - corner, axis=1)
    times = np.array(plan.waypoints.time)
    on_line = plan.time <= times[0] if order.startswith("line") else plan.time >= times[0]
    assert (off[on_line & (away > RADIUS + 1e-4)] <= 1e-4).all()
    assert (on_line & (away > RADIUS + 1e-4)).sum() > 20


def test_both_ends_of_a_joint_motion_are_rounded_and_other_waypoints_are_met() -> None:
    second = np.add(CORNER, [0.4, 0.1, -0.2, 0.1, 0.0, 0.5])
    between = np.add(CORNER, [0.3, 0.2, -0.1, 0.0, 0.1, 0.2])
    plan = ikplan.plan(
        request(
            line(AWAY, START, blend=0.03),
            joint(between),
            joint(second, blend=0.03),
            line([0.0, 0.0, 0.15], second),
        )
    )
    assert plan.certificate.stops == []
    assert plan.waypoints.q[1] == pytest.approx(between, abs=1e-6)
    assert plan.q[-1] == pytest.approx(plan.waypoints.q[3], abs=1e-9)
    misses = [plan.waypoints.position_error[k] for k in range(4)]
    assert 1e-4 < misses[0] <= 0.03
    assert misses[1] <= 1e-6
    assert 1e-4 < misses[2] <= 0.03
    assert misses[3] <= 1e-6


def test_a_line_is_rounded_at_both_ends_and_a_joint_motion_between_two_lines() -> None:
    second = np.add(CORNER, [0.4, 0.1, -0.2, 0.1, 0.0, 0.5])
    for segments in (
        [joint(CORNER, blend=0.04), line(AWAY, blend=0.04), joint(second)],
        [line(AWAY, START, blend=0.04), joint(second, blend=0.04), line([0.0, 0.0, 0.15], second)],
        [
            joint(CORNER, blend=0.03),
            line(AWAY, blend=0.03),
            joint(second, blend=0.03),
            line([0.0, 0.0, 0.15], second, blend=0.03),
            joint(START),
        ],
    ):
        plan = ikplan.plan(request(*segments))
        exact = ikplan.plan(
            request(*({k: v for k, v in s.items() if k != "blend"} for s in segments))
        )
        assert len(exact.certificate.stops) == len(segments) - 1
        assert plan.certificate.stops == []
        assert plan.duration < exact.duration
        misses = np.array(plan.waypoints.position_error)
        blends = [s.get("blend", 0.0) for s in segments]
        assert (misses <= np.maximum(blends, 1e-6)).all()


def test_limits_of_both_segments_hold_about_the_corner() -> None:
    segments = [joint(CORNER, blend=RADIUS), line(AWAY, limits={"tool_speed": 0.1})]
    plan = ikplan.plan(request(*segments))
    speed = np.linalg.norm(
        [(UR5.jacobian(q) @ dq)[:3] for q, dq in zip(plan.q, plan.dq, strict=True)], axis=1
    )
    after = plan.time >= plan.waypoints.time[0]
    assert speed[after].max() <= 0.1 * (1.0 + 1e-9)
    assert speed[~after].max() > 0.2


def test_a_corner_that_is_passed_more_slowly_than_stopped_at_is_stopped_at() -> None:
    for radius in (0.001, 0.02, 0.2):
        segments = [joint(CORNER, blend=radius), line(AWAY)]
        rounded = ikplan.plan(request(*segments))
        exact = ikplan.plan(request(joint(CORNER), segments[1]))
        assert rounded.duration <= exact.duration


def claimed(plan: Plan, path: dict[str, Any]) -> Certificate:
    """The certificate of a trajectory held to another path."""
    return certify(
        Claim(
            robot=UR5,
            path=PlanRequest.model_validate(request(*path["segments"])).path,
            q_start=START,
            waypoint_q=plan.waypoints.q,
            waypoint_time=plan.waypoints.time,
            time=plan.time,
            q=plan.q,
            dq=plan.dq,
            ddq=plan.ddq,
            limits=MotionLimits.of(UR5, LimitOptions()),
        )
    )


def test_the_certificate_holds_the_motion_to_the_ball_and_to_the_path_beyond_it() -> None:
    segments = [joint(CORNER, blend=RADIUS), line(AWAY)]
    plan = ikplan.plan(request(*segments))
    assert claimed(plan, {"segments": segments}).valid
    for smaller in (0.5, 0.0):
        less = [joint(CORNER, blend=smaller * RADIUS), line(AWAY)]
        with pytest.raises(CertificateViolated, match="the path is left by"):
            claimed(plan, {"segments": less})


def test_a_path_that_comes_back_to_its_ball_cannot_be_left_out() -> None:
    """The tool stays at the corner; the path leads away from it and back."""
    plan = ikplan.plan(request(joint(CORNER)))
    back = [joint(CORNER, blend=RADIUS), line(AWAY), line([0.0, 0.0, 0.0])]
    still = replace_rows(plan)
    with pytest.raises(CertificateViolated, match="left"):
        claimed(still, {"segments": back})
    whole = [
        joint(CORNER, blend=RADIUS),
        {
            "type": "circle",
            "radius": 0.1,
            "frame": {"position": pose(CORNER, [-0.1, 0.0, 0.0])["position"]},
        },
    ]
    with pytest.raises(CertificateViolated, match="left"):
        claimed(replace_rows(plan), {"segments": whole})


def replace_rows(plan: Plan) -> Plan:
    """The plan with its only waypoint three times, the last two at its end."""
    rows = plan.waypoints.model_copy(
        update={
            "q": np.repeat(plan.waypoints.q, 3, axis=0),
            "time": np.array([0.9, 0.95, 1.0]) * plan.duration,
        }
    )
    return plan.model_copy(update={"waypoints": rows})


@pytest.mark.parametrize(
    ("segments", "field", "word"),
    [
        ([joint(CORNER, blend=0.05)], "path.segments[0].blend", "the motion ends there"),
        (
            [joint(CORNER, blend=0.05), {"type": "move", "q": START.tolist()}],
            "path.segments[0].blend",
            "a move begins at rest",
        ),
        ([joint(CORNER, blend=0.5), line(AWAY)], "path.segments[0].blend", "the largest radius"),
        (
            [line(AWAY, START, blend=0.5), joint(CORNER)],
            "path.segments[0].blend",
            "the largest radius",
        ),
        ([joint(CORNER, blend=-1.0), line(AWAY)], "path.segments[0].blend", "greater"),
    ],
)
def test_a_blend_without_a_corner_or_room_is_refused(
    segments: list[dict[str, Any]], field: str, word: str
) -> None:
    with pytest.raises(InvalidRequest, match=word) as refused:
        ikplan.plan(request(*segments))
    assert refused.value.field == field


def test_a_joint_segment_without_a_blend_keeps_its_id() -> None:
    def identity(**more: Any) -> str:
        return PlanRequest.model_validate(request(joint(CORNER, **more), line(AWAY))).content_hash()

    assert identity() == identity(blend=None) == "2639e7b51bbe2861073c8840ca6407e2"
    assert identity(blend=0.05) != identity()
