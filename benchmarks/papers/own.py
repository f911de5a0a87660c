"""The two rows that no paper has: the project's own planner, and the true optimum."""

from __future__ import annotations

import time
from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from benchmarks.papers.case import Case
from benchmarks.papers.closed_forms import closed_form
from benchmarks.papers.series import OPTIMUM, PLANNER, Series, context_of
from ikplan.documents.poses import Tolerance
from ikplan.documents.requests.ik_options import IkOptions
from ikplan.ik.objective import evaluate
from ikplan.ik.solve import NoSolution, PoseSolver
from ikplan.kinematics.target import Target, pose_target
from ikplan.planning import TimeBudget, WaypointProblem, select_configurations
from ikplan.planning.ladder.ik_candidates import sample_ik_solutions
from ikplan.planning.ladder.ladder_graph import diverse_shortest_paths
from ikplan.planning.ladder.motion_cost import plain_cost
from ikplan.planning.ladder.path_shortening import shorten_sequence
from ikplan.planning.waypoints.stack import stack_targets

__all__ = ["OWN", "Found"]

Array = NDArray[np.float64]
Found = tuple[Array, float, tuple[float, ...]]
"""A configuration, its objective value, and evaluations, iterations, seconds, CPU seconds."""

RESTARTS = 12
"""Independent searches for the least motion, each over another set of candidates."""


def _target(case: Case, k: int) -> Target:
    if not case.oriented:
        return pose_target(case.p[k])
    R = case.R[k]
    if np.abs(R @ R.T - np.eye(3)).max() > 1e-6:
        # [L] Eq. 47 as printed: the rotation nearest to it.
        U, _, Vt = np.linalg.svd(R)
        R = U @ np.diag([1.0, 1.0, np.linalg.det(U @ Vt)]) @ Vt
    return pose_target(case.p[k], R)


def _value(case: Case, k: int, q: Array, q_s: Array) -> float:
    x = np.ascontiguousarray(q[: case.width])
    return float(evaluate(case.objective(k, q_s), x))


def _seed(case: Case, series: Series, run: int, seed: int) -> int:
    name, run, _ = context_of(case.name, series, run, 0)
    return (name + 7919 * run + 104729 * seed) % 2**31


def _found(case: Case, q: list[Array], spent: tuple[float, ...]) -> list[Found]:
    share = tuple(v / len(q) for v in spent)
    before = [case.q_start, *q[:-1]]
    return [(q[k], _value(case, k, q[k], before[k]), share) for k in range(len(q))]


def _plan(
    case: Case, series: Series, run: int, count: int | None = None, seed: int = 0
) -> list[Found]:
    """Plan with IK-BA seeds and refinement: the whole path, or target by target."""
    # At least one that can be reached, where there is any.
    n = case.count if count is None else max(count, int(np.argmax(case.reachable)) + 1)
    solver = PoseSolver(
        case.arm,
        seed=_seed(case, series, run, seed),
        tolerance_position=1e-9,
        tolerance_orientation=1e-9,
    )
    targets = [_target(case, k) for k in range(n)]
    wall, cpu = time.perf_counter(), time.thread_time()
    mode = series.params["elongation"]
    if mode == "independent":
        return [_nearest(case, solver, k, case.start(k)) for k in range(n)]
    if mode == "tracking":
        found: list[Found] = []
        for k in range(n):
            found.append(_nearest(case, solver, k, found[-1][0] if found else case.q_start))
        return found
    inside = np.flatnonzero(case.reachable[:n])
    problem = WaypointProblem(
        case.robot,
        solver,
        [targets[k] for k in inside],
        case.q_start,
        False,
        Tolerance(),
        TimeBudget(float("inf")),
    )
    chosen = select_configurations(problem, IkOptions(elongation=mode))
    spent = (problem.clock.evaluations, 0.0, time.perf_counter() - wall, time.thread_time() - cpu)
    q_of = dict(zip(inside.tolist(), chosen, strict=True))
    q, q_before = [], case.q_start
    for k in range(n):
        # Out of reach: the closest configuration.
        q_before = _finished(case, q_of[k]) if k in q_of else _nearest(case, solver, k, q_before)[0]
        q.append(q_before)
    return _found(case, q, spent)


def _nearest(case: Case, solver: PoseSolver, k: int, q_s: Array) -> Found:
    """Solve one target, near to ``q_s``; out of reach: the closest configuration found."""
    wall, cpu = time.perf_counter(), time.thread_time()
    try:
        solved = solver.solve(_target(case, k), np.clip(q_s, case.arm.lower, case.arm.upper))
        q, evaluations = solved.q[0], solved.evaluations
    except NoSolution as verdict:
        q, evaluations = np.array(verdict.closest.q), verdict.evaluations
    spent = (float(evaluations), 0.0, time.perf_counter() - wall, time.thread_time() - cpu)
    q = _finished(case, q)
    return q, _value(case, k, q, q_s), spent


def _finished(case: Case, q: Array) -> Array:
    return q if case.finish is None else case.finish(q[: case.width])


def _optimum(
    case: Case, _series: Series, _run: int, count: int | None = None, seed: int = 0
) -> list[Found]:
    """The closed form where there is one, else the least motion found by many restarts."""
    del seed  # the same candidates for every seed: it is what others are held to
    n = case.count if count is None else count
    wall, cpu = time.perf_counter(), time.thread_time()
    exact = closed_form(case.robot.name)
    if exact is not None:
        found: list[Found] = []
        q_s = case.q_start
        for k in range(n):
            solutions = [q for q in exact(case.R[k], case.p[k]) if _inside(case, q)]
            if solutions:
                q_s = min(solutions, key=lambda q: float(np.linalg.norm(q - q_s)))
            found.append((q_s, _value(case, k, q_s, q_s), (0.0, 0.0, 0.0, 0.0)))
        return found
    best, evaluations = least_motion(case, n, 1 if count else RESTARTS)
    spent = (evaluations, 0.0, time.perf_counter() - wall, time.thread_time() - cpu)
    return _found(case, list(best[0]), spent)


def _inside(case: Case, q: Array) -> bool:
    return bool(((q >= case.arm.lower - 1e-9) & (q <= case.arm.upper + 1e-9)).all())


def least_motion(case: Case, n: int, restarts: int) -> tuple[list[Array], int]:
    """Search for the configurations that meet the targets with the least joint motion.

    Each restart draws another, large set of candidates, takes the paths through them that really
    differ, and polishes each.

    Args:
        case: The case.
        n: Number of targets, from the first.
        restarts: Number of restarts.

    Returns:
        The best path of each restart, shortest first, each of shape (n, dof), and evaluations.
    """
    targets = stack_targets([_target(case, k) for k in range(n)])
    lower, upper = case.arm.search_bounds(case.q_start)
    paths: list[tuple[float, Array]] = []
    evaluations = 0
    no_seeds = np.empty((n, 0, case.arm.dof))
    for restart in range(restarts):
        shift = (0.5 + 0.618034 * restart) % 1.0
        q_start = np.array(case.q_start)
        candidates = sample_ik_solutions(
            case.arm.chain, targets, no_seeds, q_start, lower, upper, 250, 600, 60, shift, 1e-9
        )
        evaluations += int(candidates.evaluations[0])
        polished = []
        for q in diverse_shortest_paths(
            case.arm.chain,
            candidates,
            q_start,
            False,
            lower,
            upper,
            plain_cost(case.arm.dof),
            24,
            0.6,
            0.1,
        ):
            length, spent = shorten_sequence(
                case.arm.chain,
                targets,
                q,
                q_start,
                False,
                lower,
                upper,
                plain_cost(case.arm.dof),
                200,
                1e-7,
            )
            evaluations += spent
            polished.append((float(length), q))
        paths.append(min(polished, key=lambda item: item[0]))
    paths.sort(key=lambda item: item[0])
    return [q for _, q in paths], evaluations


OWN: dict[str, Callable[..., list[Found]]] = {PLANNER: _plan, OPTIMUM: _optimum}
