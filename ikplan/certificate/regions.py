"""Proof that the tool stays where a move keeps it: an axis in a cone, the position in a box.

The motion is cut in parts. In each, Pinocchio places the tool at the middle; no joint value in the
part is farther from its middle than a Bezier control value, and a unit of it turns the tool by 1 at
most, or moves it by the longest that the links beyond the joint can be. What is not proven so is
halved.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from ikplan.arrays import Array
from ikplan.certificate.clearance import JointCurve
from ikplan.certificate.requested.motion import RequestedMotion
from ikplan.certificate.requested.poses import PathFrame
from ikplan.documents.certificate import RegionCertificate
from ikplan.documents.path import PathRequest
from ikplan.documents.segment import MoveRegion, MoveSegment
from ikplan.robots import Robot

__all__ = ["RegionLeft", "has_regions", "prove_regions"]

_HALVINGS = 20
_AXES = ("tool_x", "tool_y", "tool_z")


class RegionLeft(Exception):
    """The tool leaves the region of a move, or it cannot be told that it does not.

    Attributes:
        field: The move.
        time: When [s].
        q: Joint values there, shape (dof,) [rad or m].
    """

    def __init__(self, field: str, time: float, q: Array) -> None:
        super().__init__(f"{field} leaves its region at {time:.3f} s")
        self.field, self.time, self.q = field, time, q


def has_regions(path: PathRequest) -> bool:
    """Whether a move of a path has a region."""
    segments = path.segments or ()
    return any(isinstance(s, MoveSegment) and s.within is not None for s in segments)


@dataclass(frozen=True, eq=False)
class _Region:
    frame: PathFrame
    asked: MoveRegion

    def left(self, R: Array, p: Array) -> tuple[float, float]:
        """How far the tool is inside: of the cone [rad], of the box [m]."""
        angle = distance = math.inf
        if (cone := self.asked.cone) is not None:
            axis, about = R[:, _AXES.index(cone.axis)], self.frame.direction(cone.direction)
            # By half the chord: exact near 0 and near pi.
            chord = float(np.linalg.norm(axis - about))
            angle = cone.angle - 2.0 * math.asin(min(0.5 * chord, 1.0))
        if (box := self.asked.box) is not None:
            axes, origin = self.frame.frame(box.frame)
            inside = 0.5 * np.array(box.size) - np.abs(axes.T @ (p - origin))
            distance = float(inside.min())
        return angle, distance


def prove_regions(
    robot: Robot,
    path: PathRequest,
    motion: RequestedMotion,
    waypoint_time: Array,
    curve: JointCurve,
) -> list[RegionCertificate]:
    """Prove of every move with a region that the tool stays in it at every instant.

    Args:
        robot: The robot, with its tool.
        path: The path of the request.
        motion: What it asks of the motion.
        waypoint_time: When each waypoint is passed, shape (n,) [s].
        curve: The motion, as it is handed out.

    Raises:
        RegionLeft: The tool leaves one, or it cannot be told that it does not.
    """
    frame, found = PathFrame(path), []
    rows = {joint.field: joint for joint in motion.joint_segments}
    for k, segment in enumerate(path.segments or ()):
        if not isinstance(segment, MoveSegment) or segment.within is None:
            continue
        row = rows[f"path.segments[{k}]"]
        begin = 0.0 if row.begin_row is None else float(waypoint_time[row.begin_row])
        end = float(waypoint_time[row.end_row])
        region = _Region(frame, segment.within)
        angle, distance = _proven(robot, region, curve, row.field, begin, end)
        found.append(
            RegionCertificate(
                field=row.field,
                begin=begin,
                end=end,
                cone_left=None if segment.within.cone is None else angle,
                box_left=None if segment.within.box is None else distance,
            )
        )
    return found


def _proven(
    robot: Robot, region: _Region, curve: JointCurve, field: str, begin: float, end: float
) -> tuple[float, float]:
    """How far inside the tool stays at least: of the cone [rad], of the box [m]."""
    turn, reach = _rates(robot)
    low, high = curve.window(begin, end)
    least = [math.inf, math.inf]
    pending = [
        (_part(curve.controls[k], max(low - k, 0.0), min(high - k, 1.0)), k, 0)
        for k in range(int(low), min(math.ceil(high), len(curve.controls)))
    ]
    while pending:
        part, k, depth = pending.pop()
        q = 0.125 * (part[0] + 3.0 * (part[1] + part[2]) + part[3])
        away = np.abs(part - q).max(axis=0)
        T = robot.fk(q)
        angle, distance = region.left(T.rotation, T.translation)
        bounds = angle - float(turn @ away), distance - float(reach @ away)
        if angle < 0.0 or distance < 0.0 or (min(bounds) < 0.0 and depth == _HALVINGS):
            raise RegionLeft(field, curve.time(float(k)), q)
        if min(bounds) >= 0.0:
            least = [min(pair) for pair in zip(least, bounds, strict=True)]
            continue
        pending += [(_part(part, *half), k, depth + 1) for half in ((0.0, 0.5), (0.5, 1.0))]
    return least[0], least[1]


def _part(controls: Array, begin: float, end: float) -> Array:
    """Control values of a cubic between two of its parameters, shape (4, dof): its blossom."""

    def blossom(parameters: Sequence[float]) -> Array:
        c = controls
        for t in parameters:
            c = (1.0 - t) * c[:-1] + t * c[1:]
        return np.asarray(c[0])

    return np.array([blossom([begin] * (3 - n) + [end] * n) for n in range(4)])


def _rates(robot: Robot) -> tuple[Array, Array]:
    """How far a unit of each joint value turns and moves the tool at most, shape (dof,) each."""
    model = robot.model
    slides = np.array(["P" in model.joints[k].shortname() for k in range(1, model.njoints)])
    # Joints without limits turn: they have no stroke.
    low, high = (np.where(np.isfinite(b), b, 0.0) for b in (robot.lower, robot.upper))
    farthest = np.abs(robot.coupling) @ np.maximum(np.abs(low), np.abs(high))
    strokes = np.where(slides, farthest + np.abs(robot.coupling_offset), 0.0)
    links = [
        float(np.linalg.norm(model.jointPlacements[k].translation)) for k in range(1, model.njoints)
    ]
    tip = model.frames[robot.tip_frame_id].placement.translation
    links.append(float(np.linalg.norm(tip) + np.linalg.norm(robot.T_tip_tool.translation)))
    own = [
        1.0 if slides[k] else sum(links[k + 1 :]) + float(strokes[k + 1 :].sum())
        for k in range(len(slides))
    ]
    share = np.abs(robot.coupling).T
    return share @ np.where(slides, 0.0, 1.0), share @ np.array(own)
