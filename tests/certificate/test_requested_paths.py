"""The certificate's reading of a request: against closed forms, and against the planner's path.

The two readings share no code; where they agree on random requests, an error would have to be made
twice in different formulas.
"""

from __future__ import annotations

import math
from itertools import pairwise
from typing import Any

import numpy as np
import pinocchio as pin
import pytest
from numpy.typing import NDArray

from benchmarks.requests.drawing import draw
from ikplan import InvalidRequest
from ikplan.certificate.requested import RequestedMotion, RequestedPath, read_motion
from ikplan.certificate.requested.arc_length import ArcLength
from ikplan.certificate.requested.assembly import assembled
from ikplan.certificate.requested.corners import PathItem
from ikplan.certificate.requested.curves import SinusoidCurve
from ikplan.certificate.requested.pieces import CurvePiece, line
from ikplan.certificate.requested.poses import RequestedPose
from ikplan.certificate.requested.rotations import exp, log, quaternions_of, rotations_of
from ikplan.documents.path import PathRequest
from ikplan.documents.plan_request import PlanRequest
from ikplan.path import JointLeg, Pose, ToolLeg, ToolPath, legs_of
from ikplan.pipeline.resolve import resolve_robot

from .requests import START, arm, curve_frame, pose_after

Vector = NDArray[Any]


def read(path: dict[str, Any]) -> RequestedMotion:
    return read_motion(arm(), PathRequest.model_validate(path), np.array(START))


def along(path: RequestedPath, count: int = 400) -> tuple[Vector, Vector, Vector]:
    """Path lengths, rotations and positions, evenly along a path."""
    s = np.linspace(0.0, path.length, count)
    piece = path.piece_at(s)
    places = path.derivatives(piece, s - path.begins[piece])
    return s, places.R, places.p


def only_path(segment: dict[str, Any]) -> RequestedPath:
    (leg,) = read({"segments": [segment]}).legs
    return leg.path


def test_an_arc_turns_about_its_axis_whatever_the_axis_is_long() -> None:
    T = arm().fk(START)
    axis, centre, angle = (
        np.array([0.3, -0.5, 0.8]),
        T.translation + np.array([0.05, 0.01, 0.0]),
        2.4,
    )
    z = axis / np.linalg.norm(axis)
    for scale in (0.1, 1.0, 10.0):
        segment = {"type": "arc", "centre": centre.tolist(), "angle": angle}
        segment |= {"axis": (scale * axis).tolist(), "orientation": "follow"}
        path = only_path(segment)
        s, R, p = along(path, 50)
        for share, R_here, p_here in zip(s / path.length, R, p, strict=True):
            turn = pin.exp3(share * angle * z)
            np.testing.assert_allclose(p_here, centre + turn @ (T.translation - centre), atol=1e-13)
            np.testing.assert_allclose(R_here, turn @ T.rotation, atol=1e-13)


def test_an_arc_through_a_point_is_the_circle_through_three() -> None:
    p0 = arm().fk(START).translation
    for bulge in (1e-7, 1e-3, 0.05, 0.5):
        via, p1 = p0 + np.array([0.03, bulge, 0.0]), p0 + np.array([0.08, 0.0, 0.02])
        path = only_path({"type": "arc", "via": via.tolist(), "to": {"position": p1.tolist()}})
        _, _, p = along(path)
        chords = p - p0
        # The centre is at equal distance from all points: one linear system, solved by all.
        A, b = 2.0 * chords, (chords**2).sum(axis=1)
        centre, *_ = np.linalg.lstsq(A, b, rcond=1e-12)
        if bulge >= 1e-3:
            radius = np.linalg.norm(centre)
            np.testing.assert_allclose(np.linalg.norm(chords - centre, axis=1), radius, rtol=1e-9)
        assert np.linalg.norm(p - via, axis=1).min() <= 0.51 * path.length / 399
        np.testing.assert_allclose(p[[0, -1]], [p0, p1], atol=1e-12)


@pytest.mark.parametrize(
    ("segment", "formula"),
    [
        (
            {"type": "circle", "radius": 0.05, "angle": -2.2, "phase": 0.4},
            lambda u: (0.05 * np.cos(0.4 - 2.2 * u), 0.05 * np.sin(0.4 - 2.2 * u), 0.0 * u),
        ),
        (
            {"type": "helix", "radius": 0.04, "rise": -0.07, "turns": 1.5, "phase": 0.2},
            lambda u: (
                0.04 * np.cos(0.2 + 3.0 * np.pi * u),
                0.04 * np.sin(0.2 + 3.0 * np.pi * u),
                -0.07 * u,
            ),
        ),
        (
            {"type": "rose", "radius": 0.06, "petals": 4, "phase": 0.1},
            lambda u: (
                0.06 * np.cos(4 * (0.1 + 2 * np.pi * u)) * np.cos(0.1 + 2 * np.pi * u),
                0.06 * np.cos(4 * (0.1 + 2 * np.pi * u)) * np.sin(0.1 + 2 * np.pi * u),
                0.0 * u,
            ),
        ),
        (
            {
                "type": "sinusoid",
                "length": 0.1,
                "amplitude": 0.02,
                "wavelength": 0.03,
                "phase": 0.5,
            },
            lambda u: (0.1 * u, 0.02 * np.sin(2 * np.pi * 0.1 * u / 0.03 + 0.5), 0.0 * u),
        ),
    ],
)
def test_named_curves_are_drawn_by_their_formulas(segment: Any, formula: Any) -> None:
    frame = curve_frame(arm(), [0.0, 0.0, 0.0])
    motion = read({"segments": [{**segment, "frame": frame, "connect": True}]})
    (leg,) = motion.legs
    first, last = (motion.waypoints[k].p for k in (0, -1))
    u = np.linspace(0.0, 1.0, 20001)
    T = pin.XYZQUATToSE3(np.array([*frame["position"], *frame["quaternion_xyzw"]]))
    drawn = np.stack(formula(u), axis=1) @ T.rotation.T + T.translation
    np.testing.assert_allclose([first, last], drawn[[0, -1]], atol=1e-12)
    # From its first point on, at equal shares of its length.
    begin = leg.path.waypoints[0][0]
    lengths = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(drawn, axis=0), axis=1))])
    assert leg.path.length - begin == pytest.approx(lengths[-1], rel=1e-6)
    s = np.linspace(begin, leg.path.length, 60)
    piece = leg.path.piece_at(s)
    p = leg.path.derivatives(piece, s - leg.path.begins[piece]).p
    at = np.stack([np.interp(s - begin, lengths, column) for column in drawn.T], axis=1)
    np.testing.assert_allclose(p, at, atol=1e-6)


def test_a_rounded_corner_stays_within_its_ball_and_meets_its_sides_smoothly() -> None:
    a, b = (
        pose_after(arm(), [0.1, 0.0, 0.0], [0.2, 0, 0]),
        pose_after(arm(), [0.1, 0.1, 0.0], [0, 0.2, 0]),
    )
    radius = 0.03
    motion = read(
        {
            "segments": [
                {"type": "line", "to": a, "blend": radius},
                {"type": "line", "to": b},
            ]
        }
    )
    path = motion.legs[0].path
    corner = np.array(a["position"])
    assert motion.waypoints[0].ball == radius
    _, R, p = along(path, 3000)
    away = np.linalg.norm(p - corner, axis=1)
    inside = path.begins[1:3]
    s = np.linspace(0.0, path.length, 3000)
    assert away[(s >= inside[0]) & (s <= inside[1])].max() <= radius * (1.0 + 1e-6)
    nearest = path.waypoints[0][0]
    assert away[np.argmin(np.abs(s - nearest))] == pytest.approx(away.min(), abs=1e-6)
    # Direction, curvature and angular rate have no jump: second differences shrink as steps do.
    for values in (p, R.reshape(len(R), 9)):
        fine = np.abs(np.diff(values, n=2, axis=0)).max()
        coarse = np.abs(np.diff(values[::2], n=2, axis=0)).max()
        assert fine <= 0.3 * coarse


CIRCLE = {"type": "circle", "radius": 0.05, "angle": 2.0}


def pose(x: float, turn: float) -> dict[str, Any]:
    return pose_after(arm(), [x, 0.5 * x, 0.0], [0.0, turn, 0.0])


@pytest.mark.parametrize("free", [True, False])
@pytest.mark.parametrize("kind", ["circle", "spline"])
def test_the_first_segment_begins_where_a_joint_motion_or_a_free_start_leads(
    kind: str, free: bool
) -> None:
    """Only the first: the next one is reached by a tool path."""
    frame = curve_frame(arm(), [0.0, 0.0, 0.0])
    segment = {**CIRCLE, "frame": frame, "quaternion_xyzw": [0.0, 0.0, 0.0, 1.0]}
    passed = [pose(0.1, 0.0), pose(0.15, 0.1), pose(0.2, -0.1), pose(0.3, 0.2)]
    if kind == "spline":
        segment = {"type": "spline", "through": passed}
    last = {"type": "spline", "through": [pose(0.2, 0.3), pose(0.25, 0.2)]}
    path = PathRequest.model_validate({"segments": [segment, last], "approach": "joint"})
    motion = read_motion(arm(), path, None if free else np.array(START))
    (leg,) = motion.legs
    rows = 6 if kind == "spline" else 4
    assert [row for _, row in leg.path.waypoints] == list(range(0 if free else 1, rows))
    assert leg.begin_row == (None if free else 0)
    assert len(motion.waypoints) == rows
    s, _, p = along(leg.path)
    np.testing.assert_allclose(p[0], motion.waypoints[0].p, atol=1e-12)
    if kind == "spline":
        np.testing.assert_allclose(p[0], passed[0]["position"], atol=1e-12)
    else:
        T = pin.XYZQUATToSE3(np.array([*frame["position"], *frame["quaternion_xyzw"]]))
        np.testing.assert_allclose(p[0], T.act(np.array([0.05, 0.0, 0.0])), atol=1e-12)
        assert leg.path.segments[0].end == pytest.approx(0.1, rel=1e-12)
    assert s[-1] == leg.path.length


def test_a_tool_path_from_nowhere_is_none() -> None:
    path = PathRequest.model_validate({"segments": [{"type": "line", "to": pose(0.1, 0.0)}]})
    with pytest.raises(TypeError, match="begins at a pose"):
        read_motion(arm(), path, None)


@pytest.mark.parametrize("length", [0.1, 10.0])
@pytest.mark.parametrize(("share", "kept"), [(0.2, False), (5.0, True)])
def test_what_rounding_leaves_of_a_line_between_two_corners_is_no_piece(
    length: float, share: float, kept: bool
) -> None:
    """By 1e-12 of its length; both corners together take all of it but a share of that."""
    ends = [np.array(p) * length for p in ([0, 0, 0], [1, 0, 0], [1, 1, 0], [2, 1, 0])]
    radius = 0.5 * length * (1.0 - share * 1e-12)
    items = [
        PathItem(line(a, b), f"{k}", radius, [(length, k)])
        for k, (a, b) in enumerate(pairwise(ends))
    ]
    path, balls = assembled(RequestedPose(ends[0], None), [], items, 0.0)
    assert len(path.pieces) == 4 + kept
    assert balls == {0: radius, 1: radius}
    _, _, p = along(path)
    np.testing.assert_allclose(p[[0, -1]], [ends[0], ends[3]], atol=1e-12)


def test_a_curve_is_run_along_by_its_length() -> None:
    arc = ArcLength(SinusoidCurve(np.eye(3), np.zeros(3), 0.1, 0.02, 0.03, 0.5))
    t = np.linspace(0.0, 0.1, 777)
    s = arc.at(t)
    slope = (
        0.02
        * 2.0
        * np.pi
        / 0.03
        * np.cos(2.0 * np.pi * np.linspace(0, 0.1, 2_000_001) / 0.03 + 0.5)
    )
    speed = np.sqrt(1.0 + slope**2)
    lengths = np.concatenate([[0.0], np.cumsum(0.5 * (speed[1:] + speed[:-1]))]) * 5e-8
    np.testing.assert_allclose(
        s, np.interp(t, np.linspace(0.0, 0.1, 2_000_001), lengths), atol=1e-9
    )
    np.testing.assert_allclose(arc.parameter(s), t, atol=1e-12)


def test_a_spline_that_turns_back_within_a_point_is_there_where_it_turns() -> None:
    """At the length of its fold too, where the speed of the curve is 0."""
    T = arm().fk(START)
    far = T.translation + np.array([0.1, -0.2, 0.05])
    there, back = ({"position": p.tolist()} for p in (far, T.translation))
    (leg,) = read({"waypoints": [there, back], "interpolation": "spline"}).legs
    path, step = leg.path, far - T.translation
    fold = float(np.linalg.norm(step))
    assert path.length == pytest.approx(2.0 * fold, rel=1e-12)
    s = np.concatenate([path.nodes, fold + np.array([-1e-3, -1e-9, 0.0, 1e-9, 1e-3])])
    assert np.abs(path.nodes - fold).min() < 1e-12
    piece = path.piece_at(s)
    p = path.derivatives(piece, s - path.begins[piece]).p
    away = np.minimum(s, 2.0 * fold - s)
    np.testing.assert_allclose(p, T.translation + (away / fold)[:, None] * step, atol=1e-9)


def test_a_spline_of_large_turns_over_uneven_ways_is_turned_as_the_planner_turns_it() -> None:
    """So large that a spline of quaternions over the length would swing to and fro."""
    robot = arm()
    ways, turns = [0.1, 0.105, 0.2, 0.21, 0.3], [2.6, -0.1, 2.5, -0.2, 2.6]
    poses = [
        pose_after(robot, [x, 0.3 * x * x, 0.0], [0.2 * k, turn, 0.1 * turn])
        for k, (x, turn) in enumerate(zip(ways, turns, strict=True))
    ]
    path = PathRequest.model_validate({"segments": [{"type": "spline", "through": poses}]})
    T = robot.fk(START)
    R0, p0 = T.rotation.copy(), T.translation.copy()
    (planned,) = legs_of(path, Pose(R0, p0), lambda _: (R0, p0))
    (asked,) = read_motion(robot, path, np.array(START)).legs
    assert isinstance(planned, ToolLeg)
    assert_same_path(planned.path, asked.path)
    (curve,) = asked.path.pieces
    assert isinstance(curve, CurvePiece)
    s = np.linspace(0.0, curve.length, 4001)
    R, _, _, w = curve.derivatives(s)
    # The rate is that of the rotations: by Pinocchio, from each to the next.
    steps = [pin.log3(b @ a.T) for a, b in pairwise(R)]
    middle = 0.5 * (w[1:] + w[:-1]) * (s[1] - s[0])
    np.testing.assert_allclose(steps, middle, atol=2e-3 * np.abs(middle).max())


def test_exp_and_log_are_those_of_pinocchio() -> None:
    rng = np.random.default_rng(8)
    turns = rng.normal(size=(200, 3))
    turns *= (10.0 ** rng.uniform(-12, math.log10(math.pi), 200) / np.linalg.norm(turns, axis=1))[
        :, None
    ]
    R = exp(turns)
    np.testing.assert_allclose(R, [pin.exp3(v) for v in turns], atol=1e-15)
    np.testing.assert_allclose(log(R), turns, atol=1e-12, rtol=1e-9)
    np.testing.assert_allclose(rotations_of(quaternions_of(R)), R, atol=1e-14)


def readings(kind: str, number: int) -> tuple[list[Any], RequestedMotion] | None:
    """The planner's legs and the certificate's reading of a random request; None: refused."""
    request = PlanRequest.model_validate(draw(kind, 404, number, 10.0))
    robot = resolve_robot(request)
    q, start = None, None
    if request.start != "free":
        q = robot.clip(robot.home if request.start is None else request.start)
        T = robot.fk(q)
        start = Pose(T.rotation.copy(), T.translation.copy())

    def fk(values: Vector) -> tuple[Vector, Vector]:
        T = robot.fk(values)
        return T.rotation.copy(), T.translation.copy()

    try:
        # Rounded within the tolerance only by the planner: the certificate reads the path itself.
        legs = legs_of(request.path, start, fk, "none")
    except InvalidRequest:
        return None
    return legs, read_motion(robot, request.path, q)


def assert_same_path(planned: ToolPath, asked: RequestedPath) -> None:
    assert len(planned.pieces) == len(asked.pieces)
    assert planned.length == pytest.approx(asked.length, rel=1e-6, abs=1e-9)
    oriented = np.array([piece.oriented for piece in planned.pieces])
    np.testing.assert_array_equal(oriented, asked.oriented)
    piece = np.repeat(np.arange(len(oriented)), 7)
    share = np.tile(np.linspace(0.0, 1.0, 7), len(oriented))
    one = planned.derivatives_on(piece, share * np.diff(planned.begins)[piece])
    two = asked.derivatives(piece, share * np.diff(asked.begins)[piece])
    np.testing.assert_allclose(one.p, two.p, atol=1e-8)
    np.testing.assert_allclose(one.R[oriented[piece]], two.R[oriented[piece]], atol=1e-5)
    marks = sorted((w.row, w.s) for w in planned.waypoints)
    rows = sorted((row, s) for s, row in asked.waypoints)
    assert [row for row, _ in marks] == [row for row, _ in rows]
    np.testing.assert_allclose([s for _, s in marks], [s for _, s in rows], atol=1e-5)
    # The planner keeps parts without length too.
    segments = [part for part in planned.segments if part.end > part.begin]
    for ours, theirs in zip(segments, asked.segments, strict=True):
        assert ours.field == theirs.field
        assert (ours.begin, ours.end) == pytest.approx((theirs.begin, theirs.end), abs=1e-5)


@pytest.mark.parametrize("kind", ["plan", "curve"])
@pytest.mark.parametrize("block", range(4))
def test_both_readings_of_a_request_agree(kind: str, block: int) -> None:
    agreed = 0
    for number in range(25 * block, 25 * block + 25):
        both = readings(kind, number)
        if both is None:
            continue
        legs, motion = both
        tools = [leg.path for leg in legs if isinstance(leg, ToolLeg)]
        assert len(tools) == len(motion.legs)
        for planned, leg in zip(tools, motion.legs, strict=True):
            assert_same_path(planned, leg.path)
        asked = sum(
            len(leg.waypoints) if isinstance(leg, JointLeg) else len(leg.path.waypoints)
            for leg in legs
        )
        assert asked == len(motion.waypoints)
        agreed += 1
    assert agreed >= 12
