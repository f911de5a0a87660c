"""How far an arm can reach at most, and what it means that everything is far beyond that."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from ikplan.errors import Unreachable

if TYPE_CHECKING:
    from ikplan.robots.robot import Robot

__all__ = ["MILLIMETRES", "reach", "unit_hint", "with_hint"]

MILLIMETRES = 1e-3
"""Factor of coordinates that are millimetres."""

_FAR = 10.0
"""What is so many times farther away than the arm reaches is in another unit."""


def reach(robot: Robot) -> float:
    """Return a bound of the distance of the tool from the origin of the base [m].

    The sum of the lengths of the links, however they are bent, and of the ways that joints slide;
    infinite where a joint slides without limits.
    """
    model = robot.model
    origin = robot.T_universe_base.translation
    total = float(np.linalg.norm(robot.T_tip_tool.translation))
    total += float(np.linalg.norm(model.frames[robot.tip_frame_id].placement.translation))
    for k, joint in enumerate(model.joints[1:], start=1):
        offset = model.jointPlacements[k].translation
        total += float(np.linalg.norm(offset - origin if k == 1 else offset))
        if joint.nq == 1 and not _turns(joint.shortname()):
            ways = (model.lowerPositionLimit[joint.idx_q], model.upperPositionLimit[joint.idx_q])
            total += float(max(abs(way) for way in ways))
    return total


def _turns(joint: str) -> bool:
    return joint.startswith("JointModelR")


def unit_hint(robot: Robot, positions: Sequence[Sequence[float]]) -> str | None:
    """Return what to say where every position is so far away that its unit must be wrong.

    Args:
        robot: The robot.
        positions: Where the tool is to be in the base, shape (n, 3) [m].

    Returns:
        Words that end in a question; None: some position is near enough, or there is none.
    """
    if not len(positions):
        return None
    nearest = float(np.linalg.norm(np.asarray(positions, dtype=np.float64), axis=1).min())
    farthest = reach(robot)
    if nearest <= _FAR * farthest:
        return None
    return (
        f"every position is {nearest:.0f} m or more from the base, and the arm reaches "
        f"{farthest:.2f} m at most: are the coordinates millimetres?"
    )


def with_hint(error: Unreachable, hint: str | None) -> Unreachable:
    """Return an error with a hint at the end of its detail; None: as it is."""
    if hint is not None:
        error.detail = f"{error.detail}; {hint}"
        error.args = (error.detail,)
    return error
