"""One pose: seed by the chosen method, refine, take the solution nearest to the start."""

from __future__ import annotations

import functools
import math
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from types import MappingProxyType
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike
from pinocchio import SE3, Quaternion

from ikplan.arrays import Array, Flags
from ikplan.collision.check import ContactArrays
from ikplan.documents.pose_results import IkSolution
from ikplan.errors import InvalidRequest, Unreachable
from ikplan.ik.arguments import check_options, check_start, check_tolerances, target_of
from ikplan.ik.closed_form import (
    closed_form_solutions,
    has_closed_form,
    solve_closed_form_pose,
)
from ikplan.ik.closest_approach import ClosestApproach, explain_unreachable, within
from ikplan.ik.crowding import surroundings
from ikplan.ik.levenberg_marquardt import target_error
from ikplan.ik.metaheuristic_seeds import Searcher
from ikplan.ik.nearest_solutions import nearest_solutions
from ikplan.ik.poses.kernels import solve_lm_pose
from ikplan.ik.registry import find_solver, replacements, solvers
from ikplan.ik.restarts import solve_lm
from ikplan.ik.solver import Solver
from ikplan.ik.workspace import new_workspace
from ikplan.kinematics.arm import Arm
from ikplan.kinematics.closed_form.branches import MOST_BRANCHES
from ikplan.kinematics.closed_form.form import NO_FORM
from ikplan.kinematics.target import Target
from ikplan.robots.reach import unit_hint, with_hint

if TYPE_CHECKING:
    from ikplan.robots import Robot

__all__ = [
    "BARE_NO",
    "BARE_RESTARTS",
    "QUICK",
    "NoSolution",
    "PoseSolver",
    "Solved",
    "refusal",
    "solve_pose",
    "surest_solver",
    "target_as_data",
]

_RESCUE_RESTARTS = 2000
BARE_RESTARTS = 200
"""Restarts before a target is given up without a verdict: of 100,000 random reachable poses each,
7 of panda, 2 of z1 and none of iiwa14, ur5 and xarm7 are missed."""
QUICK = ("lm", "closed-form")
"""Methods that keep nothing of the poses they solve, and are tried in one call of a kernel."""
BARE_NO = "no solution was found, and no verdict was asked for"
"""The reason of a pose that is given up without a verdict."""
_FEW_RESTARTS = 20
"""Restarts of the first try of a pose: 99.8 % of random reachable ones need no more."""
_SPREAD = 72
"""Evenly spread seeds beside those of the method: what makes the nearest solution the nearest."""
_SLIDES = 8
"""Solutions that are slid along their self-motion."""


class Solved(NamedTuple):
    """Solutions of one target, nearest to the start first.

    Attributes:
        q: Solutions, shape (k, dof), k >= 1 [rad or m].
        position_error: Distance of each from the target, shape (k,) [m].
        orientation_error: Rotation of each from the target, shape (k,) [rad].
        evaluations: Evaluations spent.
    """

    q: Array
    position_error: Array
    orientation_error: Array
    evaluations: int


class NoSolution(Exception):
    """A target without a solution within tolerance; the caller knows which waypoint it is."""

    def __init__(self, closest: ClosestApproach, evaluations: int) -> None:
        super().__init__(closest.reason)
        self.closest = closest
        self.evaluations = evaluations


@functools.lru_cache(maxsize=256)
def _prepared(
    method: str,
    params: tuple[tuple[str, type, Any], ...],
    replaced: int,  # noqa: ARG001 - a name may mean another solver once one was replaced
) -> tuple[Solver, Mapping[str, Any]]:
    """Return a solver and its checked parameters; the types tell 1 from True in the cache."""
    solver = find_solver(method)
    return solver, MappingProxyType(solver.check({name: value for name, _, value in params}))


@dataclass
class PoseSolver:
    """Solves targets of one arm, one after the other, by one method.

    Attributes:
        arm: The arm.
        method: Name of the solver.
        seed: Seed of the random numbers; the same sequence of targets gives the same answers.
        population: N; None for the planner's own, "paper" for the paper's.
        iterations: T; None for the planner's own, "paper" for the paper's.
        params: Parameters of the method.
        refined: Whether seeds are refined.
        tolerance_position: Distance that counts as solved [m].
        tolerance_orientation: Angle that counts as solved [rad].
        verdict: Whether a target without a solution is explained; else it costs little.
        searcher: The metaheuristic, set up for the arm; None for a method without one.
    """

    arm: Arm
    method: str = "ik-ba"
    seed: int = 0
    population: int | str | None = None
    iterations: int | str | None = None
    params: Mapping[str, Any] = field(default_factory=dict)
    refined: bool = True
    tolerance_position: float = 1e-6
    tolerance_orientation: float = 1e-6
    verdict: bool = True

    def __post_init__(self) -> None:
        check_options(self.method, self.seed, self.population, self.iterations, self.params)
        check_tolerances(self.tolerance_position, self.tolerance_orientation)
        self._solver, self._values = _prepared(
            self.method,
            tuple((name, type(value), value) for name, value in self.params.items()),
            replacements(),
        )
        self._few_restarts = min(_FEW_RESTARTS, int(self._values.get("restarts", _FEW_RESTARTS)))
        self.searcher: Searcher | None = None
        if self._solver.searches:
            self.searcher = Searcher(
                self.arm, self._solver, self._values, self.seed, self.population, self.iterations
            )
        elif self.population is not None:
            raise InvalidRequest(
                f"ik.population: {self.method} has no population", field="ik.population"
            )
        self._by_closed_form = self.method == "closed-form"
        if self._by_closed_form and self.arm.closed_form.kind == NO_FORM:
            others = [solver.name for solver in solvers() if solver.name != self.method]
            raise InvalidRequest(
                "ik.method: no closed form is known of this arm (it takes six joints whose last "
                "three axes meet in one point, or whose axes 2, 3 and 4 are parallel and the last "
                "two meet); 'lm' solves its poses",
                field="ik.method",
                allowed=others,
            )

    @property
    def cut(self) -> Flags:
        """Flag that ends searches early, shape (1,); see the Searcher of metaheuristic_seeds."""
        return np.zeros(1, dtype=np.bool_) if self.searcher is None else self.searcher.cut

    @property
    def search_evaluations(self) -> int:
        """About how many candidates one search evaluates."""
        return 0 if self.searcher is None else self.searcher.population * self.searcher.iterations

    def keep_clear(self, arrays: ContactArrays) -> None:
        """Make clearance a term of what the search minimises; other methods have no such thing.

        Args:
            arrays: The bodies to keep clear of.
        """
        if self.searcher is not None:
            self.searcher.around = surroundings(arrays)

    def solve(self, target: Target, q_start: Array) -> Solved:
        """Return solutions of a target, the one nearest to ``q_start`` first.

        Args:
            target: The tool pose wanted.
            q_start: Configuration to stay near to, shape (dof,) [rad or m].

        Raises:
            NoSolution: None was found within tolerance; carries the verdict.
        """
        if self._by_closed_form:
            return self._solve_by_closed_form(target, q_start)
        if self.searcher is None:
            return self._solve_by_refinement(target, q_start)
        if not self.refined:
            return self._solve_raw(self.searcher, target, q_start)
        lower, upper = self.arm.search_bounds(q_start)
        seeds, evaluations = self.searcher.seeds(target, q_start, lower, upper)
        solutions, errors = np.empty((_SLIDES, self.arm.dof)), np.empty((_SLIDES, 3))
        found, spent = nearest_solutions(
            self.arm.chain,
            target,
            np.vstack([q_start, seeds]),
            _SPREAD,
            (0.5 + self.seed * 0.6180339887498949) % 1.0,
            q_start,
            lower,
            upper,
            self.tolerance_position,
            self.tolerance_orientation,
            _SLIDES,
            solutions,
            errors,
        )
        evaluations += spent
        if found:
            return Solved(solutions[:found], errors[:found, 0], errors[:found, 1], evaluations)
        try:
            rescued = self._solve_by_refinement(target, q_start)
        except NoSolution as verdict:
            verdict.evaluations += evaluations
            raise
        return Solved(
            rescued.q,
            rescued.position_error,
            rescued.orientation_error,
            rescued.evaluations + evaluations,
        )

    def _solve_by_closed_form(self, target: Target, q_start: Array) -> Solved:
        """Every branch within the limits; where they may not be all, what lm finds as well."""
        arm = self.arm
        if not has_closed_form(arm.closed_form, target):
            return self._solve_by_refinement(target, q_start)
        q = np.empty((MOST_BRANCHES, arm.dof))
        exact = min(self.tolerance_position, self.tolerance_orientation)
        count, all_found, evaluations = closed_form_solutions(
            arm.chain,
            arm.closed_form,
            target,
            q_start,
            arm.lower,
            arm.upper,
            exact,
            q,
            new_workspace(arm.chain),
        )
        q = q[:count]
        if count == 0 and all_found and self.verdict:
            # No branch has it: what is left to tell is by how much, unless that is tolerated.
            seed = np.clip(q_start, arm.lower, arm.upper)
            met, spent = self._closest(target, seed, q_start, evaluations)
            return Solved(
                met.q[None],
                np.array([met.position_error]),
                np.array([met.orientation_error or 0.0]),
                spent,
            )
        if count == 0 or not all_found:
            try:
                further = self._solve_by_refinement(target, q_start)
            except NoSolution as verdict:
                verdict.evaluations += evaluations
                if count == 0:
                    raise
                evaluations = verdict.evaluations
            else:
                q = np.vstack([q, further.q])
                evaluations += further.evaluations
        q = q[np.argsort(np.linalg.norm(q - q_start, axis=1), kind="stable")]
        errors = np.array([pose_distance(arm, target, row) for row in q])
        return Solved(q, errors[:, 0], errors[:, 1], evaluations)

    def _solve_by_refinement(self, target: Target, q_start: Array) -> Solved:
        lower, upper = self.arm.search_bounds(q_start)
        restarts = _RESCUE_RESTARTS if self.verdict else BARE_RESTARTS
        if self.searcher is None and (self.verdict or "restarts" in self.params):
            restarts = int(self._values.get("restarts", restarts))
        iterations = self.iterations if isinstance(self.iterations, int) else 40
        q = np.empty(self.arm.dof)
        distance, angle, evaluations = solve_lm(
            *self.arm.chain,
            target.R,
            target.p,
            target.oriented,
            *target.freedom,  # type: ignore[arg-type]
            q_start,
            lower,
            upper,
            self.tolerance_position,
            self.tolerance_orientation,
            restarts,
            iterations if self.searcher is None else 40,
            self.seed,
            self.method != "lm",
            q,
        )
        if distance > self.tolerance_position or angle > self.tolerance_orientation:
            if not self.verdict:
                found = float(distance), float(angle) if target.oriented else None
                raise NoSolution(ClosestApproach(q, *found, [], BARE_NO), evaluations)
            met, evaluations = self._closest(target, q, q_start, evaluations)
            q, distance, angle = met.q, met.position_error, met.orientation_error or 0.0
        return Solved(q[None], np.array([distance]), np.array([angle]), evaluations)

    def _closest(
        self, target: Target, q_best: Array, q_start: Array, evaluations: int
    ) -> tuple[ClosestApproach, int]:
        """The closest approach where it is within tolerance after all, and evaluations in all.

        The verdict searches longer than the solver, and may find what that did not.

        Raises:
            NoSolution: It is not.
        """
        closest, spent = explain_unreachable(self.arm, target, q_best, q_start)
        evaluations += spent
        tolerance = self.tolerance_position, self.tolerance_orientation
        met, spent = within(self.arm, target, closest, q_start, *tolerance)
        evaluations += spent
        if met is None:
            raise NoSolution(closest, evaluations)
        return met, evaluations

    def solve_first(self, T: Array, q_start: Array, q: Array) -> tuple[float, float, float, int]:
        """Try a pose by lm from few seeds, or in closed form, with little around it.

        The time is a tenth of what :meth:`solve` takes.

        Args:
            T: Tool pose wanted, homogeneous, shape (4, 4).
            q_start: Configuration to stay near to, shape (dof,) [rad or m].
            q: Out: the solution that :meth:`solve` would find, shape (dof,) [rad or m].

        Returns:
            As :func:`solve_lm_pose`; infinities where :meth:`solve` is to be asked.
        """
        if self._by_closed_form:
            return solve_closed_form_pose(
                *self.arm.chain,
                *self.arm.closed_form,  # type: ignore[arg-type]
                T,
                q_start,
                self.arm.lower,
                self.arm.upper,
                self.tolerance_position,
                self.tolerance_orientation,
                q,
            )
        lower, upper = self.arm.search_bounds(q_start)
        return solve_lm_pose(
            *self.arm.chain,
            T,
            q_start,
            lower,
            upper,
            self.tolerance_position,
            self.tolerance_orientation,
            self._few_restarts,
            self.iterations if isinstance(self.iterations, int) else 40,
            self.seed,
            q,
        )

    def _solve_raw(self, searcher: Searcher, target: Target, q_start: Array) -> Solved:
        lower, upper = self.arm.search_bounds(q_start)
        q, evaluations = searcher.best(target, q_start, lower, upper)
        distance, angle = pose_distance(self.arm, target, q)
        return Solved(q[None], np.array([distance]), np.array([angle]), evaluations)


def surest_solver(solver: PoseSolver, target: Target) -> PoseSolver:
    """Return the solver that tells best whether a target has a solution at all.

    By closed form, where the arm and the target have one: that gives every branch, where a search
    that finds nothing proves nothing and takes a hundred times as long. Else the solver itself.
    """
    if solver.method == "closed-form" or not has_closed_form(solver.arm.closed_form, target):
        return solver
    return replace(solver, method="closed-form", population=None, iterations=None, params={})


def pose_distance(arm: Arm, target: Target, q: Array) -> tuple[float, float]:
    """Return the distance [m] and the rotation angle [rad] (0: none counts) of q from a target.

    What the target leaves free counts as nothing.
    """
    distance, angle = target_error(arm.chain, target, np.ascontiguousarray(q))
    return float(distance), float(angle)


def solve_pose(
    robot: Robot, solver: PoseSolver, pose: Any, start: ArrayLike | None = None
) -> IkSolution:
    """Find joint values with a solver that is set up already, see :func:`ikplan.solve_ik`."""
    q_start = np.array(robot.home) if start is None else check_start(robot, start)
    if solver.method in QUICK and isinstance(pose, SE3):
        q = np.empty(len(q_start))
        found = solver.solve_first(pose.homogeneous, q_start, q)
        if found[0] < math.inf:
            return _solution(q, *found)
    target = target_of(pose)
    try:
        solved = solver.solve(target, q_start)
    except NoSolution as verdict:
        raise refusal(robot, verdict.closest, target) from verdict
    q = solved.q[0]
    difference = q - q_start
    return _solution(
        q,
        float(solved.position_error[0]),
        float(solved.orientation_error[0]) if target.oriented else None,
        math.sqrt(float(difference @ difference)),
        solved.evaluations,
    )


def refusal(robot: Robot, closest: ClosestApproach, target: Target) -> Unreachable:
    """Return the error of a single pose without a solution, with a hint about its unit."""
    error = unreachable(robot, closest, 0, "the pose", target)
    return with_hint(error, unit_hint(robot, [target.p.tolist()]))


def _solution(
    q: Array,
    position_error: float,
    orientation_error: float | None,
    elongation: float,
    evaluations: int,
) -> IkSolution:
    return IkSolution.quick(
        {
            "q": q,
            "position_error": position_error,
            "orientation_error": orientation_error,
            "elongation": elongation,
            "evaluations": evaluations,
        }
    )


def target_as_data(target: Target) -> dict[str, Any]:
    """Return where a target is, as errors tell it."""
    quaternion = Quaternion(target.R).coeffs().tolist() if target.oriented else None
    return {"position": target.p.tolist(), "quaternion_xyzw": quaternion}


def unreachable(
    robot: Robot, closest: ClosestApproach, waypoint: int, subject: str, target: Target
) -> Unreachable:
    """Return the error of a target without a solution; ``subject`` names the target."""
    limits = [robot.joint_names[k] for k in closest.limits]
    error = f"{closest.position_error * 1e3:.3g} mm"
    if closest.orientation_error is not None:
        error += f" and {closest.orientation_error:.3g} rad"
    binding = f"; at its limit there: {', '.join(limits)}" if limits else ""
    return Unreachable(
        f"{subject} is unreachable, the closest found is {error} away: {closest.reason}{binding}",
        waypoint=waypoint,
        position_error=closest.position_error,
        orientation_error=closest.orientation_error,
        q=[float(v) for v in closest.q],
        reason=closest.reason,
        limits=limits,
        target=target_as_data(target),
    )
