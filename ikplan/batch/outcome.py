"""The answer to one line of a batch, and the row that is written of it."""

from __future__ import annotations

import json
from typing import NamedTuple

from ikplan.documents.json_text import json_ready
from ikplan.errors import IkplanError

__all__ = ["Outcome", "failed", "row_of"]

OK = 200


class Outcome(NamedTuple):
    """The answer to one line.

    Attributes:
        status: HTTP status: 200, or that of the problem.
        document: The result or the problem document, JSON on one line.
        slug: Last part of the problem type; empty: there is a result.
    """

    status: int
    document: bytes
    slug: str = ""


def failed(error: IkplanError) -> Outcome:
    """Return the outcome of a line that ended in an error."""
    problem = json_ready(error.to_problem())
    document = json.dumps(problem, allow_nan=False).encode()
    return Outcome(int(problem["status"]), document, error.slug)


def row_of(index: int, outcome: Outcome) -> bytes:
    """Return the row of an outcome, JSON with a line break at its end.

    Args:
        index: Number of the line in the input, from 0; blank lines do not count.
        outcome: The answer.
    """
    name = b"problem" if outcome.slug else b"plan"
    return b'{"index": %d, "status": %d, "%b": %b}\n' % (
        index,
        outcome.status,
        name,
        outcome.document,
    )
