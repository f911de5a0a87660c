"""The best placement of a part or a robot, and a map of those looked at."""

from __future__ import annotations

import contextlib
import json
import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from ikplan.arrays import Array
from ikplan.batch.choice import executor_for
from ikplan.batch.chunks import Line, Pace, chunks_of
from ikplan.documents import parse
from ikplan.documents.plan_request import PlanRequest
from ikplan.documents.scene import Scene
from ikplan.errors import IkplanError, InvalidRequest
from ikplan.ik.minimise import minimisers
from ikplan.placement.evaluation import PLANNED, Aim, Evaluated, Site
from ikplan.placement.moving import Moved
from ikplan.placement.work import PlacementWork, search
from ikplan.plans.plan import Plan
from ikplan.robots import Robot

__all__ = ["Placed", "Placement", "place"]

_KEPT = 3


@dataclass(frozen=True)
class Placed:
    """A placement with a certified plan.

    Attributes:
        values: What the placement changes, by name [m or rad].
        value: What it is worth: duration [s], motion [rad or m] or speed [rad/s].
        request: The request there; :func:`ikplan.plan` makes the same plan of it.
        plan: The plan.
    """

    values: dict[str, float]
    value: float
    request: dict[str, Any]
    plan: Plan


@dataclass(frozen=True)
class Placement:
    """The best placements, and all that were looked at.

    Attributes:
        names: What may change, in the order of the values.
        aim: What is least.
        given: The placement as it was given.
        best: The best ones, best first; empty: none has a plan.
        rows: Every placement looked at, search after search, in order.
    """

    names: tuple[str, ...]
    aim: Aim
    given: Evaluated
    best: tuple[Placed, ...]
    rows: tuple[Evaluated, ...]

    @property
    def gain(self) -> float:
        """By what share the best placement is better than the given one; NaN without both."""
        if not self.best or math.isnan(self.given.value):
            return math.nan
        return 1.0 - self.best[0].value / self.given.value

    @property
    def values(self) -> Array:
        """Values of the placements looked at, shape (n, d) [m or rad]."""
        return np.array([row.values for row in self.rows])


def place(
    request: Mapping[str, Any] | PlanRequest,
    bounds: Mapping[str, Sequence[float]],
    *,
    robot: Robot | None = None,
    move: Moved = "part",
    minimise: Aim = "time",
    solver: str = "bode-cs",
    evaluations: int = 200,
    searches: int = 1,
    seed: int = 0,
    params: Mapping[str, Any] | None = None,
    keep: int = _KEPT,
    carried: Sequence[str] = (),
    on: str | None = None,
    workers: int = 0,
) -> Placement:
    """Find where to put the part, or the robot's base, so that a path is feasible, and best.

    A metaheuristic of this project searches, with the planner as its objective: each placement
    is planned in full, with its scene, timed and certified. Where there is no plan, one that
    reaches more of the path counts as better.

    Args:
        request: The request for the plan, as for :func:`ikplan.plan`.
        bounds: Lowest and highest value of what may change, by name: "x", "y", "z" [m], "roll",
            "pitch", "yaw" [rad]. Zero is where the request has it. A part is turned about the
            middle of its path by roll, pitch and yaw (about the base's fixed axes, in this order),
            then shifted; a base is turned about itself.
        robot: The robot, for one that is not in the catalogue.
        move: "part": the path frame moves, and obstacles that are ``carried``; "base": the robot
            moves, the path and all obstacles stay.
        minimise: "time" (the duration), "motion" (the sum of what all joints move) or "wrist-speed"
            (the largest speed of the last three joints).
        solver: A search, see :func:`ikplan.ik.minimise.minimisers`.
        evaluations: Placements looked at in each search.
        searches: Searches, each with a seed of its own.
        seed: Seed of the first of them.
        params: Parameters of the solver.
        keep: How many of the best placements to return, at most.
        carried: Names of obstacles that move with the part.
        on: Where the searches run: "local", "ray" or "ray=ADDRESS", as for batches; None: in this
            process, one after the other. It has no influence on the result.
        workers: Worker processes; 0: one a processor.

    Returns:
        The best placements and the map. The same arguments give the same, in any process.

    Raises:
        InvalidRequest: The request or an argument makes no sense.
        RobotNotFound: No robot of that name.
    """
    parsed = parse(PlanRequest, request)
    if parsed.scene is not None and not isinstance(parsed.scene, Scene):
        raise InvalidRequest("scene: must be the scene itself, not an id", field="scene")
    names = tuple(bounds)
    lower, upper = _bounds(bounds)
    site = Site(parsed, robot, move, names, lower, upper, minimise, tuple(carried))
    site = site.with_scene_read().checked()
    if solver not in minimisers():
        raise InvalidRequest(f"solver: no {solver!r}", field="solver", allowed=minimisers())
    for field, count in (("evaluations", evaluations), ("searches", searches), ("keep", keep)):
        if count < 1:
            raise InvalidRequest(f"{field}: must be 1 or more", field=field, allowed="1 or more")
    asked: list[dict[str, Any]] = [
        {
            "solver": solver,
            "evaluations": evaluations,
            "seed": seed + k,
            "params": dict(params or {}),
        }
        for k in range(searches)
    ]
    if on is None:
        found = [search(site, **each) for each in asked]
    else:
        found = _searched(site, asked, on, workers)
    rows = tuple(row for each in found for row in each)
    given = site.evaluate([0.0] * len(names))
    return Placement(names, minimise, given, _best(site, rows, keep), rows)


def _bounds(
    bounds: Mapping[str, Sequence[float]],
) -> tuple[tuple[float, ...], tuple[float, ...]]:
    pairs = []
    for name, pair in bounds.items():
        try:
            low, high = (float(v) for v in pair)
        except (TypeError, ValueError) as error:
            raise InvalidRequest(
                f"bounds.{name}: two numbers, lowest and highest", field=f"bounds.{name}"
            ) from error
        pairs.append((low, high))
    return tuple(low for low, _ in pairs), tuple(high for _, high in pairs)


def _searched(
    site: Site, asked: Sequence[dict[str, Any]], on: str, workers: int
) -> list[list[Evaluated]]:
    """Run searches on an executor; they come back in their order."""
    lines = [Line(k, json.dumps(each).encode(), 0) for k, each in enumerate(asked)]
    found: list[list[Evaluated]] = []
    with contextlib.closing(executor_for(on, PlacementWork(site), workers)) as executor:
        for done in executor.run(chunks_of(lines, Pace(1))):
            for outcome in done.outcomes:
                document = json.loads(outcome.document)
                if outcome.slug:
                    raise IkplanError(str(document.get("detail", outcome.slug)))
                found.append([Evaluated(tuple(row[0]), *row[1:]) for row in document])
    return found


def _best(site: Site, rows: Sequence[Evaluated], keep: int) -> tuple[Placed, ...]:
    """The best different placements, planned again."""
    best: list[Placed] = []
    seen: set[tuple[float, ...]] = set()
    for row in sorted(
        (row for row in rows if row.outcome == PLANNED), key=lambda row: (row.score, row.values)
    ):
        if row.values in seen:
            continue
        seen.add(row.values)
        values = dict(zip(site.names, row.values, strict=True))
        best.append(Placed(values, row.value, site.at(row.values), site.plan(row.values)))
        if len(best) == keep:
            break
    return tuple(best)
