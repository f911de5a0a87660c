"""The summary of the report: the claims of each experiment, held to those of other seeds."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path

from benchmarks.papers.claims import Claim, held_to, read_claims
from benchmarks.papers.document import Document
from benchmarks.papers.runner import find_experiment

__all__ = ["HEADING", "OWN", "Seeds", "read_seeds", "summary"]

Seeds = Mapping[str, Mapping[str, Sequence[Claim]]]
"""Claims by seed ("seed-0", "seed-1", ...) and experiment."""

OWN = "seed-0"
"""The seed whose figures the report prints."""

HEADING = "Summary: claims, published and ours"
HOW = (
    "How a verdict is reached. A **figure** is `reproduced` where the whole 95 % interval of "
    "its ratio to the published one is within a factor of 1.5, `larger` or `smaller` where it "
    "is wholly outside, `undecided` in between; the interval is a bootstrap over runs and "
    "targets. A **maximum** that was published of one run is held to the rank of that run among "
    "ours: `larger` or `smaller` where one more run of ours would be on the published side with "
    "a probability of at most 0.05, `reproduced` where runs of ours are on both sides, "
    "`undecided` over fewer targets than published; eleven maxima of a table are eleven such "
    "ranks, not adjusted, so that one among them may be chance. An "
    "**order** `holds`, or `does not hold`, by a test at 0.05: Mann-Whitney over the runs, with "
    "A12, or Wilcoxon over the medians of each target; runs of two series are never paired. All "
    "tests of one line, or of one claim over three readings, are one family of Holm's. An "
    "effect is the probability that the first named has the smaller value, 1/2 without a "
    "difference, with its 95 % interval. What n and tests cannot decide is `undecided`, and so "
    "is a verdict that another seed turns."
)
HEAD = ["claim", "published", "ours", "n", "test", "verdict"]


def read_seeds(folder: Path) -> dict[str, dict[str, list[Claim]]]:
    """Read the claims beside the sections of a report.

    Args:
        folder: The folder of the sections; other seeds have folders of their own in it.
    """
    folders = {OWN: folder, **{f.name: f for f in sorted(folder.glob("seed-*"))}}
    return {
        seed: {file.stem: read_claims(file) for file in sorted(place.glob("*.json"))}
        for seed, place in folders.items()
    }


def summary(seeds: Seeds, names: Sequence[str]) -> str:
    """Write the summary.

    Args:
        seeds: The claims; those of :data:`OWN` are printed.
        names: The experiments, in their order; those without claims are passed over.

    Raises:
        ValueError: Another seed does not have a claim of the report: it is of another version.
    """
    document = Document(Path(), "")
    document.heading(HEADING)
    document.say(HOW)
    for name in names:
        claims = seeds[OWN].get(name, ())
        if not claims:
            continue
        others = [seeds[s][name] for s in sorted(seeds) if s != OWN and name in seeds[s]]
        checked = held_to(claims, others)
        turned = sum(c.verdict != k.verdict for c, k in zip(claims, checked, strict=True))
        document.heading(f"{name}: {find_experiment(name).title}", 3)
        document.say(
            f"Made {len(others) + 1} times, with other random numbers; {turned} of "
            f"{len(claims)} verdicts turned, and are undecided."
            if others
            else "Made once: no verdict of these was held to other random numbers."
        )
        rows = [[c.subject, c.published, c.ours, c.n, c.test, c.verdict] for c in checked]
        document.table(HEAD, rows, words=True)
    return document.text()
