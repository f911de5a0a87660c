"""Print how well paths are planned: ``python -m benchmarks.planning [PART ...] [--share S]``.

With ``--seed`` studies of random paths draw others.
"""

from __future__ import annotations

import os

for _name in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "NUMBA_NUM_THREADS"):
    os.environ.setdefault(_name, "1")

import argparse  # noqa: E402 - the threads are counted when NumPy is imported
from collections.abc import Callable, Iterator  # noqa: E402
from typing import NamedTuple  # noqa: E402

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


class Asked(NamedTuple):
    """What the caller asks a part for; those without random robots use the share alone."""

    share: float
    seed: int
    robots: list[str] | None


PARTS: dict[str, tuple[str, Callable[[Asked], Iterator[Figure]]]] = {
    "helices": (
        "five helices of the iiwa: best known length, waypoints exact",
        lambda asked: helices.figures(max(1, round(10 * asked.share))),
    ),
    "nearest": (
        "nearest solution to 500 random poses, from mid-range",
        lambda asked: nearest.figures(max(10, round(500 * asked.share))),
    ),
    "lines": (
        "200 random lines of 200 mm of the UR5",
        lambda asked: lines.figures(max(5, round(200 * asked.share))),
    ),
    "free": (
        "the same lines from any branch",
        lambda asked: lines.free_figures(max(5, round(200 * asked.share))),
    ),
    "singular": (
        "lines of 160 mm aimed at singularities, within the default tolerance",
        lambda asked: singular.figures(max(6, round(200 * asked.share)), asked.seed, asked.robots),
    ),
    "refusals": (
        "1,000 random requests: what is refused, and the repairs",
        lambda asked: refusals.figures(
            max(20, round(1000 * asked.share)), asked.seed, asked.robots
        ),
    ),
    "turns": (
        "arcs of 1 to 2.5 turns of five arms, from any branch",
        lambda asked: turns.figures(max(4, round(60 * asked.share)), asked.seed, asked.robots),
    ),
    "scattered": (
        "40 paths of ten waypoints anywhere",
        lambda asked: scattered.figures(max(4, round(40 * asked.share))),
    ),
    "scaling": ("more and more waypoints", lambda asked: scaling.figures(asked.share)),
    "e9": (
        "trajectories of the EOD arm",
        lambda asked: e9.figures(e9.NAMES[: max(1, round(asked.share * len(e9.NAMES)))]),
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
    asked = Asked(arguments.share, arguments.seed, arguments.robots)
    for name in arguments.parts or PARTS:
        title, figures = PARTS[name]
        print(f"{name}: {title}", flush=True)
        for figure in figures(asked):
            print(figure, flush=True)


if __name__ == "__main__":
    main()
