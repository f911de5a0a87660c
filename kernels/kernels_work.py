"""What ``build.py`` has done in processes of their own."""

from __future__ import annotations

import contextlib
import json
from pathlib import Path
from typing import Any

from ikplan.errors import Unreachable
from ikplan.ik.registry import solvers
from ikplan.pipeline.plan import plan
from ikplan.pipeline.pose_batch.request import solve_ik_batch_request
from ikplan.pipeline.poses import solve_ik_request
from ikplan.pipeline.retime import time_request
from ikplan.pipeline.warm_up import warm_up

EXAMPLES = Path(__file__).resolve().parents[1] / "examples"


def _mine(items: list[Any], number: int, count: int) -> list[Any]:
    """The items in an order of this process: its own part first."""
    first = len(items) * number // count
    return [*items[first:], *items[:first]]


def _plan_examples(number: int, count: int) -> None:
    for file in _mine(sorted(EXAMPLES.glob("*.json")), number, count):
        request = json.loads(file.read_text())
        if "path" in request:
            # One of them asks for too much; repairs have kernels of their own.
            with contextlib.suppress(Unreachable):
                plan({**request, "budget_s": 3600})


def compile_part(part: str) -> None:
    """Compile the kernels of every request, those of this process's part first."""
    number, count, names = json.loads(part)
    names = names or [solver.name for solver in solvers()]
    works = [("time", None), ("ik-batch", None)]
    works += [(kind, name) for name in names for kind in ("ik", "plan")]
    for kind, name in _mine(works, number, count):
        if kind == "time":
            warm_up(time_request, "time", jerk=True)
        elif kind == "ik-batch":
            warm_up(solve_ik_batch_request, "ik-batch", "lm")
        elif kind == "ik":
            warm_up(solve_ik_request, "ik", name)
        else:
            warm_up(plan, "plan", name, jerk=name == "ik-ba")
    _plan_examples(number, count)


def pack(arguments: str) -> None:
    """Write what is compiled into one file."""
    from ikplan._kernels.pack import write_pack

    cache, file = json.loads(arguments)
    count = write_pack(Path(cache) / "kernels", Path(file))
    print(f"{count} kernels")


def check(part: str) -> None:
    """Do all of it again; a kernel that is not shipped is announced."""
    compile_part(part)
