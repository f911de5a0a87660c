"""The catalogue: complete, sourced, found by name, and open to the user's own folders."""

from __future__ import annotations

import json
import shutil
import subprocess
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import yaml

from ikplan.errors import InvalidRequest, InvalidRobot, RobotNotFound
from ikplan.robots import (
    RobotInfo,
    catalogue_robot,
    load_robot,
    robot_from_urdf,
    robot_names,
)
from ikplan.robots.definition.defaults import ACCELERATION_DEFAULTS, VELOCITY_DEFAULTS
from ikplan.robots.folders import package_file, robot_folder

from .urdfs import two_joints

NAMES = robot_names()
PROMISED = {
    "baxter_left",
    "baxter_physical",
    "baxter_right",
    "baxter_table7",
    "dobot_magician",
    "eod_arm",
    "fr3",
    "iiwa14",
    "kinova_j2s6s200",
    "mh5",
    "panda",
    "so101",
    "tiago",
    "ur10",
    "ur10e",
    "ur3",
    "ur3e",
    "ur5",
    "ur5e",
    "xarm7",
    "z1",
}


def test_catalogue_holds_what_is_promised() -> None:
    assert robot_names() == sorted(robot_names())
    assert set(NAMES) >= PROMISED


@pytest.mark.parametrize("name", NAMES)
def test_robot_is_complete(name: str) -> None:
    robot = load_robot(name)
    assert robot.name == name
    assert robot.title
    n = robot.dof
    assert len(robot.joint_names) == len(set(robot.joint_names)) == n
    for array in (robot.lower, robot.upper, robot.velocity_limit, robot.acceleration_limit):
        assert array.shape == (n,)
        assert array.dtype == np.float64
        assert not array.flags.writeable
    assert robot.home.shape == robot.effort_limit.shape == (n,)
    assert (robot.lower < robot.upper).all()
    assert (robot.lower <= robot.home).all()
    assert (robot.home <= robot.upper).all()
    for limit in (robot.velocity_limit, robot.acceleration_limit):
        assert np.isfinite(limit).all()
        assert (limit > 0).all()
    np.testing.assert_array_equal(np.isinf(robot.lower), robot.continuous)
    assert not (robot.continuous & robot.prismatic).any()
    assert robot.coupling.shape == (robot.model.njoints - 1, n)
    assert robot.model.frames[robot.tip_frame_id].name == robot.tip_frame
    assert robot.T_tip_tool.isIdentity()
    assert len(robot.fingerprint) == 64


@pytest.mark.parametrize("name", NAMES)
def test_home_is_not_singular(name: str) -> None:
    robot = load_robot(name)
    rng = np.random.default_rng(0)
    random = [
        np.linalg.svd(robot.jacobian(robot.random_configuration(rng)), compute_uv=False)[-1]
        for _ in range(200)
    ]
    home = np.linalg.svd(robot.jacobian(robot.home), compute_uv=False)[-1]
    assert home > np.quantile(random, 0.3)


@pytest.mark.parametrize("name", NAMES)
def test_every_fact_has_a_source_and_every_default_a_name(name: str) -> None:
    info = load_robot(name).info()
    assert info.sources
    assert any(note.startswith("home:") for note in info.notes)
    by_limit = {s.limit: s for s in info.limit_sources}
    assert {"position", "velocity", "acceleration"} <= set(by_limit)
    assert ("effort" in by_limit) == any(j.effort is not None for j in info.joints)
    for source in info.limit_sources:
        assert (source.source is None) != (source.default is None)
    for joint in info.joints:
        if (default := by_limit["velocity"].default) is not None:
            assert joint.velocity == VELOCITY_DEFAULTS[default]
        if (default := by_limit["acceleration"].default) is not None:
            assert joint.acceleration == ACCELERATION_DEFAULTS[default](joint.velocity)
            assert any(default in note and "default" in note for note in info.notes)


@pytest.mark.parametrize("name", NAMES)
def test_info_is_plain_json(name: str) -> None:
    info = load_robot(name).info()
    text = info.model_dump_json()
    json.loads(text, parse_constant=pytest.fail)
    assert RobotInfo.model_validate_json(text) == info
    robot = load_robot(name)
    assert [j.name for j in info.joints] == list(robot.joint_names)
    assert [j.lower is None for j in info.joints] == robot.continuous.tolist()
    assert info.dof == robot.dof
    assert info.fingerprint == robot.fingerprint


@pytest.mark.parametrize("name", ["iiwa14", "panda"])
def test_known_values(name: str) -> None:
    robot = load_robot(name)
    if name == "iiwa14":
        np.testing.assert_allclose(np.degrees(robot.home), [0, 30, 0, -90, 0, 60, 0], atol=1e-12)
        np.testing.assert_allclose(
            np.degrees(robot.velocity_limit), [85, 85, 100, 75, 130, 135, 135]
        )
        effort = next(s for s in robot.info().limit_sources if s.limit == "effort")
        assert not effort.verified
        assert any("unverified" in note for note in robot.info().notes)
        assert not robot.info().inertias_sourced
    else:
        np.testing.assert_array_equal(robot.acceleration_limit, [15, 7.5, 10, 12.5, 15, 20, 20])
        assert robot.info().inertias_sourced


@pytest.mark.parametrize(
    ("name", "near"), [("iiwa", "iiwa14"), ("ur-5x", "ur5"), ("pandda", "panda"), ("ur5f", "ur5")]
)
def test_unknown_name_offers_near_ones(name: str, near: str) -> None:
    with pytest.raises(RobotNotFound) as caught:
        load_robot(name)
    assert near in caught.value.near
    assert caught.value.valid == NAMES
    assert near in caught.value.detail


@pytest.mark.parametrize("name", ["", ".", "..", "__pycache__", "../robots/panda", "/etc/passwd"])
def test_catalogue_names_lead_nowhere_else(name: str) -> None:
    with pytest.raises(RobotNotFound):
        catalogue_robot(name)


def test_another_tip_and_name_can_be_asked_for() -> None:
    hand = load_robot("panda")
    flange = load_robot("panda", tip="panda_link8", name="bare")
    assert flange.name == "bare"
    np.testing.assert_allclose(
        flange.fk(hand.home).translation, hand.fk(hand.home).translation, atol=1e-15
    )
    assert flange.fingerprint != hand.fingerprint
    arm = load_robot("tiago", base="torso_lift_link")
    assert arm.joint_names == load_robot("tiago").joint_names[1:]
    np.testing.assert_array_equal(arm.home, load_robot("tiago").home[1:])
    elbow = load_robot("iiwa14", tip="A4_link")
    assert elbow.dof == 4


def test_same_content_is_loaded_once() -> None:
    assert load_robot("baxter_left") is load_robot("baxter_left")


def test_fingerprint_is_the_same_in_another_process_and_place(tmp_path: Path) -> None:
    names = ["iiwa14", "kinova_j2s6s200", "dobot_magician"]
    shutil.copytree(robot_folder("iiwa14").parent, tmp_path / "elsewhere")
    code = (
        f"from ikplan.robots import load_robot\nfor n in {names}: print(load_robot(n).fingerprint)"
    )
    done = subprocess.run(
        [sys.executable, "-c", code],
        env={"IKPLAN_ROBOTS_PATH": str(tmp_path / "elsewhere"), "PYTHONHASHSEED": "7"},
        capture_output=True,
        text=True,
        check=True,
        cwd=Path(__file__).parents[2],
    )
    assert done.stdout.split() == [load_robot(n).fingerprint for n in names]
    assert len({load_robot(n).fingerprint for n in NAMES}) == len(NAMES)


def test_fingerprint_of_the_iiwa_is_pinned() -> None:
    """A change here changes every plan id: wanted only with a change of the robot itself."""
    assert load_robot("iiwa14").fingerprint == (
        "dfbfd7cda146fc6eb44ded8b9908165cca5cd805192934cd64e00e34e7608dc3"
    )


def test_fingerprint_follows_all_that_can_change_a_plan() -> None:
    good = two_joints()
    base = robot_from_urdf(good)
    changed = [
        robot_from_urdf(good.replace('upper="2"', 'upper="2.5"')),
        robot_from_urdf(good.replace('velocity="3"', 'velocity="3.5"')),
        robot_from_urdf(good.replace("0.1 0.2 0.3", "0.1 0.2 0.4")),
        robot_from_urdf(good.replace("0 0 1", "0 1 0")),
        robot_from_urdf(good.replace("j2", "j3")),
        robot_from_urdf(good, tip="b"),
        robot_from_urdf(good, name="another"),
        base.with_tool([0, 0, 0.1]),
        base.with_limits(acceleration=1.0),
        base.with_limits(velocity=[3, 2]),
    ]
    prints = [robot.fingerprint for robot in (base, *changed)]
    assert len(set(prints)) == len(prints)
    mesh = good.replace(
        '<link name="b"/>',
        '<link name="b"><visual><geometry><mesh filename="package://x/y.stl"/></geometry></visual></link>',
    )
    same = [
        robot_from_urdf(mesh),
        robot_from_urdf(good.replace("0 0 1", "0 0 1.0")),
        base.with_tool([0, 0, 0]),
        base.with_tool([0, 0, 0], [0, 0, 0, -1]),
        base.with_tool([0, 0, 0.1]).with_tool([-0.0, 0, 0]),
        base.with_limits(),
    ]
    assert {robot.fingerprint for robot in same} == {base.fingerprint}


def test_tool_moves_the_tool_frame_and_replaces_another() -> None:
    robot = load_robot("ur5")
    half = np.sqrt(0.5)
    tooled = robot.with_tool([9, 9, 9]).with_tool([0.1, 0.2, 0.3], [0, 0, half, half])
    T_base_tip, T_base_tool = robot.fk(robot.home), tooled.fk(robot.home)
    T_tip_tool = T_base_tip.actInv(T_base_tool)
    np.testing.assert_allclose(T_tip_tool.translation, [0.1, 0.2, 0.3], atol=1e-15)
    turn = [[0, -1, 0], [1, 0, 0], [0, 0, 1]]
    np.testing.assert_allclose(T_tip_tool.rotation, turn, atol=1e-15)
    assert robot.T_tip_tool.isIdentity()
    nearly = robot.with_tool([0, 0, 0], [0, 0, 0, 1.0009])
    np.testing.assert_array_equal(nearly.T_tip_tool.rotation, np.eye(3))


@pytest.mark.parametrize(
    ("position", "quaternion", "field"),
    [
        ([0, 0], [0, 0, 0, 1], "tool.position"),
        ([0, 0, np.nan], [0, 0, 0, 1], "tool.position"),
        ([0, 0, 0], [0, 0, 1], "tool.quaternion_xyzw"),
        ([0, 0, 0], [0, 0, 0, 1.002], "tool.quaternion_xyzw"),
        ([0, 0, 0], [0, 0, 0, 0], "tool.quaternion_xyzw"),
        ([0, 0, 0], [0, 0, 0, np.inf], "tool.quaternion_xyzw"),
    ],
)
def test_wrong_tool_is_refused(position: list[float], quaternion: list[float], field: str) -> None:
    with pytest.raises(InvalidRequest) as caught:
        load_robot("ur5").with_tool(position, quaternion)
    assert caught.value.field == field


def test_limits_can_be_replaced() -> None:
    robot = load_robot("ur5")
    slow = robot.with_limits(velocity=0.5 * robot.velocity_limit, acceleration=2.0)
    np.testing.assert_array_equal(slow.velocity_limit, 0.5 * robot.velocity_limit)
    np.testing.assert_array_equal(slow.model.upperVelocityLimit, slow.velocity_limit)
    np.testing.assert_array_equal(slow.acceleration_limit, np.full(6, 2.0))
    np.testing.assert_array_equal(slow.lower, robot.lower)
    assert all(
        s.source == "set by with_limits"
        for s in slow.info().limit_sources
        if s.limit in ("velocity", "acceleration")
    )


@pytest.mark.parametrize("values", [0.0, -1.0, np.nan, [1, 1, 1, 1, 1], [1, 1, 1, 1, 1, 0]])
def test_wrong_limits_are_refused(values: Any) -> None:
    with pytest.raises(InvalidRequest) as caught:
        load_robot("ur5").with_limits(velocity=values)
    assert caught.value.field == "velocity"


MINE = """
name: mine
title: My arm
angle_unit: deg
sources: [{fact: all, source: my workshop}]
kinematics: {urdf: {path: arm.urdf}}
base: a
tip: c
joints: [{name: j1, upper: 30}, {name: j2, acceleration: 90}]
limits:
  position: {source: measured}
  velocity: {source: measured}
  acceleration: {default: velocity-limit-reached-in-0.25-s}
home: [10, 20]
"""


@pytest.fixture
def mine(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    folder = tmp_path / "robots" / "mine"
    folder.mkdir(parents=True)
    (folder / "robot.yaml").write_text(MINE)
    (folder / "arm.urdf").write_text(two_joints())
    monkeypatch.setenv("IKPLAN_ROBOTS_PATH", str(folder.parent))
    return folder


def test_robots_of_the_users_folders_are_found(mine: Path) -> None:
    assert robot_names() == sorted([*NAMES, "mine"])
    robot = load_robot("mine")
    np.testing.assert_allclose(np.degrees(robot.home), [10, 20])
    np.testing.assert_allclose(robot.upper, [np.pi / 6, 2.0])
    np.testing.assert_allclose(robot.acceleration_limit, [12.0, np.pi / 2])
    assert load_robot(mine) is robot
    assert load_robot(mine / "robot.yaml") is robot


def test_changed_file_is_read_again(mine: Path) -> None:
    before = load_robot("mine")
    (mine / "robot.yaml").write_text(MINE.replace("[10, 20]", "[10, 21]"))
    after = load_robot("mine")
    np.testing.assert_allclose(np.degrees(after.home), [10, 21])
    assert after.fingerprint != before.fingerprint


def test_changed_description_beside_a_file_is_read_again(mine: Path) -> None:
    before = load_robot("mine")
    assert load_robot("mine") is before
    (mine / "arm.urdf").write_text(two_joints().replace("<robot", "<!-- longer --><robot", 1))
    after = load_robot("mine")
    assert after is not before
    (mine / "arm.urdf").unlink()
    with pytest.raises(InvalidRobot, match="cannot be read"):
        load_robot("mine")


def test_robot_that_is_written_later_hides_the_one_that_was_loaded(mine: Path) -> None:
    ours = load_robot("ur5")
    (mine.parent / "ur5").mkdir()
    (mine.parent / "ur5" / "arm.urdf").write_text(two_joints())
    file = mine.parent / "ur5" / "robot.yaml"
    file.write_text(MINE.replace("name: mine", "name: ur5"))
    assert load_robot("ur5").title == "My arm"
    file.unlink()
    assert load_robot("ur5") is ours


def test_users_robot_hides_ours(mine: Path) -> None:
    mine.rename(mine.parent / "ur5")
    file = mine.parent / "ur5" / "robot.yaml"
    file.write_text(MINE.replace("name: mine", "name: ur5"))
    assert load_robot("ur5").title == "My arm"


def test_folder_that_is_none_is_named(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("IKPLAN_ROBOTS_PATH", "/nowhere/at/all")
    with pytest.raises(InvalidRobot, match="/nowhere/at/all"):
        robot_names()


@pytest.mark.parametrize(
    ("old", "new", "said"),
    [
        ("base: a", "base: [", "not YAML"),
        (MINE, "- a list", "mapping"),
        (MINE, "[" * 5_000, "nested too deep|not YAML"),
        ("title: My arm\n", "", "title: Field required"),
        ("title: My arm", "titel: My arm", "tit"),
        ("home: [10, 20]", "home: [10]", "home has 1 values for 2 joints"),
        ("home: [10, 20]", "home: [10, .nan]", "home.1"),
        ("home: [10, 20]", "home: [10, 200]", "'j2': the home is 3.49.*outside"),
        ("name: mine", "name: yours", "'yours' in the folder 'mine'"),
        ("name: mine", "name: ../mine", "name:"),
        ("sources: [{fact: all, source: my workshop}]", "sources: []", "sources"),
        ("name: j2", "name: j3", "j1, j3; the chain from a to c has j1, j2"),
        ("name: j2", "name: j1", "twice"),
        ("upper: 30", "upper: -90", "'j1'.*above the upper limit"),
        ("upper: 30", "type: prismatic", "'j1' is revolute, not prismatic"),
        ("acceleration: 90", "acceleration: 0", "'j2': the acceleration limit is 0"),
        ("velocity-limit-reached-in-0.25-s", "soon", "no acceleration default 'soon'"),
        ("velocity: {source: measured}", "velocity: {}", "exactly one of source and default"),
        ("tip: c", "tip: d", "no link 'd'"),
        ("arm.urdf", "leg.urdf", "No such file"),
        ("{urdf: {path: arm.urdf}}", "{}", "exactly one of dh, axes and urdf"),
        ("{path: arm.urdf}", "{path: a.urdf, package: numpy}", "kinematics.urdf.package"),
        (
            "{urdf: {path: arm.urdf}}",
            "{dh: {convention: standard, rows: [{d: 1, a: 0, alpha: 0}]}}",
            "1 rows for 2 joints",
        ),
        (
            "{urdf: {path: arm.urdf}}",
            "{axes: {joints: [{name: j1, axis: [0, 0, 0]}], frames: {c: {}}}}",
            "'j1' has a zero axis",
        ),
        ("angle_unit: deg", "coupling: {matrix: [[1, 0]]}", "2 rows .serial joints. of 2"),
        ("angle_unit: deg", "coupling: {matrix: [[1, 0], [0, 1]], offset: [0]}", "offset: 2"),
    ],
)
def test_mistake_in_a_robot_file_is_named(mine: Path, old: str, new: str, said: str) -> None:
    assert old in MINE
    (mine / "robot.yaml").write_text(MINE.replace(old, new))
    with pytest.raises(InvalidRobot, match=said) as caught:
        load_robot("mine")
    assert "mine" in caught.value.detail
    assert "\n" not in caught.value.detail


def test_file_larger_than_two_megabytes_is_refused(mine: Path) -> None:
    (mine / "robot.yaml").write_text(MINE + "#" * 2_000_001)
    with pytest.raises(InvalidRobot, match="may have 2000000"):
        load_robot("mine")


def test_file_that_is_not_text_is_refused(mine: Path) -> None:
    (mine / "robot.yaml").write_bytes(b"\xff\xfe\x00")
    with pytest.raises(InvalidRobot, match="not UTF-8"):
        load_robot("mine")


def test_missing_package_data_lists_the_places_tried() -> None:
    with pytest.raises(InvalidRobot, match="pip install example-robot-data") as caught:
        package_file("example-robot-data", "no_such_description/urdf/arm.urdf")
    assert any("example-robot-data" in place for place in caught.value.valid)
    assert str(Path(sys.prefix)) in caught.value.detail


def test_every_robot_file_is_in_the_documented_format() -> None:
    for name in NAMES:
        file = yaml.safe_load((robot_folder(name) / "robot.yaml").read_text())
        kinematics = file["kinematics"].get("urdf")
        # A robot of ours takes its URDF from the package, never a copy in the repository.
        assert kinematics is None or kinematics["package"] == "example-robot-data"


def test_a_robot_of_the_catalogue_is_found_without_a_look_at_the_others(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """To list a hundred folders took longer than many a plan."""

    def refuse() -> list[str]:
        raise AssertionError("the whole catalogue was listed")

    monkeypatch.setattr("ikplan.robots.load.robot_names", refuse)
    assert catalogue_robot("ur5").name == "ur5"
    with pytest.raises(AssertionError, match="listed"):
        catalogue_robot("UR-5")
