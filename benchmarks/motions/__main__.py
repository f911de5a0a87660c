"""``python -m benchmarks.motions``: moving ends, and least time beside least motion."""

from __future__ import annotations

import argparse
import sys

from benchmarks.motions import least_time, moving_ends

_KINDS = ("helices", "waypoints", "lines")


def main() -> int:
    """Run the studies asked for; not 0 where a promise is broken."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks.motions", description=__doc__)
    parser.add_argument("study", choices=("moving", "small", *_KINDS))
    parser.add_argument("--count", type=int, default=100, help="how many motions")
    parser.add_argument("--seed", type=int, default=0, help="seed of every random choice")
    options = parser.parse_args()
    if options.study == "moving":
        return int(moving_ends.study(options.count, options.seed) > 0)
    if options.study == "small":
        least_time.small_gaps(options.count, options.seed)
        return 0
    return int(least_time.study(options.study, options.count, options.seed) > 0)


if __name__ == "__main__":
    sys.exit(main())
