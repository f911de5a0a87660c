"""Joint paths that begin and end along given velocities."""

from __future__ import annotations

import itertools
from collections.abc import Iterator
from dataclasses import dataclass, field
from typing import Any, Literal, NamedTuple

import numpy as np

from ikplan.arrays import Array
from ikplan.joint_path.joint_path import JointPath
from ikplan.joint_path.spline import limit_tangents, natural_tangents
from ikplan.limits.joint_limits import JointLimits
from ikplan.timing.moving.moving_ends import MovingEnds

__all__ = ["Lead", "leads", "moving_path", "with_bends"]

_SCALES = (1.0, 1.7, 3.0, 5.5)
"""How much longer than necessary the braking beside the setting out takes, for points to pass."""
_STOPPING = 1.03
"""The way to stop on is longer than the shortest one by this."""
_NEAR = 0.5
"""A point to pass is no farther than this share of the way to the next waypoint."""


class Lead(NamedTuple):
    """How a path begins along a velocity.

    Attributes:
        kind: "plain": a spline that is tangent to it; "via": past a point where the motion has
            turned; "stop": it stops straight ahead, and goes on from there.
        scale: Of "via": how much time the turn is given.
    """

    kind: Literal["plain", "via", "stop"]
    scale: float = 1.0


def leads() -> Iterator[tuple[Lead, Lead]]:
    """Yield ways to begin and to end, those that tend to be fast first."""
    plain, stop = Lead("plain"), Lead("stop")
    via = [Lead("via", scale) for scale in _SCALES]
    yield plain, plain
    for one in via:
        yield one, one
        yield one, plain
        yield plain, one
    yield stop, plain
    yield plain, stop
    for one in via:
        yield one, stop
        yield stop, one
    yield stop, stop


@dataclass
class _Span:
    """Points of a path between two rests, and what is asked for at its ends.

    Attributes:
        q: The points, shape (n, dof).
        old: Knot of the path before of each, -1 for a new one.
        tangents: Of the spline before, where it is kept, at the points, or None.
        start: Tangent and second derivative at the first point, or None.
        end: The same at the last point.
    """

    q: Array
    old: list[int]
    tangents: Array | None = None
    start: tuple[Array, Array | None] | None = None
    end: tuple[Array, Array | None] | None = None
    laid: tuple[Array, Array, Array, Array] = field(init=False)
    knots: list[int] = field(init=False)


def moving_path(
    path: JointPath,
    limits: JointLimits,
    ends: MovingEnds,
    ways: tuple[Lead, Lead],
    paces: tuple[float, float] = (1.0, 1.0),
) -> JointPath | None:
    """Return a path through the same waypoints that begins and ends along given velocities.

    Args:
        path: A path from rest to rest.
        limits: Joint limits.
        ends: The velocities; under jerk limits the accelerations at the ends too.
        ways: How it begins and how it ends, where these move.
        paces: Lengths of the tangents at moving ends.

    Returns:
        The path; None: it does not stay inside the
        position limits, or the way is the same as another.
    """
    rests = path.rest_knots
    spans = [
        _Span(
            path.q_knots[a : b + 1],
            list(range(a, b + 1)),
            np.vstack([path.tangents_start[a:b], path.tangents_end[b - 1 : b]]),
        )
        for a, b in itertools.pairwise(rests)
    ]
    smooth = limits.jerk is not None
    if ends.end_moves:
        # The end is a start, backwards in time.
        spans = _turned(spans)
        bent = 0.0 if smooth else None
        spans = _begun(spans, limits, -ends.end_velocity, bent, ways[1], paces[1])
        spans = _turned(spans)
    elif ways[1].kind != "plain":
        return None
    if ends.start_moves and spans:
        v = ends.start_velocity
        bend: Array | float | None = None
        if smooth:
            along = v / np.linalg.norm(v)
            across = ends.start_acceleration - along * float(along @ ends.start_acceleration)
            bend = across * paces[0] ** 2 / float(v @ v)
        spans = _begun(spans, limits, v, bend, ways[0], paces[0])
    elif ways[0].kind != "plain":
        return None
    if not spans or not all(_lay(span, limits) for span in spans):
        return None
    return _joined(path, spans)


def _begun(
    spans: list[_Span],
    limits: JointLimits,
    v: Array,
    bend: Array | float | None,
    way: Lead,
    pace: float,
) -> list[_Span]:
    """The spans with a beginning along a velocity; none where there is no room."""
    first = spans[0]
    speed = float(np.linalg.norm(v))
    along = pace * v / speed
    turn = None if bend is None else np.zeros(len(v)) + bend
    time = _braking_time(limits, v)
    if way.kind == "stop":
        if turn is not None and np.abs(turn).max() > 1e-9:
            return []
        q_stop = first.q[0] + 0.5 * _STOPPING * time * v
        if (q_stop < limits.lower).any() or (q_stop > limits.upper).any():
            return []
        stop = _Span(np.vstack([first.q[0], q_stop]), [first.old[0], -1])
        stop.start = (along, turn)
        rest = _Span(np.vstack([q_stop, first.q[1:]]), [-1, *first.old[1:]])
        rest.end = first.end
        return [stop, rest, *spans[1:]]
    begun = _Span(first.q, list(first.old), end=first.end)
    begun.start = (along, turn)
    if way.kind == "via":
        time *= 2.0 * way.scale
        q_stop = first.q[0] + 0.5 * time * v
        ahead = first.q[1] - q_stop
        far = float(np.linalg.norm(ahead))
        if far == 0.0:
            return []
        share = np.abs(ahead) / far
        pull = float((_least_acceleration(limits) / np.maximum(share, 1e-12)).min())
        step = min(0.25 * pull * time * time, _NEAR * far)
        via = np.clip(q_stop + step * ahead / far, limits.lower, limits.upper)
        begun.q = np.vstack([first.q[:1], via, first.q[1:]])
        begun.old = [first.old[0], -1, *first.old[1:]]
    return [begun, *spans[1:]]


def _least_acceleration(limits: JointLimits) -> Array:
    least = np.minimum(limits.acceleration, -limits.acceleration_lower)
    return least if limits.deceleration is None else np.minimum(least, limits.deceleration)


def _braking_time(limits: JointLimits, v: Array) -> float:
    """The least time in which all joints come to rest along the velocity [s]."""
    speed = np.abs(v)
    least = _least_acceleration(limits)
    time = float((speed / least).max())
    if limits.jerk is not None:
        low = speed > 0.0
        pull = float((least[low] / speed[low]).min())
        jerk = float((limits.jerk[low] / speed[low]).min())
        # Of a speed of one: two ramps of the deceleration and its limit, or two ramps alone.
        time = 1.0 / pull + pull / jerk if jerk >= pull * pull else 2.0 / np.sqrt(jerk)
    return time


def _turned(spans: list[_Span]) -> list[_Span]:
    """The spans backwards."""
    turned = []
    for span in reversed(spans):
        tangents = None if span.tangents is None else -span.tangents[::-1]
        one = _Span(span.q[::-1].copy(), span.old[::-1], tangents)
        one.start = None if span.end is None else (-span.end[0], span.end[1])
        one.end = None if span.start is None else (-span.start[0], span.start[1])
        turned.append(one)
    return turned


def _lay(span: _Span, limits: JointLimits) -> bool:
    """Lay the spline of a span; whether it stays inside the position limits."""
    s = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(span.q, axis=0), axis=1))])
    if len(s) < 2 or not (np.diff(s) > 0.0).all():
        return False
    if span.start is None and span.end is None:
        m = span.tangents
        if m is None:
            m = natural_tangents(s, span.q)
            limit_tangents(s, span.q, m, limits.lower, limits.upper)
        span.laid, span.knots = (s, span.q, m[:-1].copy(), m[1:].copy()), list(range(len(s)))
        return True
    m = _clamped(s, span)
    limit_tangents(s, span.q, m, limits.lower, limits.upper)
    for end, at in ((span.start, 0), (span.end, -1)):
        if end is not None and not np.array_equal(m[at], end[0]):
            return False
    span.laid, span.knots = (s, span.q, m[:-1].copy(), m[1:].copy()), list(range(len(s)))
    if span.start is not None and span.start[1] is not None:
        span.laid = _with_bend(span.laid, span.start[1])
        span.knots = [k + 2 if k else 0 for k in span.knots]
    if span.end is not None and span.end[1] is not None:
        span.laid = _backwards(_with_bend(_backwards(span.laid), span.end[1]))
        span.knots[-1] = len(span.laid[0]) - 1
    return True


def _clamped(s: Array, span: _Span) -> Array:
    """Tangents of the spline with given tangents at its ends; natural where none is given."""
    from scipy.interpolate import CubicSpline

    zero = np.zeros(span.q.shape[1])
    ends: list[Any] = [(2, zero) if end is None else (1, end[0]) for end in (span.start, span.end)]
    m = np.ascontiguousarray(CubicSpline(s, span.q, bc_type=(ends[0], ends[1]))(s, 1))
    if span.start is not None:
        m[0] = span.start[0]
    if span.end is not None:
        m[-1] = span.end[0]
    return m


_Laid = tuple[Array, Array, Array, Array]


def _with_bend(laid: _Laid, bend: Array) -> _Laid:
    """Give the first piece a second derivative at its start, by three pieces in its place.

    With knots at thirds there is one curve with continuous second derivative that has the value,
    the first and the second derivative wanted at both ends.
    """
    s, q, start, end = laid
    g = (s[1] - s[0]) / 3.0
    q0, q3, m0, m3 = q[0], q[1], start[0], end[0]
    d = (q3 - q0) / (3.0 * g)
    bend3 = (2.0 * m0 + 4.0 * m3 - 6.0 * d) / (3.0 * g)
    a = q0 + g * m0 + g * g * bend / 3.0
    b = q3 - g * m3 + g * g * bend3 / 3.0
    bend1 = (b - 2.0 * a + q0) / (g * g) - bend / 6.0
    bend2 = (a - 2.0 * b + q3) / (g * g) - bend3 / 6.0
    q1, q2 = a + g * g * bend1 / 6.0, b + g * g * bend2 / 6.0
    m1 = (q1 - q0) / g + g * (2.0 * bend1 + bend) / 6.0
    m2 = (q3 - q2) / g - g * (2.0 * bend2 + bend3) / 6.0
    return (
        np.concatenate([s[:1], [s[0] + g, s[0] + 2.0 * g], s[1:]]),
        np.vstack([q0, q1, q2, q[1:]]),
        np.vstack([m0, m1, m2, start[1:]]),
        np.vstack([m1, m2, m3, end[1:]]),
    )


def with_bends(laid: _Laid, start: Array, end: Array) -> _Laid:
    """Give pieces second derivatives at both ends: knots, values, tangents at starts and at ends.

    The first and the last piece become three.

    Args:
        laid: Knots, shape (n,), values, (n, dof), tangents at the starts and the ends of pieces.
        start: Second derivative at the first knot, shape (dof,).
        end: That at the last one.
    """
    return _backwards(_with_bend(_backwards(_with_bend(laid, start)), end))


def _backwards(laid: _Laid) -> _Laid:
    s, q, start, end = laid
    return (s[-1] - s)[::-1].copy(), q[::-1].copy(), -end[::-1], -start[::-1]


def _joined(path: JointPath, spans: list[_Span]) -> JointPath:
    """Join the spans, each from a rest to the next."""
    s, q = [np.zeros(1)], [spans[0].laid[1][:1]]
    start, end = [], []
    rests, count, length = [0], 0, 0.0
    knot_of = np.zeros(len(path.s_knots), dtype=np.int64)
    for span in spans:
        s.append(span.laid[0][1:] + length)
        q.append(span.laid[1][1:])
        start.append(span.laid[2])
        end.append(span.laid[3])
        for old, knot in zip(span.old, span.knots, strict=True):
            if old >= 0:
                knot_of[old] = count + knot
        count += len(span.laid[0]) - 1
        length = float(s[-1][-1])
        rests.append(count)
    return JointPath(
        np.concatenate(s),
        np.vstack(q),
        np.ascontiguousarray(np.vstack(start)),
        np.ascontiguousarray(np.vstack(end)),
        rest_knots=rests,
        knot_of_waypoint=knot_of[path.knot_of_waypoint],
    )
