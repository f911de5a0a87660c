"""Files that people have become robots without a question."""

from __future__ import annotations

import random
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import ikplan
from benchmarks.robots.corpus import is_single_arm, urdf_files
from ikplan.errors import InvalidRobot, RobotNotFound
from ikplan.robots import Robot, load_robot, robot_from_urdf
from ikplan.robots.loading.checking import check_against_whole
from ikplan.robots.loading.given_limits import read_joint_limits
from ikplan.robots.loading.home import conditioning
from ikplan.robots.loading.tip import arm_ends, pick_chain
from ikplan.robots.names import known_name
from ikplan.robots.urdf.urdf import parse_urdf

from .urdfs import joint, urdf

AXES = ("0 0 1", "0 1 0", "0 1 0", "0 0 1", "0 1 0", "0 0 1", "0 1 0")


def arm(joints: int, prefix: str = "", base: str = "base") -> list[str]:
    """Joints of an arm with parallel and crossed axes; its last link is ``l<joints>``."""
    links = [base, *(f"{prefix}l{i + 1}" for i in range(joints))]
    return [
        joint(f"{prefix}j{i + 1}", links[i], links[i + 1], axis=f'<axis xyz="{AXES[i % 7]}"/>',
              origin='<origin xyz="0.05 0 0.3"/>')
        for i in range(joints)
    ]  # fmt: skip


def document(*joints: str) -> str:
    """A URDF whose links are those that its joints name."""
    text = "".join(joints)
    links: dict[str, None] = {}
    for part in text.split('link="')[1:]:
        links[part.split('"')[0]] = None
    return urdf(*joints, links=" ".join(links))


def fixed(name: str, parent: str, child: str) -> str:
    return joint(name, parent, child, kind="fixed", axis="", limit="")


GRIPPER = (
    fixed("mount", "l6", "hand"),
    joint("left", "hand", "left_tip", kind="prismatic"),
    joint("right", "hand", "right_tip", kind="prismatic", more='<mimic joint="left"/>'),
)


@pytest.mark.parametrize(
    ("more", "tip"),
    [
        ((), "l6"),
        ((fixed("a", "l6", "flange"), fixed("b", "flange", "tool0")), "tool0"),
        ((fixed("a", "l6", "ft_frame"), fixed("b", "l6", "arm_tool0")), "arm_tool0"),
        ((fixed("a", "l6", "camera"), fixed("b", "l6", "marker")), "l6"),
        (GRIPPER, "l6"),
        ((*GRIPPER, fixed("c", "hand", "hand_tcp")), "hand_tcp"),
        ((fixed("x", "base", "table"), fixed("y", "base", "pedestal")), "l6"),
        ((joint("wheel", "base", "tyre", kind="continuous"),), "l6"),
        ((joint("gripper", "l6", "jaw"), fixed("f", "l6", "flange")), "flange"),
    ],
)
def test_the_tip_of_the_only_arm_is_found(more: tuple[str, ...], tip: str) -> None:
    robot = robot_from_urdf(document(*arm(6), *more))
    assert (robot.base_frame, robot.tip_frame) == ("base", tip)
    assert robot.joint_names == ("j1", "j2", "j3", "j4", "j5", "j6")


def test_several_arms_are_asked_for_with_their_joint_counts() -> None:
    both = document(*arm(7, "left_"), *arm(6, "right_"), *arm(2, "head_"))
    with pytest.raises(InvalidRobot) as caught:
        robot_from_urdf(both)
    assert "left_l7 (7 joints), right_l6 (6 joints)" in caught.value.detail
    assert "head" not in caught.value.detail
    assert caught.value.valid == ["left_l7", "right_l6"]
    assert robot_from_urdf(both, tip="right_l6").dof == 6


def test_what_floats_or_rolls_in_a_plane_below_the_root_is_left_out() -> None:
    free = joint("free", "world", "base", kind="floating", axis="", limit="")
    robot = robot_from_urdf(document(free, *arm(6)))
    assert robot.base_frame == "base"
    assert any("base: base, below the floating joint free" in n for n in robot.info().notes)


@settings(max_examples=60, deadline=None)
@given(joints=st.integers(4, 7), order=st.randoms(use_true_random=False))
def test_the_tip_does_not_depend_on_the_order_of_the_document(
    joints: int, order: random.Random
) -> None:
    parts = [*arm(joints), fixed("a", f"l{joints}", "flange"), fixed("b", "flange", "tool0")]
    order.shuffle(parts)
    tree = parse_urdf(document(*parts).encode(), robot="x")
    assert pick_chain(tree, None)[:2] == ("base", "tool0")
    assert [end.joints for end in arm_ends(tree, "base")] == [joints]


@pytest.mark.parametrize("joints", [1, 2, 3, 4, 5, 6, 7])
def test_the_home_is_well_conditioned_and_the_same_every_time(joints: int) -> None:
    robot = robot_from_urdf(document(*arm(joints)))
    assert conditioning(robot, robot.home[None])[0] > 0.02
    middle = 0.5 * (robot.lower + robot.upper)
    assert (np.abs(robot.home - middle) <= 0.3 * (robot.upper - robot.lower) + 1e-3).all()
    again = robot_from_urdf(document(*arm(joints)) + " ")
    np.testing.assert_array_equal(again.home, robot.home)


def test_conditioning_does_not_depend_on_the_size_of_the_arm() -> None:
    small = document(*arm(6))
    large = small.replace("0.05 0 0.3", "0.5 0 3")
    q = np.random.default_rng(3).uniform(-1, 1, (20, 6))
    a, b = (conditioning(robot_from_urdf(text), q) for text in (small, large))
    np.testing.assert_allclose(a, b, rtol=1e-9)


LIMITS = """
joint_limits:
  j1: {has_velocity_limits: true, max_velocity: 1.5, has_acceleration_limits: true,
       max_acceleration: 4.0, has_position_limits: true, min_position: -5.0, max_position: 0.5}
  j2: {has_velocity_limits: true, max_velocity: !degrees 90, has_acceleration_limits: false,
       max_acceleration: 9.0}
  j3: {max_velocity: 100.0, max_acceleration: 0.0}
  other: {max_velocity: 1.0}
"""
SRDF = (
    '<robot name="a"><group name="g"><chain base_link="base" tip_link="l6"/></group>'
    '<group_state name="home" group="g">'
    + "".join(f'<joint name="j{i}" value="{0.1 * i}"/>' for i in range(1, 7))
    + "</group_state></robot>"
)


@pytest.fixture
def package(tmp_path: Path) -> Path:
    """A package with a description in its ``urdf`` folder; returns the description."""
    root = tmp_path / "my_arm"
    for folder in ("urdf", "config"):
        (root / folder).mkdir(parents=True)
    (root / "package.xml").write_text("<package><name>my_arm</name></package>")
    (root / "urdf" / "my_arm.urdf").write_text(document(*arm(6)))
    return root / "urdf" / "my_arm.urdf"


def test_joint_limits_of_the_package_narrow_those_of_the_description(package: Path) -> None:
    (package.parents[1] / "config" / "joint_limits.yaml").write_text(LIMITS)
    robot = load_robot(package)
    assert (robot.lower[0], robot.upper[0]) == (-1.0, 0.5)
    np.testing.assert_allclose(robot.velocity_limit, [1.5, np.pi / 2, 3, 3, 3, 3])
    np.testing.assert_allclose(robot.acceleration_limit[:3], [4.0, np.pi / 2 / 0.6, 5.0])
    assert robot.description.assumptions == (
        "acceleration limits of j2, j3, j4, j5, j6: velocity-limit-reached-in-0.6-s; no source "
        "gives them",
    )
    assert "joint_limits.yaml" in str(robot.info().limit_sources[0].source)


def test_of_several_files_of_limits_none_is_taken_unless_it_is_named_for_the_robot(
    package: Path,
) -> None:
    config = package.parents[1] / "config"
    for name in ("a", "b"):
        (config / f"{name}_joint_limits.yaml").write_text(LIMITS)
    robot = load_robot(package)
    assert robot.velocity_limit.tolist() == [3.0] * 6
    assert any("2 files fit, none was used" in note for note in robot.info().notes)
    (config / "my_arm_joint_limits.yaml").write_text(LIMITS)
    assert load_robot(package).velocity_limit[0] == 1.5


def test_the_home_of_the_srdf_is_used_unless_it_is_singular(package: Path) -> None:
    srdf = package.parents[1] / "config" / "my_arm.srdf"
    srdf.write_text(SRDF)
    np.testing.assert_allclose(load_robot(package).home, 0.1 * np.arange(1, 7))
    zero = SRDF
    for i in range(1, 7):
        zero = zero.replace(f'value="{0.1 * i}"', 'value="0"')
    srdf.write_text(zero)
    robot = load_robot(package)
    assert (
        conditioning(robot, np.zeros((1, 6)))[0] < 1e-2 < conditioning(robot, robot.home[None])[0]
    )
    assert any("the home of my_arm.srdf is singular" in note for note in robot.info().notes)


def test_limits_and_home_that_are_given_replace_all_others(package: Path) -> None:
    (package.parents[1] / "config" / "joint_limits.yaml").write_text(LIMITS)
    robot = load_robot(
        package, limits={"j1": {"velocity": 4.5, "acceleration": 2.0}}, home={"j2": 0.5}
    )
    assert robot.velocity_limit[:2].tolist() == [4.5, 3.0]
    assert robot.home.tolist() == [0.0, 0.5, 0.0, 0.0, 0.0, 0.0]
    with pytest.raises(InvalidRobot, match="no joint 'jx' moves"):
        load_robot(package, limits={"jx": {"velocity": 1.0}})
    with pytest.raises(InvalidRobot, match="no limit 'speed'"):
        load_robot(package, limits={"j1": {"speed": 1.0}})
    with pytest.raises(InvalidRobot, match="home: 6 values expected"):
        load_robot(package, home=[0.0])
    with pytest.raises(InvalidRobot, match="velocity limit is -1"):
        load_robot(package, limits={"j1": {"velocity": -1.0}})


def test_a_robot_of_the_catalogue_takes_limits_and_a_home_too() -> None:
    plain = load_robot("ur5")
    given = {name: {"velocity": 1.0, "acceleration": 2.0} for name in plain.joint_names}
    robot = load_robot("ur5", limits=given, home=[0.1] * 6)
    assert robot.velocity_limit.tolist() == [1.0] * 6
    assert robot.home.tolist() == [0.1] * 6
    assert plain.description.assumptions
    assert not robot.description.assumptions
    assert robot.fingerprint != plain.fingerprint
    with pytest.raises(InvalidRobot, match="limits: no joint 'jx'"):
        load_robot("ur5", limits={"jx": {"velocity": 1.0}})
    with pytest.raises(InvalidRobot, match="args belongs to"):
        load_robot("ur5", args={"a": "b"})


@pytest.mark.parametrize(
    "text", ["[1", "a: 1", "joint_limits: 3", "joint_limits: {j: {max_velocity: x}}"]
)
def test_a_file_of_limits_that_makes_no_sense_is_refused(text: str) -> None:
    with pytest.raises(InvalidRobot, match="limits"):
        read_joint_limits(text.encode(), robot="x")


def line(robot: Robot) -> ikplan.Plan:
    pose = robot.fk(robot.home)
    place = (pose.translation - 0.05 * pose.rotation[:, 0]).tolist()
    request = {"robot": robot.name, "path": {"waypoints": [{"position": place}]}}
    return ikplan.plan(request, robot=robot)


def test_the_certificate_names_what_was_assumed() -> None:
    robot = robot_from_urdf(document(*arm(6)))
    assert line(robot).certificate.assumptions == [
        "acceleration limits of j1, j2, j3, j4, j5, j6: velocity-limit-reached-in-0.6-s; no "
        "source gives them"
    ]
    assert line(robot.with_limits(acceleration=5.0)).certificate.assumptions == []


NAMES = ["baxter_left", "fr3", "iiwa14", "panda", "ur5", "ur5e", "ur10e"]


@pytest.mark.parametrize(
    ("name", "meant"),
    [
        ("UR5e", "ur5e"),
        ("ur-5e", "ur5e"),
        ("UR 5", "ur5"),
        ("Franka Panda", "panda"),
        ("IIWA14", "iiwa14"),
    ],
)
def test_a_name_in_other_letters_is_the_same_arm(name: str, meant: str) -> None:
    assert known_name(name, NAMES) == meant


@pytest.mark.parametrize(
    ("name", "near"),
    [
        ("franka", ["fr3", "panda"]),
        ("Franka", ["fr3", "panda"]),
        ("ur", ["ur5e", "ur10e", "ur5"]),
        ("ur5ee", ["ur5e", "ur5"]),
        ("iiwa7", ["iiwa14"]),
        ("", []),
    ],
)
def test_a_name_that_may_be_several_is_none(name: str, near: list[str]) -> None:
    with pytest.raises(RobotNotFound) as caught:
        known_name(name, NAMES)
    assert caught.value.near[: len(near)] == near


def test_every_alias_is_of_a_robot_that_there_is() -> None:
    names = set(ikplan.robot_names())
    from ikplan.robots.names import _aliases

    same, several = _aliases()
    assert set(same.values()) <= names
    assert {robot for robots in several.values() for robot in robots} <= names
    assert not {name for name in same if known_name(name, sorted(names)) != same[name]}


SINGLE = [file for file in urdf_files(None) if is_single_arm(file)]


@pytest.mark.parametrize("file", SINGLE, ids=lambda file: file.stem)
def test_single_arms_of_the_package_load_without_a_question(file: Path) -> None:
    robot = load_robot(file)
    assert robot.dof >= 4
    assert robot.dof == 5 or conditioning(robot, robot.home[None])[0] > 1e-2
    assert "equal Pinocchio's" in check_against_whole(robot, file.read_bytes())


def test_the_package_has_arms() -> None:
    assert len(SINGLE) > 15
