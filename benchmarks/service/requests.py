"""Helix requests that are each new to the service, and as much work as one another."""

from __future__ import annotations

import itertools
import json
from collections.abc import Iterator
from pathlib import Path
from typing import Any

__all__ = ["helices", "slow_request"]

_HELIX = Path(__file__).parents[2] / "examples" / "helix_iiwa14.json"


def helices(first: int = 0) -> Iterator[bytes]:
    """Yield the example's helix again and again, each with a seed of its own: none is kept yet."""
    document = json.loads(_HELIX.read_bytes())
    for seed in itertools.count(first):
        yield json.dumps({**document, "ik": {**document.get("ik", {}), "seed": seed}}).encode()


def slow_request(seconds: float, seed: int = 0) -> dict[str, Any]:
    """Return a request whose search outlasts its budget."""
    points = [{"position": [0.5, 0.01 * i, 0.5]} for i in range(50)]
    return {
        "robot": "iiwa14",
        "path": {"waypoints": points},
        "ik": {"population": 2000, "iterations": 5000, "seed": seed},
        "budget_s": seconds,
    }
