"""What the written robots are held to: facts of their sources, solved poses, planned lines."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
import pinocchio as pin
from numpy.typing import NDArray

import ikplan
from catalogue.facts import Arm, FactsJoint
from ikplan.robots import Robot, load_robot

__all__ = ["DIRECTIONS", "fk_errors", "lines_planned", "poses_solved", "serial_values"]

Array = NDArray[Any]
DIRECTIONS = {"+x": (1, 0, 0), "-x": (-1, 0, 0), "+z": (0, 0, 1), "-z": (0, 0, -1)}
_LENGTH = 0.1


def fk_errors(arm: Arm, robot: Robot, count: int, rng: np.random.Generator) -> tuple[float, float]:
    """Largest position [m] and rotation [rad] error against both compositions of the facts.

    Args:
        arm: The facts.
        robot: The robot of the catalogue.
        count: How many random configurations.
        rng: Draws them.
    """
    model = pin.buildModelFromXML(_urdf(arm))
    data, tip = model.createData(), model.getFrameId("facts_tip", pin.FrameType.BODY)
    worst = np.zeros(2)
    for _ in range(count):
        q = robot.random_configuration(rng)
        serial = serial_values(arm, q)
        pin.framesForwardKinematics(model, data, _configuration(arm, serial))
        for T in (_composed(arm, serial), data.oMf[tip].homogeneous):
            moved = robot.fk(q).actInv(pin.SE3(T))
            turned = float(np.linalg.norm(pin.log3(moved.rotation)))
            worst = np.maximum(worst, (float(np.linalg.norm(moved.translation)), turned))
    return float(worst[0]), float(worst[1])


def poses_solved(robot: Robot, count: int, rng: np.random.Generator) -> int:
    """How many poses of random configurations ``lm`` solves, each from another configuration."""
    solved = 0
    for _ in range(count):
        target = robot.fk(robot.random_configuration(rng))
        try:
            found = ikplan.solve_ik(
                robot, target, start=robot.random_configuration(rng), method="lm"
            )
        except ikplan.IkplanError:
            continue
        missed = robot.fk(found.q).actInv(target)
        solved += bool(np.linalg.norm(pin.log6(missed).vector) <= 1e-5)
    return solved


def lines_planned(name: str, directions: Sequence[str] = tuple(DIRECTIONS)) -> dict[str, str]:
    """Plan lines of 100 mm from home; "planned" or the refusal, by direction."""
    robot = load_robot(name)
    home = robot.fk(robot.home)
    turn = pin.Quaternion(home.rotation).coeffs().tolist()
    said = {}
    for direction in directions:
        to = home.translation + _LENGTH * np.array(DIRECTIONS[direction])
        waypoint = {"position": to.tolist(), "quaternion_xyzw": turn}
        path = {"waypoints": [waypoint], "interpolation": "line"}
        try:
            plan = ikplan.plan({"robot": name, "path": path, "budget_s": 30})
        except ikplan.IkplanError as refusal:
            said[direction] = f"{type(refusal).__name__}: {refusal.detail}"
        else:
            said[direction] = "planned" if plan.certificate.valid else "not certified"
    return said


def serial_values(arm: Arm, q: Array) -> Array:
    """Values of the serial joints of the facts."""
    return q if arm.counting is None else np.array(arm.counting.matrix) @ q


def _composed(arm: Arm, serial: Array) -> Array:
    T = np.eye(4)
    for joint, value in zip(arm.joints, serial, strict=True):
        T = T @ _placed(joint.xyz, joint.rpy) @ _moved(joint, float(value))
    return T @ _placed(arm.tool.xyz, arm.tool.rpy)


def _placed(xyz: Sequence[float], rpy: Sequence[float]) -> Array:
    (cr, cp, cy), (sr, sp, sy) = np.cos(rpy), np.sin(rpy)
    T = np.eye(4)
    T[:3, :3] = [
        [cy * cp, cy * sp * sr - sy * cr, cy * sp * cr + sy * sr],
        [sy * cp, sy * sp * sr + cy * cr, sy * sp * cr - cy * sr],
        [-sp, cp * sr, cp * cr],
    ]
    T[:3, 3] = xyz
    return T


def _moved(joint: FactsJoint, value: float) -> Array:
    T = np.eye(4)
    if joint.type == "prismatic":
        T[:3, 3] = value * np.array(joint.axis)
    else:
        T[:3, :3] = pin.AngleAxis(value, np.array(joint.axis)).matrix()
    return T


def _urdf(arm: Arm) -> str:
    """The facts as a URDF whose last link is ``facts_tip``."""
    parts, parent = [f'<robot name="{arm.name}"><link name="facts_base"/>'], "facts_base"
    tool = FactsJoint(
        name="facts_tool", xyz=arm.tool.xyz, rpy=arm.tool.rpy, axis=(0, 0, 1), velocity=1.0
    )
    for i, joint in enumerate([*arm.joints, tool]):
        kind = joint.type if joint is not tool else "fixed"
        child = f"facts_{i}" if joint is not tool else "facts_tip"
        xyz, rpy, axis = (" ".join(map(repr, v)) for v in (joint.xyz, joint.rpy, joint.axis))
        parts.append(
            f'<link name="{child}"/><joint name="{joint.name}" type="{kind}">'
            f'<parent link="{parent}"/><child link="{child}"/><origin xyz="{xyz}" rpy="{rpy}"/>'
            f'<axis xyz="{axis}"/><limit lower="{joint.lower or 0}" upper="{joint.upper or 0}" '
            f'velocity="{joint.velocity}" effort="{joint.effort or 0}"/></joint>'
        )
        parent = child
    return "".join(parts) + "</robot>"


def _configuration(arm: Arm, serial: Array) -> Array:
    """Pinocchio's configuration: two numbers for a continuous joint."""
    parts = [
        (np.cos(v), np.sin(v)) if joint.type == "continuous" else (v,)
        for joint, v in zip(arm.joints, serial, strict=True)
    ]
    return np.concatenate(parts)
