"""Pick and place as one request: parts from one tray to another across a wall."""

from __future__ import annotations

from typing import Any

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
    return [
        0.5 + _PITCH * (row - 1.5),
        side * 0.32 + _PITCH * (column - 2.0),
        _TOP + _EDGE,
    ]


def _there_and_back(place: list[float]) -> list[dict[str, Any]]:
    """A move above a place, a line down and one up again."""
    above = {"position": [*place[:2], place[2] + _ABOVE], "quaternion_xyzw": _DOWN}
    at = {"position": place, "quaternion_xyzw": _DOWN}
    return [
        {"type": "move", "to": above},
        {"type": "line", "to": at},
        {"type": "line", "to": above},
    ]
