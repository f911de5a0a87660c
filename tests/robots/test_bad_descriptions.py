"""Every kind of nonsense in a description is refused, by name, and in silence."""

from __future__ import annotations

import pickle
from pathlib import Path

import numpy as np
import pinocchio as pin
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from ikplan.errors import InvalidRobot
from ikplan.robots import load_robot, robot_from_urdf

from .urdfs import LIMIT, joint, long_chain, two_joints, urdf

GOOD = two_joints()


def test_the_good_one_is_accepted() -> None:
    robot = robot_from_urdf(GOOD, name="good")
    assert robot.joint_names == ("j1", "j2")
    assert (robot.base_frame, robot.tip_frame) == ("a", "c")
    np.testing.assert_allclose(robot.acceleration_limit, [5.0, 5.0], rtol=1e-15)
    assert "velocity-limit-reached-in-0.6-s" in " ".join(robot.info().notes)


def limit(**values: str) -> str:
    fields = {"lower": "-1", "upper": "2", "velocity": "3", "effort": "4", **values}
    return "<limit " + " ".join(f'{k}="{v}"' for k, v in fields.items() if v) + "/>"


# document, joint named, words said
CASES: dict[str, tuple[str, str | None, str]] = {
    "not xml": ("this is not XML", None, "not XML"),
    "empty": ("", None, "not XML"),
    "cut off": (GOOD[:-20], None, "not XML"),
    "another document": ("<svg/>", None, "not <robot>"),
    "dtd": ("<!DOCTYPE robot [<!ENTITY a 'b'>]>" + GOOD, None, "DOCTYPE"),
    "unknown encoding": ('<?xml version="1.0" encoding="klingon"?>' + GOOD, None, "not XML"),
    "xacro": (
        '<robot name="x" xmlns:xacro="http://www.ros.org/wiki/xacro"><xacro:macro/></robot>',
        None,
        "run xacro",
    ),
    "no links": ('<robot name="x"/>', None, "no links"),
    "nothing moves": (urdf(links="a"), None, "nothing moves"),
    "two roots": (urdf(joint("j1", "a", "b")), None, "not one tree"),
    "two links of a name": (urdf(joint("j1", "a", "b"), links="a b b"), None, "two links"),
    "two joints of a name": (
        urdf(joint("j", "a", "b"), joint("j", "b", "c")),
        None,
        "two joints named 'j'",
    ),
    "loop": (
        urdf(joint("j1", "b", "c"), joint("j2", "c", "b")),
        "j1",
        "loop",
    ),
    "two parents": (
        urdf(joint("j1", "a", "b"), joint("j2", "a", "c"), joint("j3", "b", "c")),
        "j3",
        "child of two",
    ),
    "unknown link": (urdf(joint("j1", "a", "zz"), links="a b"), "j1", "no such child link: 'zz'"),
    "no name": (urdf(joint("", "a", "b"), links="a b"), None, "1 to 200 printable"),
    "unknown type": (two_joints(kind="hinge"), "j2", "'hinge'"),
    "no type": (two_joints().replace('"j2" type="revolute"', '"j2"'), "j2", "type ''"),
    "zero axis": (two_joints(axis='<axis xyz="0 0 0"/>'), "j2", "zero axis: '0 0 0'"),
    "tiny axis": (two_joints(axis='<axis xyz="0 0 1e-9"/>'), "j2", "zero axis"),
    "axis not finite": (two_joints(axis='<axis xyz="0 nan 1"/>'), "j2", "nan"),
    "axis of two": (two_joints(axis='<axis xyz="0 1"/>'), "j2", "three numbers"),
    "axis of words": (two_joints(axis='<axis xyz="a b c"/>'), "j2", "not a number: 'a'"),
    "origin not finite": (two_joints(origin='<origin xyz="0 inf 0"/>'), "j2", "xyz .* inf"),
    "origin on the moon": (two_joints(origin='<origin xyz="4e8 0 0"/>'), "j2", "at most 1e.06"),
    "lower > upper": (two_joints(limit=limit(lower="3")), "j2", "above the upper limit 2"),
    "no range": (two_joints(limit=limit(lower="2")), "j2", "equals the upper"),
    "limit not finite": (two_joints(limit=limit(upper="inf")), "j2", "no upper position limit"),
    "limit beyond any range": (two_joints(limit=limit(lower="-2e3")), "j2", "no lower position"),
    "slide beyond any range": (
        two_joints(kind="prismatic", limit=limit(lower="-1e16", upper="1e16")),
        "j2",
        "no lower position limit",
    ),
    "limit nan": (two_joints(limit=limit(lower="nan")), "j2", "lower .* nan"),
    "no limits": (two_joints(limit=""), "j2", "no velocity limit"),
    "no lower": (two_joints(limit=limit(lower="")), "j2", "no lower position limit"),
    "no upper": (two_joints(limit=limit(upper="")), "j2", "no upper position limit"),
    "prismatic without limits": (
        two_joints(kind="prismatic", limit=limit(lower="", upper="")),
        "j2",
        "prismatic and has no lower",
    ),
    "zero velocity": (two_joints(limit=limit(velocity="0")), "j2", "velocity limit is 0"),
    "negative velocity": (two_joints(limit=limit(velocity="-1")), "j2", "velocity limit is -1"),
    "no velocity": (two_joints(limit=limit(velocity="")), "j2", "no velocity limit"),
    "continuous without velocity": (
        two_joints(kind="continuous", limit=""),
        "j2",
        "no velocity limit",
    ),
    "negative effort": (two_joints(limit=limit(effort="-4")), "j2", "effort limit is -4"),
    "zero acceleration": (two_joints(limit=limit(acceleration="0")), "j2", "acceleration"),
    "floating": (two_joints(kind="floating"), "j2", "floating"),
    "planar": (two_joints(kind="planar"), "j2", "planar"),
    "mimic of nothing on the chain": (
        two_joints(more='<mimic joint="j9"/>'),
        "j2",
        "mimics 'j9', which is not on it",
    ),
    "mimic of itself": (two_joints(more='<mimic joint="j2"/>'), "j2", "mimics itself"),
    "mimic without a number": (
        two_joints(more='<mimic joint="j1" multiplier="two"/>'),
        "j2",
        "multiplier of the mimic of joint 'j2' is not a number",
    ),
    "too many joints": (long_chain(65), None, "65 movable joints; at most 64"),
    "a parser's grave": (long_chain(5_000), None, "5001 links; at most 1000"),
    "too many links": (long_chain(1_001, "fixed"), None, "at most 1000"),
    "nested": ("<robot>" + "<a>" * 40 + "</a>" * 40 + "</robot>", None, "nested more than"),
    "too many elements": ("<robot>" + "<a/>" * 50_001 + "</robot>", None, "more than 50000"),
    "too large": (GOOD + " " * 2_000_001, None, "bytes"),
}


@pytest.mark.parametrize("case", CASES)
def test_refused_with_the_joint_and_the_reason(
    case: str, capfd: pytest.CaptureFixture[str]
) -> None:
    document, name, said = CASES[case]
    with pytest.raises(InvalidRobot, match=said) as caught:
        robot_from_urdf(document, name="bad")
    assert caught.value.robot == "bad"
    assert caught.value.joint == name
    assert caught.value.detail.startswith("bad: ")
    if name is not None:
        assert repr(name) in caught.value.detail
    assert "\n" not in caught.value.detail
    # No word from Pinocchio or urdfdom, on either stream.
    assert capfd.readouterr() == ("", "")


def test_error_survives_pickling_with_its_choices() -> None:
    with pytest.raises(InvalidRobot) as caught:
        robot_from_urdf(GOOD, tip="nowhere", name="bad")
    copy = pickle.loads(pickle.dumps(caught.value))
    assert copy.data == caught.value.data
    assert copy.valid == ["a", "b", "c"]


@pytest.mark.parametrize(
    ("base", "tip", "said"),
    [
        (None, "tool0", "no link 'tool0' to be the tip"),
        ("world", None, "no link 'world' to be the base"),
        ("b", "b", "nothing moves"),
    ],
)
def test_wrong_frames_are_refused(base: str | None, tip: str | None, said: str) -> None:
    with pytest.raises(InvalidRobot, match=said) as caught:
        robot_from_urdf(GOOD, base=base, tip=tip)
    assert caught.value.value in (base, tip)


def test_near_frames_are_offered() -> None:
    with pytest.raises(InvalidRobot, match="did you mean panda_link8") as caught:
        load_robot("panda", tip="panda_lnk8")
    assert "panda_hand_tcp" in caught.value.valid


def test_several_ends_are_listed() -> None:
    document = urdf(joint("j1", "a", "b"), joint("j2", "a", "c"))
    with pytest.raises(InvalidRobot, match=r"2 ends: b .1 joint., c .1 joint.") as caught:
        robot_from_urdf(document)
    assert caught.value.valid == ["b", "c"]
    assert robot_from_urdf(document, tip="c").joint_names == ("j2",)


def test_the_root_may_have_any_name_and_a_joint_a_links_name() -> None:
    document = urdf(joint("b", "universe", "b"), joint("c", "b", "c"), links="universe b c")
    robot = robot_from_urdf(document)
    assert robot.joint_names == ("b", "c")
    model = pin.buildModelFromXML(document)
    data = model.createData()
    q = np.array([0.3, -0.4])
    pin.framesForwardKinematics(model, data, q)
    want = data.oMf[model.getFrameId("c", pin.FrameType.BODY)]
    np.testing.assert_allclose(robot.fk(q).homogeneous, want.homogeneous, atol=1e-14)


def test_joints_beside_the_chain_are_locked_and_may_be_odd() -> None:
    """A gripper's zero speeds and mimic joints do not matter to the arm."""
    document = urdf(
        joint("j1", "a", "b"),
        joint("finger", "b", "c", limit=limit(velocity="0")),
        joint("other", "b", "d", kind="prismatic", more='<mimic joint="finger"/>'),
        joint("free", "b", "e", kind="floating", limit=""),
        joint("j2", "b", "f"),
        links="a b c d e f",
    )
    robot = robot_from_urdf(document, tip="f")
    assert robot.joint_names == ("j1", "j2")
    assert robot.model.nv == 2


def test_long_axis_is_normalised() -> None:
    short = robot_from_urdf(two_joints(axis='<axis xyz="0 0.6 0.8"/>'))
    long = robot_from_urdf(two_joints(axis='<axis xyz="0 6 8"/>'))
    q = [0.3, 0.7]
    np.testing.assert_allclose(short.fk(q).homogeneous, long.fk(q).homogeneous, atol=1e-15)
    assert long.fingerprint == short.fingerprint
    np.testing.assert_allclose(np.linalg.det(long.fk(q).rotation), 1, atol=1e-14)


def test_missing_axis_is_x_as_urdf_has_it() -> None:
    without, x = two_joints(axis=""), two_joints(axis='<axis xyz="1 0 0"/>')
    assert robot_from_urdf(without).fk([0.1, 0.2]) == robot_from_urdf(x).fk([0.1, 0.2])


def test_arbitrary_axis_continuous_and_prismatic_joints_equal_pinocchio() -> None:
    tilted = '<axis xyz="0.36 -0.48 0.8"/>'
    document = urdf(
        joint("j1", "a", "b", kind="continuous", axis=tilted),
        joint("j2", "b", "c", kind="prismatic", axis=tilted),
        joint("j3", "c", "d", axis=tilted),
        joint("j4", "d", "e", kind="continuous", axis='<axis xyz="0 -1 0"/>'),
        links="a b c d e",
    )
    robot = robot_from_urdf(document)
    model = pin.buildModelFromXML(document)
    data = model.createData()
    q = np.array([2.5, 0.3, -0.9, -3.0])
    want = np.array([np.cos(2.5), np.sin(2.5), 0.3, -0.9, np.cos(-3.0), np.sin(-3.0)])
    np.testing.assert_allclose(robot.configuration(q), want)
    pin.framesForwardKinematics(model, data, want)
    T = data.oMf[model.getFrameId("e", pin.FrameType.BODY)]
    np.testing.assert_allclose(robot.fk(q).homogeneous, T.homogeneous, atol=1e-14)


@pytest.mark.parametrize(
    ("inertial", "said"),
    [
        ('<mass value="-1"/><inertia ixx="1"/>', "mass of link 'c' is -1"),
        ("", "needs <mass> and <inertia>"),
        ('<mass value="nan"/><inertia ixx="1"/>', "value of link 'c' is nan"),
    ],
)
def test_a_wrong_inertial_refuses_torques_only(inertial: str, said: str) -> None:
    link = f'<link name="c"><inertial>{inertial}</inertial></link>'
    robot = robot_from_urdf(GOOD.replace('<link name="c"/>', link))
    assert not robot.info().inertias_sourced
    assert any("torques cannot" in note and said in note for note in robot.info().notes)
    np.testing.assert_array_equal(
        robot.fk([0.1, 0.2]).homogeneous, robot_from_urdf(GOOD).fk([0.1, 0.2]).homogeneous
    )


@pytest.mark.parametrize(
    "odd",
    [
        {"axis": '<axis xyz="0 0 0"/>'},
        {"axis": '<axis xyz="a b c"/>'},
        {"origin": '<origin xyz="0 inf 0"/>'},
        {"limit": limit(effort="1e7", velocity="1e9")},
        {"limit": limit(lower="nan")},
        {"kind": "hinge"},
        {"more": '<mimic joint="j1" multiplier="x"/>'},
    ],
)
def test_numbers_off_the_chain_never_refuse(odd: dict[str, str]) -> None:
    document = urdf(joint("j1", "a", "b"), joint("odd", "a", "d", **odd), links="a b d")
    assert robot_from_urdf(document, tip="b").joint_names == ("j1",)


def test_more_joints_than_can_move_are_locked_off_the_chain() -> None:
    fingers = [joint(f"f{i}", "b", f"g{i}") for i in range(100)]
    links = "a b " + " ".join(f"g{i}" for i in range(100))
    robot = robot_from_urdf(urdf(joint("j1", "a", "b"), *fingers, links=links), tip="b")
    assert robot.model.nv == 1


def test_a_joint_without_an_end_to_its_range_turns_without_end() -> None:
    robot = robot_from_urdf(two_joints(limit=limit(lower="-1e16", upper="999999")))
    assert robot.continuous.tolist() == [False, True]
    plain = robot_from_urdf(GOOD)
    q = [0.3, 1.7]
    np.testing.assert_allclose(robot.fk(q).homogeneous, plain.fk(q).homogeneous, atol=1e-15)


def test_a_mimic_joint_on_the_chain_is_a_coupling() -> None:
    mimic = '<mimic joint="j1" multiplier="-2" offset="0.25"/>'
    robot, plain = robot_from_urdf(two_joints(more=mimic)), robot_from_urdf(GOOD)
    assert robot.joint_names == ("j1",)
    np.testing.assert_allclose(
        robot.fk([0.4]).homogeneous, plain.fk([0.4, 0.25 - 0.8]).homogeneous, atol=1e-15
    )
    assert any("j2 = -2 j1 + 0.25" in note for note in robot.info().notes)


def test_home_is_inside_the_limits_where_zero_is_not() -> None:
    robot = robot_from_urdf(two_joints(limit=limit(lower="1", upper="2")))
    assert 1.2 <= robot.home[1] <= 1.8


def test_acceleration_of_the_file_is_used_where_given() -> None:
    robot = robot_from_urdf(two_joints(limit=limit(acceleration="7")))
    np.testing.assert_allclose(robot.acceleration_limit, [5.0, 7.0], rtol=1e-15)


def test_effort_of_zero_reads_as_not_known() -> None:
    robot = robot_from_urdf(two_joints(limit=limit(effort="0")))
    assert robot.effort_limit[0] == 4
    assert np.isnan(robot.effort_limit[1])
    assert robot.info().joints[1].effort is None


@pytest.mark.parametrize(
    "source",
    ["{}/missing.urdf", "{}/no_folder/", "nowhere/robot", "arm.urdf", "arm.yaml", "a\0b/c.urdf"],
)
def test_missing_file_is_named(source: str, tmp_path: Path) -> None:
    source = source.format(tmp_path)
    for given_as in (source, Path(source)):
        with pytest.raises(InvalidRobot, match="cannot be read") as caught:
            load_robot(given_as)
        assert Path(source).name in caught.value.detail


def test_folder_without_a_robot_is_named(tmp_path: Path) -> None:
    with pytest.raises(InvalidRobot, match=r"robot.yaml: cannot be read: No such file"):
        load_robot(tmp_path)


def test_file_larger_than_two_megabytes_is_not_read(tmp_path: Path) -> None:
    path = tmp_path / "big.urdf"
    path.write_text(GOOD + " " * 2_000_001)
    with pytest.raises(InvalidRobot, match="bytes"):
        load_robot(path)


def test_file_gives_the_name_and_takes_another(tmp_path: Path) -> None:
    path = tmp_path / "arm.urdf"
    path.write_text(GOOD)
    assert load_robot(path).name == "arm"
    assert load_robot(str(path), name="other").name == "other"
    assert load_robot(path).fingerprint == robot_from_urdf(GOOD, name="arm").fingerprint


SCRAPS = st.sampled_from(
    [
        '"0"', '"-1"', '"nan"', '"1e400"', '""', '"a"', '"0 0 0"', '"fixed"', '"floating"',
        "<axis/>", "<limit/>", "<parent/>", "<link/>", "<joint/>", "</joint>", "&amp;", "\x00", "é",
    ]
)  # fmt: skip


@settings(max_examples=150, deadline=None)
@given(
    cuts=st.lists(
        st.tuples(st.integers(0, len(GOOD)), st.integers(0, 12), SCRAPS), min_size=1, max_size=4
    )
)
def test_mutilated_files_raise_nothing_else(cuts: list[tuple[int, int, str]]) -> None:
    document = GOOD
    for at, length, scrap in cuts:
        document = document[:at] + scrap + document[at + length :]
    try:
        robot = robot_from_urdf(document)
    except InvalidRobot:
        pass
    else:
        assert np.isfinite(robot.fk(robot.home).homogeneous).all()
        assert (robot.velocity_limit > 0).all()
        assert (robot.lower < robot.upper).all()


def test_limit_of_the_good_file_is_the_one_tests_change() -> None:
    assert limit() == LIMIT
