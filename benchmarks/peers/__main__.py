"""Print ikplan beside its peers: ``python -m benchmarks.peers``.

The packages are in the extra ``peers``; one that is not installed, or has no build for this
platform, is left out. All of it runs in one process and one thread, and the contestants take turns:
trust the ratios, not the times. A ratio below 1 is a loss of ikplan's.
"""

from __future__ import annotations

import os

for _name in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "NUMBA_NUM_THREADS"):
    os.environ[_name] = "1"

import argparse  # noqa: E402 - the threads are counted when NumPy is imported
import sys  # noqa: E402

from benchmarks.peers import lines, poses, retiming  # noqa: E402
from benchmarks.speed.measure import FkClock  # noqa: E402
from ikplan import load_robot  # noqa: E402

SECTIONS = {"poses": poses.run, "retiming": retiming.run, "lines": lines.run}


def main() -> int:
    """Run the sections asked for and print one table, as Markdown."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks.peers", description=__doc__)
    parser.add_argument("sections", nargs="*", metavar="SECTION", help=", ".join(SECTIONS))
    parser.add_argument("--effort", type=float, default=1.0, help="share of the inputs, in (0, 1]")
    options = parser.parse_args()
    unknown = set(options.sections) - set(SECTIONS)
    if unknown or not 0.0 < options.effort <= 1.0:
        parser.error(f"no section {unknown}" if unknown else "the effort is in (0, 1]")
    clock = FkClock(load_robot("ur5"))
    print("| work | library | time, x FK | times ikplan's | |")
    print("| --- | --- | --- | --- | --- |", flush=True)
    for name in options.sections or SECTIONS:
        clock.tick()
        rows = SECTIONS[name](options.effort)
        clock.tick()
        for row in rows:
            ratio = row.seconds / clock.seconds
            print(
                f"| {row.work} | {row.name} | {ratio:,.0f} | {row.beside:.2f} | {row.note} |",
                flush=True,
            )
    return 0


if __name__ == "__main__":
    sys.exit(main())
