"""Where the tool may be on a move: an axis of it within a cone, its position within a box."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from ikplan.arrays import Array
from ikplan.documents.path import PathRequest
from ikplan.documents.segment import MoveRegion
from ikplan.kinematics.arm import Arm
from ikplan.kinematics.chain import Chain
from ikplan.path.build.path_frame import PathFrame

__all__ = ["RegionScratch", "ToolRegion", "region_scratch", "tool_region"]

_AXES = {"tool_x": 0, "tool_y": 1, "tool_z": 2}
_FAR = 1e3
"""Half width of a box that bounds nothing [m]."""


class ToolRegion(NamedTuple):
    """Where the tool may be, for the kernels.

    Attributes:
        chain: The chain of the arm.
        axis: Number of the tool's axis.
        direction: Where that axis points, of length 1, in the base, shape (3,).
        cone: Half angle of the cone about it [rad]; pi: none.
        R: Axes of the box in the base, a column each, shape (3, 3).
        middle: Middle of the box in the base, shape (3,) [m].
        half: Half its edges, shape (3,) [m].
        turn: How far a unit of each joint value turns the tool at most, shape (dof,) [rad].
        reach: How far it moves the tool at most, shape (dof,) [m].
    """

    chain: Chain
    axis: int
    direction: Array
    cone: float
    R: Array
    middle: Array
    half: Array
    turn: Array
    reach: Array


class RegionScratch(NamedTuple):
    """Work space of the kernels.

    Attributes:
        R: Shape (3, 3).
        p: Shape (3,).
        z: Shape (n, 3), n serial joints.
        o: Shape (n, 3).
        Jt: Shape (dof, 6).
        q: Shape (dof,).
        step: Shape (dof,).
        controls: Shape (depth, 4, dof).
        halvings: Shape (depth,).
    """

    R: Array
    p: Array
    z: Array
    o: Array
    Jt: Array
    q: Array
    step: Array
    controls: Array
    halvings: Array


def region_scratch(chain: Chain) -> RegionScratch:
    """Return work space for a chain."""
    n, dof = chain.coupling.shape
    return RegionScratch(
        np.empty((3, 3)),
        np.empty(3),
        np.empty((n, 3)),
        np.empty((n, 3)),
        np.empty((dof, 6)),
        np.empty(dof),
        np.empty(dof),
        np.empty((64, 4, dof)),
        np.empty(64),
    )


def tool_region(arm: Arm, path: PathRequest, asked: MoveRegion) -> ToolRegion:
    """Return what a move asks for.

    Args:
        arm: The arm.
        path: The path, in whose frame it is asked for.
        asked: What is asked for.
    """
    frame, chain = PathFrame(path), arm.chain
    R, _ = frame.frame(asked.box.frame) if asked.box is not None else (np.eye(3), None)
    middle, half = np.zeros(3), np.full(3, _FAR)
    if asked.box is not None:
        middle = frame.point(asked.box.frame.position)
        half = 0.5 * np.array(asked.box.size)
    axis, direction, cone = 2, np.array([0.0, 0.0, 1.0]), math.pi
    if asked.cone is not None:
        axis, cone = _AXES[asked.cone.axis], float(asked.cone.angle)
        direction = frame.direction(asked.cone.direction)
    slides = chain.prismatic
    farthest = np.maximum(np.abs(arm.lower), np.abs(arm.upper))
    strokes = np.abs(chain.coupling) @ np.where(np.isfinite(farthest), farthest, 0.0)
    strokes = np.where(slides, strokes + np.abs(chain.offset), 0.0)
    links = np.linalg.norm(chain.placements[:, 9:], axis=1)
    n = len(slides)
    own = np.array(
        [1.0 if slides[k] else links[k + 1 :].sum() + strokes[k + 1 :].sum() for k in range(n)]
    )
    coupling = np.abs(chain.coupling).T
    turn = np.where(slides, 0.0, 1.0)
    return ToolRegion(
        chain, axis, np.array(direction), cone, np.ascontiguousarray(R), np.array(middle), half,
        np.ascontiguousarray(coupling @ turn), np.ascontiguousarray(coupling @ own),
    )  # fmt: skip
