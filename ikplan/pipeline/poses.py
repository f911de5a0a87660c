"""Single poses: the solver of a request, and a solution free of contact where a scene is given."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import numpy as np
import pinocchio as pin

from ikplan.arrays import Array
from ikplan.documents import parse
from ikplan.documents.plan_request import IkOptions, IkRequest
from ikplan.documents.pose_results import IkSolution
from ikplan.ik.arguments import check_start, target_of
from ikplan.ik.solve import PoseSolver, pose_distance, solve_pose
from ikplan.kinematics.arm import arm_of
from ikplan.path.rotation.so3 import rotation_of
from ikplan.pipeline.collisions import requested_model, with_meshes
from ikplan.pipeline.helpers import helped_by
from ikplan.pipeline.request_budget import RequestBudget
from ikplan.pipeline.resolve import resolve_robot
from ikplan.robots import Robot
from ikplan.time_budget import Progress

if TYPE_CHECKING:
    from ikplan.planning.waypoints.waypoint_problem import WaypointProblem

__all__ = ["pose_solver", "solve_ik_request"]


def pose_solver(
    robot: Robot, ik: IkOptions, tolerance_position: float, tolerance_orientation: float
) -> PoseSolver:
    """Return the solver that a request asks for.

    Args:
        robot: The robot, with its tool.
        ik: How solutions are looked for.
        tolerance_position: Position error that counts as solved [m].
        tolerance_orientation: Orientation error that counts as solved [rad].

    Raises:
        InvalidRequest: No such method, or a parameter that it does not have.
    """
    return PoseSolver(
        arm_of(robot),
        ik.method,
        ik.seed,
        ik.population,
        ik.iterations,
        ik.params,
        ik.refine,
        tolerance_position=tolerance_position,
        tolerance_orientation=tolerance_orientation,
    )


def solve_ik_request(
    request: Mapping[str, Any] | IkRequest,
    *,
    robot: Robot | None = None,
    progress: Progress | None = None,
) -> IkSolution:
    """Solve the single pose of an IK request, see :func:`ikplan.solve_ik`; robot as in plan.

    Raises:
        InvalidRequest: A field of the request is wrong.
        RobotNotFound: No robot of that name.
        Unreachable: No solution within tolerance.
        InCollision: The request has a scene, and every solution found is in contact.
        BudgetExceeded: ``budget_s`` ran out.
    """
    request = with_meshes(parse(IkRequest, request))
    helped_by("ik", request.ik.method)
    clock = RequestBudget(request.budget_s, progress)
    robot = resolve_robot(request, robot)
    pose: Any = np.array(request.position)
    if request.quaternion_xyzw is not None:
        pose = pin.SE3(rotation_of(request.quaternion_xyzw), pose)
    tolerance = request.tolerance
    solver = pose_solver(robot, request.ik, tolerance.position, tolerance.orientation)
    model = requested_model(robot, request.scene, request.fixed_joints, request.tool, always=False)
    with clock.stage("ik"), clock.cutting(solver.cut, solver.search_evaluations):
        solution = solve_pose(robot, solver, pose, request.start)
        if model is None or len(model.pairs) == 0:
            return solution
        from ikplan.collision.checker import CollisionChecker
        from ikplan.planning.waypoints.free_solutions import free_solutions
        from ikplan.planning.waypoints.waypoint_problem import WaypointProblem

        contact = CollisionChecker(robot, model)
        if contact.free(solution.q[None])[0]:
            return solution
        q_start = check_start(robot, robot.home if request.start is None else request.start)
        problem = WaypointProblem(
            robot, solver, [target_of(pose)], q_start, False, tolerance, clock, contact=contact
        )
        return _solution(problem, free_solutions(problem, 0, q_start)[0])


def _solution(problem: WaypointProblem, q: Array) -> IkSolution:
    target = problem.targets[0]
    distance, angle = pose_distance(problem.solver.arm, target, q)
    return IkSolution.model_construct(
        q=q,
        position_error=distance,
        orientation_error=angle if target.oriented else None,
        elongation=float(np.linalg.norm(q - problem.q_start)),
        evaluations=problem.clock.evaluations,
    )
