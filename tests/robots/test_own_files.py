"""xacro, description packages and DH tables, and robots that are written from them."""

from __future__ import annotations

import shutil
from pathlib import Path

import numpy as np
import pinocchio as pin
import pytest
import yaml

from ikplan.documents import parse
from ikplan.errors import InvalidRobot
from ikplan.robots import Robot, RobotUpload, load_robot, robot_from_urdf
from ikplan.robots.loading.checking import check_against_whole
from ikplan.robots.loading.packages import find_package
from ikplan.robots.loading.sources import read_source
from ikplan.robots.loading.uploading import upload_fields
from ikplan.robots.loading.writing import catalogue_name, write_robot

from .urdfs import joint, two_joints, urdf

EXAMPLE = Path(__file__).parents[2] / "examples" / "ur5e_cell"
CELL = EXAMPLE / "cell_description"
ARM = {"arm": "ur5e"}


def assert_same_motion(robot: Robot, other: Robot, off: float = 1e-9) -> None:
    rng = np.random.default_rng(1)
    for _ in range(20):
        q = other.random_configuration(rng)
        a, b = robot.fk(q), other.fk(q)
        np.testing.assert_allclose(a.homogeneous, b.homogeneous, atol=off)


def test_a_package_of_xacro_files_is_the_arm_that_they_describe() -> None:
    """The macros, arguments and lengths of two packages, against the catalogue's own arm."""
    robot = load_robot(CELL, args={**ARM, "nozzle": "0.12"}, tip="nozzle_tcp")
    arm = load_robot("ur5e").with_tool([0, 0, 0.12])
    rng = np.random.default_rng(2)
    for _ in range(20):
        q = arm.random_configuration(rng)
        want = pin.SE3(np.eye(3), np.array([0, 0, 0.8])) * arm.fk(q)
        np.testing.assert_allclose(robot.fk(q).homogeneous, want.homogeneous, atol=1e-9)
    assert load_robot(CELL, args=ARM).tip_frame == "tool0"


def test_an_expanded_file_is_the_same_robot() -> None:
    source = read_source(CELL, ARM)
    assert b"xacro:" not in source.urdf
    assert_same_motion(load_robot(CELL, args=ARM), robot_from_urdf(source.urdf), 0.0)


def test_limits_of_the_package_are_read_with_their_units() -> None:
    robot = load_robot(CELL, args=ARM)
    np.testing.assert_allclose(np.degrees(robot.velocity_limit), [120, 120, 150, 180, 180, 180])
    np.testing.assert_allclose(np.degrees(robot.acceleration_limit), [300] * 6)
    assert "wrist_1_joint, wrist_2_joint, wrist_3_joint" in robot.description.assumptions[0]


def test_an_argument_without_a_default_is_asked_for_and_a_misspelt_one_refused() -> None:
    with pytest.raises(InvalidRobot, match=r"argument arm; give it as NAME:=VALUE"):
        load_robot(CELL)
    with pytest.raises(InvalidRobot, match="no argument 'nozle'; did you mean nozzle"):
        load_robot(CELL, args={**ARM, "nozle": "1"})
    with pytest.raises(InvalidRobot, match=r"xacro: .*ur99_geometry"):
        load_robot(CELL, args={"arm": "ur99"})


def test_a_package_that_is_not_there_is_named(tmp_path: Path) -> None:
    shutil.copytree(CELL, tmp_path / "a" / "b" / "cell_description")
    with pytest.raises(InvalidRobot, match="no package 'arm_macros' near it") as caught:
        load_robot(tmp_path / "a" / "b" / "cell_description", args=ARM)
    assert "cell_description" in caught.value.valid
    shutil.copytree(EXAMPLE / "arm_macros", tmp_path / "a" / "elsewhere" / "macros")
    file = tmp_path / "a" / "b" / "cell_description" / "urdf" / "cell.urdf.xacro"
    from ikplan.robots.loading import packages

    packages._packages_near.cache_clear()
    assert find_package("arm_macros", file).name == "macros"
    assert load_robot(file, args=ARM).dof == 6


def test_xacro_is_left_as_it_was() -> None:
    from xacro import substitution_args

    before = substitution_args._eval_find
    load_robot(CELL, args=ARM)
    assert substitution_args._eval_find is before is substitution_args._eval_dict["find"]


def test_the_service_expands_no_xacro() -> None:
    text = (CELL / "urdf" / "cell.urdf.xacro").read_text()
    with pytest.raises(InvalidRobot, match="is a xacro macro; run xacro on the file first"):
        parse(RobotUpload, {"urdf": text}).robot()


@pytest.mark.parametrize(
    ("document", "said"),
    [
        ("<mujoco/>", "MJCF has no velocity limits and is not read"),
        ("<sdf version='1.7'/>", "SDF is not read"),
        ("<svg/>", "not <robot>$"),
    ],
)
def test_other_formats_are_refused_with_what_to_do(
    document: str, said: str, tmp_path: Path
) -> None:
    file = tmp_path / "robot.xml"
    file.write_text(document)
    with pytest.raises(InvalidRobot, match=said):
        load_robot(file)


def test_a_folder_of_several_descriptions_asks_for_one(tmp_path: Path) -> None:
    folder = tmp_path / "two_arms"
    folder.mkdir()
    for name in ("left", "right"):
        (folder / f"{name}.urdf").write_text(two_joints())
    with pytest.raises(InvalidRobot, match=r"there are 2 descriptions: left.urdf, right.urdf"):
        load_robot(folder)
    (folder / "two_arms.urdf").write_text(two_joints())
    assert load_robot(folder).name == "two_arms"


PANDA = """
convention: modified
angles: deg
rows:
  - {a: 0, d: 0.333, alpha: 0}
  - {a: 0, d: 0, alpha: -90}
  - {a: 0, d: 0.316, alpha: 90}
  - {a: 0.0825, d: 0, alpha: 90}
  - {a: -0.0825, d: 0.384, alpha: -90}
  - {a: 0, d: 0, alpha: 90}
  - {a: 0.088, d: 0, alpha: 90}
"""


def dh_limits() -> dict[str, dict[str, float]]:
    panda = load_robot("panda")
    return {
        f"joint_{i + 1}": {"lower": a, "upper": b, "velocity": v, "acceleration": c}
        for i, (a, b, v, c) in enumerate(
            zip(
                panda.lower,
                panda.upper,
                panda.velocity_limit,
                panda.acceleration_limit,
                strict=True,
            )
        )
    }


def test_a_modified_dh_table_is_the_arm_of_its_maker(tmp_path: Path) -> None:
    file = tmp_path / "franka.yaml"
    file.write_text(PANDA)
    robot = load_robot(file, limits=dh_limits())
    assert (robot.base_frame, robot.tip_frame, robot.dof) == ("base", "tool", 7)
    assert_same_motion(robot, load_robot("panda", tip="panda_link7"))
    assert not robot.description.assumptions


def test_a_standard_dh_table_in_csv_with_a_slide(tmp_path: Path) -> None:
    file = tmp_path / "scara.csv"
    file.write_text(
        "# convention: standard\n# lengths: mm\n"
        "name, type, a, d, alpha, theta, lower, upper, velocity\n"
        "j1, revolute, 325, 400, 0, , -2.5, 2.5, 6\n"
        "j2, revolute, 225, 0, 3.141592653589793, , -2.4, 2.4, 7\n"
        "z, prismatic, 0, , 0, 0, 0, 170, 1100\n"
    )
    robot = load_robot(file)
    assert robot.prismatic.tolist() == [False, False, True]
    np.testing.assert_allclose([robot.upper[2], robot.velocity_limit[2]], [0.17, 1.1])
    a, b, z = 0.3, -0.8, 0.1
    want = [0.325 * np.cos(a) + 0.225 * np.cos(a + b), 0.325 * np.sin(a) + 0.225 * np.sin(a + b)]
    np.testing.assert_allclose(robot.fk([a, b, z]).translation, [*want, 0.4 - z], atol=1e-12)


@pytest.mark.parametrize(
    ("text", "said"),
    [
        (PANDA.replace("convention: modified", ""), "say which convention it has"),
        (PANDA.replace("modified", "craig"), "'craig' is not one of standard, modified"),
        (PANDA.replace("deg", "degrees"), "angles: 'degrees' is not one of rad, deg"),
        (PANDA.replace("d: 0.333, ", ""), "row 1: d is missing"),
        (PANDA.replace("0.333", "x"), "row 1: d is not a number: 'x'"),
        (PANDA.replace("d: 0.333", "dd: 0.333"), "row 1: no column 'dd'"),
        (PANDA, "'joint_1' has no velocity limit: give one"),
        ("convention: standard\nrows: []", "1 to 64 rows"),
    ],
)
def test_a_dh_table_that_makes_no_sense_is_refused(text: str, said: str, tmp_path: Path) -> None:
    file = tmp_path / "table.yaml"
    file.write_text(text)
    with pytest.raises(InvalidRobot, match=said):
        load_robot(file)


def test_settings_of_a_table_can_be_given(tmp_path: Path) -> None:
    file = tmp_path / "table.yaml"
    file.write_text(PANDA.replace("convention: modified", ""))
    robot = load_robot(file, args={"convention": "modified"}, limits=dh_limits())
    assert_same_motion(robot, load_robot("panda", tip="panda_link7"))


MIMIC = '<mimic joint="j1" multiplier="-1" offset="0.1"/>'


@pytest.mark.parametrize(
    "document",
    [
        two_joints(),
        two_joints(kind="continuous"),
        two_joints(kind="prismatic"),
        two_joints(more=MIMIC),
        two_joints(limit='<limit lower="-1e9" upper="1e9" velocity="3" effort="0"/>'),
        two_joints(limit='<limit lower="-1" upper="1" velocity="3" effort="0" acceleration="9"/>'),
        urdf(
            joint("j1", "a", "b"),
            joint("j2", "b", "c", more=MIMIC),
            joint("j3", "c", "d", kind="continuous"),
            links="a b c d",
        ),
    ],
)
def test_a_written_robot_reads_as_the_same(document: str, tmp_path: Path) -> None:
    robot = robot_from_urdf(document, name="mine")
    folder = write_robot(tmp_path / "robots", robot.description, document.encode())
    again = load_robot(folder)
    assert again.fingerprint == robot.fingerprint
    assert again.description.assumptions == robot.description.assumptions
    assert yaml.safe_load((folder / "robot.yaml").read_text())["name"] == "mine"
    with pytest.raises(InvalidRobot, match="is there; give another --name"):
        write_robot(tmp_path / "robots", robot.description, document.encode())
    write_robot(tmp_path / "robots", robot.description, document.encode(), replace=True)
    assert "equal Pinocchio's" in check_against_whole(robot, document.encode())


def test_a_file_that_moves_otherwise_is_found_out() -> None:
    robot = robot_from_urdf(two_joints())
    with pytest.raises(InvalidRobot, match="differ from those of the whole file"):
        check_against_whole(robot, two_joints().replace("0.2 0.3", "0.2 0.31").encode())


def test_what_goes_to_a_service_is_the_same_robot() -> None:
    said = {"args": ARM}
    source, robot = read_source(CELL, ARM), load_robot(CELL, args=ARM)
    upload = parse(
        RobotUpload, {"urdf": source.urdf.decode(), **upload_fields(robot, source, said)}
    )
    there = upload.robot()
    assert_same_motion(there, robot, 0.0)
    for name in ("lower", "upper", "velocity_limit", "acceleration_limit", "home"):
        np.testing.assert_array_equal(getattr(there, name), getattr(robot, name))
    assert there.description.assumptions == robot.description.assumptions


@pytest.mark.parametrize(("name", "plain"), [("My Arm", "my_arm"), ("UR5e.v2", "ur5e_v2")])
def test_names_of_files_become_names_of_the_catalogue(name: str, plain: str) -> None:
    assert catalogue_name(name) == plain
    with pytest.raises(InvalidRobot, match="no name for a robot"):
        catalogue_name("...")
