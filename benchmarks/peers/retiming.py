"""Waypoints of seven joints, timed under velocity and acceleration limits."""

from __future__ import annotations

import functools
from typing import Any

import numpy as np
from scipy.interpolate import CubicSpline

from benchmarks.peers.measure import Contestant, Row, compare, module
from benchmarks.speed.paths import retiming
from ikplan.arrays import Array
from ikplan.joint_path import JointPath
from ikplan.limits import JointLimits
from ikplan.timing import time_joint_path

__all__ = ["run"]


def run(effort: float) -> list[Row]:
    """Time 20, 200 and 2,000 waypoints.

    Args:
        effort: Share of the full number of repeats, in (0, 1].
    """
    rows = []
    for count in (20, 200, 2000):
        q, limits = retiming(count)
        nodes = len(_ikplan(q, limits).s)
        contestants = [_contestant("ikplan", functools.partial(_ikplan, q, limits), "")]
        if module("toppra") is not None:
            call = functools.partial(_toppra, q, limits, nodes)
            contestants.append(
                _contestant("toppra", call, "no limits between nodes; as many nodes as ikplan")
            )
        if module("copp_py") is not None:
            call = functools.partial(_copp, q, limits, nodes)
            contestants.append(
                _contestant(
                    "copp topp2_ra", call, "no limits between nodes; as many nodes as ikplan"
                )
            )
        rows += compare(f"{count} waypoints timed", contestants, max(1, round(5 * effort)))
    return rows


def _contestant(name: str, call: Any, note: str) -> Contestant:
    return Contestant(name, [call] * 3, note)


def _ikplan(q: Array, limits: JointLimits) -> Any:
    return time_joint_path(JointPath.through(q, limits), limits)


def _toppra(q: Array, limits: JointLimits, nodes: int) -> object:
    import toppra
    import toppra.algorithm
    import toppra.constraint

    path = toppra.SplineInterpolator(np.linspace(0.0, 1.0, len(q)), q)
    bounds = [
        toppra.constraint.JointVelocityConstraint(np.column_stack([-v, v]))
        if k == 0
        else toppra.constraint.JointAccelerationConstraint(np.column_stack([-v, v]))
        for k, v in enumerate((limits.velocity, limits.acceleration))
    ]
    grid = np.linspace(0.0, 1.0, nodes)
    solver = toppra.algorithm.TOPPRA(bounds, path, gridpoints=grid)
    found = solver.compute_trajectory()
    assert found is not None
    return found


class _Spline:
    """A natural cubic spline through waypoints, as copp takes a path."""

    def __init__(self, q: Array) -> None:
        self._curve = CubicSpline(np.linspace(0.0, 1.0, len(q)), q, bc_type="natural")
        self.dim = q.shape[1]

    def evaluate_up_to_2nd(self, s: Array) -> tuple[Array, Array, Array]:
        """Return values and two derivatives, each of shape (n, dim)."""
        at = np.asarray(s)
        return self._curve(at), self._curve(at, 1), self._curve(at, 2)


def _copp(q: Array, limits: JointLimits, nodes: int) -> object:
    copp: Any = module("copp_py")
    s = np.linspace(0.0, 1.0, nodes)
    path = copp.Path.from_evaluator_2nd(_Spline(q), 0.0, 1.0)
    robot = copp.Robot(q.shape[1], capacity=nodes)
    robot.append_s(s)
    robot.set_q_from_path_2nd(path, 0, nodes)
    robot.add_velocity_limits(limits.velocity, -limits.velocity, start_idx_s=0, length=nodes)
    robot.add_acceleration_limits(
        limits.acceleration, -limits.acceleration, start_idx_s=0, length=nodes
    )
    ends = {"idx_s_interval": (0, nodes - 1), "a_boundary": (0.0, 0.0)}
    problem = copp.solver.topp2_ra.Problem(robot.constraints, **ends)
    speeds = copp.solver.topp2_ra.solve(problem)
    return copp.interpolation.s_to_t_topp2(s, speeds, 0.0)
