"""Plans without checks for contact, beside an earlier checkout of the project, in turns.

Each checkout plans in a process of its own. Requests are asked of both by turns, so that a load on
the machine meets both; processor time counts.
"""

from __future__ import annotations

import json
import os
import subprocess
import sys
from dataclasses import dataclass
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

__all__ = ["Beside", "beside_before"]

_ROOT = Path(__file__).parents[2]
_WORKER = """
import json, sys, time
import ikplan
for line in sys.stdin:
    request = json.loads(line)
    begin = time.process_time()
    try:
        plan = ikplan.plan(request)
    except ikplan.IkplanError:
        plan = None
    spent = time.process_time() - begin
    same = None if plan is None else [plan.duration, len(plan.time)]
    print("answer", json.dumps([spent, same]), flush=True)
"""


class Beside(NamedTuple):
    """Median processor times of one request.

    Attributes:
        name: Of the request.
        before: In the earlier checkout [ms].
        now: In this one [ms].
    """

    name: str
    before: float
    now: float


@dataclass
class _Planner:
    """A process that plans with the code of one checkout."""

    process: subprocess.Popen[str]

    @classmethod
    def of(cls, checkout: Path) -> _Planner:
        threads = {"OPENBLAS_NUM_THREADS": "1", "NUMBA_NUM_THREADS": "1"}
        process = subprocess.Popen(
            [sys.executable, "-c", _WORKER],
            cwd=checkout,
            env={**os.environ, **threads, "PYTHONPATH": str(checkout)},
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            text=True,
        )
        return cls(process)

    def plan(self, request: dict[str, Any]) -> tuple[float, bool]:
        """Processor time of one plan [s], and whether there is one."""
        pipe, answers = self.process.stdin, self.process.stdout
        assert pipe is not None
        assert answers is not None
        pipe.write(json.dumps(request) + "\n")
        pipe.flush()
        for line in answers:
            word, _, answer = line.partition(" ")
            if word == "answer":
                spent, plan = json.loads(answer)
                return float(spent), plan is not None
        raise RuntimeError("a planner ended without an answer")


def beside_before(checkout: Path, repeats: int) -> list[Beside]:
    """Plan the vectors and examples that both can, with no check for contact.

    Args:
        checkout: Folder of the earlier checkout, which knows no ``scene``.
        repeats: Plans of each request in each checkout; the first of all are not counted.
    """
    before, now = _Planner.of(checkout), _Planner.of(_ROOT)
    found = []
    for file in sorted((checkout / "tests/vectors/planning").glob("*.json")):
        request = json.loads(file.read_text())["request"]
        off = {**request, "scene": {"self_collision": False}}
        if not (before.plan(request)[1] and now.plan(off)[1]):
            continue
        spent = []
        for k in range(repeats):
            if k % 2:
                spent.append((before.plan(request)[0], now.plan(off)[0]))
            else:
                spent.append((now.plan(off)[0], before.plan(request)[0])[::-1])
        old, new = 1e3 * np.median(spent, axis=0)
        found.append(Beside(file.stem, float(old), float(new)))
    for planner in (before, now):
        planner.process.terminate()
        planner.process.wait()
    return found
