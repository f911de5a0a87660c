"""Torque limits, tool limits and steady tool speeds, judged by Pinocchio on the samples."""

from __future__ import annotations

import statistics
import time

import numpy as np
import pinocchio as pin
from numpy.typing import NDArray

import ikplan
from ikplan.robots import Robot

__all__ = ["steady_study", "tool_study", "torque_study"]

Array = NDArray[np.float64]

_TORQUE_ROBOTS = ("panda", "ur5")
_TOOL_ROBOTS = ("iiwa14", "panda", "ur5", "kinova_j2s6s200", "dobot_magician", "tiago")


def _walk(robot: Robot, seed: int) -> Array:
    """Waypoints about the robot's home, shape (n, dof)."""
    rng = np.random.default_rng([3, seed])
    n = int(rng.integers(3, 12))
    q = robot.home + np.cumsum(rng.normal(0.0, 0.15, (n, robot.dof)), axis=0)
    return np.array([robot.clip(row) for row in q])


def _twists(robot: Robot, q: Array, dq: Array) -> tuple[Array, Array]:
    """Linear and angular speeds of the tool, shape (m,) each."""
    twists = np.array([robot.jacobian(a) @ b for a, b in zip(q, dq, strict=True)])
    return np.linalg.norm(twists[:, :3], axis=1), np.linalg.norm(twists[:, 3:], axis=1)


def torque_study(count: int) -> None:
    """Print the greatest torque over its limit, by pinocchio.rnea on 1 kHz samples."""
    for name in _TORQUE_ROBOTS:
        robot = ikplan.load_robot(name)
        data = robot.model.createData()
        worst, prices, binds = 0.0, [], 0
        for seed in range(count):
            q = _walk(robot, seed)
            free = ikplan.time_path(robot, q)
            motions = list(zip(free.q, free.dq, free.ddq, strict=True))
            most = np.abs([pin.rnea(robot.model, data, *m) for m in motions]).max(axis=0)
            gravity = [pin.computeGeneralizedGravity(robot.model, data, m[0]) for m in motions]
            still = np.abs(gravity).max(axis=0)
            limit = still + 0.5 * np.maximum(most - still, 0.5)
            kept = ikplan.time_path(robot, q, rate_hz=1000.0, limits={"torque": limit})
            motions = list(zip(kept.q, kept.dq, kept.ddq, strict=True))
            tau = np.abs([pin.rnea(robot.model, data, *m) for m in motions])
            worst = max(worst, float((tau / np.minimum(limit, robot.effort_limit)).max()))
            prices.append(kept.duration / free.duration - 1.0)
            reasons = kept.timing.binding if kept.timing else []
            binds += any(reason.limit == "torque" for reason in reasons)
        print(
            f"  {name:16s} {count} paths: greatest torque {worst:.6f} x limit; a torque binds in "
            f"{binds}; longer by {100 * statistics.median(prices):.1f} % (median)"
        )


def tool_study(count: int) -> None:
    """Print the greatest tool speed over its limit on 1 kHz samples, and the seconds it took."""
    speed, turn = 0.1, 0.5
    limits = {
        "tool_speed": {"linear": speed, "angular": turn},
        "tool_acceleration": {"linear": 0.5, "angular": 3.0},
    }
    for name in _TOOL_ROBOTS:
        robot = ikplan.load_robot(name).with_tool([0.0, 0.05, 0.15])
        worst, rates, seconds = 0.0, 0.0, []
        ikplan.time_path(robot, _walk(robot, 0), limits=limits)
        for seed in range(count):
            start = time.process_time()
            plan = ikplan.time_path(robot, _walk(robot, seed), rate_hz=1000.0, limits=limits)
            seconds.append(time.process_time() - start)
            linear, angular = _twists(robot, plan.q, plan.dq)
            worst = max(worst, float(np.maximum(linear / speed, angular / turn).max()))
            rates = max(rates, plan.certificate.tool_acceleration_ratio or 0.0)
        print(
            f"  {name:16s} {count} paths: greatest speed {worst:.7f} x limit, acceleration "
            f"{rates:.6f} x limit; processor seconds a path {statistics.median(seconds):.3f} "
            f"(median) {max(seconds):.3f} (worst)"
        )


def steady_study() -> None:
    """Print how far the tool's speed is from its limit along straight lines, at 1 kHz."""
    limit = 0.1
    for name, way in (("panda", [-0.1, 0.3, -0.1]), ("ur5", [0.0, 0.2, -0.15])):
        robot = ikplan.load_robot(name)
        pose = pin.SE3ToXYZQUAT(robot.fk(robot.home))
        end = {"position": (pose[:3] + way).tolist(), "quaternion_xyzw": pose[3:].tolist()}
        plan = ikplan.plan(
            {
                "robot": name,
                "path": {"waypoints": [end], "interpolation": "line"},
                "limits": {"tool_speed": limit},
                "sampling": {"rate_hz": 1000.0},
            }
        )
        linear, _ = _twists(robot, plan.q, plan.dq)
        middle = (plan.time > 0.1 * plan.duration) & (plan.time < 0.9 * plan.duration)
        print(
            f"  {name:16s} {plan.duration:.3f} s: in the middle 80 % at most "
            f"{limit - linear[middle].min():.1e} m/s below the limit; at most "
            f"{linear.max() - limit:.1e} m/s above it anywhere"
        )
