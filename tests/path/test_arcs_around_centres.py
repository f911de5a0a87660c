"""Arcs by centre and end: the shorter way around, both readings alike, no arc that is none."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest
from hypothesis import assume, given, settings

from ikplan import InvalidRequest, load_robot
from ikplan.certificate.requested import read_motion
from ikplan.documents import parse
from ikplan.documents.path import PathRequest
from ikplan.documents.plan_request import PlanRequest
from ikplan.path import Pose
from ikplan.path.rotation.so3 import exp

from .requests import of_segments, pose, seeds

ORIGIN = Pose(np.eye(3), np.zeros(3))


def arc(centre: Any, to: Any, rotvec: Any = None, **more: Any) -> dict[str, Any]:
    return {"type": "arc", "centre": list(centre), "to": pose(to, rotvec), **more}


def test_a_quarter_circle_has_its_radius_and_its_length() -> None:
    path = of_segments(arc([0.0, 0.2, 0.0], [0.2, 0.2, 0.0], [0.0, 0.0, 0.4]), start=ORIGIN)
    assert path.length == pytest.approx(0.2 * math.pi / 2.0, rel=1e-12)
    R, p = path.poses(np.linspace(0.0, path.length, 9))
    np.testing.assert_allclose(np.linalg.norm(p - [0.0, 0.2, 0.0], axis=1), 0.2, rtol=1e-12)
    assert (p[:, 0] >= -1e-15).all()
    np.testing.assert_allclose(p[4], [0.2 * math.sqrt(0.5), 0.2 - 0.2 * math.sqrt(0.5), 0.0])
    np.testing.assert_allclose(R[4], exp(np.array([0.0, 0.0, 0.2])), atol=1e-12)


@settings(max_examples=25, deadline=None)
@given(seeds)
def test_both_readings_go_the_same_way_around(seed: int) -> None:
    rng = np.random.default_rng(seed)
    robot = load_robot("ur5")
    q = robot.home
    T = robot.fk(q)
    centre = T.translation + 0.2 * rng.normal(size=3)
    spoke = T.translation - centre
    turned = exp(rng.normal(size=3)) @ spoke * (1.0 + rng.uniform(-5e-4, 5e-4))
    cosine = float(spoke @ turned) / float(spoke @ spoke)
    assume(-0.99 < cosine < 0.999)
    document = {"segments": [arc(centre, centre + turned, [0.1, 0.2, 0.3])]}
    path = of_segments(*document["segments"], start=Pose(T.rotation, T.translation))
    (leg,) = read_motion(robot, parse(PathRequest, document), q).legs
    assert leg.path.length == pytest.approx(path.length, rel=1e-9)
    s = np.linspace(0.0, path.length, 17)
    R, p = path.poses(s)
    read = leg.path.derivatives(leg.path.piece_at(s), s)
    np.testing.assert_allclose(p, read.p, atol=1e-9)
    np.testing.assert_allclose(R, read.R, atol=1e-7)
    np.testing.assert_allclose(p[-1], centre + turned, atol=1e-9)
    assert path.length < math.pi * np.linalg.norm(spoke) * 1.001


@pytest.mark.parametrize(
    ("segment", "words"),
    [
        (arc([0.1, 0.0, 0.0], [0.2, 0.0, 0.0]), "half a turn"),
        (arc([0.1, 0.0, 0.0], [0.1, 0.2, 0.0]), "from its centre"),
        (arc([0.1, 0.0, 0.0], [0.0, 0.0, 0.0]), "ends coincide"),
        (arc([2e-8, 0.0, 0.0], [2e-8, 2e-8, 0.0]), "radius"),
        ({"type": "arc", "centre": [2e-8, 0.0, 0.0], "angle": 1.0}, "radius"),
        ({"type": "arc", "via": [2e-8, 2e-8, 0.0], "to": pose([4e-8, 0.0, 0.0])}, "radius"),
    ],
)
def test_what_makes_no_arc_is_refused(segment: dict[str, Any], words: str) -> None:
    with pytest.raises(InvalidRequest, match=words) as caught:
        of_segments(segment, start=ORIGIN)
    assert caught.value.field == "path.segments[0]"


def test_an_orientation_rule_belongs_to_an_angle_and_an_axis_to_a_centre() -> None:
    to = [0.2, 0.2, 0.0]
    with pytest.raises(InvalidRequest, match="belongs to an arc given by centre and angle"):
        of_segments(arc([0.0, 0.2, 0.0], to, orientation="follow"), start=ORIGIN)
    through = {"type": "arc", "via": [0.1, 0.1, 0.0], "to": pose(to), "axis": [0.0, 0.0, 1.0]}
    with pytest.raises(InvalidRequest, match="belongs to an arc given by its centre"):
        of_segments(through, start=ORIGIN)


@pytest.mark.parametrize(
    ("axis", "turned"),
    [
        ([0.0, 0.0, 1.0], 0.5 * math.pi),
        ([0.0, 0.0, -1.0], 1.5 * math.pi),  # over half a turn: the other way round
        (None, 0.5 * math.pi),
    ],
)
def test_an_arc_with_an_axis_turns_right_handed_about_it(axis: Any, turned: float) -> None:
    # From the origin about (0, 0.2): right-handed about z it leaves towards +x.
    document = arc([0.0, 0.2, 0.0], [0.2, 0.2, 0.0], axis=axis)
    path = of_segments(document, start=ORIGIN)
    assert path.length == pytest.approx(0.2 * turned, rel=1e-12)
    _, p = path.poses(np.array([0.0, 1e-3, path.length]))
    assert math.copysign(1.0, p[1, 0]) == (1.0 if turned < math.pi else -1.0)
    np.testing.assert_allclose(p[-1], [0.2, 0.2, 0.0], atol=1e-15)


def test_half_a_turn_goes_the_way_the_axis_says() -> None:
    for sign in (1.0, -1.0):
        document = arc([0.0, 0.2, 0.7], [0.0, 0.4, 0.0], axis=[0.0, 0.0, sign])
        path = of_segments(document, start=ORIGIN)
        _, p = path.poses(np.array([0.5 * path.length]))
        np.testing.assert_allclose(p[0], [sign * 0.2, 0.2, 0.0], atol=1e-12)


@settings(max_examples=25, deadline=None)
@given(seeds)
def test_both_readings_turn_alike_about_an_axis(seed: int) -> None:
    rng = np.random.default_rng(seed)
    robot = load_robot("ur5")
    q = robot.home
    T = robot.fk(q)
    z = rng.normal(size=3)
    z = z / np.linalg.norm(z)
    across = np.cross(z, rng.normal(size=3))
    spoke = across * rng.uniform(0.05, 0.4) / np.linalg.norm(across)
    angle = rng.uniform(0.05, 2.0 * math.pi - 0.05)
    # The end a little off the circle, the centre anywhere on the axis.
    turned = exp(angle * z) @ spoke * (1.0 + rng.uniform(-2e-5, 2e-5))
    turned += rng.uniform(-2e-5, 2e-5) * np.linalg.norm(spoke) * z
    to = T.translation - spoke + turned
    centre = T.translation - spoke + rng.uniform(-0.5, 0.5) * z
    document = {"segments": [arc(centre, to, [0.1, 0.2, 0.3], axis=(3.0 * z).tolist())]}
    path = of_segments(*document["segments"], start=Pose(T.rotation, T.translation))
    assert path.length == pytest.approx(angle * np.linalg.norm(spoke), rel=2e-3)
    (leg,) = read_motion(robot, parse(PathRequest, document), q).legs
    assert leg.path.length == pytest.approx(path.length, rel=1e-9)
    s = np.linspace(0.0, path.length, 17)
    R, p = path.poses(s)
    read = leg.path.derivatives(leg.path.piece_at(s), s)
    np.testing.assert_allclose(p, read.p, atol=1e-9)
    np.testing.assert_allclose(R, read.R, atol=1e-7)
    np.testing.assert_allclose(p[-1], to, atol=1e-9)


def test_how_far_along_the_axis_the_centre_is_does_not_count() -> None:
    # The end is a little higher than the begin, so that the chord leans towards the axis.
    for height in (0.0, 0.5, -2.0):
        document = arc([0.0, 0.06, height], [0.06, 0.06, 3e-5], axis=[0.0, 0.0, 1.0])
        path = of_segments(document, start=ORIGIN)
        assert path.length == pytest.approx(0.06 * 0.5 * math.pi, rel=1e-6)


@pytest.mark.parametrize(
    ("centre", "to", "axis", "words"),
    [
        ([0.0, 0.2, 0.0], [0.2, 0.2, 0.0], [1.0, 0.0, 0.0], "not level"),
        ([0.0, 0.2, 0.0], [0.3, 0.2, 0.0], [0.0, 0.0, 1.0], "from its axis"),
        ([0.0, 0.2, 0.0], [0.0, 0.0, 0.0], [0.0, 0.0, 1.0], "ends coincide"),
        ([0.0, 2e-8, 0.0], [2e-8, 2e-8, 0.0], [0.0, 0.0, 1.0], "radius"),
    ],
)
def test_what_makes_no_arc_about_an_axis_is_refused(
    centre: Any, to: Any, axis: Any, words: str
) -> None:
    with pytest.raises(InvalidRequest, match=words) as caught:
        of_segments(arc(centre, to, axis=axis), start=ORIGIN)
    assert caught.value.field == "path.segments[0]"


def test_only_an_axis_that_is_given_with_an_end_changes_the_id() -> None:
    def hashed(**segment: Any) -> str:
        path = {"segments": [{"type": "arc", "centre": [0.0, 0.2, 0.0], **segment}]}
        request = {"robot": "ur5", "path": path}
        return parse(PlanRequest, request).content_hash()

    up = [0.0, 0.0, 1.0]
    assert hashed(angle=1.0) == hashed(angle=1.0, axis=up)
    end = pose([0.2, 0.2, 0.0])
    assert hashed(to=end) == hashed(to=end, axis=None) != hashed(to=end, axis=up)
