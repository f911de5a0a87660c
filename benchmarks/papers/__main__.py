"""Run experiments and write their report."""

from __future__ import annotations

import argparse
import os
import sys
import time
from pathlib import Path

NAMES = ["E1", "E2", "E3", "E4", "E5", "E6", "E7", "E8", "E9", "D", "S1", "S2"]


def main() -> None:
    """Run what is asked for."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks.papers", description=__doc__)
    parser.add_argument(
        "experiments", nargs="*", metavar="NAME", help=f"of {', '.join(NAMES)}; default: all"
    )
    parser.add_argument("--runs", type=int, default=20, help="runs of every series (default 20)")
    parser.add_argument(
        "--seed", type=int, default=0, help="seed of all random numbers (default 0)"
    )
    parser.add_argument("--rows", action="store_true", help="make the rows only, no report")
    parser.add_argument("--jobs", type=int, default=1, help="workers (default 1)")
    parser.add_argument("--on", help="local, ray or ray=ADDRESS; absent: local processes")
    parser.add_argument(
        "--thin", type=int, default=1, help="use every THIN-th target of E7, E8 and E9 only"
    )
    parser.add_argument("--out", type=Path, default=Path("out/papers"), help="folder of the rows")
    parser.add_argument(
        "--report", type=Path, default=None, help="Markdown to be written (default OUT/REPORT.md)"
    )
    options = parser.parse_args()
    names = options.experiments or NAMES
    unknown = sorted(set(names) - set(NAMES))
    if unknown:
        parser.error(f"no experiment {', '.join(unknown)}; there are {', '.join(NAMES)}")
    if min(options.runs, options.jobs, options.thin) < 1:
        parser.error("--runs, --jobs and --thin are at least 1")
    for variable in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "NUMBA_NUM_THREADS"):
        os.environ.setdefault(variable, "1")
    # Only now: the threads are counted when NumPy is imported.
    from benchmarks.papers.report import Sections
    from benchmarks.papers.runner import find_experiment, run_experiment

    sections = Sections(options.report or options.out / "REPORT.md", options.out / "sections")
    for name in names:
        begin = time.perf_counter()
        results = run_experiment(
            name, options.runs, options.jobs, options.thin, options.out, options.on, options.seed
        )
        if options.rows:
            print(f"{name} done in {time.perf_counter() - begin:.0f} s", file=sys.stderr)
            continue
        sections.write(find_experiment(name), results, options.runs, options.thin, options.seed)
        print(f"{name} done in {time.perf_counter() - begin:.0f} s", file=sys.stderr)
    if options.rows:
        return
    sections.join(1.0 if options.thin == 1 else 0.2)
    print(sections.report)


if __name__ == "__main__":
    main()
