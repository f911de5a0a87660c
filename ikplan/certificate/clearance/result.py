"""What a proof found, and its document."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ikplan.certificate.clearance.search import GROUPS, Findings, findings
from ikplan.documents.clearance import Clearance

__all__ = ["ClearanceResult", "ClearanceViolation", "joined"]

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class ClearanceViolation:
    """A place where two bodies are nearer than asked for.

    Attributes:
        time: When [s].
        pair: Names of the two bodies.
        gap: Their distance, 0 where they touch [m].
        depth: At most how deep they are in each other, 0 where they do not touch [m].
        q: Joint values there, shape (dof,) [rad or m].
        undecided: Whether the place only could not be told from contact.
    """

    time: float
    pair: tuple[str, str]
    gap: float
    depth: float
    q: Array
    undecided: bool


@dataclass(frozen=True, eq=False)
class ClearanceResult:
    """A proof, or what stands against one.

    Attributes:
        clearance: The document of the certificate.
        violation: Where bodies are too near; None exactly where the document says ``proven``.
        configurations: How many configurations were looked at.
        queries: How many distance queries were made.
    """

    clearance: Clearance
    violation: ClearanceViolation | None
    configurations: int
    queries: int

    @property
    def proven(self) -> bool:
        """Whether the gap asked for is proven at every instant."""
        return self.clearance.proven


def joined(parts: list[Findings]) -> Findings:
    """Return the findings of several parts of a motion as those of the whole."""
    out = findings()
    for part in parts:
        for g in range(GROUPS):
            if part.found[g] < out.found[g]:
                out.found[g], out.at[g], out.pair[g] = part.found[g], part.at[g], part.pair[g]
                out.points[g] = part.points[g]
            out.least[g] = min(out.least[g], part.least[g])
            out.undecided[g] += part.undecided[g]
        out.counts[:] += part.counts
    return out
