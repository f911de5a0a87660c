"""Pick and place as one request, timed: ``python -m benchmarks.moves.pick``.

Parts are carried from one tray to another across a wall, in the given order and in free order.
"""

from __future__ import annotations

import argparse
import sys
import time
from typing import Any

import ikplan

__all__ = ["pick_request"]

_DOWN = [1.0, 0.0, 0.0, 0.0]
_PITCH = 0.06
"""Distance between neighbouring parts [m]."""
_EDGE = 0.03
"""Edge of a part, a cube [m]."""
_ABOVE = 0.08
"""How far above a part the moves end [m]."""
_TOP = 0.05
"""Height of the trays [m]."""
_SCRAMBLED = [(7 * k + 3) % 20 for k in range(20)]
"""In which order the places of a tray are named."""


def pick_request(parts: int, order: str = "free", seed: int = 0) -> dict[str, Any]:
    """Return the request that carries parts from one tray to another, by a ur5.

    Each part is gone to by a move, reached by a line, lifted by a line, carried by a move, put
    down by a line and left by a line; it is attached from its lift to the line that puts it down.

    Args:
        parts: How many, 1 to 20; the given order goes to and fro over the trays.
        order: ``"free"`` or ``"given"``.
        seed: Seed of the searches.
    """
    segments: list[dict[str, Any]] = []
    attached: list[dict[str, Any]] = []
    for k in range(parts):
        lies, goes = _place(_SCRAMBLED[k], -1.0), _place(_SCRAMBLED[_SCRAMBLED[k]], 1.0)
        first = len(segments)
        segments += _there_and_back(lies) + _there_and_back(goes)
        attached.append(
            {
                "name": f"part {k}",
                "shape": {"type": "box", "size": [_EDGE] * 3},
                "position": [0.0, 0.0, 0.5 * _EDGE],
                "first_segment": first + 2,
                "last_segment": first + 4,
                "touches": ["tray -", "tray +"],
            }
        )
    size = [5 * _PITCH, 6 * _PITCH, 0.02]
    trays = [
        {
            "name": f"tray {sign}",
            "shape": {"type": "box", "size": size},
            "position": [0.5, side * 0.32, _TOP - 0.01],
        }
        for sign, side in (("-", -1.0), ("+", 1.0))
    ]
    wall = {
        "name": "wall",
        "shape": {"type": "box", "size": [0.5, 0.03, 0.35]},
        "position": [0.55, 0.0, 0.175],
    }
    gripper = {
        "name": "gripper",
        "shape": {"type": "box", "size": [0.05, 0.05, 0.08]},
        "position": [0.0, 0.0, 0.05],
    }
    return {
        "robot": "ur5",
        "tool": {"position": [0.0, 0.0, 0.1], "geometry": [gripper]},
        "scene": {"obstacles": [*trays, wall], "attached": attached},
        "path": {"segments": segments, "order": order},
        "ik": {"seed": seed},
        "budget_s": 600.0,
    }


def _place(number: int, side: float) -> list[float]:
    """Where the top of a part is in a tray of four columns."""
    column, row = divmod(number, 4)
    place = (0.5 + _PITCH * (row - 1.5), side * 0.32 + _PITCH * (column - 2.0), _TOP + _EDGE)
    return [round(value, 6) for value in place]


def _there_and_back(place: list[float]) -> list[dict[str, Any]]:
    """A move above a place, a line down and one up again."""
    above = {"position": [*place[:2], round(place[2] + _ABOVE, 6)], "quaternion_xyzw": _DOWN}
    at = {"position": place, "quaternion_xyzw": _DOWN}
    return [
        {"type": "move", "to": above},
        {"type": "line", "to": at},
        {"type": "line", "to": above},
    ]


def main() -> int:
    """Plan it in both orders; 1 where the free order takes longer, or a motion is not proven."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks.moves.pick", description=__doc__)
    parser.add_argument("--parts", type=int, default=20, help="how many parts, 1 to 20")
    parser.add_argument("--seeds", type=int, default=1, help="seeds of the searches")
    options = parser.parse_args()
    for order in ("given", "free"):  # compiles
        ikplan.plan(pick_request(2, order))
    return max(_both_orders(options.parts, seed) for seed in range(options.seeds))


def _both_orders(parts: int, seed: int) -> int:
    durations, proven = [], True
    for order in ("given", "free"):
        begin = time.process_time()
        plan = ikplan.plan(pick_request(parts, order, seed))
        spent = time.process_time() - begin
        clearance = plan.certificate.clearance
        proven &= clearance is not None and clearance.proven
        durations.append(plan.duration)
        length = sum(move.length for move in plan.stats.moves)
        print(
            f"{parts} parts, seed {seed}, {order:5} order: {spent:.2f} s of processor time, motion "
            f"of {plan.duration:.2f} s, moves of {length:.1f} rad, proven: {proven}"
        )
    return int(not proven or durations[1] > durations[0])


if __name__ == "__main__":
    sys.exit(main())
