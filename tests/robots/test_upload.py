"""A URDF and what is said with it, as one document: chain, home, limits, tool, inertias."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from ikplan.documents import parse
from ikplan.errors import InvalidRequest, InvalidRobot
from ikplan.robots import RobotUpload, is_upload_id, robot_from_urdf, robot_visual
from ikplan.robots.urdf.mesh_uris import check_mesh_uri

from .urdfs import joint, two_joints, urdf

FORK = urdf(
    joint("j1", "a", "b"),
    joint("j2", "b", "c"),
    joint("finger", "c", "d", kind="prismatic"),
    links="a b c d",
)
SRDF = (
    '<robot name="test"><group name="arm"><chain base_link="a" tip_link="c"/></group>'
    '<group name="hand"><joint name="finger"/></group>'
    '<group_state name="Home" group="arm"><joint name="j1" value="0.25"/>'
    '<joint name="j2" value="-0.5"/></group_state>'
    '<disable_collisions link1="a" link2="b" reason="Adjacent"/></robot>'
)


def upload(**fields: Any) -> RobotUpload:
    return parse(RobotUpload, {"urdf": two_joints(), **fields})


def test_it_is_the_robot_of_its_urdf_under_the_name_of_its_content() -> None:
    made, plain = upload().robot(), robot_from_urdf(two_joints())
    assert is_upload_id(made.name)
    assert made.name == upload().content_id() == upload(base=None).content_id()
    q = [0.3, -0.4]
    np.testing.assert_array_equal(made.fk(q).homogeneous, plain.fk(q).homogeneous)
    for limits in ("lower", "upper", "velocity_limit", "acceleration_limit", "home"):
        np.testing.assert_array_equal(getattr(made, limits), getattr(plain, limits))


def test_anything_said_with_it_changes_the_name() -> None:
    names = {
        upload(**fields).content_id()
        for fields in (
            {},
            {"title": "x"},
            {"tip": "b"},
            {"home": [0.1, 0.1]},
            {"tool": {"position": [0, 0, 0.1]}},
            {"joints": [{"name": "j1", "velocity": 1.0}]},
        )
    }
    assert len(names) == 6


def test_a_stored_upload_of_the_first_rules_stays_the_robot_that_it_was() -> None:
    first = upload(rules=1)
    again = RobotUpload.stored(first.canonical())
    assert b"rules" not in first.canonical()
    assert (again.rules, again.content_id()) == (1, first.content_id())
    robot = again.robot()
    assert robot.home.tolist() == [0.0, 0.0]
    assert robot.acceleration_limit.tolist() == [12.0, 12.0]
    now = upload()
    assert RobotUpload.stored(now.canonical()).content_id() == now.content_id()
    assert now.content_id() != first.content_id()


def test_a_coupling_says_how_the_controller_counts() -> None:
    coupled = upload(coupling={"j2": {"j1": 1.0, "j2": 1.0}}).robot()
    np.testing.assert_allclose(
        coupled.fk([0.3, 0.2]).homogeneous, upload().robot().fk([0.3, 0.5]).homogeneous, atol=1e-15
    )
    assert any("j2 = 1 j1 + 1 j2" in note for note in coupled.info().notes)
    assert any("counts otherwise" in note for note in upload().robot().info().notes)


def test_a_velocity_of_zero_has_a_default_on_request() -> None:
    document = two_joints(limit='<limit lower="-1" upper="2" velocity="0" effort="4"/>')
    with pytest.raises(InvalidRobot, match="0 means not known: give one, or ask for a default"):
        upload(urdf=document).robot()
    robot = upload(urdf=document, velocity_default="90-deg-per-s").robot()
    np.testing.assert_allclose(robot.velocity_limit, [3.0, np.pi / 2])
    assert robot.description.assumptions[0].startswith("velocity limits of j2: 90-deg-per-s")
    with pytest.raises(InvalidRobot, match="no velocity default '1'; there is 90-deg-per-s"):
        upload(urdf=document, velocity_default="1").robot()


def test_limits_home_and_tool_replace_what_the_urdf_says() -> None:
    robot = upload(
        joints=[{"name": "j2", "lower": -0.5, "velocity": 1.5, "acceleration": 7.0, "effort": 9.0}],
        home=[0.5, -0.25],
        tool={"position": [0.0, 0.0, 0.1], "quaternion_xyzw": [0.0, 1.0, 0.0, 0.0]},
        title="Mine",
    ).robot()
    assert robot.title == "Mine"
    assert robot.lower.tolist() == [-1.0, -0.5]
    assert robot.velocity_limit.tolist() == [3.0, 1.5]
    np.testing.assert_allclose(robot.acceleration_limit, [5.0, 7.0], rtol=1e-15)
    assert robot.effort_limit.tolist() == [4.0, 9.0]
    assert robot.home.tolist() == [0.5, -0.25]
    bare = robot_from_urdf(two_joints()).with_tool([0, 0, 0.1], [0, 1, 0, 0])
    np.testing.assert_array_equal(robot.fk([0.1, 0.2]).homogeneous, bare.fk([0.1, 0.2]).homogeneous)
    sources = {s.limit: s.source for s in robot.info().limit_sources}
    assert "what was given with it" in str(sources["velocity"])


def test_the_srdf_names_the_chain_and_its_home() -> None:
    robot = upload(urdf=FORK, srdf=SRDF, group="arm").robot()
    assert (robot.base_frame, robot.tip_frame) == ("a", "c")
    assert robot.home.tolist() == [0.25, -0.5]
    hand = upload(urdf=FORK, srdf=SRDF, group="hand").robot()
    assert (hand.base_frame, hand.tip_frame, hand.joint_names) == ("c", "d", ("finger",))
    assert upload(urdf=FORK, srdf=SRDF, group="arm", home=[0.0, 0.1]).robot().home[1] == 0.1


@pytest.mark.parametrize(
    ("fields", "joint", "said"),
    [
        ({"joints": [{"name": "jx", "velocity": 1.0}]}, "jx", "no joint 'jx' moves"),
        ({"joints": [{"name": "j1", "lower": 5.0}]}, "j1", "above the upper limit 2"),
        ({"coupling": {"jx": {"j1": 1.0}}}, "jx", "coupling: no joint 'jx'"),
        ({"coupling": {"j2": {"jx": 1.0}}}, "jx", "coupling: no joint 'jx'"),
        ({"joints": [{"name": "j1", "upper": 0.1}], "home": [0.2, 0.0]}, "j1", "outside"),
        ({"home": [0.0]}, None, "home: 2 values expected .j1, j2., got 1"),
        ({"tip": "z"}, None, "no link 'z' to be the tip"),
        ({"group": "arm"}, None, "needs an SRDF"),
        ({"urdf": FORK, "srdf": SRDF}, None, "name one of its groups; chains there: arm, hand"),
        ({"urdf": FORK, "srdf": SRDF, "group": "leg"}, None, "no group 'leg'"),
        ({"urdf": FORK, "srdf": SRDF.replace("-0.5", "nan"), "group": "arm"}, "j2", "'nan'"),
        ({"urdf": FORK, "srdf": SRDF.replace("-0.5", "-5"), "group": "arm"}, "j2", "home is -5"),
        ({"srdf": "<!DOCTYPE robot>" + SRDF}, None, "DOCTYPE"),
        ({"srdf": "<svg/>"}, None, "not an SRDF"),
        ({"srdf": '<robot name="x"/>'}, None, "chains there: none"),
    ],
)
def test_what_makes_no_sense_is_refused_by_name(
    fields: dict[str, Any], joint: str | None, said: str
) -> None:
    with pytest.raises(InvalidRobot, match=said) as caught:
        upload(**fields).robot()
    assert caught.value.joint == joint


@pytest.mark.parametrize(
    ("fields", "field"),
    [
        ({"joints": [{"name": "j1", "velocity": 0.0}]}, "joints[0].velocity"),
        ({"joints": [{"name": "j1", "velocty": 1.0}]}, "joints[0].velocty"),
        ({"home": [float("nan"), 0.0]}, "home[0]"),
        ({"urdf": ""}, "urdf"),
        ({"tool": {"quaternion_xyzw": [1, 1, 0, 0]}}, "tool.quaternion_xyzw"),
    ],
)
def test_a_wrong_field_is_named(fields: dict[str, Any], field: str) -> None:
    with pytest.raises(InvalidRequest) as caught:
        upload(**fields)
    assert caught.value.field == field


def with_inertias(second: str, mass: str = "1") -> str:
    good = '<inertia ixx="0.1" iyy="0.1" izz="0.1" ixy="0" ixz="0" iyz="0"/>'
    document = two_joints()
    for link, inertia, m in (("b", good, "1"), ("c", second, mass)):
        body = f'<inertial><mass value="{m}"/>{inertia}</inertial>'
        document = document.replace(f'<link name="{link}"/>', f'<link name="{link}">{body}</link>')
    return document


@pytest.mark.parametrize(
    ("inertia", "mass", "said"),
    [
        ('<inertia ixx="0.1" iyy="0.1" izz="0.2" ixy="0" ixz="0" iyz="0"/>', "1", None),
        ('<inertia ixx="0.1" iyy="0.1" izz="0.1" ixy="0" ixz="0" iyz="0"/>', "0", "has no mass"),
        ('<inertia ixx="0.1" iyy="0.1" izz="0.3" ixy="0" ixz="0" iyz="0"/>', "1", "no body has"),
        ('<inertia ixx="-0.1" iyy="0.1" izz="0.1" ixy="0" ixz="0" iyz="0"/>', "1", "negative"),
        ('<inertia ixx="0.1" iyy="0.1" izz="0.1" ixy="0.2" ixz="0" iyz="0"/>', "1", "negative"),
    ],
)
def test_torques_need_inertias_that_a_body_can_have(
    inertia: str, mass: str, said: str | None
) -> None:
    info = upload(urdf=with_inertias(inertia, mass)).robot().info()
    notes = [note for note in info.notes if note.startswith("torques")]
    assert info.inertias_sourced == (said is None) == (not notes)
    if said is not None:
        assert "link 'c' (on joint 'j2')" in notes[0]
        assert said in notes[0]


def with_mesh(uri: str) -> str:
    visual = f'<visual><geometry><mesh filename="{uri}"/></geometry></visual>'
    return two_joints().replace('<link name="c"/>', f'<link name="c">{visual}</link>')


OUTSIDE = [
    "file:///etc/passwd",
    "FILE:/etc/passwd",
    "file:etc/passwd",
    "/etc/passwd",
    "//host/share/x.stl",
    "\\\\host\\share\\x.stl",
    "C:\\windows\\x.stl",
    "~/x.stl",
    "http://127.0.0.1/x.stl",
    "https://example.org/x.stl",
    "data:model/stl;base64,AA==",
    "model://x/y.dae",
    "package:///etc/passwd",
    "package://",
    "package:/x/y.stl",
    "package://../x.stl",
    "package://x/../../y.stl",
    "package://x/meshes/../../../etc/passwd",
    "package://x/..",
    "package://x\\..\\..\\y.stl",
    "package://x/%2e%2e/%2e%2e/y.stl",
    "package://x/%252e%252e/y.stl",
    "package://x/%2E%2E%2Fy.stl",
    "package://x/..%5c..%5cy.stl",
    "package%3A//x/../y.stl",
    "package://x/file:///etc/passwd",
    "package://x/.. /y.stl",
    "package://x/.../y.stl",
    "../y.stl",
    "meshes/../../y.stl",
    "./../y.stl",
    "%2fetc%2fpasswd",
    "%66ile:///etc/passwd",
    " /etc/passwd",
    " file:///etc/passwd",
    "package://x/y%00.stl",
    "package://x/y%0a.stl",
    "%" + "25" * 20 + "2e%2e/y",
]


@pytest.mark.parametrize("uri", OUTSIDE)
def test_a_mesh_outside_of_a_package_is_dropped_however_it_is_spelt(uri: str) -> None:
    with pytest.raises(InvalidRobot, match="the mesh of link 'c' is at") as caught:
        check_mesh_uri(uri, where="link 'c'", robot="x")
    assert caught.value.value == uri
    assert "package://<package>/<path>" in caught.value.valid
    robot = upload(urdf=with_mesh(uri)).robot()
    (note,) = [n for n in robot.info().notes if "mesh" in n]
    assert note.startswith("1 addresses of meshes cannot be used and were dropped")
    assert "mesh" not in robot.description.urdf
    visual = robot_visual(robot, with_mesh(uri).encode(), str)
    assert (visual.meshes, visual.left_out) == ({}, (uri,))


@pytest.mark.parametrize("tag", ["visual", "collision", "texture"])
def test_every_element_that_names_a_file_is_looked_at(tag: str) -> None:
    document = with_mesh("file:///etc/passwd")
    if tag == "texture":
        document = two_joints().replace(
            "</robot>",
            '<material name="m"><texture filename="file:///etc/passwd"/></material></robot>',
        )
    notes = upload(urdf=document.replace("visual", tag)).describe().notes
    assert any("'file' is not a scheme for meshes" in note for note in notes)


@pytest.mark.parametrize("uri", ["package://my_arm/meshes/a b.stl", "meshes/a.v2.stl", "./a.dae"])
def test_a_mesh_in_a_package_is_not_opened_and_the_robot_says_so(uri: str) -> None:
    (note,) = [n for n in upload(urdf=with_mesh(uri)).robot().info().notes if "meshes" in n]
    assert "not opened" in note
    assert ("my_arm" in note) == uri.startswith("package")
