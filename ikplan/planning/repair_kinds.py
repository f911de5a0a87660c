"""Changes of a request that give up a little: a box, rounded corners, a shift, a gap."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from ikplan.arrays import Array
from ikplan.documents.path import PathRequest
from ikplan.errors import InCollision
from ikplan.path import Leg, ToolLeg
from ikplan.planning.joint_route import JointPathProblem

__all__ = [
    "LONGEST_ASIDE",
    "Repair",
    "boxed",
    "by_joint_motion",
    "merged_document",
    "moved_aside",
    "rounded",
    "smaller_clearance",
]


_BOXES = ((1e-3, 1e-2), (5e-3, 5e-2))
"""Half widths of boxes that are tried: position [m], rotation vector [rad]."""
_BLENDS = (5e-3, 2e-2)
"""Radii within which corners are rounded [m]."""
_ASIDE = (0.02, 0.1)
"""Shifts along each axis that are tried [m]."""

LONGEST_ASIDE = max(_ASIDE)

Lays = Callable[[JointPathProblem], bool]


@dataclass(frozen=True)
class Repair:
    """A change of the request.

    Attributes:
        change: Fields of the request.
        detail: The same in words.
    """

    change: dict[str, Any]
    detail: str


def merged_document(document: Any, change: Any) -> Any:
    """Return a document with a change applied: documents within it merged, the rest replaced."""
    if not isinstance(document, Mapping) or not isinstance(change, Mapping):
        return change
    changed = {key: merged_document(document.get(key), value) for key, value in change.items()}
    return {**document, **changed}


def boxed(problem: JointPathProblem, lays: Lays) -> Iterator[Repair]:
    """Yield a box about the path, the smallest first."""
    path = problem.path
    if path.tolerance.box is not None or path.orientation_free is not None:
        return
    document = path.model_dump(mode="json")
    for position, orientation in _BOXES:
        box = {"position": [position] * 3, "orientation": [orientation] * 3}
        tolerance = {**document["tolerance"], "box": box}
        wider = PathRequest.model_validate({**document, "tolerance": tolerance})
        if lays(replace(problem, path=wider)):
            detail = (
                f"allow the tool to be up to {position * 1e3:g} mm and {orientation:g} rad "
                "beside the path, along and about each axis"
            )
            yield Repair({"path": {"tolerance": {"box": box}}}, detail)


def rounded(problem: JointPathProblem, legs: Sequence[Leg], lays: Lays) -> Iterator[Repair]:
    """Yield corners rounded, the smallest radius first, where the motion stops at corners."""
    path = problem.path
    if (path.blend or 0.0) > 0.0 or not any(
        isinstance(leg, ToolLeg) and len(leg.path.corners) for leg in legs
    ):
        return
    for blend in _BLENDS:
        if lays(replace(problem, path=path.model_copy(update={"blend": blend}))):
            detail = f"round the corners of the path within {blend * 1e3:g} mm"
            yield Repair({"path": {"blend": blend}}, detail)


def by_joint_motion(problem: JointPathProblem, lays: Lays) -> Iterator[Repair]:
    """Yield a joint motion through the waypoints in the place of the tool's path between them."""
    path = problem.path
    if path.waypoints is None or len(path.waypoints) < 2 or path.interpolation == "joint":
        return
    if lays(replace(problem, path=path.model_copy(update={"interpolation": "joint"}))):
        detail = (
            "pass the waypoints by a joint motion: what the tool does between them is then free"
        )
        yield Repair({"path": {"interpolation": "joint"}}, detail)


def moved_aside(
    problem: JointPathProblem, moved: Callable[[JointPathProblem, Array], Any], lays: Lays
) -> Iterator[Repair]:
    """Yield shifts of the path frame along the axes of the base, the shortest first."""
    for length in _ASIDE:
        for axis in (2, 0, 1):
            for sign in (1.0, -1.0):
                shift = np.zeros(3)
                shift[axis] = sign * length
                attempt = moved(problem, shift)
                if lays(attempt):
                    position = attempt.path.frame.position
                    way = f"{'-' if sign < 0.0 else ''}{'xyz'[axis]}"
                    detail = f"move the path by {length * 1e3:g} mm along {way} of the base"
                    yield Repair({"path": {"frame": {"position": position}}}, detail)


def smaller_clearance(error: InCollision, clearance: float) -> Iterator[Repair]:
    """Yield a clearance as large as the gap there is, then none: planned by whoever asks."""
    if clearance <= 0.0:
        return
    left = math.floor((clearance - error.depth) * 1e3 - 0.5) * 1e-3
    for smaller in dict.fromkeys((round(max(left, 0.0), 6), 0.0)):
        detail = f"ask for a clearance of {smaller * 1e3:g} mm"
        yield Repair({"scene": {"clearance": smaller}}, detail)
