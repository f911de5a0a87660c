"""Many poses of one robot."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from ikplan.arrays import Array, Flags
from ikplan.documents import MAX_NUMBER, parse
from ikplan.documents.pose_results import IkBatchSolution, RefusedPose
from ikplan.documents.requests.ik_options import IkOptions
from ikplan.documents.scene import Scene, ToolFrame
from ikplan.errors import InCollision, InvalidRequest, Unreachable
from ikplan.ik.arguments import check_start
from ikplan.ik.poses.arrays import PoseArrays, pose_arrays
from ikplan.ik.poses.batch import beyond_shoulder, solve_batch, thread_count
from ikplan.ik.solve import BARE_RESTARTS, PoseSolver
from ikplan.pipeline.collisions import keep_clear, requested_model
from ikplan.pipeline.poses import free_pose, pose_solver
from ikplan.robots import Robot
from ikplan.robots.reach import reach as reach_of
from ikplan.scene.body import CollisionModel
from ikplan.scene.resolve import resolve_scene
from ikplan.time_budget import TimeBudget

__all__ = ["BatchOptions", "FoundPoses", "find_solutions", "solve_ik_batch", "solve_poses"]

_LONG_S = 1e6
"""Budget of a call from Python [s]."""


class BatchOptions(NamedTuple):
    """How poses are solved.

    Attributes:
        ik: The solver and its parameters.
        tolerance_position: Distance that counts as solved [m].
        tolerance_orientation: Angle that counts as solved [rad].
        verdict: Whether poses without a solution are explained.
        threads: Largest number of threads.
    """

    ik: IkOptions
    tolerance_position: float = 1e-6
    tolerance_orientation: float = 1e-6
    verdict: bool = True
    threads: int = 1


def solve_ik_batch(
    robot: Robot,
    poses: Any,
    *,
    start: ArrayLike | None = None,
    method: str = "lm",
    seed: int = 0,
    population: int | str | None = None,
    iterations: int | str | None = None,
    params: Mapping[str, Any] | None = None,
    verdict: bool = True,
    tolerance_position: float = 1e-6,
    tolerance_orientation: float = 1e-6,
    scene: Mapping[str, Any] | Scene | None = None,
    threads: int | None = None,
    objective: str = "motion",
) -> IkBatchSolution:
    """Find joint values for many poses, each as :func:`ikplan.solve_ik` does alone.

    No pose has an influence on another: the answer to one is the same in any batch, on any number
    of threads.

    Args:
        robot: The robot.
        poses: Poses of the tool in the base: a list of ``pinocchio.SE3``, homogeneous matrices of
            shape (n, 4, 4), rows of position and unit quaternion (xyzw) of shape (n, 7), or
            positions of shape (n, 3) [m].
        start: Configuration to stay near to, shape (dof,), or one for each pose, shape (n, dof)
            [rad or m]; None: the robot's home.
        method: Name of a solver; ``"lm"`` is solved in one call of a kernel.
        seed: Seed of the random numbers.
        population: N; None: the planner's own; "paper": the paper's.
        iterations: T; None: the planner's own; "paper": the paper's.
        params: Parameters of the method, by name.
        verdict: Explain poses without a solution, which takes 20 ms each, and may find one after
            all; False: a bare no, after 200 restarts unless ``params`` says how many.
        tolerance_position: Distance that counts as solved [m].
        tolerance_orientation: Angle that counts as solved [rad].
        scene: What must not be touched, as in a request; mesh files are read relative to the
            working folder. ``{}``: the arm itself only. None: nothing is checked.
        threads: Largest number of threads; None: one a processor (``NUMBA_NUM_THREADS``).
        objective: As for :func:`ikplan.solve_ik`.

    Returns:
        ``.q``, ``.solved``, ``.position_error``, ``.orientation_error``, and why poses were
        refused.

    Raises:
        InvalidRequest: An argument is wrong; the error of a pose or a start names its index.
    """
    ik = parse(
        IkOptions,
        {
            "method": method,
            "seed": seed,
            "population": population,
            "iterations": iterations,
            "params": dict(params or {}),
            "objective": objective,
        },
    )
    model = None
    if scene is not None:
        resolved = resolve_scene(parse(Scene, scene), Path.cwd())
        model = requested_model(robot, resolved, {}, ToolFrame(), always=False)
    options = BatchOptions(
        ik,
        tolerance_position,
        tolerance_orientation,
        verdict,
        thread_count() if threads is None else threads,
    )
    return solve_poses(robot, pose_arrays(poses), start, model, options, TimeBudget(_LONG_S))


class FoundPoses(NamedTuple):
    """What was found for many poses.

    Attributes:
        q: Solutions, or the best configurations found, shape (n, dof) [rad or m].
        solved: Which have a solution, shape (n,).
        errors: Distance [m], rotation angle [rad] and evaluations of each, shape (n, 3).
        refused: Why poses have no solution; empty without verdicts.
    """

    q: Array
    solved: Flags
    errors: Array
    refused: list[RefusedPose]


def solve_poses(
    robot: Robot,
    poses: PoseArrays,
    start: ArrayLike | None,
    model: CollisionModel | None,
    options: BatchOptions,
    clock: TimeBudget,
) -> IkBatchSolution:
    """Find joint values for many poses, see :func:`solve_ik_batch`.

    Args:
        robot: The robot, with its tool.
        poses: The poses.
        start: As there.
        model: Bodies that must not touch; None: nothing is checked.
        options: How poses are solved.
        clock: The time budget.

    Raises:
        InvalidRequest: A start or an option is wrong.
        BudgetExceeded: The budget ran out.
    """
    found = find_solutions(robot, poses, start, model, options, clock)
    return IkBatchSolution.model_construct(
        q=found.q,
        solved=found.solved,
        position_error=found.errors[:, 0],
        orientation_error=found.errors[:, 1] if poses.oriented else None,
        evaluations=int(found.errors[:, 2].sum()),
        refused=found.refused,
    )


def find_solutions(
    robot: Robot,
    poses: PoseArrays,
    start: ArrayLike | None,
    model: CollisionModel | None,
    options: BatchOptions,
    clock: TimeBudget,
) -> FoundPoses:
    """Find joint values for many poses; arguments and errors as for :func:`solve_poses`."""
    q_start = _starts(robot, start, len(poses.p))
    solver = pose_solver(
        robot, options.ik, options.tolerance_position, options.tolerance_orientation
    )
    clear = options.ik.objective == "clearance"
    if clear:
        keep_clear(robot, solver, model)  # refused as a whole where there is nothing to do so
    with clock.stage("ik"):
        if options.ik.method == "lm":
            q, errors = _by_kernel(reach_of(robot), solver, poses, q_start, options, clock)
        else:
            q = np.repeat(q_start, len(poses.p) // len(q_start), axis=0)
            errors = np.full((len(poses.p), 3), np.inf)
        solved: Flags = (errors[:, 0] <= options.tolerance_position) & (
            errors[:, 1] <= options.tolerance_orientation
        )
        again = ~solved
        if options.ik.method == "lm" and not options.verdict:
            again[:] = False
        again |= solved if clear else _touching(robot, model, q, solved)
        refused = []
        for k in np.flatnonzero(again):
            clock.check()
            reason = _alone(robot, poses, int(k), q_start, model, options, clock, q, errors)
            solved[k] = not reason
            if reason and options.verdict:
                refused.append(RefusedPose.model_construct(pose=int(k), reason=reason))
    return FoundPoses(q, solved, errors, refused)


def _starts(robot: Robot, start: ArrayLike | None, count: int) -> Array:
    """Starts of shape (1, dof) or (n, dof).

    Raises:
        InvalidRequest: Wrong shape, not finite, or outside the position limits.
    """
    if start is None:
        return np.array(robot.home, dtype=np.float64)[None]
    values = np.asarray(start, dtype=object if isinstance(start, list) else None)
    if values.ndim < 2:
        return check_start(robot, start)[None]
    try:
        rows = np.array(start, dtype=np.float64)
    except (TypeError, ValueError) as error:
        raise _wrong_starts(robot, count) from error
    if rows.shape != (count, robot.dof):
        raise _wrong_starts(robot, count)
    lower = np.maximum(robot.lower, -MAX_NUMBER)
    upper = np.minimum(robot.upper, MAX_NUMBER)
    with np.errstate(invalid="ignore"):
        wrong = ~((rows >= lower - 1e-9) & (rows <= upper + 1e-9)).all(axis=1)
    if wrong.any():
        k = int(np.argmax(wrong))
        check_start(robot, rows[k], f"start[{k}]")
    return np.clip(rows, lower, upper)


def _wrong_starts(robot: Robot, count: int) -> InvalidRequest:
    allowed = f"{robot.dof} numbers, or {count} rows of them"
    return InvalidRequest(f"start: must be {allowed}", field="start", allowed=allowed)


def _by_kernel(
    reach: float,
    solver: PoseSolver,
    poses: PoseArrays,
    q_start: Array,
    options: BatchOptions,
    clock: TimeBudget,
) -> tuple[Array, Array]:
    """Solutions of the method lm, and their errors; those beyond reach are tried once."""
    arm, given = solver.arm, options.ik
    restarts = int(given.params.get("restarts", BARE_RESTARTS))
    iterations = given.iterations if isinstance(given.iterations, int) else 40
    tolerances = options.tolerance_position, options.tolerance_orientation
    beyond = beyond_shoulder(arm, poses, *tolerances)
    beyond |= np.linalg.norm(poses.p, axis=1) > reach + options.tolerance_position + 1e-9
    q, errors = np.empty((len(poses.p), arm.dof)), np.empty((len(poses.p), 3))
    done = 0

    def check(count: int, processor_s: float) -> None:
        nonlocal done
        done += count
        clock.spend(processor_s)
        clock.check()

    for rows, tries in ((~beyond, restarts), (beyond, 0)):
        if not rows.any():
            continue
        whole = rows.all()
        part = PoseArrays(
            poses.R if whole or not poses.oriented else poses.R[rows],
            poses.p if whole else poses.p[rows],
            poses.oriented,
        )
        starts = q_start if whole or len(q_start) == 1 else q_start[rows]
        found = solve_batch(
            arm,
            part,
            starts,
            *tolerances,
            tries,
            iterations,
            given.seed,
            threads=options.threads,
            check=check,
        )
        if whole:
            return found
        q[rows], errors[rows] = found
    return q, errors


def _touching(robot: Robot, model: CollisionModel | None, q: Array, solved: Flags) -> Flags:
    """Which solutions are in contact, shape (n,)."""
    touching = np.zeros(len(q), dtype=np.bool_)
    if model is not None and len(model.pairs) and solved.any():
        from ikplan.collision.checker import CollisionChecker

        touching[solved] = ~CollisionChecker(robot, model).free(q[solved])
    return touching


def _alone(
    robot: Robot,
    poses: PoseArrays,
    k: int,
    q_start: Array,
    model: CollisionModel | None,
    options: BatchOptions,
    clock: TimeBudget,
    q: Array,
    errors: Array,
) -> str:
    """Solve pose k as solve_ik does, into ``q`` and ``errors``; why it has no solution, or ""."""
    solver = pose_solver(
        robot,
        options.ik,
        options.tolerance_position,
        options.tolerance_orientation,
        verdict=options.verdict,
    )
    start = q_start[k if len(q_start) > 1 else 0]
    try:
        solution = free_pose(
            robot, solver, poses.target(k), start, model, clock, options.ik.objective
        )
    except Unreachable as error:
        q[k] = error.q
        errors[k] = error.position_error, error.orientation_error or 0.0, 0.0
        return error.reason
    except InCollision as error:
        if not np.isfinite(errors[k, 0]):  # no solution of a kernel stands there
            q[k], T = error.q, robot.fk(error.q)
            errors[k] = (*poses.missed(k, T.rotation, T.translation), 0.0)
        return error.detail
    q[k] = solution.q
    errors[k] = (
        solution.position_error,
        solution.orientation_error or 0.0,
        solution.evaluations,
    )
    return ""
