"""Single poses: the solver of a request, and a solution free of contact where a scene is given."""

from __future__ import annotations

import functools
from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
import pinocchio as pin
from numpy.typing import ArrayLike

from ikplan.arrays import Array
from ikplan.documents import parse
from ikplan.documents.pose_results import IkSolution
from ikplan.documents.poses import Posture, Tolerance
from ikplan.documents.requests.ik import IkRequest
from ikplan.documents.requests.ik_options import IkOptions
from ikplan.documents.scene import Scene, ToolFrame
from ikplan.errors import InvalidRequest
from ikplan.ik.arguments import check_objective, check_start, target_of
from ikplan.ik.solve import QUICK, PoseSolver, pose_distance, solve_pose
from ikplan.kinematics.arm import arm_of
from ikplan.path.rotation.so3 import rotation_of
from ikplan.pipeline.collisions import keep_clear, requested_model, with_meshes
from ikplan.pipeline.helpers import helped_by
from ikplan.pipeline.request_budget import RequestBudget
from ikplan.pipeline.resolve import resolve_robot
from ikplan.robots import Robot
from ikplan.scene.body import CollisionModel
from ikplan.scene.resolve import resolve_scene
from ikplan.time_budget import Progress, TimeBudget

if TYPE_CHECKING:
    from ikplan.planning.waypoints.waypoint_problem import WaypointProblem

__all__ = ["free_pose", "pose_solver", "solve_ik", "solve_ik_request"]

_LONG_S = 3600.0
"""Budget of a pose without a request [s]."""


def pose_solver(
    robot: Robot,
    ik: IkOptions,
    tolerance_position: float,
    tolerance_orientation: float,
    *,
    verdict: bool = True,
) -> PoseSolver:
    """Return the solver that a request asks for.

    Args:
        robot: The robot, with its tool.
        ik: How solutions are looked for.
        tolerance_position: Position error that counts as solved [m].
        tolerance_orientation: Orientation error that counts as solved [rad].
        verdict: Whether a pose without a solution is explained.

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
        verdict=verdict,
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
    solver = pose_solver(
        robot, request.ik, tolerance.position, tolerance.orientation, verdict=request.verdict
    )
    model = requested_model(robot, request.scene, request.fixed_joints, request.tool, always=False)
    if request.ik.posture is not None:
        return _preferred(
            robot,
            solver,
            pose,
            request.start,
            model,
            clock,
            request.ik.posture,
            request.ik.objective,
        )
    return free_pose(robot, solver, pose, request.start, model, clock, request.ik.objective)


def solve_ik(
    robot: Robot,
    pose: Any,
    *,
    start: ArrayLike | None = None,
    method: str = "ik-ba",
    seed: int = 0,
    population: int | str | None = None,
    iterations: int | str | None = None,
    params: Mapping[str, Any] | None = None,
    refine: bool = True,
    tolerance_position: float = 1e-6,
    tolerance_orientation: float = 1e-6,
    scene: Mapping[str, Any] | Scene | None = None,
    objective: str = "motion",
    posture: Mapping[str, Any] | Posture | None = None,
) -> IkSolution:
    """Find joint values that bring the tool to a pose, near to a start configuration.

    Args:
        robot: The robot.
        pose: The tool in the base: a ``pinocchio.SE3``, a homogeneous matrix of shape (4, 4), x y z
            qx qy qz qw of shape (7,), a pair of a position and a rotation (quaternion xyzw, matrix
            or SciPy ``Rotation``); or a position alone, shape (3,) [m].
        start: Configuration to stay near to, shape (dof,) [rad or m]; None: the robot's home.
        method: Name of a solver, see :func:`ikplan.ik.registry.solvers`.
        seed: Seed of the random numbers.
        population: N; None: the planner's own; "paper": the paper's.
        iterations: T; None: the planner's own; "paper": the paper's.
        params: Parameters of the method, by name.
        refine: Polish the seed; False returns what the method itself found, however far off.
        tolerance_position: Distance that counts as solved [m].
        tolerance_orientation: Angle that counts as solved [rad].
        scene: What must not be touched, as in a request; mesh files are read relative to the
            working folder. ``{}``: the arm itself only. None: nothing is checked.
        objective: What is least: "motion", the distance from the start; "clearance", how crowded
            the configuration is by what ``scene`` names, see docs/solvers.md.
        posture: Which solutions are preferred, as ``ik.posture`` of a request: near a
            configuration, within soft limits, with weights of the joints. None: the nearest.

    Returns:
        The nearest solution found, or the one that the posture prefers; with a scene, of those
        that are free of contact, or the least crowded.

    Raises:
        InvalidRequest: An argument is wrong, or there is nothing to keep clear of.
        Unreachable: No solution within tolerance; carries the best one and the reason.
        InCollision: Every solution found is in contact; for which pairs of bodies.
    """
    solver: PoseSolver
    plain = not params and population is iterations is None and type(seed) is int
    if plain and method in QUICK:
        solver = _quick_solver(
            robot, method, seed, refine, tolerance_position, tolerance_orientation
        )
    else:
        solver = PoseSolver(
            arm_of(robot),
            method,
            seed,
            population,
            iterations,
            params or {},
            refine,
            tolerance_position,
            tolerance_orientation,
        )
    check_objective(objective)
    if scene is None and objective == "motion" and posture is None:
        return solve_pose(robot, solver, pose, start)
    model = None
    if scene is not None:
        resolved = resolve_scene(parse(Scene, scene), Path.cwd())
        model = requested_model(robot, resolved, {}, ToolFrame(), always=False)
    if posture is not None:
        if not refine:
            raise InvalidRequest(
                "ik.posture chooses among refined solutions; refine is false",
                field="ik.refine",
                allowed=[True],
            )
        clock, wanted = TimeBudget(_LONG_S), parse(Posture, posture)
        return _preferred(robot, solver, pose, start, model, clock, wanted, objective)
    return free_pose(robot, solver, pose, start, model, TimeBudget(_LONG_S), objective)


def _preferred(
    robot: Robot,
    solver: PoseSolver,
    pose: Any,
    start: ArrayLike | None,
    model: CollisionModel | None,
    clock: TimeBudget,
    posture: Posture,
    objective: str,
) -> IkSolution:
    """The solution that a posture prefers, free of contact where there are bodies."""
    from ikplan.collision.checker import CollisionChecker
    from ikplan.planning.preferred_pose import preferred_pose

    clearest = objective == "clearance"

    def contact_of(within: Robot, solver: PoseSolver) -> CollisionChecker | None:
        if clearest:
            return keep_clear(within, solver, model)
        return None if model is None or len(model.pairs) == 0 else CollisionChecker(robot, model)

    return preferred_pose(robot, solver, pose, start, clock, posture, contact_of, clearest=clearest)


@functools.lru_cache(maxsize=64)
def _quick_solver(
    robot: Robot,
    method: str,
    seed: int,
    refine: bool,
    tolerance_position: float,
    tolerance_orientation: float,
) -> PoseSolver:
    """Return a solver that keeps nothing of the poses that it solves."""
    return PoseSolver(
        arm_of(robot),
        method,
        seed,
        refined=refine,
        tolerance_position=tolerance_position,
        tolerance_orientation=tolerance_orientation,
    )


def free_pose(
    robot: Robot,
    solver: PoseSolver,
    pose: Any,
    start: ArrayLike | None,
    model: CollisionModel | None,
    clock: TimeBudget,
    objective: str = "motion",
) -> IkSolution:
    """Return the solution nearest to the start, of those free of contact; or the least crowded.

    Args:
        robot: The robot, with its tool.
        solver: The solver.
        pose: As for :func:`solve_ik`, or the target.
        start: As there.
        model: Bodies that must not touch; None: nothing is checked.
        clock: The time budget.
        objective: As for :func:`solve_ik`.

    Raises:
        InvalidRequest: The objective is clearance, and there is nothing to keep clear of.
        Unreachable: No solution within tolerance.
        InCollision: Every solution found is in contact.
        BudgetExceeded: The budget ran out.
    """
    contact = keep_clear(robot, solver, model) if objective == "clearance" else None
    with clock.stage("ik"), clock.cutting(solver.cut, solver.search_evaluations):
        solution = solve_pose(robot, solver, pose, start)
        if model is None or len(model.pairs) == 0:
            return solution
        from ikplan.collision.checker import CollisionChecker
        from ikplan.planning.waypoints.clear_solutions import clearest_solution
        from ikplan.planning.waypoints.free_solutions import free_solutions
        from ikplan.planning.waypoints.waypoint_problem import WaypointProblem

        clearest = contact is not None and solver.refined
        contact = contact or CollisionChecker(robot, model)
        if not clearest and contact.free(solution.q[None])[0]:
            return solution
        q_start = check_start(robot, robot.home if start is None else start)
        tolerance = Tolerance.model_construct(
            position=solver.tolerance_position, orientation=solver.tolerance_orientation
        )
        problem = WaypointProblem(
            robot, solver, [target_of(pose)], q_start, False, tolerance, clock, contact=contact
        )
        if not clearest:
            return _solution(problem, free_solutions(problem, 0, q_start)[0])
        clock.count(solution.evaluations)
        return _solution(problem, clearest_solution(problem, 0, q_start, solution.q))


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
