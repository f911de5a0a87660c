"""Random plans of arms as their controllers get them: no rate, no jerk in the request."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Literal

import ikplan
from benchmarks.requests.drawing import draw
from ikplan.errors import CertificateViolated, IkplanError
from ikplan.pipeline.retime import time_request
from ikplan.plans.plan import Plan

__all__ = ["random_plans"]

Kind = Literal["plan", "timing"]
_KINDS: tuple[Kind, ...] = ("plan", "timing")


def random_plans(
    robots: Sequence[str], seed: int, budget_s: float = 20.0, kinds: Sequence[Kind] = _KINDS
) -> Iterator[Plan]:
    """Yield plans and timings of random requests, refused ones left out, without end.

    A broken certificate is no refusal: it is raised.

    Args:
        robots: Names of the robots to draw from.
        seed: Which series.
        budget_s: Time budget of each request [s].
        kinds: Plans of paths, timings of joint paths, or both by turns.
    """
    number = 0
    while True:
        kind = kinds[number % len(kinds)]
        request = draw(kind, seed, number // len(kinds), budget_s, robots)
        number += 1
        request.pop("sampling", None)
        request["limits"].pop("jerk", None)
        try:
            yield time_request(request) if kind == "timing" else ikplan.plan(request)
        except CertificateViolated:
            raise
        except IkplanError:
            continue
