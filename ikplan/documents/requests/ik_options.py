"""How joint solutions are looked for."""

from __future__ import annotations

import math
from typing import Annotated, Any, Literal

from pydantic import Discriminator, Field, PlainValidator, Tag, model_validator

from ikplan.documents import Document, IfGiven
from ikplan.documents.poses import Posture

__all__ = ["IkOptions"]


def _budget_tag(value: Any) -> str:
    return "[name]" if isinstance(value, str) else "[number]"


Budget = Annotated[
    Annotated[int, Field(ge=1, le=100_000), Tag("[number]")]
    | Annotated[Literal["paper"], Tag("[name]")],
    Discriminator(_budget_tag),
]


def _scalar(value: Any) -> bool | int | float | str:
    if not isinstance(value, bool | int | float | str):
        raise ValueError("a parameter is a number, a string, true or false")
    if isinstance(value, float) and not math.isfinite(value):
        raise ValueError("NaN and infinities are not allowed")
    if isinstance(value, int) and abs(value) >= 2**63:
        raise ValueError("a whole number must fit into 64 bits")
    return value


Scalar = Annotated[bool | int | float | str, PlainValidator(_scalar)]


MAX_EVALUATIONS = 10_000_000
"""Most evaluations of one search."""
_LOOKS = {"gsa": 20}
"""Methods in which every individual looks at all others: how many looks take as long as one
evaluation of a candidate (measured: 64 ns and 0.8 us, of half of them on average)."""


class IkOptions(Document):
    """How joint solutions are looked for."""

    method: str = Field("ik-ba", description="Name of a solver; see GET /v1/solvers.")
    seed: int = Field(0, ge=0, lt=2**63, description="Seed of every random choice.")
    population: Budget | None = Field(
        None,
        description="Candidates per iteration, 1 to 100000; null: the planner's own, as small as "
        'keeps its promises; "paper": the number of the method\'s paper. Times the iterations, '
        "at most 10,000,000; gsa, whose individuals all look at each other, allows fewer.",
    )
    iterations: Budget | None = Field(
        None,
        description="Iterations, 1 to 100000; null: the planner's own; \"paper\": the paper's.",
    )
    params: dict[str, Scalar] = Field({}, description="Parameters of the method, by name.")
    refine: bool = Field(
        True, description="Polish the seeds to machine precision; false: the raw solver."
    )
    elongation: Literal["global", "greedy"] = Field(
        "global",
        description='How joint motion is kept small: "global" over the whole path, "greedy" '
        "waypoint by waypoint.",
    )
    objective: Annotated[Literal["motion", "time", "clearance"], IfGiven()] = Field(
        "motion",
        description='What is least: "motion", the motion of the joints; "time", the time that the '
        "motion takes within its limits, never more than that of least joint motion; or "
        '"clearance", how near configurations are to touching anything, which in a plan chooses '
        "those of waypoints that joint motions lead to; paths with tool paths or moves do not "
        "take it.",
    )
    effort: Annotated[
        Annotated[int, Field(ge=1, le=10_000_000)] | None,
        IfGiven(),
    ] = Field(
        None,
        description="Samples drawn at most in the search for the way of a move; for every 200 of "
        "them one shortcut is tried. null: 20,000. The time budget only ends a search, it never "
        "decides what it finds.",
    )
    posture: Annotated[Posture | None, IfGiven()] = Field(
        None,
        description="Which motions are preferred: near a configuration, within soft limits, with "
        "weights of the joints; for plans, and for single poses, whose motion is that from the "
        "start; not for batches of poses. null: those of least joint motion, all joints alike.",
    )

    move_engine: Annotated[
        Literal["ikplan", "ompl:RRTConnect", "ompl:AORRTC", "ompl:BITstar"], IfGiven()
    ] = Field(
        "ikplan",
        description="What searches for the way of a move: ikplan's own search, or a planner of "
        "OMPL, which has to be installed; `effort` is then the number of its iterations at most, "
        "all of which AORRTC and BIT* use for shorter ways.",
    )

    @model_validator(mode="after")
    def _affordable(self) -> IkOptions:
        # A search runs to its end, whatever the time budget: seconds at most, not hours.
        most = {"population": 100, "iterations": 1000}
        asked = [
            budget if isinstance(budget, int) else most[name] if budget == "paper" else 50
            for name, budget in (("population", self.population), ("iterations", self.iterations))
        ]
        population, iterations = asked
        if population * iterations > MAX_EVALUATIONS:
            raise ValueError(
                f"population times iterations must be at most {MAX_EVALUATIONS:,}, "
                f"not {population * iterations:,}"
            )
        looks = _LOOKS.get(self.method)
        if looks and population * iterations * (1 + population / looks) > MAX_EVALUATIONS:
            fewer = int(MAX_EVALUATIONS / (population * (1 + population / looks)))
            raise ValueError(
                f"in {self.method} all individuals look at each other: with a population of "
                f"{population:,}, at most {fewer:,} iterations are allowed, not {iterations:,}"
            )
        return self
