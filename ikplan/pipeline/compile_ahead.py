"""A helper that compiles kernels: ``python -m ikplan.pipeline.compile_ahead KIND METHOD JERK N M``.

It runs the small requests of a warm-up from their other end, so that it meets the process that it
helps in the middle. Kernels that are being compiled elsewhere are waited for, not compiled twice.
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
from ikplan.pipeline.warm_up import small_requests, warming

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
            with contextlib.suppress(IkplanError), warming():
                run(request)
            if os.getppid() == 1:
                return  # nobody waits any more
    finally:
        turn.give_back()


def _work(kind: str, method: str, jerk: bool) -> list[tuple[Run, dict[str, Any]]]:
    """Small requests and what runs them, those first that are far from where a warm-up begins."""
    if kind == "ik":
        return [(solve_ik_request, r) for r in reversed(small_requests("ik", method))]
    flags = (True, False) if jerk else (False,)
    work: list[tuple[Run, dict[str, Any]]] = [
        (time_request, r) for flag in flags for r in small_requests("time", method, jerk=flag)
    ]
    if kind == "plan":
        work += [(plan, r) for r in reversed(small_requests("plan", method))]
    return work


if __name__ == "__main__":
    main(sys.argv[1:])
