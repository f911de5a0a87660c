"""Compile every kernel of the service and check that plans can be made."""

import contextlib
import json
from pathlib import Path

from ikplan._jit import cache_folder
from ikplan.errors import Unreachable
from ikplan.ik.registry import solvers
from ikplan_api.workers.tasks import TaskInput, run_task, warm_up

EXAMPLES = Path(__file__).resolve().parents[1] / "examples"

if __name__ == "__main__":
    warm_up([solver.name for solver in solvers()])
    for file in sorted(EXAMPLES.glob("*.json")):
        request = json.loads(file.read_text())
        if "path" in request:
            # One of them asks for too much; repairs have kernels of their own.
            with contextlib.suppress(Unreachable):
                run_task("plan", TaskInput(json.dumps({**request, "budget_s": 3600}).encode()))
    kernels = len(list(cache_folder().rglob("*.nbc")))
    print(f"{kernels} kernels in {cache_folder()}")
