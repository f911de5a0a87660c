"""Measure several replicas on one PostgreSQL, and the SQLite file at its bounds.

``python -m benchmarks.fleet faults`` kills replicas and workers at random, ``restart`` restarts the
database, ``events`` times events at the other replica, ``sqlite`` times puts at a full file.
"""

from __future__ import annotations

import argparse
import functools
import tempfile
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

from benchmarks.fleet.events import event_latency
from benchmarks.fleet.faults import Faults, jobs_with_faults
from benchmarks.fleet.postgres import Postgres, postgres
from benchmarks.fleet.replica import Replica
from benchmarks.fleet.sqlite import sqlite_puts

_CHECKS = ("faults", "restart", "events", "sqlite")


def main(argv: Sequence[str] | None = None) -> None:
    """Run the chosen checks."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks.fleet", description=__doc__)
    parser.add_argument("checks", nargs="*", choices=_CHECKS, default=[], metavar="CHECK")
    parser.add_argument("--jobs", type=int, default=200)
    parser.add_argument("--waypoints", type=int, default=40)
    parser.add_argument("--lease", type=float, default=2.0, help="lease of a claim [s]")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--plans", type=int, default=100_000, help="plans of the SQLite file")
    options = parser.parse_args(argv)
    checks = options.checks or _CHECKS
    if "sqlite" in checks:
        _tell("sqlite", sqlite_puts(options.plans, 20_000, 2_000))
    if set(checks) == {"sqlite"}:
        return
    runs: list[Callable[[str, list[Replica]], None]] = []
    with tempfile.TemporaryDirectory() as folder, postgres() as server:
        for name, faults in (
            ("faults", Faults()),
            ("restart", Faults(replicas=0, workers=0, halts=0, restarts=2)),
        ):
            if name in checks:
                runs.append(_harmed(server, name, faults, options))
        if "events" in checks:
            runs.append(functools.partial(_events, options))
        _with_replicas(server, Path(folder), options, runs)


def _events(options: argparse.Namespace, database: str, replicas: list[Replica]) -> None:
    for replica in replicas:
        replica.wait_until_ready()
    found = event_latency(database, replicas, jobs=options.jobs, waypoints=options.waypoints)
    _tell("events", found)


def _harmed(
    server: Postgres, name: str, faults: Faults, options: argparse.Namespace
) -> Callable[[str, list[Replica]], None]:
    def run(database: str, replicas: list[Replica]) -> None:
        found = jobs_with_faults(
            server,
            database,
            replicas,
            jobs=options.jobs,
            waypoints=options.waypoints,
            lease_s=options.lease,
            faults=faults,
            seed=options.seed,
        )
        _tell(name, found)

    return run


def _with_replicas(
    server: Postgres,
    folder: Path,
    options: argparse.Namespace,
    runs: Sequence[Callable[[str, list[Replica]], None]],
) -> None:
    database = server.new_database()
    replicas = [Replica(database, folder / f"replica-{i}.log", options.lease) for i in range(2)]
    try:
        for replica in replicas:
            replica.start()
        for replica in replicas:
            replica.wait_until_ready()
        for run in runs:
            run(database, replicas)
    finally:
        for replica in replicas:
            replica.kill()


def _tell(name: str, figures: dict[str, Any]) -> None:
    print(name)
    for title, value in figures.items():
        print(f"  {title}: {value}", flush=True)


if __name__ == "__main__":
    main()
