"""Searches as lines of work: those of ikplan, and CMA-ES."""

from __future__ import annotations

import json
import time
import traceback
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from ikplan.batch.executor import Answers
from ikplan.batch.outcome import OK, Outcome, failed
from ikplan.errors import IkplanError
from ikplan.placement.evaluation import Evaluated, Site
from ikplan.placement.work import search

__all__ = ["CMA", "StudyWork"]

CMA = "cma-es"
"""CMA-ES of the package ``cma`` (Hansen, 2016), started at the given placement."""
_STEP = 0.3


def _cma(site: Site, evaluations: int, seed: int) -> list[Evaluated]:
    """Search by CMA-ES in the unit cube, with a first step of 0.3."""
    import cma

    low, high = np.array(site.lower), np.array(site.upper)
    start = np.clip(-low / np.where(high > low, high - low, 1.0), 0.0, 1.0)
    options: dict[str, Any] = {
        "bounds": [0.0, 1.0], "seed": seed + 1, "maxfevals": evaluations, "verbose": -9,
    }  # fmt: skip
    strategy = cma.CMAEvolutionStrategy(start, _STEP, options)
    rows = [site.evaluate([0.0] * len(low))]
    while len(rows) < evaluations and not strategy.stop(ignore_list=["maxfevals"]):
        candidates = strategy.ask()
        made = [site.evaluate(low + np.asarray(x) * (high - low)) for x in candidates]
        rows += made
        strategy.tell(candidates, [row.score for row in made])
    return rows[:evaluations]


@dataclass(frozen=True)
class StudyWork:
    """Answers lines with a search, its evaluations and its seed.

    Attributes:
        site: What is placed.
    """

    site: Site

    @property
    def preload(self) -> str:
        """The module that loads the planner's kernels."""
        return "ikplan.batch.preload.plan"

    def answer(self, lines: Sequence[bytes]) -> Answers:
        """Answer some lines."""
        begun = time.perf_counter()
        outcomes, faults = [], []
        for line in lines:
            asked = json.loads(line)
            try:
                if asked["solver"] == CMA:
                    rows = _cma(self.site, asked["evaluations"], asked["seed"])
                else:
                    rows = search(self.site, **asked, params={})
                outcomes.append(Outcome(OK, json.dumps(rows).encode()))
            except Exception:
                faults.append(traceback.format_exc())
                outcomes.append(failed(IkplanError("a search failed, told on stderr")))
        return Answers(outcomes, time.perf_counter() - begun, tuple(faults))
