"""One corner between a joint motion and a tool path, rounded in joint space."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ikplan.arrays import Array, lengths_of
from ikplan.collision.check import ContactCheck
from ikplan.joint_path import JointPath
from ikplan.kinematics.forward import forward_batch
from ikplan.planning.tracking.path_deviation import deviation_ratios
from ikplan.planning.tracking.reference_path import ReferencePath
from ikplan.planning.tracking.tolerance_bounds import has_bounds
from ikplan.planning.tracking.tracked_arm import EXACT, TrackedArm
from ikplan.planning.tracking.tracking_kernels import project_onto_targets

__all__ = ["JoinCorner", "RoundedJoin"]


_SHRINKS = 12
"""How often a corner is rounded less, by a fifth each time, before the motion stops there."""
_SAMPLES = 24
"""Steps of the quintic."""
_GUIDES = 8
"""Steps of the joint motion that lead to it, so that the spline keeps to it."""
_LOOKS = 65
_DENSER = 12
"""How often points are added where the spline leaves the tool path."""


@dataclass(frozen=True, eq=False)
class RoundedJoin:
    """The configurations from the rest before a join to the end of the tool path after it.

    Attributes:
        q: Shape (k, dof) [rad or m].
        s: Path positions of those on the tool path, shape (m,).
        place: Index in them of each of those before, that of the corner left out.
        nearest: Index of the one whose tool is nearest to the corner.
        ends: Indices of those between which the corner is rounded.
    """

    q: Array
    s: Array
    place: dict[int, int]
    nearest: int
    ends: tuple[int, int]


@dataclass(frozen=True, eq=False)
class JoinCorner:
    """A join whose joint motion comes first.

    Attributes:
        tracked: The arm.
        reference: The tool path, from the corner.
        radius: Radius of the ball about the corner [m].
        q_joint: The joint motion from its last rest to the corner, shape (k, dof).
        q_tool: The tool path from the corner to its next rest, or to where another corner of it
            is rounded, shape (m, dof).
        q_beyond: What follows it up to the next rest, shape (n, dof).
        s: Path positions of the tool path's, shape (m,).
        kept: Index in the joint motion of the last configuration that has to stay.
    """

    tracked: TrackedArm
    reference: ReferencePath
    radius: float
    q_joint: Array
    q_tool: Array
    q_beyond: Array
    s: Array
    kept: int

    def rounded(self) -> RoundedJoin | None:
        """The corner rounded as widely as its ball allows; None: it cannot be."""
        if len(self.q_joint) < 2 or len(self.q_tool) < 2:
            return None
        reach = min(self.radius, 0.5 * float(self.s[-1]))
        inside = self.reference.waypoint_s
        inside = inside[(inside > 1e-9) & (inside <= self.s[-1])]
        reach = min(reach, 0.999 * float(inside.min(initial=np.inf)))
        for _ in range(_SHRINKS):
            self.tracked.clock.check()
            found = self._tried(reach)
            if found is not None:
                return found
            reach *= 0.8
        return None

    def _tried(self, reach: float) -> RoundedJoin | None:
        limits = self.tracked.limits
        entry = self._entry(reach)
        leaving = self._leaving(reach)
        if entry is None or leaving is None:
            return None
        q_before, q_in, slope_in = entry
        q_out, slope_out, s_out = leaving
        corner = self.q_tool[0]
        span = float(np.linalg.norm(corner - q_in) + np.linalg.norm(q_out - corner))
        if span < 1e-9:
            return None
        curve = _quintic(q_in, slope_in, q_out, slope_out, span)
        kept = self.s > s_out + 0.2 * (self.s[1:][self.s[1:] > s_out][0] - s_out)
        s, q = np.concatenate([[s_out], self.s[kept]]), np.vstack([q_out[None], self.q_tool[kept]])
        head = np.vstack([q_before, curve[:-1]])
        if ((head < limits.lower) | (head > limits.upper)).any():
            return None
        added = self._on_path(head, s, q)
        if added is None:
            return None
        s, q = added
        rows = np.vstack([head, q])
        bend = slice(len(q_before), len(head) + 1)
        p_corner = self._tool(corner[None])[0]
        path = JointPath.through(np.vstack([rows, self.q_beyond]), limits)
        knots = path.s_waypoints
        looks = np.linspace(knots[bend.start], knots[len(head)], _LOOKS)
        away = lengths_of(self._tool(path(looks)) - p_corner)
        if away.max() > self.radius:
            return None
        contact = self.tracked.contact
        if contact is not None and _touches(contact, rows):
            return None
        near = lengths_of(self._tool(rows[bend]) - p_corner)
        joints = len(self.q_joint) - 1
        place = {k: min(k, self.kept) for k in range(joints)}
        place |= {joints: bend.start + int(np.argmin(near))}
        where = len(head) + np.searchsorted(s, self.s[1:])
        place |= {joints + 1 + k: min(int(i), len(rows) - 1) for k, i in enumerate(where)}
        return RoundedJoin(
            rows, s, place, bend.start + int(np.argmin(near)), (bend.start, len(head))
        )

    def _tool(self, q: Array) -> Array:
        """Positions of the tool, shape (m, 3) [m]."""
        return np.asarray(forward_batch(self.tracked.arm.chain, np.ascontiguousarray(q))[1])

    def _entry(self, reach: float) -> tuple[Array, Array, Array] | None:
        """Configurations up to the ball, the last of them, and its direction and curvature."""
        path = JointPath.through(self.q_joint, self.tracked.limits)
        knots = path.s_waypoints
        low, high = 0.5 * (knots[self.kept] + knots[-1]), knots[-1]
        if high - low < 1e-9:
            return None
        looks = np.linspace(high, low, _LOOKS)
        away = lengths_of(self._tool(path(looks)) - self._tool(self.q_tool[:1]))
        out = np.flatnonzero(away > reach)
        sigma = float(looks[out[0] - 1 if len(out) else -1])
        if high - sigma < 1e-9:
            return None
        guides = np.linspace(knots[self.kept], sigma, _GUIDES + 1)
        q, d1, d2 = path.derivatives(guides)
        return (
            np.vstack([self.q_joint[: self.kept + 1], q[1:-1]]),
            q[-1],
            np.array([d1[-1], d2[-1]]),
        )

    def _leaving(self, reach: float) -> tuple[Array, Array, float] | None:
        """The configuration where the tool path is followed from, direction, curvature, place."""
        path = JointPath.through(np.vstack([self.q_tool, self.q_beyond]), self.tracked.limits)
        k = int(np.clip(np.searchsorted(self.s, reach, "right") - 1, 0, len(self.s) - 2))
        share = (reach - self.s[k]) / (self.s[k + 1] - self.s[k])
        knots = path.s_waypoints
        sigma = knots[k] + share * (knots[k + 1] - knots[k])
        q, d1, d2 = path.derivatives(np.array([sigma]))
        on = self._projected(np.array([reach]), q)
        return None if on is None else (on[0], np.array([d1[0], d2[0]]), reach)

    def _projected(self, s: Array, q: Array) -> Array | None:
        """Configurations brought onto the path at positions; None where one is not."""
        tracked = self.tracked
        on = np.ascontiguousarray(np.clip(q, tracked.arm.lower, tracked.arm.upper))
        off, spent = project_onto_targets(
            tracked.arm.chain,
            tracked.targets_at(self.reference, s),
            on,
            tracked.arm.lower,
            tracked.arm.upper,
        )
        tracked.clock.count(spent)
        return on if (off <= EXACT).all() else None

    def _on_path(self, head: Array, s: Array, q: Array) -> tuple[Array, Array] | None:
        """Points of the tool path, more where the spline through all would leave it."""
        tracked, first = self.tracked, len(head)
        for _ in range(_DENSER):
            path = JointPath.through(np.vstack([head, q, self.q_beyond]), tracked.limits)
            knots = path.knot_of_waypoint
            if len(np.unique(knots)) < len(knots):
                return None
            last = first + len(q)
            part = JointPath(
                path.s_knots[first:last] - path.s_knots[first],
                path.q_knots[first:last],
                path.tangents_start[first : last - 1],
                path.tangents_end[first : last - 1],
            )
            off, spent = deviation_ratios(
                tracked.arm.chain,
                self.reference,
                lambda at: tracked.targets_at(self.reference, at),
                s,
                part,
                tracked.tolerance,
                tracked.deviation_share,
                bounded=has_bounds(tracked.freedom),
            )
            tracked.clock.count(spent)
            wide = np.flatnonzero(off > tracked.deviation_share)
            if len(wide) == 0:
                return s, q
            middle = 0.5 * (s[wide] + s[wide + 1])
            sigma = 0.5 * (part.s_waypoints[wide] + part.s_waypoints[wide + 1])
            on = self._projected(middle, part(sigma))
            if on is None:
                return None
            order = np.argsort(np.concatenate([s, middle]), kind="stable")
            s = np.concatenate([s, middle])[order]
            q = np.ascontiguousarray(np.vstack([q, on])[order])
        return None


def _quintic(a: Array, slope_a: Array, b: Array, slope_b: Array, span: float) -> Array:
    """Points from a to b, shape (n + 1, dof), with directions and curvatures at both ends."""
    t = np.linspace(0.0, 1.0, _SAMPLES + 1)[:, None]
    t2, t3, t4, t5 = t**2, t**3, t**4, t**5
    va, ka, vb, kb = (
        span * slope_a[0],
        span**2 * slope_a[1],
        span * slope_b[0],
        span**2 * slope_b[1],
    )
    rise = 10.0 * t3 - 15.0 * t4 + 6.0 * t5
    points = (1.0 - rise) * a + rise * b
    points = points + (t - 6.0 * t3 + 8.0 * t4 - 3.0 * t5) * va
    points = points + (0.5 * t2 - 1.5 * t3 + 1.5 * t4 - 0.5 * t5) * ka
    points = points + (-4.0 * t3 + 7.0 * t4 - 3.0 * t5) * vb
    return np.asarray(points + (0.5 * t3 - t4 + 0.5 * t5) * kb)


def _touches(contact: ContactCheck, rows: Array) -> bool:
    """Whether the motion through configurations meets a body, with all that is ever carried."""
    return contact.first_contact(np.ascontiguousarray(rows)) is not None
