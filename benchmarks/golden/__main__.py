"""Digests of trajectories: ``python -m benchmarks.golden check`` or ``write``.

``write`` plans every case and writes ``benchmarks/golden/PROCESSOR.json``; ``check`` plans them
again and names each whose outcome is another. Compiled kernels and linear algebra round
differently on another processor, so that each kind has a list of its own: on one without, write it
from a checkout that is known to be good, then check the other against it.
"""

from __future__ import annotations

import argparse
import hashlib
import json
import sys
from pathlib import Path
from typing import Any

import numpy as np
from llvmlite import binding

import ikplan
from benchmarks.golden.cases import BUDGET_S, golden_cases
from ikplan.errors import IkplanError
from ikplan.joint_path import JointPath
from ikplan.limits import JointLimits
from ikplan.pipeline.retime import time_request
from ikplan.timing import sample, time_joint_path

LIST = Path(__file__).with_name(f"{binding.get_host_cpu_name()}.json")


def _digest(*arrays: Any) -> str:
    found = hashlib.sha256()
    for array in arrays:
        values = np.ascontiguousarray(array, dtype=np.float64)
        found.update(repr(values.shape).encode())
        found.update(values.tobytes())
    return found.hexdigest()[:32]


def _timed(vector: dict[str, Any]) -> str:
    fields = vector["limits"]
    names = tuple(f"joint{i}" for i in range(len(fields["lower"])))
    limits = JointLimits(joint_names=names, **fields)
    waypoints = [[float(value) for value in row] for row in vector["waypoints"]]
    path = JointPath.through(waypoints, limits, rest_at=vector.get("rest_at", ()))
    samples = sample(time_joint_path(path, limits), vector.get("rate_hz", 1000.0))
    return _digest(samples.time, samples.q, samples.dq, samples.ddq)


def outcome(kind: str, document: dict[str, Any]) -> str:
    """Return the digest of the trajectory of a case, or the name of its refusal."""
    try:
        if kind == "joint path":
            return _timed(document)
        request = {**document, "budget_s": BUDGET_S}
        if kind == "plan":
            request["scene"] = {"self_collision": False}
        plan = time_request(request) if kind == "timing" else ikplan.plan(request)
    except IkplanError as error:
        return type(error).__name__
    except Exception as error:  # a fault is an outcome too: the list says what there was
        return f"fault: {type(error).__name__}"
    t = plan.trajectory
    return _digest(t.time, t.q, t.dq, t.ddq, plan.waypoints.time)


def main() -> int:
    """Write the list, or hold today's outcomes to it."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("action", choices=("check", "write"))
    parser.add_argument("--only", default="", help="cases whose name contains this")
    options = parser.parse_args()
    found = {}
    if options.action == "check" and not LIST.exists():
        print(f"no list for this processor: {LIST.name}")
        return 2
    known = json.loads(LIST.read_text())["cases"] if options.action == "check" else {}
    changed = unknown = 0
    for name, kind, document in golden_cases():
        if options.only not in name:
            continue
        found[name] = outcome(kind, document)
        if options.action == "write" or known.get(name) == found[name]:
            continue
        if name in known:
            changed += 1
            print(f"{name}: {known[name]} is now {found[name]}", flush=True)
        else:
            unknown += 1
    if options.action == "write":
        head = {"command": "python -m benchmarks.golden write", "processor": LIST.stem}
        LIST.write_text(json.dumps({**head, "cases": found}, indent=1) + "\n")
    print(f"{len(found)} cases, {changed} changed, {unknown} not in the list of this processor")
    return 1 if changed else 0


if __name__ == "__main__":
    sys.exit(main())
