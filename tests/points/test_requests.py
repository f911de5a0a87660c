"""From points to requests."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pinocchio as pin
import pytest

from ikplan import InvalidRequest
from ikplan.documents import parse
from ikplan.documents.plan_request import PlanRequest
from ikplan.points import Choices, frame_of, read_points, request_of

HEAD = "x,y,z,rx,ry,rz"
ROWS = ["0.5,-0.1,0.3,0,3,0", "0.5,0.1,0.3,0,3,0", "0.4,0.1,0.3,0,3,0"]


def made(text: str, **choices: Any) -> dict[str, Any]:
    request, _ = request_of(read_points(text.encode()), Choices(robot="ur5", **choices))
    parse(PlanRequest, request)
    return request


def table(extra: str = "", *cells: str) -> str:
    lines = [HEAD + extra]
    lines += [row + (cells[k] if cells else "") for k, row in enumerate(ROWS)]
    return "\n".join(lines)


def test_poses_become_waypoints_as_the_choices_say() -> None:
    poses = read_points(table().encode()).poses
    assert made(table()) == {"robot": "ur5", "path": {"waypoints": poses}}
    frame = {"position": [0.1, 0.0, 0.2]}
    request = made(
        table(), interpolation="spline", approach="joint", start="free", frame=frame, tool=frame
    )
    assert request == {
        "robot": "ur5",
        "start": "free",
        "tool": frame,
        "path": {
            "waypoints": poses,
            "interpolation": "spline",
            "approach": "joint",
            "frame": frame,
        },
    }


def test_a_tool_axis_leaves_the_turn_about_it_free() -> None:
    request = made("x,y,z,i,j,k\n0.5,0,0.3,0,0,-1\n")
    assert request["path"]["orientation_free"] == {"about": "tool_z"}


def test_one_speed_and_one_zone_for_all_stay_with_waypoints() -> None:
    request = made(table(",speed [mm/s],zone_mm", ",250,20", ",250,20", ",250,0"))
    assert request["limits"] == {"tool_speed": 0.25}
    assert request["path"]["interpolation"] == "line"
    assert request["path"]["blend"] == 0.02
    assert len(request["path"]["waypoints"]) == 3
    assert made(table(",speed [%]", ",50", ",50", ",50"))["limits"] == {"velocity_scale": 0.5}


def test_speeds_and_zones_that_differ_belong_to_the_segment_of_their_row() -> None:
    text = table(",v,zone", ",0.1,z10", ",,fine", ",0.3,")
    request = made(text)
    segments = request["path"]["segments"]
    assert [s["type"] for s in segments] == ["line"] * 3
    assert [s.get("limits") for s in segments] == [{"tool_speed": 0.1}, None, {"tool_speed": 0.3}]
    assert [s.get("blend") for s in segments] == [0.01, None, None]
    assert "limits" not in request
    # From anywhere, no line leads to the first point.
    request = made(text, start="free")
    poses = read_points(text.encode()).poses
    assert request["path"]["begin"] == poses[0]
    assert [s["to"] for s in request["path"]["segments"]] == poses[1:]
    # Without zones, joint motions can have speeds too.
    text = table(",v", ",0.1", ",0.2", ",0.3")
    assert [s["type"] for s in made(text)["path"]["segments"]] == ["joint"] * 3


def test_speeds_follow_the_unit_of_the_coordinates() -> None:
    assert made("x,y,z,speed\n500,0,300,250\n")["limits"] == {"tool_speed": 0.25}
    feed = made("x_mm,y_mm,z_mm,F [mm/min]\n500,0,300,6000\n")
    assert feed["limits"]["tool_speed"] == pytest.approx(0.1)


def test_joint_values_become_joint_segments() -> None:
    points = read_points(b"t,j1,j2,j3,j4,j5,j6,speed [%]\n0,0,-1,1,0,0,0,10\n1,0,-2,1,0,0,0,20\n")
    request, notes = request_of(points, Choices(robot="ur5"))
    parse(PlanRequest, request)
    assert request["path"]["segments"] == [
        {"type": "joint", "q": [0, -1, 1, 0, 0, 0], "limits": {"velocity_scale": 0.1}},
        {"type": "joint", "q": [0, -2, 1, 0, 0, 0], "limits": {"velocity_scale": 0.2}},
    ]
    said = " ".join(note.text for note in notes)
    assert "joint segments" in said
    assert "times are not kept" in said


@pytest.mark.parametrize(
    ("text", "choices", "field"),
    [
        (table(), {"robot": None}, "robot"),
        (table(), {"interpolation": "arc"}, "interpolation"),
        (table(), {"approach": "jump"}, "approach"),
        (table(",zone_mm", ",5", ",5", ",5"), {"interpolation": "joint"}, "interpolation"),
        (table(",v", ",0.1", ",0.2", ",0.3"), {"interpolation": "spline"}, "interpolation"),
        ("j1,j2\n0,0\n", {"interpolation": "line"}, "interpolation"),
        ("j1,j2\n0,0\n", {"frame": {"position": [1, 0, 0]}}, "frame"),
        ("j1,j2,zone_mm\n0,0,5\n", {}, "zone"),
    ],
)
def test_choices_that_do_not_fit_are_refused(
    text: str, choices: dict[str, Any], field: str
) -> None:
    with pytest.raises(InvalidRequest) as caught:
        request_of(read_points(text.encode()), Choices(**{"robot": "ur5", **choices}))
    assert caught.value.field == field


def test_a_frame_has_three_six_or_seven_numbers() -> None:
    assert frame_of([0, 0, 0.1], "tool") == {"position": [0.0, 0.0, 0.1]}
    turn = frame_of([0, 0, 0.1, 1.0, -2.0, 0.5], "tool")["quaternion_xyzw"]
    R = pin.Quaternion(np.array(turn)).matrix()
    np.testing.assert_allclose(R, pin.exp3(np.array([1.0, -2.0, 0.5])), atol=1e-12)
    s = math.sqrt(0.5)
    assert frame_of([0, 0, 0, 0, 0, s, s], "tool")["quaternion_xyzw"] == pytest.approx([0, 0, s, s])
    for numbers in ([0.1, 0.2], [0] * 4, [0, 0, 0, 1, 1, 1, 1]):
        with pytest.raises(InvalidRequest) as caught:
            frame_of(numbers, "tool")
        assert caught.value.field == "tool"
