"""Placement on an executor: searches and single placements as lines of work."""

from __future__ import annotations

import json
import time
import traceback
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

from ikplan.batch.executor import Answers
from ikplan.batch.outcome import OK, Outcome, failed
from ikplan.errors import IkplanError
from ikplan.ik.minimise import minimise
from ikplan.placement.evaluation import Evaluated, Site

__all__ = ["PlacementWork", "search"]


def search(
    site: Site, solver: str, evaluations: int, seed: int, params: dict[str, Any]
) -> list[Evaluated]:
    """Search for the best placement.

    Args:
        site: What is placed.
        solver: Name of the search, see :func:`ikplan.ik.minimise.minimisers`.
        evaluations: Placements looked at, at most.
        seed: Seed of the search.
        params: Parameters of the search.

    Returns:
        Every placement looked at, in order; the given one is the first where it is within bounds.
    """
    seen: dict[tuple[float, ...], Evaluated] = {}
    rows: list[Evaluated] = []

    def score(values: Any) -> float:
        key = tuple(float(v) for v in values)
        if key not in seen:
            seen[key] = site.evaluate(key)
        rows.append(seen[key])
        return seen[key].score

    within = all(low <= 0.0 <= high for low, high in zip(site.lower, site.upper, strict=True))
    start = [0.0] * len(site.names) if within else None
    minimise(
        score,
        site.lower,
        site.upper,
        solver=solver,
        budget=evaluations,
        rng=seed,
        start=start,
        params=params,
    )
    return rows


@dataclass(frozen=True)
class PlacementWork:
    """Answers lines about one site: ``{"evaluate": values}`` or the arguments of a search.

    Attributes:
        site: What is placed.
    """

    site: Site

    @property
    def preload(self) -> str:
        """The module that loads the planner's kernels."""
        return "ikplan.batch.preload.plan"

    def answer(self, lines: Sequence[bytes]) -> Answers:
        """Answer some lines; no line spoils another."""
        begun = time.perf_counter()
        outcomes, faults = [], []
        for line in lines:
            try:
                outcomes.append(Outcome(OK, self._answer(json.loads(line))))
            except IkplanError as error:
                outcomes.append(failed(error))
            except Exception:  # told on stderr, and the other lines go on
                faults.append(traceback.format_exc())
                outcomes.append(
                    failed(IkplanError("an unexpected fault of ikplan, told on stderr"))
                )
        return Answers(outcomes, time.perf_counter() - begun, tuple(faults))

    def _answer(self, asked: dict[str, Any]) -> bytes:
        if "evaluate" in asked:
            rows = [self.site.evaluate(asked["evaluate"])]
        else:
            rows = search(self.site, **asked)
        return json.dumps(rows).encode()
