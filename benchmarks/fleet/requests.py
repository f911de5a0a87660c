"""Distinct requests of a chosen size."""

from __future__ import annotations

import math
from typing import Any

__all__ = ["request"]


def request(number: int, waypoints: int) -> dict[str, Any]:
    """Return a request: an arc of waypoints, which no other number has."""
    shift = 1e-5 * number
    angles = [math.pi * i / max(1, waypoints - 1) for i in range(waypoints)]
    path = [
        {"position": [0.5 + shift, 0.15 * math.cos(a), 0.35 + 0.1 * math.sin(a)]} for a in angles
    ]
    path[0]["quaternion_xyzw"] = [0.0, 1.0, 0.0, 0.0]
    return {"robot": "iiwa14", "path": {"waypoints": path}, "budget_s": 60.0}
