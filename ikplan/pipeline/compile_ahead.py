"""A helper that compiles kernels beside a process that waits for them.

Started as a module, with kind of the requests, name of the solver, 1 for limits of jerks, number of
this helper and how many there are. It runs small requests of the kind, those first that use what a
request uses last, so that it meets the process that it helps in the middle. Kernels that are being
compiled elsewhere are waited for, not compiled twice.
"""

from __future__ import annotations

import contextlib
import os
import sys
from collections.abc import Callable, Mapping, Sequence
from typing import Any

from ikplan._jit import cache_folder
from ikplan._kernels.turns import Turn
from ikplan.errors import IkplanError
from ikplan.pipeline.plan import plan
from ikplan.pipeline.poses import solve_ik_request
from ikplan.pipeline.retime import time_request
from ikplan.pipeline.warm_up import small_requests

__all__ = ["main"]

Run = Callable[[Mapping[str, Any]], object]


def main(arguments: Sequence[str]) -> None:
    """Compile what requests of a kind use.

    Args:
        arguments: Kind of the requests, name of the solver, 1 for limits of jerks, the number of
            this helper and how many there are.
    """
    kind, method, jerk, number, count = arguments
    try:
        turn = Turn(cache_folder() / f"helper-{number}.lock")
    except OSError:
        return  # another process has its helpers already, or nothing can be kept
    try:
        work = _work(kind, method, jerk == "1")
        first = len(work) * int(number) // int(count)
        for run, request in (*work[first:], *work[:first]):
            with contextlib.suppress(IkplanError):
                run(request)
            if os.getppid() == 1:
                return  # nobody waits any more
    finally:
        turn.give_back()


def _work(kind: str, method: str, jerk: bool) -> list[tuple[Run, dict[str, Any]]]:
    """Small requests, and what runs them."""
    if kind == "ik":
        return [(solve_ik_request, request) for request in small_requests("ik", method)]
    timings = small_requests("time", jerk=jerk)
    if kind == "time":
        return [(time_request, request) for request in timings]
    # Timing, certificate and the proof of no contact, which come last in a plan.
    checked: dict[str, Any] = {"scene": {"self_collision": True}}
    return [
        *((time_request, {**request, **checked}) for request in timings),
        *((plan, request) for request in small_requests("plan", method)[:1]),
    ]


if __name__ == "__main__":
    main(sys.argv[1:])
