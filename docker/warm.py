"""Compile every kernel of the service, check that plans can be made, and pack the kernels.

``python docker/warm.py FILE``: the file is found within the package, ``ikplan/kernels.pack``.
"""

import contextlib
import json
import sys
from pathlib import Path

from ikplan._jit import cache_folder
from ikplan._kernels.pack import write_pack
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
    kernels = write_pack(cache_folder(), Path(sys.argv[1]))
    print(f"{kernels} kernels in {sys.argv[1]}")
