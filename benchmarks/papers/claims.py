"""What the report says first: claims of the papers, what came out here, and a verdict."""

from __future__ import annotations

import json
import math
from collections.abc import Sequence
from dataclasses import asdict, dataclass
from pathlib import Path

__all__ = ["Claim", "against", "read_claims", "short", "write_claims"]

NEAR = 1.5
"""A figure within this factor of the published one is reproduced."""


@dataclass(frozen=True)
class Claim:
    """A line of the summary.

    Attributes:
        subject: What is claimed.
        published: The published figure.
        ours: The figure found here.
        verdict: Whether the claim holds.
    """

    subject: str
    published: str
    ours: str
    verdict: str


def against(published: float, ours: float) -> str:
    """Return the verdict on a figure: reproduced within a factor of 1.5, or by how much it is off.

    Args:
        published: The published figure, above 0.
        ours: The figure found here, above 0.
    """
    ratio = ours / published
    if not (math.isfinite(ratio) and ratio > 0.0):
        raise ValueError(f"no ratio of {ours} to {published}")
    if 1.0 / NEAR <= ratio <= NEAR:
        return "reproduced"
    times = short(ratio if ratio > 1.0 else 1.0 / ratio)
    return f"{times} times as {'large' if ratio > 1.0 else 'small'}"


def short(value: float) -> str:
    """Write a figure with two digits."""
    return f"{float(f'{value:.2g}'):g}"


def write_claims(path: Path, claims: Sequence[Claim]) -> None:
    """Keep claims as JSON."""
    path.write_text(json.dumps([asdict(c) for c in claims], indent=1))


def read_claims(path: Path) -> list[Claim]:
    """Read claims kept by :func:`write_claims`."""
    return [Claim(**row) for row in json.loads(path.read_text())]
