"""``python -m benchmarks.catalogue``: the written robots against the facts of their sources.

For each robot that ``python -m catalogue`` writes: the largest error of its forward kinematics
against the facts (composed here in numpy, and by Pinocchio from a URDF of the facts), how many of
200 random poses ``lm`` solves, the smallest singular value at home, and how many of the 100 mm
lines from home along +x, -x, +z and -z plan.
"""

from __future__ import annotations

import argparse
import time
from collections.abc import Sequence
from typing import Any

import numpy as np
import pinocchio as pin
from numpy.typing import NDArray

import ikplan
from catalogue.facts import Arm, FactsJoint, read_facts
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


def main(arguments: Sequence[str] | None = None) -> None:
    """Print a row a robot, and the sums."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks.catalogue", description=__doc__)
    parser.add_argument("--poses", type=int, default=200, help="poses of IK a robot")
    parser.add_argument("names", nargs="*", help="robots; none: all")
    options = parser.parse_args(arguments)
    facts = read_facts()
    arms = [arm for arm in facts.arms if not options.names or arm.name in options.names]
    errors, solved, planned, least, refusals = np.zeros(2), 0, 0, np.inf, []
    begun = time.perf_counter()
    for number, arm in enumerate(arms):
        robot = load_robot(arm.name)
        rng = np.random.default_rng([14, number])
        error = fk_errors(arm, robot, 50, rng)
        met = poses_solved(robot, options.poses, rng)
        value = float(np.linalg.svd(robot.jacobian(robot.home), compute_uv=False)[-1])
        said = lines_planned(arm.name)
        lines = sum(answer == "planned" for answer in said.values())
        errors = np.maximum(errors, error)
        solved, planned, least = solved + met, planned + lines, min(least, value)
        refusals += [f"{arm.name} {k}: {v}" for k, v in said.items() if v != "planned"]
        print(
            f"{arm.name:28} FK {error[0]:.1e} m {error[1]:.1e} rad  IK {met}/{options.poses}  "
            f"home {value:.3f}  lines {lines}/4",
            flush=True,
        )
    print(
        f"{len(arms)} robots: FK at most {errors[0]:.1e} m and {errors[1]:.1e} rad; IK {solved} of "
        f"{options.poses * len(arms)}; smallest singular value at home at least {least:.3f}; lines "
        f"{planned} of {4 * len(arms)}; {time.perf_counter() - begun:.0f} s"
    )
    print(*refusals, sep="\n")


if __name__ == "__main__":
    main()
