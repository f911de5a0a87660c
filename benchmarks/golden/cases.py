"""What the golden list holds: every vector, every example and a series of random requests."""

from __future__ import annotations

import json
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from benchmarks.requests.drawing import draw

__all__ = ["BUDGET_S", "golden_cases"]

_ROOT = Path(__file__).parents[2]
_SEED = 2026
# Named, so that a new robot does not change which robot each number draws.
_ROBOTS = (
    "baxter_left", "baxter_physical", "baxter_right", "baxter_table7", "dobot_magician", "eod_arm",
    "iiwa14", "kinova_j2s6s200", "mh5", "panda", "so101", "tiago", "ur10", "ur3", "ur5", "xarm7",
    "z1",
)  # fmt: skip
_RANDOM = {"plan": 40, "timing": 30, "curve": 30}
BUDGET_S = 900.0
"""Budget of every request [s]: large enough that no outcome depends on the clock."""


def golden_cases() -> Iterator[tuple[str, str, dict[str, Any]]]:
    """Yield the name, the kind ("plan", "timing" or "joint path") and the document of each case."""
    for path in sorted((_ROOT / "tests/vectors/planning").glob("*.json")):
        yield f"vectors/planning/{path.stem}", "plan", json.loads(path.read_text())["request"]
    for path in sorted((_ROOT / "tests/vectors/timing/requests").glob("*.json")):
        yield f"vectors/timing/requests/{path.stem}", "timing", _request(path)
    for path in sorted((_ROOT / "tests/vectors/timing").glob("*.json")):
        yield f"vectors/timing/{path.stem}", "joint path", json.loads(path.read_text())
    for path in sorted((_ROOT / "examples").glob("*.json")):
        document = json.loads(path.read_text())
        if isinstance(document, list):  # joint waypoints, as the README times them
            yield f"examples/{path.stem}", "timing", {"robot": "ur5", "waypoints": document}
        else:
            yield f"examples/{path.stem}", "plan", document
    for line, text in enumerate((_ROOT / "examples/batch_ur5.jsonl").read_text().splitlines()):
        yield f"examples/batch_ur5/{line}", "plan", json.loads(text)
    for kind, count in _RANDOM.items():
        for number in range(count):
            request = draw(kind, _SEED, number, BUDGET_S, _ROBOTS)
            name = "timing" if kind == "timing" else "plan"
            yield f"random/{kind}/{number}", name, request


def _request(path: Path) -> dict[str, Any]:
    document: dict[str, Any] = json.loads(path.read_text())
    return dict(document.get("request", document))
