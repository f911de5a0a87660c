"""Controllers: described with sources, checked, counted by the fingerprint, and shown."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pinocchio as pin
import pytest
import yaml

from ikplan.documents import parse
from ikplan.errors import InvalidRequest, InvalidRobot
from ikplan.robots import RobotInfo, RobotUpload, load_robot, robot_names
from ikplan.robots.folders import robot_folder

from .urdfs import joint, two_joints, urdf

CONTROLLED = {
    "fer": 0.001, "fr3": 0.001, "panda": 0.001, "ur10": 0.008, "ur10e": 0.002, "ur16e": 0.002,
    "ur20": 0.002, "ur3": 0.008, "ur30": 0.002, "ur3e": 0.002, "ur5": 0.008, "ur5e": 0.002,
    # Every arm of these makers whose controller runs KRL, RAPID, TP programs or DRL.
    **{name: 0.004 for name in robot_names() if name.startswith(("kuka_kr", "abb_"))},
    **{name: 0.008 for name in robot_names() if name.startswith("fanuc_")},
    **{name: 0.001 for name in robot_names() if name.startswith("doosan_")},
}  # fmt: skip
HALF_PI = np.pi / 2


@pytest.mark.parametrize("name", robot_names())
def test_every_fact_of_a_controller_has_a_source(name: str) -> None:
    robot = load_robot(name)
    controller = robot.controller
    assert (controller is None) == (name not in CONTROLLED)
    assert RobotInfo.model_validate_json(robot.info().model_dump_json()).controller == controller
    if controller is None:
        assert robot.jerk_limit is None
        return
    assert controller.cycle == CONTROLLED[name]
    facts = " ".join(source.fact for source in controller.sources)
    assert "cycle" in facts
    assert ("jerk" in facts) == (controller.jerk is not None)
    assert ("acceleration" in facts) == controller.zero_end_acceleration
    assert ("base frame" in facts) == (controller.base_frame is not None)
    longest = any(language.longest_program for language in controller.languages)
    assert ("longest program" in facts) == longest
    if controller.jerk is not None:
        np.testing.assert_array_equal(robot.jerk_limit, controller.jerk)
        assert robot.jerk_limit is not None
        assert not robot.jerk_limit.flags.writeable


def dh(theta: float, a: float, d: float, alpha: float) -> np.ndarray:
    c, s, ca, sa = np.cos(theta), np.sin(theta), np.cos(alpha), np.sin(alpha)
    return np.array(
        [[c, -s * ca, s * sa, a * c], [s, c * ca, -c * sa, a * s], [0, sa, ca, d], [0, 0, 0, 1]]
    )


# The makers' tables: a and d [m], alpha [rad].
UR_DH = {
    "ur3e": [0.15185, -0.24355, -0.2132, 0.13105, 0.08535, 0.0921],
    "ur5e": [0.1625, -0.425, -0.3922, 0.1333, 0.0997, 0.0996],
    "ur10e": [0.1807, -0.6127, -0.57155, 0.17415, 0.11985, 0.11655],
}


@pytest.mark.parametrize("name", UR_DH)
def test_ur_e_series_is_the_makers_dh_table_in_the_controllers_base(name: str) -> None:
    d1, a2, a3, d4, d5, d6 = UR_DH[name]
    rows = [(0.0, d1, HALF_PI), (a2, 0.0, 0.0), (a3, 0.0, 0.0)]
    rows += [(0.0, d4, HALF_PI), (0.0, d5, -HALF_PI), (0.0, d6, 0.0)]
    robot = load_robot(name)
    controller = robot.controller
    assert controller is not None
    assert controller.base_frame is not None
    frame = controller.base_frame
    T_base_controller = pin.XYZQUATToSE3(np.array([*frame.position, *frame.quaternion_xyzw]))
    rng = np.random.default_rng(6)
    for _ in range(50):
        q = robot.random_configuration(rng)
        T = np.linalg.multi_dot([dh(angle, *row) for angle, row in zip(q, rows, strict=True)])
        seen = (T_base_controller.inverse() * robot.fk(q)).homogeneous
        np.testing.assert_allclose(seen, T, atol=1e-9, rtol=0)


def test_fr3_is_the_makers_modified_dh_table() -> None:
    rows = [(0, 0.333, 0), (0, 0, -HALF_PI), (0, 0.316, HALF_PI), (0.0825, 0, HALF_PI)]
    rows += [(-0.0825, 0.384, -HALF_PI), (0, 0, HALF_PI), (0.088, 0, HALF_PI)]
    robot = load_robot("fr3")
    rng = np.random.default_rng(7)
    for _ in range(50):
        q = robot.random_configuration(rng)
        T = np.eye(4)
        for angle, (a, d, alpha) in zip(q, rows, strict=True):
            T = T @ dh(0.0, a, 0.0, alpha) @ dh(angle, 0.0, d, 0.0)
        T = T @ dh(0.0, 0.0, 0.107, 0.0)
        np.testing.assert_allclose(robot.fk(q).homogeneous, T, atol=1e-9, rtol=0)


@pytest.mark.parametrize("name", ["ur3e", "ur5e", "ur10e"])
def test_the_flange_of_a_ur_is_its_tool0_turned_as_ros_has_it(name: str) -> None:
    q = np.arange(6) * 0.1
    tool0, flange = load_robot(name).fk(q), load_robot(name, tip="flange").fk(q)
    np.testing.assert_allclose(flange.translation, tool0.translation, atol=1e-15)
    for mine, theirs in ((0, 2), (1, 0), (2, 1)):
        expected = tool0.rotation[:, theirs] * (1 if mine == 0 else -1)
        np.testing.assert_allclose(np.abs(flange.rotation[:, mine] @ expected), 1.0, atol=1e-12)
    np.testing.assert_allclose(flange.rotation[:, 0], tool0.rotation[:, 2], atol=1e-12)


def test_the_fingerprint_counts_what_a_controller_does_and_not_its_sources() -> None:
    description = load_robot("panda").description
    controller = description.controller
    assert controller is not None
    seen = {description.fingerprint()}
    assert controller.jerk is not None
    for change in (
        {"cycle": 0.002},
        {"jerk": [*controller.jerk[:6], 9999.0]},
        {"zero_end_acceleration": False},
        {"base_frame": None},
        {"interpolation": "linear"},
    ):
        other = replace(description, controller=controller.model_copy(update=change))
        seen.add(other.fingerprint())
    assert len(seen) == 6
    assert replace(description, controller=None).fingerprint() not in seen
    silent = replace(description, controller=controller.model_copy(update={"sources": []}))
    assert silent.fingerprint() == description.fingerprint()


def test_a_shorter_chain_keeps_its_joints_jerks_and_a_longer_one_has_no_controller(
    tmp_path: Path,
) -> None:
    whole = load_robot("panda")
    part = load_robot("panda", tip="panda_link5")
    assert part.jerk_limit is not None
    assert whole.jerk_limit is not None
    np.testing.assert_array_equal(part.jerk_limit, whole.jerk_limit[: part.dof])
    assert part.controller is not None
    assert part.controller.base_frame is not None
    content = yaml.safe_load((robot_folder("ur5") / "robot.yaml").read_text())
    content |= {key: content[key][:4] for key in ("joints", "home")} | {"tip": "wrist_1_link"}
    (tmp_path / "robot.yaml").write_text(yaml.safe_dump(content))
    assert load_robot(tmp_path).controller is not None
    assert load_robot(tmp_path, tip="tool0").controller is None
    moved = load_robot("panda", base="panda_link1").controller
    assert moved is not None
    assert moved.base_frame is None


def written(folder: Path, **controller: Any) -> Path:
    text = (robot_folder("iiwa14") / "robot.yaml").read_text()
    content = yaml.safe_load(text)
    content["controller"] = {
        "title": "a controller",
        "cycle": 0.004,
        "sources": [{"fact": "all", "source": "a test"}],
        **controller,
    }
    path = folder / "robot.yaml"
    path.write_text(yaml.safe_dump(content))
    return path


def test_jerks_of_a_file_in_degrees_are_read_in_degrees(tmp_path: Path) -> None:
    robot = load_robot(written(tmp_path, jerk=[1000.0] * 7))
    assert robot.jerk_limit is not None
    np.testing.assert_allclose(robot.jerk_limit, np.radians(1000.0), rtol=1e-15)
    assert robot.info().controller == robot.controller


@pytest.mark.parametrize(
    ("fields", "words"),
    [
        ({"jerk": [1.0] * 6}, "controller.jerk: give 7 numbers"),
        ({"jerk": [1.0] * 6 + [0.0]}, "controller.jerk.6"),
        ({"cycle": 0.0}, "controller.cycle"),
        ({"zero_end_acceleration": True}, "needs jerk limits"),
        ({"languages": [{"name": "basic", "variant": "cb3"}]}, "controller.languages.0.name"),
        ({"cylce": 0.1}, "controller.cylce"),
        ({"sources": []}, "controller.sources"),
    ],
)
def test_a_controller_that_makes_no_sense_is_refused_by_its_field(
    tmp_path: Path, fields: dict[str, Any], words: str
) -> None:
    with pytest.raises(InvalidRobot, match=words):
        load_robot(written(tmp_path, **fields))


def test_an_uploaded_robot_can_have_a_controller() -> None:
    document = urdf(joint("j1", "a", "b"), joint("j2", "b", "c"))
    controller: dict[str, Any] = {"title": "mine", "cycle": 0.01, "jerk": [5.0, 6.0]}
    upload = RobotUpload.model_validate({"urdf": document, "controller": controller})
    robot = upload.robot()
    np.testing.assert_array_equal(robot.jerk_limit, [5.0, 6.0])
    read = RobotUpload.model_validate_json(upload.canonical())
    assert read.content_id() == upload.content_id()
    assert read.robot().fingerprint == robot.fingerprint
    wrong = {"urdf": document, "controller": {**controller, "jerk": [5.0]}}
    with pytest.raises(InvalidRobot, match="give 2 numbers"):
        RobotUpload.model_validate(wrong).robot()
    with pytest.raises(InvalidRequest, match="cycle"):
        parse(RobotUpload, {"urdf": document, "controller": {"title": "mine", "cycle": 0.0}})


def test_an_upload_without_a_controller_has_the_id_that_it_had_before_there_were_any() -> None:
    upload = RobotUpload(urdf=two_joints(), rules=1)
    assert upload.content_id() == "urdf-1306de67591669a0661b539ff1e346e5"
    assert b"controller" not in upload.canonical()
