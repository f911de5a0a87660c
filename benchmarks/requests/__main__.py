"""Ask for random plans and timings until the time is up: ``python -m benchmarks.requests``.

Ends with exit code 1 if a request ended in anything but a certified plan or a refusal of its own
kind. Those, and the slow ones, are written to a folder, to be asked again with
``ikplan plan FILE``, or with ``--only NUMBER``.
"""

from __future__ import annotations

import argparse
import collections
import itertools
import json
import statistics
import sys
import time
import traceback
from pathlib import Path
from typing import Any

import ikplan
from benchmarks.requests.between import as_polynomial, share_between
from benchmarks.requests.drawing import KINDS, draw
from ikplan.errors import CertificateViolated, IkplanError
from ikplan.pipeline.retime import time_request
from ikplan.plans.plan import Plan
from ikplan.robots import robot_names


def asked(kind: str, request: dict[str, Any]) -> Plan:
    """Make the plan or the timing of a request."""
    return time_request(request) if kind == "timing" else ikplan.plan(request)


def outcome(kind: str, request: dict[str, Any], finer: int) -> tuple[str, str, float]:
    """Return how a request ended, what it says, and the seconds of the timing stage.

    Args:
        kind: The kind of the request.
        request: The request.
        finer: How many times denser than its samples a plan is looked at; 0: not at all.

    Returns:
        "plan", the class of a refusal, or "FAULT ..."; words; seconds.
    """
    try:
        plan = asked(kind, request)
        share = share_between(request, plan, finer) if finer and kind != "timing" else 0.0
    except CertificateViolated as error:
        return "FAULT CertificateViolated", error.detail, 0.0
    except IkplanError as error:
        return type(error).__name__, str(error), 0.0
    except Exception as error:  # anything else is what is looked for
        return f"FAULT {type(error).__name__}", traceback.format_exc(), 0.0
    if share > 1.0:
        return "FAULT off its path", f"{share:.4g} of the tolerance between samples", 0.0
    return "plan", "", plan.stats.seconds.get("timing", 0.0)


def main() -> int:
    """Ask, count, and write down what must not be."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--seed", type=int, default=0, help="which series of requests")
    parser.add_argument("--seconds", type=float, default=60.0, help="how long to ask")
    parser.add_argument("--first", type=int, default=0, help="number of the first request")
    parser.add_argument("--only", type=int, help="number of the one request to ask")
    parser.add_argument("--kind", choices=(*KINDS, "all"), default="all")
    parser.add_argument("--all-robots", action="store_true", help="not the reference robots alone")
    parser.add_argument("--slow", type=float, default=5.0, help="processor seconds that are long")
    parser.add_argument("--budget", type=float, default=40.0, help="budget_s of each request")
    parser.add_argument("--tell", nargs="*", default=[], help="refusals to print, by class")
    parser.add_argument(
        "--between",
        type=int,
        default=0,
        metavar="N",
        help="look at plans N times denser than their samples too",
    )
    parser.add_argument("--out", type=Path, default=Path("out/requests"))
    options = parser.parse_args()
    robots = robot_names() if options.all_robots else None
    kinds = KINDS if options.kind == "all" else (options.kind,)
    numbers = itertools.count(options.first) if options.only is None else [options.only]
    counts: collections.Counter[str] = collections.Counter()
    seconds, timing_seconds, faults = [], [], 0
    end = time.monotonic() + options.seconds
    for number, kind in ((number, kind) for number in numbers for kind in kinds):
        if time.monotonic() > end:
            break
        request = draw(kind, options.seed, number, options.budget, robots)
        if options.between and kind != "timing":
            request = as_polynomial(request)
        begin = time.process_time()
        found, words, timing = outcome(kind, request, options.between)
        took = time.process_time() - begin
        counts[f"{kind}: {found}"] += 1
        seconds.append(took)
        if found == "plan":
            timing_seconds.append(timing)
        fault, slow = found.startswith("FAULT"), took > options.slow
        faults += fault
        if found in options.tell:
            print(f"{kind} {number}: {found}, {words}", flush=True)
        if fault or slow:
            options.out.mkdir(parents=True, exist_ok=True)
            file = options.out / f"{kind}_{options.seed}_{number}.json"
            file.write_text(json.dumps(request))
            print(f"{file}: {found}, {took:.1f} s of the processor, {timing:.1f} s timing")
            print(words, end="\n" if words else "", flush=True)
    for name, count in sorted(counts.items()):
        print(f"{count:6d}  {name}")
    if seconds:
        print(f"processor seconds a request: median {statistics.median(seconds):.2f}, ", end="")
        print(f"worst {max(seconds):.2f}")
    if timing_seconds:
        print(
            f"seconds of the timing stage: median {statistics.median(timing_seconds):.2f}, ", end=""
        )
        print(f"worst {max(timing_seconds):.2f}")
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(main())
