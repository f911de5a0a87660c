"""What the parts of the benchmark share: requests, routes and times."""

from __future__ import annotations

import statistics
import time
from collections.abc import Callable
from typing import Any

import numpy as np
import pinocchio as pin
from numpy.typing import NDArray

from ikplan.documents import parse
from ikplan.documents.plan_request import PlanRequest
from ikplan.ik.solve import PoseSolver
from ikplan.kinematics.arm import arm_of
from ikplan.limits import JointLimits
from ikplan.planning import JointPathProblem, JointRoute, TimeBudget, plan_joint_path
from ikplan.robots import Robot

__all__ = ["laid", "median_seconds", "pose_document", "route_problem"]

Array = NDArray[np.float64]


def pose_document(R: Array, p: Array) -> dict[str, Any]:
    """Return a waypoint with rotation R, shape (3, 3), and position p, shape (3,) [m]."""
    quaternion = pin.Quaternion(R).coeffs()
    return {"position": p.tolist(), "quaternion_xyzw": quaternion.tolist()}


def route_problem(request: dict[str, Any], robot: Robot) -> JointPathProblem:
    """Return what the planner is asked by a request without a tool."""
    asked = parse(PlanRequest, request)
    ik = asked.ik
    solver = PoseSolver(
        arm_of(robot),
        ik.method,
        ik.seed,
        ik.population,
        ik.iterations,
        ik.params,
        ik.refine,
        tolerance_position=1e-9,
        tolerance_orientation=1e-9,
    )
    free = asked.start == "free"
    q_start = np.array(robot.home if free or asked.start is None else asked.start, dtype=float)
    return JointPathProblem(
        robot,
        solver,
        asked.path,
        ik,
        q_start,
        free,
        JointLimits.from_robot(robot),
        TimeBudget(asked.budget_s),
    )


def laid(request: dict[str, Any], robot: Robot) -> JointRoute:
    """Return the route of a request: what is planned before it is timed."""
    return plan_joint_path(route_problem(request, robot))


def median_seconds(call: Callable[[], object], repeats: int) -> float:
    """Return the median time of a call in processor time: other work does not count [s]."""
    call()
    times = []
    for _ in range(repeats):
        begin = time.thread_time()
        call()
        times.append(time.thread_time() - begin)
    return statistics.median(times)
