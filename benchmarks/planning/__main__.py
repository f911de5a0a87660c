"""Print how well paths are planned: ``python -m benchmarks.planning [PART ...] [--share S]``.

With ``--seed`` studies of random paths draw others.
"""

from __future__ import annotations

import os

for _name in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "NUMBA_NUM_THREADS"):
    os.environ.setdefault(_name, "1")

import argparse  # noqa: E402 - the threads are counted when NumPy is imported
from collections.abc import Callable, Iterator  # noqa: E402

from benchmarks.planning import (  # noqa: E402
    e9,
    helices,
    lines,
    nearest,
    refusals,
    scaling,
    scattered,
    singular,
    turns,
)
from benchmarks.speed.measure import Figure  # noqa: E402

Names = list[str] | None
"""Names of robots; None: all of a study."""

PARTS: dict[str, tuple[str, Callable[[float, int, Names], Iterator[Figure]]]] = {
    "helices": (
        "five helices of the iiwa: best known length, waypoints exact",
        lambda share, seed, names: helices.figures(max(1, round(10 * share))),
    ),
    "nearest": (
        "nearest solution to 500 random poses, from mid-range",
        lambda share, seed, names: nearest.figures(max(10, round(500 * share))),
    ),
    "lines": (
        "200 random lines of 200 mm of the UR5",
        lambda share, seed, names: lines.figures(max(5, round(200 * share))),
    ),
    "free": (
        "the same lines from any branch",
        lambda share, seed, names: lines.free_figures(max(5, round(200 * share))),
    ),
    "singular": (
        "lines of 160 mm aimed at singularities, within the default tolerance",
        lambda share, seed, names: singular.figures(max(6, round(200 * share)), seed, names),
    ),
    "refusals": (
        "1,000 random requests: what is refused, and the repairs",
        lambda share, seed, names: refusals.figures(max(20, round(1000 * share)), seed, names),
    ),
    "turns": (
        "arcs of 1 to 2.5 turns of five arms, from any branch",
        lambda share, seed, names: turns.figures(max(4, round(60 * share)), seed, names),
    ),
    "scattered": (
        "40 paths of ten waypoints anywhere",
        lambda share, seed, names: scattered.figures(max(4, round(40 * share))),
    ),
    "scaling": ("more and more waypoints", lambda share, seed, names: scaling.figures(share)),
    "e9": (
        "trajectories of the EOD arm",
        lambda share, seed, names: e9.figures(e9.NAMES[: max(1, round(share * len(e9.NAMES)))]),
    ),
}


def main() -> None:
    """Print a table for each part."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks.planning", description=__doc__)
    parser.add_argument("parts", nargs="*", metavar="PART", help=", ".join(PARTS))
    parser.add_argument("--share", type=float, default=1.0, help="share of the effort, in (0, 1]")
    parser.add_argument("--seed", type=int, default=15, help="of singular, refusals and turns")
    parser.add_argument("--robots", nargs="*", help="of singular, refusals and turns; absent: all")
    arguments = parser.parse_args()
    unknown = [name for name in arguments.parts if name not in PARTS]
    if unknown or not 0.0 < arguments.share <= 1.0:
        parser.error(f"parts are {', '.join(PARTS)}; share is in (0, 1]")
    for name in arguments.parts or PARTS:
        title, figures = PARTS[name]
        print(f"{name}: {title}", flush=True)
        for figure in figures(arguments.share, arguments.seed, arguments.robots):
            print(figure, flush=True)


if __name__ == "__main__":
    main()
