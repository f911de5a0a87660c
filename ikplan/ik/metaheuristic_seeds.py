"""Run a metaheuristic on a target: objective, bounds, decoupling, budget, random numbers."""

from __future__ import annotations

import functools
from collections.abc import Mapping
from typing import Any

import numpy as np

from ikplan.arrays import Array
from ikplan.errors import InvalidRequest
from ikplan.ik.crowding import Surroundings
from ikplan.ik.metaheuristics.bounds import BOUNDS
from ikplan.ik.metaheuristics.population import Outcome, Problem
from ikplan.ik.objective import (
    ORIENTATION,
    POSITION,
    WEIGHTED,
    Objective,
    pose_objective,
    wrist_objective,
)
from ikplan.ik.solver import Solver
from ikplan.ik.weights import fitness_weights
from ikplan.kinematics.arm import Arm
from ikplan.kinematics.forward import forward
from ikplan.kinematics.target import Target
from ikplan.kinematics.wrist import nearest_wrist
from ikplan.time_budget import SearchCut

__all__ = ["Searcher", "generator"]


WARM = ("cold", "individual", "cloud")

_SEEDS = 3
"""Members of the last population that are refined beside the best."""


def generator(seed: int, *context: int) -> np.random.Generator:
    """Return the random numbers of a seed and what they are for."""
    return np.random.Generator(np.random.PCG64(np.random.SeedSequence([seed, *context])))


class Searcher:
    """A metaheuristic set up for an arm.

    Attributes:
        cut: Shape (1,); once another thread makes it true, every search ends early and raises.
        around: What configurations are to keep clear of, as a term of the objective, in metres;
            None: nothing.

    Raises:
        InvalidRequest: A population too small for the method, or a decoupling asked of an arm
            without a spherical wrist.
    """

    def __init__(
        self,
        arm: Arm,
        solver: Solver,
        values: Mapping[str, Any],
        seed: int,
        population: int | str | None = None,
        iterations: int | str | None = None,
    ) -> None:
        self.arm = arm
        self.solver = solver
        self.values = values
        paper_population, paper_iterations = solver.paper_budget(values)
        if solver.population is None:
            if population is not None:
                raise InvalidRequest(
                    f"ik.population: {solver.name} has no population", field="ik.population"
                )
            self.population = 1
        else:
            self.population = _budget(
                "population", population, solver.planner_population, paper_population
            )
        self.iterations = _budget(
            "iterations", iterations, solver.planner_iterations, paper_iterations
        )
        if self.population < solver.min_population:
            raise InvalidRequest(
                f"ik.population: {solver.name} needs at least {solver.min_population} candidates",
                field="ik.population",
                allowed=f"at least {solver.min_population}",
            )
        if self.iterations < 1:
            raise InvalidRequest(
                f"ik.iterations: must be at least 1, not {self.iterations}",
                field="ik.iterations",
                allowed="at least 1",
            )
        if values["decouple"] and arm.wrist is None:
            raise InvalidRequest(
                "ik.params.decouple: this arm has no spherical wrist (its last three axes do not "
                "meet in one point, each perpendicular to the next)",
                field="ik.params.decouple",
                allowed=[False],
            )
        self._kernel = solver.load()
        self._packed = solver.pack(values)
        self._seed = seed
        self.cut = np.zeros(1, dtype=np.bool_)
        self.around: Surroundings | None = None

    @functools.cached_property
    def _rng(self) -> np.random.Generator:
        """Random numbers; a path that is only tracked needs none."""
        return generator(self._seed)

    def objective(self, target: Target, q_start: Array) -> Objective:
        """Return what is minimised for a target.

        Raises:
            InvalidRequest: The objective asked for needs an orientation that the target lacks.
        """
        name = self.values["objective"]
        if self.values["decouple"] and self.around is not None:
            raise InvalidRequest(
                "ik.params.decouple: a search over the arm without its wrist cannot keep clear of "
                "bodies",
                field="ik.params.decouple",
                allowed=[False],
            )
        if self.values["decouple"] and self.values.get("weight_motion", 0.0) > 0.0:
            raise InvalidRequest(
                "ik.params.weight_motion: a search over the arm without its wrist has no joint "
                "values of the wrist to weigh",
                field="ik.params.weight_motion",
                allowed=[0.0],
            )
        if self.values["decouple"] and target.oriented and self.arm.wrist is not None:
            return wrist_objective(
                self.arm.wrist,
                target.R,
                target.p,
                q_start[-3:],
                penalise=self.values["wrist_limits"] == "penalise",
            )
        if not target.oriented and name in ("orientation", "weighted", "bode-cs"):
            raise InvalidRequest(
                f"ik.params.objective: {name} needs a target with an orientation",
                field="ik.params.objective",
                allowed=["auto", "position"],
            )
        if target.oriented and name == "bode-cs":
            weights = fitness_weights(self.arm)
            return pose_objective(
                self.arm.chain,
                target.R,
                target.p,
                weight_position=weights.omega_position,
                weight_orientation=weights.omega_rotation,
                weight_motion=self.values.get("weight_motion", 0.0),
                q_start=q_start,
                around=self._around(weights.omega_position),
            )
        kinds = {"position": POSITION, "orientation": ORIENTATION, "weighted": WEIGHTED}
        kind = kinds.get(name, WEIGHTED if target.oriented else POSITION)
        return pose_objective(
            self.arm.chain,
            target.R,
            target.p,
            kind,
            weight_position=self.values["weight_position"],
            weight_orientation=self.values["weight_orientation"],
            weight_motion=self.values.get("weight_motion", 0.0),
            q_start=q_start,
            around=self._around(self.values["weight_position"] if kind == WEIGHTED else 1.0),
        )

    def _around(self, metre: float) -> Surroundings | None:
        """What to keep clear of, where the objective counts a metre's distance as ``metre``."""
        if self.around is None:
            return None
        # Without a distance in the objective, its own unit stands for the metre.
        scale = metre or 1.0
        return self.around._replace(
            near=scale * self.around.near, weight=scale * self.around.weight
        )

    def run(
        self,
        target: Target,
        q_start: Array,
        lower: Array,
        upper: Array,
        *,
        warm: bool | None = None,
        stop_value: float = 0.0,
    ) -> Outcome:
        """Search, with the next random numbers of this searcher.

        Args:
            target: The tool pose wanted.
            q_start: Start configuration, shape (dof,) [rad or m].
            lower: Lower bounds, finite, shape (dof,) [rad or m].
            upper: Upper bounds, finite, shape (dof,) [rad or m].
            warm: Whether individual 0 is the start configuration; None: as the parameters say.
            stop_value: The search ends once the best value is this small.

        Returns:
            The outcome, over the joints searched: without the last three when decoupled.

        Raises:
            SearchCut: ``cut`` became true.
        """
        objective = self.objective(target, q_start)
        d = objective.joints.shape[1] - 2
        problem = Problem(
            objective,
            np.array(lower[:d], dtype=np.float64),
            np.array(upper[:d], dtype=np.float64),
            np.array(q_start[:d], dtype=np.float64),
            WARM.index(self.values["warm"]) if warm is None else int(warm),
            BOUNDS.index(self.values.get("bounds", "clip")),
            self.population,
            self.iterations,
            stop_value,
            self.cut,
        )
        outcome: Outcome = self._kernel(problem, self._packed, self._rng)
        if self.cut[0]:
            raise SearchCut
        return outcome

    def complete(self, x: Array, target: Target, q_start: Array) -> Array:
        """Return the whole configuration, shape (dof,), of the joints searched over."""
        if x.shape[0] == self.arm.dof or self.arm.wrist is None:
            return x
        R_arm, _ = forward(self.arm.wrist.arm, x)
        angles = np.empty(3)
        nearest_wrist(self.arm.wrist, R_arm, target.R, np.ascontiguousarray(q_start[-3:]), angles)
        return np.concatenate([x, angles])

    def best(self, target: Target, q_start: Array, lower: Array, upper: Array) -> tuple[Array, int]:
        """Return the best configuration of one search, shape (dof,), and its evaluations."""
        outcome = self.run(target, q_start, lower, upper)
        return self.complete(outcome.x, target, q_start), int(outcome.evaluations[0])

    def seeds(
        self, target: Target, q_start: Array, lower: Array, upper: Array
    ) -> tuple[Array, int]:
        """Return the best configuration and the best of the last population, shape (k, dof)."""
        outcome = self.run(target, q_start, lower, upper)
        order = np.argsort(outcome.F, kind="stable")[:_SEEDS]
        rows = [outcome.x, *outcome.X[order]]
        seeds = np.array([self.complete(x, target, q_start) for x in rows])
        return seeds, int(outcome.evaluations[0])


def _budget(name: str, asked: int | str | None, own: int | None, paper: int | None) -> int:
    """The number of individuals or iterations to use."""
    if isinstance(asked, int):
        return asked
    if asked not in (None, "paper"):
        raise InvalidRequest(
            f'ik.{name}: must be a number, "paper" or null, not {asked!r}',
            field=f"ik.{name}",
            allowed=["paper"],
        )
    chosen = paper if asked == "paper" or own is None else own
    if chosen is None:
        raise InvalidRequest(f"ik.{name}: must be a number", field=f"ik.{name}")
    return chosen
