"""Corners between joint motions and tool paths that are passed without a stop.

Within a ball about the corner, the end of the joint motion and the begin of the tool path, or the
other way round, are replaced by a quintic in joint space that has the direction and curvature of
both sides where it meets them.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from ikplan.arrays import Array, Flags
from ikplan.path.tool_path import SegmentRange
from ikplan.planning.join_corner import JoinCorner
from ikplan.planning.joint_route import JointRoute
from ikplan.planning.tracking.reference_path import ReferencePath
from ikplan.planning.tracking.tracked_arm import TrackedArm

__all__ = ["Join", "with_joins"]


@dataclass(frozen=True, eq=False)
class Join:
    """A corner between a joint motion and a tool path.

    Attributes:
        corner: Index of the configuration there.
        radius: Radius of the ball about it within which it may be rounded [m].
        reference: The tool path.
        s: Path positions of its points, shape (m,).
        first: Index of the configuration at the begin of the tool path.
    """

    corner: int
    radius: float
    reference: ReferencePath
    s: Array
    first: int

    @property
    def begins(self) -> bool:
        """Whether the tool path begins at the corner; otherwise it ends there."""
        return self.corner == self.first


class _Backwards:
    """A tool path run through from its end."""

    def __init__(self, path: ReferencePath) -> None:
        self._path = path

    @property
    def length(self) -> float:
        return self._path.length

    @property
    def corners(self) -> Array:
        return self.length - self._path.corners[::-1]

    @property
    def waypoint_s(self) -> Array:
        return self.length - self._path.waypoint_s[::-1]

    @property
    def orientation_changes(self) -> Array:
        return self.length - self._path.orientation_changes[::-1]

    @property
    def segments(self) -> Sequence[SegmentRange]:
        return ()

    @property
    def taken(self) -> float:
        return self._path.taken

    def poses(self, s: Array) -> tuple[Array, Array]:
        return self._path.poses(self.length - s)

    def positions(self, s: Array) -> Array:
        return self._path.positions(self.length - s)

    def orientation_mask(self, s: Array) -> Flags:
        return self._path.orientation_mask(self.length - s)


def with_joins(tracked: TrackedArm, route: JointRoute, joins: Sequence[Join]) -> JointRoute:
    """Return a route that passes its joins without a stop, wherever that can be.

    Args:
        tracked: The arm, and what it has to keep on tool paths.
        route: The route, at rest at every join.
        joins: The joins, in order.
    """
    joined, known = route, {join.first: join.s for join in joins}
    for join in reversed(joins):
        found = _joined(tracked, joined, replace(join, s=known[join.first]))
        if found is not None:
            joined, known[join.first] = found
    return joined if joined is route else replace(joined, stopped=route)


def _joined(tracked: TrackedArm, route: JointRoute, join: Join) -> tuple[JointRoute, Array] | None:
    """The route that passes one join, and the path positions of what is left of its tool path.

    None where the motion has to stop.
    """
    at, rests = join.corner, sorted({0, *route.rest, len(route.q) - 1})
    before = max((k for k in rests if k < at), default=None)
    after = min((k for k in rests if k > at), default=None)
    if before is None or after is None:
        return None
    held = {*rests, *(w.index for w in route.waypoints)}
    held |= {k for part in route.segments for k in (part.first, part.last)}
    held |= {k for move in route.moves for k in (move.first, move.last)}
    q, length = route.q, join.reference.length
    if join.begins:
        end = at + min(len(join.s), after - at + 1) - 1
        kept = max(k for k in held if k < at) - before
        s, reference = join.s[: end - at + 1], join.reference
        parts = q[before : at + 1], q[at : end + 1], q[end + 1 : after + 1]
        after = end
    else:
        kept = after - min(k for k in held if k > at)
        s, reference = (length - join.s[before - join.first :])[::-1], _Backwards(join.reference)
        parts = q[at : after + 1][::-1], q[before : at + 1][::-1], q[:0]
    corner = JoinCorner(tracked, reference, join.radius, *parts, s, kept)
    rounded = corner.rounded()
    if rounded is None:
        return None
    place = np.array([rounded.place[k] for k in range(len(parts[0]) + len(parts[1]) - 1)])
    q, nearest, ends, left = rounded.q, rounded.nearest, rounded.ends, rounded.s
    if not join.begins:
        q, place = q[::-1], len(q) - 1 - place[::-1]
        nearest, ends = len(q) - 1 - nearest, (len(q) - 1 - ends[1], len(q) - 1 - ends[0])
        left = np.concatenate([join.s[: before - join.first], (length - left)[::-1]])
    more = len(q) - (after - before + 1)
    moved = [
        k if k <= before else k + more if k >= after else before + int(place[k - before])
        for k in range(len(route.q))
    ]
    enters, leaves = before + ends[0], before + ends[1]
    made = replace(
        route,
        q=np.ascontiguousarray(np.vstack([route.q[:before], q, route.q[after + 1 :]])),
        rest=[moved[k] for k in route.rest if k != at],
        waypoints=[
            replace(w, index=before + nearest, exact=False)
            if w.index == at
            else replace(w, index=moved[w.index])
            for w in route.waypoints
        ],
        segments=[
            replace(
                x,
                first=enters if x.first == at and x.last > at else moved[x.first],
                last=leaves if x.last == at and x.first < at else moved[x.last],
            )
            for x in route.segments
        ],
        moves=[replace(m, first=moved[m.first], last=moved[m.last]) for m in route.moves],
        joint_steps=[
            replace(
                x,
                first=leaves if x.first == at else moved[x.first],
                last=enters if x.last == at else moved[x.last],
            )
            for x in route.joint_steps
        ],
    )
    return made, left
