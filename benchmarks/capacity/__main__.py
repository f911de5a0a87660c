"""Capacity plan: ``python -m benchmarks.capacity``.

It draws service times that ``--measure N`` has measured on this machine, simulates a fleet under
loads of 50, 200 and 1,000 plans a second, and adds up a study of 10^8 poses: cores, memory,
storage, cost. What is assumed are options: the database's time a job, the price of a core, memory
of a worker.
"""

from __future__ import annotations

import argparse
import json
import sys

import numpy as np
from numpy.typing import NDArray

from benchmarks.capacity.measuring import FILE, measure
from benchmarks.capacity.simulation import Fleet, least_workers, simulate

_DAY = 86_400
_HOURS = 3_600_000.0
_GB = 1e9


def _loads(
    measured: dict[str, float], service: NDArray[np.float64], options: argparse.Namespace
) -> None:
    print(
        "| plans/s | workers | database cores | busy | p50 / p95 / p99 ms | memory GB "
        "| zstd a day GB | cost a day |"
    )
    print("|---|---|---|---|---|---|---|---|")
    half = options.database_ms / 2e3
    for rate in options.rates:
        cores = max(int(np.ceil(1.5 * rate * options.database_ms / 1e3)), 1)
        base = Fleet(1, cores, half, half)
        fleet, found = least_workers(rate, service, base, options.jobs, options.slack_ms / 1e3)
        memory = fleet.workers * options.worker_mb / 1e3
        stored = rate * _DAY * measured["plan_bytes_zstd"] / _GB
        cost = 24.0 * (fleet.workers + cores) * options.core_hour
        cost += stored * options.gb_month / 30.0 * options.keep_days
        latency = " / ".join(f"{1e3 * t:.0f}" for t in (found.p50, found.p95, found.p99))
        print(
            f"| {rate:g} | {fleet.workers} | {cores} | {100 * found.busy:.0f} % | "
            f"{latency} | {memory:.1f} | "
            f"{stored:.0f} | {cost:.0f} $ |"
        )
    rate = max(options.rates)
    few = max(int(0.8 * rate * options.database_ms / 1e3), 1)
    workers = int(np.ceil(1.5 * rate * float(service.mean())))
    found = simulate(Fleet(workers, few, half, half), rate, service, options.jobs)
    print(
        f"\nwith {few} database cores (load {rate * options.database_ms / 1e3 / few:.2f}) "
        f"{rate:g} plans/s end after {1e3 * found.p50:.0f} / {1e3 * found.p95:.0f} / "
        f"{1e3 * found.p99:.0f} ms: the database is full, and the queue grows"
    )


def _study(measured: dict[str, float], options: argparse.Namespace) -> None:
    print("\n| poses | reached | core hours | on 64 cores | rows, zstd GB | cost |")
    print("|---|---|---|---|---|---|")
    for share in (0.9, 0.5, 0.1):
        each = share * measured["pose_reached_ms"] + (1 - share) * measured["pose_refused_ms"]
        hours = options.poses * each / _HOURS
        stored = options.poses * options.row_bytes / _GB
        print(
            f"| {options.poses:.0e} | {100 * share:.0f} % | {hours:.1f} | "
            f"{60 * hours / 64:.0f} min | {stored:.1f} | {hours * options.core_hour:.2f} $ |"
        )


def main() -> int:
    """Measure or simulate, and print."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument(
        "--measure", type=int, metavar="N", help="measure N plans first, and keep them"
    )
    parser.add_argument("--rates", type=float, nargs="+", default=[50.0, 200.0, 1000.0])
    parser.add_argument("--jobs", type=int, default=40_000, help="jobs of each simulation")
    parser.add_argument("--slack-ms", type=float, default=50.0, help="queueing allowed at p99")
    parser.add_argument("--database-ms", type=float, default=2.5, help="database core time a job")
    parser.add_argument("--worker-mb", type=float, default=100.0, help="memory of a worker")
    parser.add_argument("--core-hour", type=float, default=0.04, help="price of a core hour [$]")
    parser.add_argument("--gb-month", type=float, default=0.023, help="price of a GB month [$]")
    parser.add_argument("--keep-days", type=float, default=30.0, help="how long results are kept")
    parser.add_argument("--poses", type=float, default=1e8, help="poses of the study")
    parser.add_argument("--row-bytes", type=float, default=60.0, help="bytes of a row in a shard")
    options = parser.parse_args()
    if options.measure is not None:
        FILE.write_text(json.dumps(measure(options.measure), indent=None) + "\n", encoding="utf-8")
    measured = json.loads(FILE.read_text())
    service = np.array(measured["plan_ms"]) / 1e3
    print(
        f"service times: {len(service)} plans, mean {1e3 * service.mean():.1f} ms, median "
        f"{1e3 * np.median(service):.1f}, p99 {1e3 * np.percentile(service, 99):.1f} ms; "
        f"{measured['plan_bytes'] / 1e3:.0f} kB of JSON, "
        f"{measured['plan_bytes_zstd'] / 1e3:.0f} kB zstd; a pose "
        f"{measured['pose_reached_ms']:.3f} ms reached, {measured['pose_refused_ms']:.3f} ms not\n"
    )
    _loads(measured, service, options)
    _study(measured, options)
    return 0


if __name__ == "__main__":
    sys.exit(main())
