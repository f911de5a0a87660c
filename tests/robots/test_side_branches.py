"""Robots whose base is on another branch than their tip: positioners, turntables, parts in hand."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pinocchio as pin
import pytest

import ikplan
from ikplan.robots.urdf.rerooting import rooted_for
from ikplan.robots.urdf.urdf import parse_urdf


def joint(name: str, parent: str, child: str, xyz: str, axis: str, rpy: str = "0 0 0") -> str:
    return (
        f'<joint name="{name}" type="revolute"><parent link="{parent}"/><child link="{child}"/>'
        f'<origin xyz="{xyz}" rpy="{rpy}"/><axis xyz="{axis}"/>'
        '<limit lower="-2.9" upper="2.9" velocity="2" effort="100"/></joint>'
    )


def fixed(parent: str, child: str, xyz: str, rpy: str = "0 0 0") -> str:
    return (
        f'<joint name="{child}_fixed" type="fixed"><parent link="{parent}"/>'
        f'<child link="{child}"/><origin xyz="{xyz}" rpy="{rpy}"/></joint>'
    )


LINKS = ["world", "a1", "a2", "a3", "a4", "a5", "a6", "tool", "stand", "tilted", "plate", "gun"]
CELL = (
    '<robot name="cell">'
    + "".join(f'<link name="{name}"/>' for name in LINKS)
    + joint("j1", "world", "a1", "0 0 0.3", "0 0 1")
    + joint("j2", "a1", "a2", "0 0 0.1", "0 1 0")
    + joint("j3", "a2", "a3", "0 0 0.5", "0 1 0")
    + joint("j4", "a3", "a4", "0 0 0.1", "0 0 1")
    + joint("j5", "a4", "a5", "0 0 0.4", "0 1 0")
    + joint("j6", "a5", "a6", "0 0 0.08", "0 0 1")
    + fixed("a6", "tool", "0 0 0.1")
    + fixed("world", "stand", "0.75 0.1 0.2", "0.1 -0.2 0.3")
    + joint("tilt", "stand", "tilted", "0 0 0.05", "1 0 0", "0.3 0.2 -0.1")
    + joint("turn", "tilted", "plate", "0.01 0.02 0.1", "0 0 1")
    + fixed("world", "gun", "0.6 -0.3 0.7", "0 1.2 0.4")
    + "</robot>"
)
HOME = {"j2": 0.4, "j3": 1.2, "j5": 1.5}


@pytest.fixture(scope="module")
def cell(tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("cell") / "cell.urdf"
    path.write_text(CELL)
    return path


def poses_by_pinocchio(values: dict[str, float]) -> dict[str, pin.SE3]:
    model = pin.buildModelFromXML(CELL)
    data = model.createData()
    q = pin.neutral(model)
    for name, value in values.items():
        q[model.joints[model.getJointId(name)].idx_q] = value
    pin.framesForwardKinematics(model, data, q)
    return {name: data.oMf[model.getFrameId(name, pin.FrameType.BODY)] for name in LINKS}


@pytest.mark.parametrize(("base", "tip"), [("plate", "tool"), ("tilted", "a5"), ("tool", "gun")])
def test_the_tip_is_where_pinocchio_has_it_against_the_moving_base(
    cell: Path, base: str, tip: str
) -> None:
    robot = ikplan.load_robot(cell, base=base, tip=tip)
    rng = np.random.default_rng(0)
    for _ in range(20):
        q = rng.uniform(-2.0, 2.0, robot.dof)
        poses = poses_by_pinocchio(dict(zip(robot.joint_names, q.tolist(), strict=True)))
        wanted = poses[base].inverse() * poses[tip]
        assert np.abs(robot.fk(q).homogeneous - wanted.homogeneous).max() <= 1e-12


def test_the_way_goes_up_one_branch_and_down_the_other(cell: Path) -> None:
    robot = ikplan.load_robot(cell, base="plate", tip="tool")
    assert robot.joint_names == ("turn", "tilt", "j1", "j2", "j3", "j4", "j5", "j6")
    assert any("gravity" in note for note in robot.info().notes)
    tree = parse_urdf(CELL.encode(), robot="cell")
    assert rooted_for(tree, "world", "tool") is tree


def line_on_the_part(robot: ikplan.Robot, **fields: Any) -> dict[str, Any]:
    start = np.array([0.3, -0.2, 0.1, 0.5, 1.1, 0.1, 1.0, 0.2])
    T = robot.fk(start)
    to = T.translation + np.array([0.1, 0.08, 0.0])
    quaternion = pin.Quaternion(T.rotation).coeffs().tolist()
    target = {"position": to.tolist(), "quaternion_xyzw": quaternion}
    return {
        "robot": "cell",
        "start": start.tolist(),
        "path": {"segments": [{"type": "line", "to": target}]},
        **fields,
    }


def test_a_line_on_the_part_is_followed_while_both_move(cell: Path) -> None:
    robot = ikplan.load_robot(cell, base="plate", tip="tool")
    request = line_on_the_part(robot)
    plan = ikplan.plan(request, robot=robot)
    assert plan.certificate.valid
    moved = np.abs(plan.q - plan.q[0]).max(axis=0)
    assert moved[0] > 1e-3
    assert moved[2:].max() > 1e-3
    begin = robot.fk(plan.q[0]).translation
    along = np.array(request["path"]["segments"][0]["to"]["position"]) - begin
    along /= np.linalg.norm(along)
    # In the frame of the plate, by Pinocchio on the whole cell.
    for q in plan.q[:: len(plan.q) // 20]:
        poses = poses_by_pinocchio(dict(zip(robot.joint_names, q.tolist(), strict=True)))
        off = (poses["plate"].inverse() * poses["tool"]).translation - begin
        assert np.linalg.norm(off - along * float(off @ along)) <= 1e-4


@pytest.mark.parametrize("half", [0.0, 1e-10, 1e-8, 1e-7])
def test_a_positioner_that_stands_gives_the_motion_of_the_arm_alone(
    cell: Path, half: float
) -> None:
    robot = ikplan.load_robot(cell, base="plate", tip="tool")
    request = line_on_the_part(robot)
    start = request["start"]
    still = {
        name: {"lower": value - half, "upper": value + half}
        for name, value in zip(("turn", "tilt"), start, strict=False)
    }
    both = ikplan.plan({**request, "limits": {"joints": still}}, robot=robot)
    arm = ikplan.load_robot(cell, base="world", tip="tool")
    values = dict(zip(robot.joint_names, start, strict=True))
    T = poses_by_pinocchio(values)["plate"]
    frame = {
        "position": T.translation.tolist(),
        "quaternion_xyzw": pin.Quaternion(T.rotation).coeffs().tolist(),
    }
    alone = ikplan.plan(
        {**request, "start": start[2:], "path": {**request["path"], "frame": frame}}, robot=arm
    )
    assert both.duration == pytest.approx(alone.duration, abs=0.0045)
    assert np.abs(both.q[:, :2] - start[:2]).max() <= 1.01 * (half or 1e-9)
    assert np.abs(both.waypoints.q[-1][2:] - alone.waypoints.q[-1]).max() <= 1e-6


def test_an_obstacle_in_the_cell_stands_while_the_base_moves(cell: Path) -> None:
    robot = ikplan.load_robot(cell, base="plate", tip="tool")
    tool = {"geometry": [{"name": "torch", "shape": {"type": "sphere", "radius": 0.03}}]}
    request = line_on_the_part(robot, tool=tool)
    values = dict(zip(robot.joint_names, request["start"], strict=True))
    at = poses_by_pinocchio(values)["tool"].translation
    ball = {"name": "ball", "shape": {"type": "sphere", "radius": 0.02}, "link": "world"}
    scene = {"obstacles": [{**ball, "position": (at + np.array([0.0, 0.0, 0.2])).tolist()}]}
    free = ikplan.plan({**request, "scene": scene}, robot=robot)
    assert free.certificate.clearance is not None
    assert free.certificate.clearance.proven
    scene = {"obstacles": [{**ball, "position": at.tolist()}]}
    with pytest.raises(ikplan.InCollision):
        ikplan.plan({**request, "scene": scene}, robot=robot)
    scene = {"obstacles": [{**ball, "link": "nowhere", "position": [0, 0, 0]}]}
    with pytest.raises(ikplan.InvalidRequest, match="link"):
        ikplan.plan({**request, "scene": scene}, robot=robot)


def test_mimic_joints_on_the_chain_follow_their_leader(tmp_path: Path) -> None:
    text = CELL.replace(
        '<axis xyz="0 1 0"/><limit lower="-2.9" upper="2.9" velocity="2" effort="100"/></joint>'
        '<joint name="j4"',
        '<axis xyz="0 1 0"/><mimic joint="j2" multiplier="-0.5" offset="0.1"/>'
        '<limit lower="-2.9" upper="2.9" velocity="2" effort="100"/></joint><joint name="j4"',
    )
    assert "mimic" in text
    path = tmp_path / "mimic.urdf"
    path.write_text(text)
    robot = ikplan.load_robot(path, base="plate", tip="tool")
    assert robot.joint_names == ("turn", "tilt", "j1", "j2", "j4", "j5", "j6")
    q = np.array([0.3, -0.2, 0.1, 0.5, 0.2, 1.0, 0.2])
    values = dict(zip(robot.joint_names, q.tolist(), strict=True))
    values["j3"] = -0.5 * values["j2"] + 0.1
    poses = poses_by_pinocchio(values)
    wanted = poses["plate"].inverse() * poses["tool"]
    assert np.abs(robot.fk(q).homogeneous - wanted.homogeneous).max() <= 1e-12
