"""Compare searches at placing parts: ``python -m benchmarks.placement``.

Each search places each path with some seeds, with the planner as its objective and the same number
of placements looked at. Random search and CMA-ES (the package ``cma``) are beside them. ``-o``
writes every placement that was looked at, ``--on`` says where searches run.
"""

from __future__ import annotations

import argparse
import contextlib
import csv
import json
import math
import sys
import warnings
from collections.abc import Iterator, Sequence
from pathlib import Path
from statistics import median
from typing import Any

import numpy as np

from benchmarks.placement.cases import CASES, PlacementCase
from benchmarks.placement.work import CMA, StudyWork
from ikplan.batch.choice import executor_for
from ikplan.batch.chunks import Line, Pace, chunks_of
from ikplan.documents import parse
from ikplan.documents.plan_request import PlanRequest
from ikplan.ik.minimise import RANDOM, minimisers
from ikplan.placement.evaluation import PLANNED, Evaluated, Site

_SOLVERS = ("de-best-1", "de-rand-1", "bode-cs", "cs", "pso", "abc", "ba", "ga", RANDOM, CMA)


def site_of(case: PlacementCase) -> Site:
    """Return what is placed of a case."""
    lower, upper = zip(*case.bounds.values(), strict=True)
    request = parse(PlanRequest, case.request)
    names = tuple(case.bounds)
    return Site(request, None, "part", names, lower, upper, case.aim, case.carried).checked()


def _best(rows: list[Evaluated]) -> tuple[float, float, int]:
    """Least value, largest share reached, and after how many placements the first has a plan."""
    planned = [k for k, row in enumerate(rows) if row.outcome == PLANNED]
    least = min((rows[k].value for k in planned), default=math.nan)
    return least, max(row.reached for row in rows), planned[0] + 1 if planned else 0


def _searched(
    site: Site, asked: Sequence[dict[str, Any]], options: argparse.Namespace
) -> Iterator[list[Evaluated]]:
    """Run searches here or on an executor; they come in their order."""
    work = StudyWork(site)
    lines = [Line(k, json.dumps(each).encode(), 0) for k, each in enumerate(asked)]
    with contextlib.ExitStack() as stack:
        if options.on == "here":
            outcomes = (work.answer([line.content]).outcomes[0] for line in lines)
        else:
            executor = executor_for(options.on, work, options.workers)
            stack.enter_context(contextlib.closing(executor))
            done = executor.run(chunks_of(lines, Pace(1)))
            outcomes = (outcome for each in done for outcome in each.outcomes)
        for outcome in outcomes:
            if outcome.slug:
                raise RuntimeError(outcome.document.decode())
            yield [Evaluated(tuple(row[0]), *row[1:]) for row in json.loads(outcome.document)]


def _study(name: str, options: argparse.Namespace, writer: Any) -> None:
    case = CASES[name]()
    site = site_of(case)
    given = site.evaluate([0.0] * len(site.names))
    print(f"\n{name}: {case.title}; least {case.aim}")
    print(f"as given: {given.outcome}, value {given.value:.4g}, reached {given.reached:.2f}")
    asked = [
        {"solver": solver, "evaluations": options.evaluations, "seed": seed}
        for solver in options.solvers
        for seed in range(options.seeds)
    ]
    found = []
    for each, rows in zip(asked, _searched(site, asked, options), strict=True):
        found.append(rows)
        least, share, first = _best(rows)
        print(
            f"{each['solver']}, seed {each['seed']}: least {least:.4g}, reached {share:.2f}, first "
            f"plan after {first}",
            file=sys.stderr,
            flush=True,
        )
    print("| search | with a plan | median | best | worst | first plan after |")
    print("|---|---|---|---|---|---|")
    for solver in options.solvers:
        runs = [
            _best(rows) for each, rows in zip(asked, found, strict=True) if each["solver"] == solver
        ]
        values = sorted(value for value, _, _ in runs if not math.isnan(value))
        firsts = [first for _, _, first in runs if first]
        shown = (
            f"{median(values):.4g} | {values[0]:.4g} | {values[-1]:.4g} | {median(firsts):.0f}"
            if values
            else f"none, {max(share for _, share, _ in runs):.2f} reached | | |"
        )
        print(f"| {solver} | {len(values)} of {len(runs)} | {shown} |")
    every = [row for rows in found for row in rows if row.outcome == PLANNED]
    if every:
        best = min(every, key=lambda row: row.value)
        plan = site.plan(best.values)
        values_shown = dict(zip(site.names, np.round(best.values, 4).tolist(), strict=True))
        gain = "" if math.isnan(given.value) else f", {100 * (1 - best.value / given.value):.1f} %"
        print(
            f"best: {best.value:.4g} at {values_shown}{gain}; certified: "
            f"{plan.certificate.valid}, {plan.duration:.3f} s"
        )
    if writer is not None:
        for each, rows in zip(asked, found, strict=True):
            for row in rows:
                writer.writerow(
                    [name, each["solver"], each["seed"], *row.values, row.outcome, row.value,
                     row.reached]
                )  # fmt: skip


def main() -> int:
    """Compare, and print."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--cases", nargs="+", choices=list(CASES), default=list(CASES))
    parser.add_argument(
        "--solvers", nargs="+", choices=[*minimisers(), CMA], default=list(_SOLVERS)
    )
    parser.add_argument("--evaluations", type=int, default=100)
    parser.add_argument("--seeds", type=int, default=3)
    parser.add_argument("--on", default="local", help="local, ray, ray=ADDRESS, or here")
    parser.add_argument("--workers", type=int, default=0)
    parser.add_argument("-o", "--output", metavar="FILE", help="every placement, as CSV")
    options = parser.parse_args()
    warnings.simplefilter("ignore")
    with contextlib.ExitStack() as stack:
        writer = None
        if options.output is not None:
            file = stack.enter_context(Path(options.output).open("w", newline="", encoding="utf-8"))
            writer = csv.writer(file, lineterminator="\n")
        for name in options.cases:
            _study(name, options, writer)
    return 0


if __name__ == "__main__":
    sys.exit(main())
