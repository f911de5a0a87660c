"""How time and memory of moves grow with obstacles: ``python -m benchmarks.moves.scaling``."""

from __future__ import annotations

import sys
import time
import tracemalloc

import numpy as np

import ikplan
from benchmarks.moves.problems import Problem, checker_of
from ikplan.planning.moves.connect import connect, is_free
from ikplan.planning.moves.space import search_space

_COUNTS = (10, 100, 1000, 2000)  # as many as a scene may have
_SEARCHES = 5


def main() -> int:
    """Print times and memory for 10 to 2,000 boxes of 3 cm about the ur5, and the exponents."""
    robot = ikplan.load_robot("ur5")
    rows = []
    for count in (_COUNTS[0], *_COUNTS):  # the first one compiles
        rng = np.random.default_rng(1)
        places = rng.uniform(-1.0, 1.0, (8 * count, 3))
        places = places[np.linalg.norm(places[:, :2], axis=1) > 0.6][:count]
        scene = {
            "obstacles": [
                {
                    "name": f"box {k}",
                    "shape": {"type": "box", "size": [0.03, 0.03, 0.03]},
                    "position": place.tolist(),
                }
                for k, place in enumerate(places)
            ]
        }
        problem = Problem("cell", robot.home, robot.home, scene, {}, [])
        tracemalloc.start()
        begin = time.process_time()
        arrays = (checker := checker_of(robot, problem)).arrays(None)
        build = time.process_time() - begin
        memory = tracemalloc.get_traced_memory()[1]
        tracemalloc.stop()
        q = robot.home + rng.uniform(-1.5, 1.5, (2000, robot.dof))
        begin = time.process_time()
        free = q[checker.free(q)]
        check = (time.process_time() - begin) / len(q)
        spent = []
        for k in range(_SEARCHES):
            a, b = free[2 * k].copy(), free[2 * k + 1].copy()
            begin = time.process_time()
            space = search_space(arrays, robot.lower, robot.upper, a, b[None])
            if not is_free(space, a, b, arrays.scratch):
                cut = np.zeros(1, dtype=np.bool_)
                connect(space, a, b[None], 2000, np.random.default_rng(k), cut, arrays.scratch)
            spent.append(time.process_time() - begin)
        rows.append((count, build, check, float(np.median(spent)), memory))
        print(
            f"{count} boxes: built in {1e3 * build:.1f} ms, {memory / 1e6:.1f} MB; a configuration "
            f"{1e6 * check:.2f} us; a search {1e3 * rows[-1][3]:.2f} ms",
            flush=True,
        )
    values = np.log(np.array(rows[1:]))
    slopes = [np.polyfit(values[:, 0], values[:, k], 1)[0] for k in range(1, 5)]
    names = ("building", "a configuration", "a search", "memory")
    print("exponents: " + ", ".join(f"{n} {s:.2f}" for n, s in zip(names, slopes, strict=True)))
    return 0


if __name__ == "__main__":
    sys.exit(main())
