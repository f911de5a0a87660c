"""What a request is taken apart into."""

from typing import Any

import numpy as np
import pytest
from numpy.testing import assert_allclose

from ikplan import InvalidRequest
from ikplan.path import JointLeg, Pose, ToolLeg

from .requests import START, START_R, fk, legs, pose, quaternion, random_poses

HELIX = {"type": "helix", "radius": 0.2, "rise": 0.5, "turns": 2, "phase": 0.1}
FIRST = [0.2 * np.cos(0.1), 0.2 * np.sin(0.1), 0.0]
LINE = {"type": "line", "to": pose([0.1, 0.2, 0.3])}


def shape(found: list[Any]) -> list[tuple[str, list[int]]]:
    """Kind of each leg with the rows of its waypoints."""
    return [
        ("joint", [t.row for t in leg.waypoints])
        if isinstance(leg, JointLeg)
        else ("tool", [w.row for w in leg.path.waypoints])
        for leg in found
    ]


@pytest.mark.parametrize("start", [START, None])
@pytest.mark.parametrize("approach", ["path", "joint"])
def test_joint_interpolation_is_one_joint_motion(start: Pose | None, approach: str) -> None:
    document = {"waypoints": random_poses(0, 3), "approach": approach}
    (leg,) = legs(document, start)
    assert isinstance(leg, JointLeg)
    assert [(t.row, t.name, t.q) for t in leg.waypoints] == [
        (k, f"path.waypoints[{k}]", None) for k in range(3)
    ]


@pytest.mark.parametrize("interpolation", ["line", "spline"])
def test_a_tool_path_begins_at_the_start_or_at_the_first_waypoint(interpolation: str) -> None:
    document: dict[str, Any] = {"waypoints": random_poses(0, 3), "interpolation": interpolation}
    first = np.array(document["waypoints"][0]["position"])
    (leg,) = legs(document)
    assert_allclose(leg.path.pose(0.0)[1], START.p, atol=1e-15)
    assert leg.path.waypoint_s[0] > 0.0
    (free,) = legs(document, None)
    assert_allclose(free.path.pose(0.0)[1], first, atol=1e-15)
    assert free.path.waypoint_s[0] == 0.0
    approached = legs({**document, "approach": "joint"})
    assert shape(approached) == [("joint", [0]), ("tool", [1, 2])]
    assert_allclose(approached[0].waypoints[0].pose.p, first)
    assert_allclose(approached[1].path.pose(0.0)[1], first, atol=1e-15)
    alone = {**document, "waypoints": document["waypoints"][:1], "approach": "joint"}
    assert shape(legs(alone)) == [("joint", [0])]


def test_segments_of_every_kind_mix() -> None:
    found = legs(
        {
            "segments": [
                LINE,
                {"type": "spline", "through": random_poses(0, 2)},
                {"type": "joint", "q": [0.1, 0.2, 0.3, 0.4, 0.5, 0.6]},
                {"type": "joint", "to": pose([0.3, 0.1, 0.2], [0.1, 0, 0])},
                {"type": "arc", "via": [0.3, 0.2, 0.2], "to": pose([0.4, 0.2, 0.2])},
                {**HELIX, "orientation": "free"},
                {"type": "joint", "q": [0.0] * 6},
                {**LINE, "to": pose([0.1, 0.2, 0.3], [0.2, 0, 0])},
            ]
        }
    )
    assert shape(found) == [
        ("tool", [0, 1, 2]), ("joint", [3, 4]), ("tool", [5, 6, 7]), ("joint", [8]), ("tool", [9]),
    ]  # fmt: skip
    assert_allclose(found[1].waypoints[0].q, [0.1, 0.2, 0.3, 0.4, 0.5, 0.6])
    assert_allclose(found[2].path.pose(0.0)[1], [0.3, 0.1, 0.2])
    assert [w.name for w in found[2].path.waypoints] == [
        "path.segments[4].to", "the first point of path.segments[5]", "the end of path.segments[5]",
    ]  # fmt: skip
    R, p = fk(np.zeros(6))
    assert_allclose(found[4].path.pose(0.0)[0], R, atol=1e-15)
    assert_allclose(found[4].path.pose(0.0)[1], p, atol=1e-15)
    assert found[4].path.oriented(0.0)


def test_a_curve_is_joined_by_a_line_unless_it_must_not_be() -> None:
    (leg,) = legs({"segments": [HELIX], "corners": "exact"})
    assert [w.row for w in leg.path.waypoints] == [0, 1]
    assert_allclose(leg.path.waypoints[0].p, FIRST)
    assert leg.path.waypoint_s[0] == pytest.approx(np.linalg.norm(START.p - FIRST))
    with pytest.raises(InvalidRequest, match="mm") as caught:
        legs({"segments": [{**HELIX, "connect": False}]})
    assert caught.value.field == "path.segments[0].connect"
    (joined,) = legs({"segments": [{**HELIX, "connect": False}]}, Pose(START.R, np.array(FIRST)))
    assert (joined.path.waypoints[0].row, joined.path.waypoint_s[0]) == (0, 0.0)
    assert len(joined.path.pieces) == 1
    turned = {**HELIX, "connect": False, "quaternion_xyzw": quaternion([0, 1, 0])}
    with pytest.raises(InvalidRequest, match="rad"):
        legs({"segments": [turned]}, Pose(START.R, np.array(FIRST)))


def test_a_curve_without_length_is_refused() -> None:
    point = {**HELIX, "radius": 1e-6, "turns": 1e-6, "rise": 0.0}
    with pytest.raises(InvalidRequest, match="a point, not a path") as caught:
        legs({"segments": [point]})
    assert caught.value.field == "path.segments[0]"


def test_a_joint_approach_leads_to_the_first_point_of_a_curve_or_spline() -> None:
    found = legs({"segments": [HELIX], "approach": "joint"})
    assert shape(found) == [("joint", [0]), ("tool", [1])]
    assert_allclose(found[0].waypoints[0].pose.p, FIRST)
    assert_allclose(found[0].waypoints[0].pose.R, START_R)
    spline = {"type": "spline", "through": random_poses(0, 3)}
    assert shape(legs({"segments": [spline], "approach": "joint"})) == [
        ("joint", [0]), ("tool", [1, 2]),
    ]  # fmt: skip
    assert shape(legs({"segments": [spline]}, None)) == [("tool", [0, 1, 2])]


def test_begin_says_where_the_first_segment_begins() -> None:
    document = {"segments": [LINE], "begin": pose([0, 0, 0.3], [0.1, 0, 0])}
    (free,) = legs(document, None)
    assert_allclose(free.path.waypoint_s, [0.0, np.hypot(0.1, 0.2)])
    assert shape(legs({**document, "approach": "joint"})) == [("joint", [0]), ("tool", [1])]
    (joined,) = legs(document)
    assert [w.name for w in joined.path.waypoints] == ["path.begin", "path.segments[0].to"]
    assert_allclose(joined.path.pose(0.0)[1], START.p, atol=1e-15)
    for start, approach in ((None, "path"), (START, "joint")):
        with pytest.raises(InvalidRequest, match="begin") as caught:
            legs({"segments": [LINE], "approach": approach}, start)
        assert caught.value.field == "path.begin"


def test_a_free_start_needs_no_begin_for_a_curve_but_an_orientation_to_keep() -> None:
    with pytest.raises(InvalidRequest, match="no orientation to keep") as caught:
        legs({"segments": [HELIX]}, None)
    assert caught.value.field == "path.segments[0].orientation"
    (leg,) = legs({"segments": [{**HELIX, "quaternion_xyzw": quaternion([1, 0, 0])}]}, None)
    assert leg.path.oriented(0.1)
    (free,) = legs({"segments": [{**HELIX, "orientation": "free"}]}, None)
    assert not any(piece.oriented for piece in free.path.pieces)
    (all_free,) = legs({"segments": [HELIX], "orientation_free": "all"}, None)
    assert not any(piece.oriented for piece in all_free.path.pieces)
    assert [w.row for w in free.path.waypoints] == [0, 1]
    assert shape(legs({"segments": [{"type": "joint", "q": [0.0] * 6}]}, None)) == [("joint", [0])]


def test_the_path_frame_places_everything() -> None:
    frame = {"position": [0.1, 0.2, 0.3], "quaternion_xyzw": quaternion([0, 0, np.pi / 2])}
    (leg,) = legs({"segments": [LINE], "frame": frame})
    assert isinstance(leg, ToolLeg)
    assert_allclose(leg.path.waypoints[0].p, [-0.1, 0.3, 0.6], atol=1e-15)
    (target,) = legs({"waypoints": [pose([1, 0, 0])], "frame": frame})[0].waypoints
    assert_allclose(target.pose.p, [0.1, 1.2, 0.3], atol=1e-15)
