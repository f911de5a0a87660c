"""Limits of single joints in a request: the motion keeps them, and none can be widened."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import ikplan
from ikplan.errors import IkplanError, InvalidRequest, Unreachable

UR5 = ikplan.load_robot("ur5")
FROM, TO = UR5.home, UR5.home + np.array([0.6, 0.3, -0.4, 0.2, 0.3, 0.5])
PAN, LIFT = UR5.joint_names[:2]


def timed(joints: dict[str, Any] | None) -> ikplan.Plan:
    return ikplan.time_path(UR5, [FROM, TO], limits={"joints": joints})


def test_the_motion_keeps_them() -> None:
    plain, slow = timed(None), timed({PAN: {"velocity": 0.2, "acceleration": 1.0}})
    assert np.abs(slow.dq[:, 0]).max() <= 0.2 + 1e-9
    assert np.abs(slow.ddq[:, 0]).max() <= 1.0 + 1e-9
    assert slow.duration > plain.duration
    assert slow.certificate.velocity_limit_ratio > 0.95
    assert slow.id != plain.id


def test_limits_as_wide_as_the_robots_own_change_nothing() -> None:
    same = timed({PAN: {"velocity": float(UR5.velocity_limit[0]), "lower": float(UR5.lower[0])}})
    np.testing.assert_array_equal(same.q, timed(None).q)


def line(joints: dict[str, Any] | None) -> ikplan.Plan:
    goal = UR5.fk(TO).translation.tolist()
    request = {
        "robot": "ur5",
        "path": {"waypoints": [{"position": goal}]},
        "limits": {"joints": joints},
    }
    return ikplan.plan(request)


def test_a_plan_stays_inside_a_narrower_range() -> None:
    free = line(None)
    moved = np.abs(free.q - free.q[0]).max(axis=0)
    i = int(np.argmax(moved))
    name, middle = UR5.joint_names[i], float(free.q[0, i])
    around = {
        joint: {"lower": float(q.min()) - 0.01, "upper": float(q.max()) + 0.01}
        for joint, q in zip(UR5.joint_names, free.q.T, strict=True)
    }
    made = line(around)
    for k, joint in enumerate(UR5.joint_names):
        assert made.q[:, k].min() >= around[joint]["lower"] - 1e-9
        assert made.q[:, k].max() <= around[joint]["upper"] + 1e-9
    # Held to the narrow ranges, which the motion nearly fills.
    assert 0.8 < made.certificate.position_limit_ratio <= 1.0
    close = {"lower": middle - 0.4 * float(moved[i]), "upper": middle + 0.4 * float(moved[i])}
    with pytest.raises(Unreachable, match=f"at its limit there: {name}"):
        line({name: close})


@pytest.mark.parametrize(
    ("joints", "field"),
    [
        ({"shoulder": {"velocity": 1.0}}, "limits.joints.shoulder"),
        ({PAN: {"velocity": 100.0}}, f"limits.joints.{PAN}.velocity"),
        ({PAN: {"acceleration": 1e5}}, f"limits.joints.{PAN}.acceleration"),
        ({PAN: {"lower": -100.0}}, f"limits.joints.{PAN}.lower"),
        ({PAN: {"upper": 100.0}}, f"limits.joints.{PAN}.upper"),
        ({PAN: {"lower": 1.0, "upper": 0.5}}, f"limits.joints.{PAN}"),
        ({PAN: {"velocity": 0.0}}, f"limits.joints.{PAN}.velocity"),
        ({PAN: {"speed": 1.0}}, f"limits.joints.{PAN}.speed"),
    ],
)
def test_what_is_wrong_is_named(joints: dict[str, Any], field: str) -> None:
    with pytest.raises(InvalidRequest) as caught:
        timed(joints)
    assert caught.value.field == field


def test_a_start_outside_of_the_range_is_refused() -> None:
    with pytest.raises(IkplanError, match=LIFT):
        line({LIFT: {"lower": float(UR5.home[1]) + 0.1}})
