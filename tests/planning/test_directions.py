"""Plans do not depend on the lengths of a request's axes, and the tool turns as geometry says.

The poses that the samples are held to come from Rodrigues' formula about the unit axis and from
Pinocchio's kinematics, and from no path code of the project.
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pinocchio as pin
import pytest
from numpy.typing import NDArray

import ikplan
from ikplan import Plan, load_robot

Array = NDArray[np.float64]

START = [0.4, -1.2, 1.5, -0.8, -1.2, 0.3]
UR5 = load_robot("ur5")
T0 = UR5.fk(START)
RADIUS, ANGLE = 0.06, 0.9
# Not of unit length, and near to the tool's z axis, about which the arm can turn far.
AXIS = 1.7 * (T0.rotation[:, 2] + np.array([0.1, -0.05, 0.08]))
TOWARDS = 0.6 * (T0.rotation[:, 2] + np.array([-0.1, 0.2, 0.1]))
FRAME = pin.SE3(pin.exp3(np.array([0.4, -0.7, 0.5])), np.array([0.1, -0.2, 0.05]))
ARCS = ("constant", "follow", "free", "end", "end about")
KINDS = (*(f"arc {rule}" for rule in ARCS), "arc via", "line")
TOLERANCE = {"position": 1e-4, "orientation": 1e-3}
# Freedom of the orientation, whether in a path frame, whether from a free start.
SETTINGS: dict[str, tuple[dict[str, Any] | None, bool, bool]] = {
    "as it is": (None, False, False),
    "in a frame, from anywhere": (None, True, True),
    "free about z, in a frame": ({"about": "tool_z"}, True, False),
    "in a cone about y, from anywhere": ({"about": "tool_y", "cone": 0.05}, False, True),
}


def rodrigues(axis: Array, angle: float) -> Array:
    x, y, z = axis / math.sqrt(float(axis @ axis))
    K = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
    return np.asarray(np.eye(3) + math.sin(angle) * K + (1.0 - math.cos(angle)) * K @ K)


def across(axis: Array) -> Array:
    aside = np.cross(axis, [0.3, 0.2, 1.0])
    return np.asarray(aside / np.linalg.norm(aside))


CENTRE = T0.translation + RADIUS * across(AXIS)
TO = T0.translation + np.array([0.05, 0.04, 0.03])
TURN_ABOUT, TURN_BY = T0.rotation[:, 2], 2.6
"""The turn from the begin to the end, the shorter way; TOWARDS asks for it."""
R1 = rodrigues(TURN_ABOUT, TURN_BY) @ T0.rotation


def planned(kind: str, scale: float, setting: str) -> Plan:
    free, framed, anywhere = SETTINGS[setting]
    T_frame = FRAME if framed else pin.SE3.Identity()
    R = T_frame.rotation.T

    def waypoint(p: Array, rotation: Array) -> dict[str, Any]:
        x = pin.SE3ToXYZQUAT(T_frame.actInv(pin.SE3(rotation, p))).tolist()
        return {"position": x[:3], "quaternion_xyzw": x[3:]}

    towards = (scale * (R @ TOWARDS)).tolist()
    segment: dict[str, Any]
    if kind == "line":
        segment = {"type": "line", "to": waypoint(TO, R1), "turn_axis": towards}
    elif kind == "arc via":
        via = 0.5 * (T0.translation + TO) + 0.02 * across(TO - T0.translation)
        segment = {
            "type": "arc", "via": T_frame.actInv(via).tolist(), "to": waypoint(TO, R1),
            "turn_axis": towards,
        }  # fmt: skip
    else:
        rule: Any = kind.removeprefix("arc ")
        segment = {
            "type": "arc", "centre": T_frame.actInv(CENTRE).tolist(), "angle": ANGLE,
            "axis": (scale * (R @ AXIS)).tolist(), "orientation": rule,
        }  # fmt: skip
        if rule.startswith("end"):
            end = waypoint(TO, R1)["quaternion_xyzw"]
            segment["orientation"] = {"quaternion_xyzw": end}
        if rule == "end about":
            segment["turn_axis"] = towards
    x = pin.SE3ToXYZQUAT(T_frame).tolist()
    path: dict[str, Any] = {
        "frame": {"position": x[:3], "quaternion_xyzw": x[3:]},
        "segments": [segment],
        "orientation_free": free,
        "tolerance": TOLERANCE,
    }
    if anywhere:
        path["begin"] = waypoint(T0.translation, T0.rotation)
    start = "free" if anywhere else START
    return ikplan.plan({"robot": "ur5", "start": start, "path": path, "ik": {"method": "lm"}})


def pose_at(kind: str, share: float) -> tuple[Array | None, Array]:
    """Rotation (None: free) and position on a path, by how much of its length is behind."""
    if kind in ("line", "arc via"):
        R = rodrigues(TURN_ABOUT, share * TURN_BY) @ T0.rotation
        if kind == "line":
            return R, T0.translation + share * (TO - T0.translation)
        return R, arc_point(share)
    turn = rodrigues(AXIS, share * ANGLE)
    p = CENTRE + turn @ (T0.translation - CENTRE)
    rotations: dict[str, Array | None] = {
        "arc constant": T0.rotation,
        "arc follow": turn @ T0.rotation,
        "arc free": None,
    }
    ended = rodrigues(TURN_ABOUT, share * TURN_BY) @ T0.rotation
    return rotations.get(kind, ended), p


def arc_point(share: float) -> Array:
    """The point of the circle through three points, by the law of sagitta and chord."""
    chord = TO - T0.translation
    c, h = 0.5 * float(np.linalg.norm(chord)), 0.02
    radius = (c * c + h * h) / (2.0 * h)
    half = math.atan2(c, radius - h)
    middle, up = 0.5 * (T0.translation + TO), across(chord)
    centre = middle - (radius - h) * up
    angle = half * (2.0 * share - 1.0)
    along = chord / (2.0 * c)
    return np.asarray(centre + radius * (math.sin(angle) * along + math.cos(angle) * up))


def off(kind: str, T: pin.SE3, share: float) -> tuple[float, Array]:
    """Distance [m] of the tool from a place of the path, and the rotation vector from it [rad]."""
    R, p = pose_at(kind, share)
    turn = np.zeros(3) if R is None else pin.log3(R.T @ T.rotation)
    return float(np.linalg.norm(T.translation - p)), np.asarray(turn)


def allowed(kind: str, T: pin.SE3, share: float, free: dict[str, Any] | None) -> bool:
    """Whether the tool is at a place of the path, as far as the tolerance goes."""
    distance, turn = off(kind, T, share)
    angle = float(np.linalg.norm(turn))
    if free is not None and (R := pose_at(kind, share)[0]) is not None:
        column = ("tool_x", "tool_y", "tool_z").index(free["about"])
        a, b = R[:, column], T.rotation[:, column]
        angle = math.atan2(float(np.linalg.norm(np.cross(a, b))), float(a @ b))
        angle -= free.get("cone", 0.0)
    return distance <= 1.01 * TOLERANCE["position"] and angle <= 1.01 * TOLERANCE["orientation"]


@pytest.mark.parametrize("setting", SETTINGS)
@pytest.mark.parametrize("kind", KINDS)
def test_the_tool_turns_as_geometry_says_whatever_the_length_of_the_axes(
    kind: str, setting: str
) -> None:
    free = SETTINGS[setting][0]
    plans = [planned(kind, scale, setting) for scale in (1.0, 0.1, 10.0)]
    for plan in plans:
        T_end = UR5.fk(plan.q[-1])
        assert allowed(kind, T_end, 1.0, free)
        # Where half of the way is behind, some place near the half is met.
        travelled = np.linalg.norm(np.diff([UR5.fk(q).translation for q in plan.q], axis=0), axis=1)
        behind = np.concatenate([[0.0], np.cumsum(travelled)])
        middle = int(np.argmin(np.abs(behind - 0.5 * behind[-1])))
        share = behind[middle] / behind[-1]
        near = share + np.linspace(-0.01, 0.01, 401)
        assert any(allowed(kind, UR5.fk(plan.q[middle]), float(x), free) for x in near)
    one, *others = plans
    for other in others:
        # 0.1 is no binary number: the axes differ by rounding, which the path and the waypoints
        # pass on and the choice of the speed magnifies (up to 9e-11 s and 2e-11 rad seen).
        assert np.abs(other.waypoints.q - one.waypoints.q).max() < 1e-12
        assert other.time.shape == one.time.shape
        for name in ("time", "q"):
            assert np.abs(getattr(other, name) - getattr(one, name)).max() < 1e-9, name


@pytest.mark.parametrize("kind", KINDS)
def test_axes_longer_by_a_power_of_two_give_the_same_bytes(kind: str) -> None:
    one, other = (planned(kind, scale, "in a frame, from anywhere") for scale in (1.0, 8.0))
    for name in ("time", "q", "dq", "ddq"):
        assert np.array_equal(getattr(one, name), getattr(other, name))
