"""Print how fast it is, as ratios measured in one run: ``python -m benchmarks.speed``.

Every ratio is against one ``pinocchio.framesForwardKinematics`` call of the same robot in the same
run, in processor time of one thread; medians, taken from the least disturbed moments of both.
A further section is one module with a ``SECTION`` and its name in ``SECTIONS``.
"""

from __future__ import annotations

import os

for _name in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "NUMBA_NUM_THREADS"):
    os.environ[_name] = "1"

import argparse  # noqa: E402 - the threads are counted when NumPy is imported
import importlib  # noqa: E402
import json  # noqa: E402
import platform  # noqa: E402
import sys  # noqa: E402
from pathlib import Path  # noqa: E402

from benchmarks.speed.measure import FkClock, Section  # noqa: E402
from ikplan import load_robot  # noqa: E402

SECTIONS = (
    "poses",
    "branches",
    "pose_batches",
    "population",
    "helix",
    "lines",
    "paths",
    "scaling",
    "searches",
)


def load_sections() -> list[Section]:
    """Import every section."""
    return [importlib.import_module(f"benchmarks.speed.{name}").SECTION for name in SECTIONS]


def main(arguments: list[str] | None = None) -> int:
    """Run the sections asked for; 1 where a figure is not reached."""
    sections = {section.name: section for section in load_sections()}
    parser = argparse.ArgumentParser(prog="python -m benchmarks.speed", description=__doc__)
    parser.add_argument("sections", nargs="*", metavar="SECTION", help=", ".join(sections))
    parser.add_argument("--effort", type=float, default=1.0, help="share of the repeats, in (0, 1]")
    parser.add_argument("--json", type=Path, help="write the figures to this file as well")
    options = parser.parse_args(arguments)
    unknown = set(options.sections) - set(sections)
    if unknown or not 0.0 < options.effort <= 1.0:
        parser.error(f"no section {unknown}" if unknown else "the effort is in (0, 1]")
    clock = FkClock(load_robot("iiwa14"))
    clock.tick()
    fk = clock.seconds
    print(f"{platform.processor() or platform.machine()}, Python {platform.python_version()}")
    print(f"one framesForwardKinematics call on the iiwa from Python: {fk * 1e6:.2f} us")
    results = {}
    for name in options.sections or sections:
        print(f"\n{name}: {sections[name].title}", flush=True)
        figures = sections[name].run(options.effort)
        for figure in figures:
            print(figure, flush=True)
        results[name] = [figure.as_row() for figure in figures]
    if options.json:
        options.json.write_text(json.dumps({"fk_us": fk * 1e6, "sections": results}, indent=1))
    missed = [row for rows in results.values() for row in rows if not row["good"]]
    print(f"\n{len(missed)} figure(s) not reached" if missed else "\nevery figure is reached")
    return 1 if missed else 0


if __name__ == "__main__":
    sys.exit(main())
