"""What the report says first: claims of the papers, what came out here, and a verdict.

A verdict is one of a few words, so that reports of other seeds can be held to it. A figure is
decided by its interval, an order by a test; what neither decides is undecided.
"""

from __future__ import annotations

import json
import math
from collections.abc import Sequence
from dataclasses import asdict, dataclass, replace
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from benchmarks.papers.statistics import LEVEL, Comparison, Estimate

__all__ = [
    "UNDECIDED",
    "VERDICTS",
    "Claim",
    "against",
    "held_to",
    "one_of_ours",
    "read_claims",
    "short",
    "smallest",
    "told",
    "write_claims",
]

NEAR = 1.5
"""A figure within this factor of the published one is reproduced."""
REPRODUCED, LARGER, SMALLER, UNDECIDED = "reproduced", "larger", "smaller", "undecided"
HOLDS, FAILS = "holds", "does not hold"
VERDICTS = (REPRODUCED, LARGER, SMALLER, HOLDS, FAILS, UNDECIDED)


@dataclass(frozen=True)
class Claim:
    """A line of the summary.

    Attributes:
        subject: What is claimed.
        published: The published figure.
        ours: The figure found here, with its interval.
        n: What it is made of.
        test: The test or the interval that decides.
        verdict: One of :data:`VERDICTS`.
    """

    subject: str
    published: str
    ours: str
    n: str
    test: str
    verdict: str


def against(published: float, ours: Estimate) -> str:
    """Return the verdict on a figure, by where the interval of its ratio to the published one is.

    Args:
        published: The published figure, above 0.
        ours: The figure found here, above 0.
    """
    if not (published > 0.0 and ours.value > 0.0 and math.isfinite(ours.value)):
        raise ValueError(f"no ratio of {ours.value} to {published}")
    low, high = ours.low / published, ours.high / published
    if low > NEAR:
        return LARGER
    if high < 1.0 / NEAR:
        return SMALLER
    if low >= 1.0 / NEAR and high <= NEAR:
        return REPRODUCED
    return UNDECIDED


def one_of_ours(runs: NDArray[np.float64], published: float) -> tuple[str, float, float]:
    """Return the verdict on a figure published of one run, by its rank among ours.

    One more run like ours is as small as the published one with a probability of at most (k + 1) /
    (n + 1), where k of n are as small, and as large in the same manner: beyond one in twenty of
    either the published run is none of ours.

    Args:
        runs: The figure of each of our runs, shape (runs,).
        published: The published figure.

    Returns:
        The verdict, and both probabilities.
    """
    n, k = len(runs), int((runs <= published).sum())
    small, large = (k + 1) / (n + 1), (n - k + 1) / (n + 1)
    if small <= LEVEL:
        return LARGER, small, large
    if large <= LEVEL:
        return SMALLER, small, large
    return (UNDECIDED if k in (0, n) else REPRODUCED), small, large


def smallest(comparisons: Sequence[Comparison]) -> str:
    """Return the verdict on "smaller than each", by tests adjusted as one family.

    Args:
        comparisons: The one claimed to be smallest against each other.
    """
    if all(c.first_is_smaller for c in comparisons):
        return HOLDS
    return FAILS if any(c.second_is_smaller for c in comparisons) else UNDECIDED


def told(value: Estimate, unit: str = "") -> str:
    """Write a figure with its interval."""
    unit = f" {unit}" if unit else ""
    return f"{short(value.value)}{unit} ({short(value.low)} to {short(value.high)})"


def short(value: float) -> str:
    """Write a figure with two digits."""
    return f"{float(f'{value:.2g}'):g}"


def held_to(claims: Sequence[Claim], others: Sequence[Sequence[Claim]]) -> list[Claim]:
    """Return the claims, those undecided whose verdict another seed turns.

    Args:
        claims: The claims of the report.
        others: The claims of reports of other seeds.

    Raises:
        ValueError: A report of another seed does not have a claim: it is of another version.
    """
    checked = []
    by_subject = [{c.subject: c.verdict for c in other} for other in others]
    for claim in claims:
        if not all(claim.subject in verdicts for verdicts in by_subject):
            raise ValueError(f"a report of another seed says nothing of {claim.subject!r}")
        found = {verdicts[claim.subject] for verdicts in by_subject}
        turned = sorted(found - {claim.verdict})
        verdict = claim.verdict
        if turned and verdict != UNDECIDED:
            verdict = f"{UNDECIDED}: {claim.verdict}; another seed: {', '.join(turned)}"
        checked.append(replace(claim, verdict=verdict))
    return checked


def write_claims(path: Path, claims: Sequence[Claim]) -> None:
    """Keep claims as JSON."""
    path.write_text(json.dumps([asdict(c) for c in claims], indent=1))


def read_claims(path: Path) -> list[Claim]:
    """Read claims kept by :func:`write_claims`."""
    return [Claim(**row) for row in json.loads(path.read_text())]
