"""Every axis of a request is a direction: its length changes nothing, its turn is Rodrigues'."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pinocchio as pin
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.testing import assert_allclose
from numpy.typing import NDArray

from ikplan.path import ToolPath

from .requests import START, of_segments, pose, quaternion, seeds

Array = NDArray[np.float64]

assert START.R is not None
R0, P0 = START.R, START.p
FRAME_TURN = np.array([0.4, -0.7, 0.5])
FRAME_ORIGIN = np.array([0.1, -0.2, 0.05])
RULES = ("constant", "follow", "free", "end", "end about")


def rodrigues(axis: Array, angle: float) -> Array:
    """The rotation by an angle about an axis of any length, by Rodrigues' formula."""
    x, y, z = axis / math.sqrt(float(axis @ axis))
    K = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
    return np.asarray(np.eye(3) + math.sin(angle) * K + (1.0 - math.cos(angle)) * K @ K)


def frame(turned: bool) -> tuple[dict[str, Any], Array, Array]:
    """A path frame as a document, and its rotation and origin."""
    if not turned:
        return {}, np.eye(3), np.zeros(3)
    document = {"position": FRAME_ORIGIN.tolist(), "quaternion_xyzw": quaternion(FRAME_TURN)}
    return document, rodrigues(FRAME_TURN, float(np.linalg.norm(FRAME_TURN))), FRAME_ORIGIN


def the_way(axis: Array, angle: float, towards: Array) -> tuple[Array, float]:
    """Of the two turns to one orientation, the one about the axis nearer to a direction."""
    return (axis, angle) if axis @ towards > 0.0 else (-axis, 2.0 * math.pi - angle)


def scaled(vector: Array, length: float) -> list[float]:
    components: list[float] = (length * vector / np.linalg.norm(vector)).tolist()
    return components


@settings(max_examples=80, deadline=None)
@given(
    seed=seeds,
    rule=st.sampled_from(RULES),
    length=st.sampled_from([0.1, 1.0, 10.0, 1e-6, 1e4]),
    turned=st.booleans(),
)
def test_an_arc_turns_by_its_angle_about_its_axis_whatever_its_length(
    seed: int, rule: str, length: float, turned: bool
) -> None:
    rng = np.random.default_rng(seed)
    document, R, p = frame(turned)
    axis, towards, spoke = rng.normal(size=(3, 3))
    angle = float(rng.uniform(0.2, 4.0) * rng.choice([-1.0, 1.0]))
    centre = P0 + 0.3 * spoke
    z = R @ axis
    # The orientation at the end, told as a turn in the base after that at the begin.
    about, by = rng.normal(size=3), float(rng.uniform(0.3, 2.5))
    about /= np.linalg.norm(about)
    R1 = rodrigues(about, by) @ R0
    segment: dict[str, Any] = {
        "type": "arc", "centre": (R.T @ (centre - p)).tolist(), "angle": angle,
        "axis": scaled(axis, length), "orientation": rule,
    }  # fmt: skip
    if rule.startswith("end"):
        segment["orientation"] = {"quaternion_xyzw": quaternion(pin.log3(R.T @ R1))}
    if rule == "end about":
        segment["turn_axis"] = scaled(towards, length)
        about, by = the_way(about, by, R @ towards)
    path = of_segments(segment, frame=document)
    for share in (0.0, 0.3, 0.5, 1.0):
        R_path, p_path = path.pose(share * path.length)
        turn = rodrigues(z, share * angle)
        assert_allclose(p_path, centre + turn @ (P0 - centre), atol=1e-12)
        if rule == "follow":
            assert_allclose(R_path, turn @ R0, atol=1e-12)
        elif rule == "constant":
            assert_allclose(R_path, R0, atol=1e-12)
        elif rule != "free":
            assert_allclose(R_path, rodrigues(about, share * by) @ R0, atol=1e-11)
    assert any(piece.oriented for piece in path.pieces) == (rule != "free")


@settings(max_examples=60, deadline=None)
@given(
    seed=seeds,
    kind=st.sampled_from(["line", "arc"]),
    length=st.sampled_from([0.1, 1.0, 10.0, 1e-6, 1e4]),
    turned=st.booleans(),
    half=st.booleans(),
)
def test_a_turn_axis_tells_the_way_whatever_its_length(
    seed: int, kind: str, length: float, turned: bool, half: bool
) -> None:
    rng = np.random.default_rng(seed)
    document, R, p = frame(turned)
    about, towards, by_line, aside = rng.normal(size=(4, 3))
    about /= np.linalg.norm(about)
    by = math.pi if half else float(rng.uniform(0.3, 3.0))
    to = P0 + 0.2 * by_line
    waypoint = {
        "position": (R.T @ (to - p)).tolist(),
        "quaternion_xyzw": quaternion(pin.log3(R.T @ rodrigues(about, by) @ R0)),
    }
    segment: dict[str, Any] = {"type": kind, "to": waypoint, "turn_axis": scaled(towards, length)}
    if kind == "arc":
        via = 0.5 * (P0 + to) + 0.05 * np.cross(by_line, aside)
        segment["via"] = (R.T @ (via - p)).tolist()
    path = of_segments(segment, frame=document)
    axis, angle = the_way(about, by, R @ towards)
    for share in (0.0, 0.25, 0.5, 1.0):
        R_path, p_path = path.pose(share * path.length)
        # Near a half turn the axis is as exact as the square root of rounding allows.
        assert_allclose(R_path, rodrigues(axis, share * angle) @ R0, atol=1e-7 if half else 1e-11)
        if kind == "line":
            assert_allclose(p_path, P0 + share * (to - P0), atol=1e-12)


@pytest.mark.parametrize("rule", ["constant", "follow", "free"])
@pytest.mark.parametrize("length", [0.125, 2.0, 4096.0])
def test_an_axis_longer_by_a_power_of_two_gives_the_same_path_to_the_last_digit(
    rule: str, length: float
) -> None:
    axis = np.array([0.3, -0.5, 0.8])
    paths = [_arc(rule, (factor * axis).tolist()) for factor in (1.0, length)]
    s = np.linspace(0.0, paths[0].length, 17)
    for one, other in zip(paths[0].derivatives(s), paths[1].derivatives(s), strict=True):
        assert np.array_equal(one, other)


def _arc(rule: str, axis: list[float]) -> ToolPath:
    arc = {"type": "arc", "centre": [0.1, 0.2, 0.3], "angle": 2.0, "axis": axis}
    return of_segments({**arc, "orientation": rule}, frame=frame(True)[0])


def test_a_line_from_a_pose_given_by_a_half_turn_needs_no_unit_axis() -> None:
    """The turn of a half turn is as asked: +z one way, -z the other, of any length."""
    to = pose(P0 + np.array([0.1, 0.0, 0.0]))
    to["quaternion_xyzw"] = quaternion(pin.log3(rodrigues(np.array([0, 0, 1.0]), math.pi) @ R0))
    for sign in (1.0, -1.0):
        for length in (0.1, 10.0):
            path = of_segments({"type": "line", "to": to, "turn_axis": [0, 0, sign * length]})
            R, _ = path.pose(0.5 * path.length)
            quarter = rodrigues(np.array([0.0, 0.0, sign]), 0.5 * math.pi)
            assert_allclose(R, quarter @ R0, atol=1e-7)
