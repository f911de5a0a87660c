"""The search for a motion with given joint rates at its ends, and for the nearest feasible ones."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from ikplan.arrays import Array
from ikplan.errors import TimingFailed
from ikplan.joint_path import JointPath
from ikplan.limits import JointLimits
from ikplan.limits.motion_limits import LimitedSegment, MotionLimits
from ikplan.pipeline.timing_stage import joint_limits, prepared
from ikplan.robots import Robot
from ikplan.timing import PathConstraint
from ikplan.timing.engines.engine import Check, EngineFailed
from ikplan.timing.moving.moving_ends import MovingEnds
from ikplan.timing.moving.moving_jerk_span import EndRates
from ikplan.timing.moving.moving_motion import MovingMotion, time_moving_path
from ikplan.timing.moving.moving_path import Lead, leads, moving_path

__all__ = ["Moved", "MovingSearch"]

_ALONG = 1e-3
"""How far a velocity at the end of a tool path may be from the path's own direction [rad]."""
_NEAR_POINTS, _FEWEST_POINTS = 7, 4
_STOP_COSTS = 1.03
"""A motion that stops on its way is taken where it is faster by this."""
_SUCCESSES = 3
"""Of jerk-limited motions so many are found, and the fastest is taken."""
_TRIED = 5
"""Of so many motions, those that are fastest without jerk limits, the timing is made in full."""
_HALVINGS = 8
_BACK = 1.0 - 1e-3
"""Share of the greatest feasible speed found that is offered."""


@dataclass(frozen=True, eq=False)
class Moved:
    """A motion with given joint rates at its ends.

    Attributes:
        motion: The motion.
        path: Its path, with the waypoints asked for.
        constraints: Limits other than those of single joints.
    """

    motion: MovingMotion
    path: JointPath
    constraints: Sequence[PathConstraint]


@dataclass(frozen=True, eq=False)
class MovingSearch:
    """The search for motions along a path with given joint rates at its ends.

    Attributes:
        path: The path, from rest to rest.
        robot: The robot.
        limits: What the motion has to keep.
        segments: Segments with limits of their own.
        bends: Whether the path may be laid anew at its begin and at its end.
        check: Is called now and then, and may end the search by an error of its own.
    """

    path: JointPath
    robot: Robot
    limits: MotionLimits
    segments: Sequence[LimitedSegment]
    bends: tuple[bool, bool]
    check: Check

    def found(self, ends: MovingEnds) -> Moved:
        """Return the fastest motion found.

        Raises:
            TimingFailed: None was; carries the nearest rates that are feasible.
        """
        moved = self._searched(ends)
        if moved is not None:
            return moved
        nearest = self._nearest(ends)
        fields = {
            name: getattr(nearest, name).tolist()
            for name in ("start_velocity", "start_acceleration", "end_velocity")
            if getattr(ends, name).any()
        }
        asked = [name for name in fields if (getattr(ends, name) != getattr(nearest, name)).any()]
        raise TimingFailed(
            f"no motion within the limits has the {' and the '.join(asked)} asked for; "
            "the nearest found: "
            + ", ".join(f"{k} [{', '.join(f'{x:.6g}' for x in v)}]" for k, v in fields.items()),
            nearest=fields,
        )

    def _searched(self, ends: MovingEnds, *, quick: bool = False) -> Moved | None:
        limits = joint_limits(self.robot, self.limits)
        if not _below(ends, limits):
            return None
        rough: list[tuple[float, int, JointPath]] = []
        for k, (ways, path) in enumerate(self._paths(ends, limits)):
            self.check()
            if quick and any(way.kind == "via" for way in ways):
                continue
            moved = self._timed(path, ends, rough=True)
            if moved is not None:
                stops = sum(way.kind == "stop" for way in ways)
                rough.append((moved.motion.duration * _STOP_COSTS**stops, k, path))
        rough.sort(key=lambda row: row[:2])
        # Those that stop at both ends, or where only one moves, are the gentlest, and come last.
        gentlest = max(rough, key=lambda row: row[1]) if rough else None
        rough = rough[:_TRIED]
        if gentlest is not None and gentlest not in rough:
            rough.append(gentlest)
        jerk = any(x.jerk is not None for x in (self.limits, *(s.limits for s in self.segments)))
        found: list[Moved] = []
        for _, _, path in rough:
            self.check()
            moved = self._timed(path, ends, rough=False)
            if moved is not None:
                found.append(moved)
                if quick or len(found) == (_SUCCESSES if jerk else 1):
                    break
        return min(found, key=lambda moved: moved.motion.duration) if found else None

    def _paths(
        self, ends: MovingEnds, limits: JointLimits
    ) -> Iterator[tuple[tuple[Lead, Lead], JointPath]]:
        """Yield paths that begin and end along the velocities."""
        moves = (ends.start_moves, ends.end_moves)
        for free, moving, along in zip(self.bends, moves, self._off(ends), strict=True):
            if moving and not free and along > _ALONG:
                return
        for ways in leads():
            if any(
                way.kind != "plain" and not (free and moving)
                for way, free, moving in zip(ways, self.bends, moves, strict=True)
            ):
                continue
            path = moving_path(self.path, limits, ends, ways, self._paces())
            if path is not None:
                yield ways, path

    def _off(self, ends: MovingEnds) -> tuple[float, float]:
        """Angles between the velocities and the path's own directions [rad]."""
        return tuple(_angle(v, t) for v, t in zip(_velocities(ends), self._tangents(), strict=True))  # type: ignore[return-value]

    def _paces(self) -> tuple[float, float]:
        """Lengths of the tangents at the ends: those of a path that is not laid anew stay."""
        own = [float(np.linalg.norm(t)) for t in self._tangents()]
        first, last = (
            1.0 if free or length == 0.0 else length
            for free, length in zip(self.bends, own, strict=True)
        )
        return first, last

    def _tangents(self) -> tuple[Array, Array]:
        """The directions of the path at its ends.

        A natural spline has none of the path's curvature at its ends, and a direction that is off
        by that: the direction is that of a curve through points next to the end.
        """
        path = self.path
        if len(path.s_knots) == 1:
            return np.zeros(path.dof), np.zeros(path.dof)
        first, last = path.rest_knots[1], path.rest_knots[-2]
        head = slice(0, min(first, _NEAR_POINTS) + 1)
        tail = slice(max(last, len(path.s_knots) - 1 - _NEAR_POINTS), len(path.s_knots))
        return (
            _direction(path.s_knots[head], path.q_knots[head], path.tangents_start[0], 0),
            _direction(path.s_knots[tail], path.q_knots[tail], path.tangents_end[-1], -1),
        )

    def _timed(self, path: JointPath, ends: MovingEnds, *, rough: bool) -> Moved | None:
        start, end = (float(np.linalg.norm(v)) for v in _velocities(ends))
        pull = float(ends.start_velocity @ ends.start_acceleration) / start if start > 0.0 else 0.0
        paces = self._paces()
        start, pull, end = start / paces[0], pull / paces[0], end / paces[1]
        path, joint_segments, constraints = prepared(path, self.robot, self.limits, self.segments)
        try:
            motion = time_moving_path(
                path,
                joint_limits(self.robot, self.limits),
                EndRates(start, pull, end),
                segments=joint_segments,
                constraints=constraints,
                check=self.check,
                rough=rough,
            )
        except (EngineFailed, TimingFailed):
            return None
        return Moved(motion, path, constraints)

    def _nearest(self, ends: MovingEnds) -> MovingEnds:
        """The nearest rates found that are feasible."""
        limits = joint_limits(self.robot, self.limits)
        ends = self._projected(_clipped(ends, limits))
        if self._feasible(ends):
            return ends
        gentle = ends.scaled(1.0, 1.0)
        if ends.start_acceleration.any():
            gentle = replace(ends, start_acceleration=np.zeros_like(ends.start_acceleration))
            if self._feasible(gentle):
                return gentle
        if self._feasible(gentle.scaled(1.0, 0.0)):
            return gentle.scaled(1.0, self._most(lambda k: gentle.scaled(1.0, k)))
        if self._feasible(gentle.scaled(0.0, 1.0)):
            return gentle.scaled(self._most(lambda k: gentle.scaled(k, 1.0)), 1.0)
        first = self._most(lambda k: gentle.scaled(k, 0.0))
        last = self._most(lambda k: gentle.scaled(first, k))
        return gentle.scaled(first, last)

    def _feasible(self, ends: MovingEnds) -> bool:
        return not ends.moving or self._searched(ends, quick=True) is not None

    def _most(self, scaled: Callable[[float], MovingEnds]) -> float:
        """The greatest scale found that is feasible; 0 always is."""
        low, high = 0.0, 1.0
        for _ in range(_HALVINGS):
            middle = 0.5 * (low + high)
            if self._feasible(scaled(middle)):
                low = middle
            else:
                high = middle
        if low == 0.0 or self._feasible(scaled(_BACK * low)):
            return _BACK * low
        return low

    def _projected(self, ends: MovingEnds) -> MovingEnds:
        """The rates along a path that may not be laid anew."""
        changes: dict[str, Any] = {}
        names = ("start_velocity", "end_velocity")
        for free, name, t, off in zip(
            self.bends, names, self._tangents(), self._off(ends), strict=True
        ):
            if not free and off > _ALONG:
                length = float(t @ t)
                share = max(float(getattr(ends, name) @ t), 0.0) / max(length, 1e-300)
                changes[name] = share * t
        return replace(ends, **changes)


def _direction(s: Array, q: Array, natural: Array, at: int) -> Array:
    """The direction at an end of points, by a spline that is one cubic over two pieces there."""
    from scipy.interpolate import CubicSpline

    if len(s) < _FEWEST_POINTS:
        return natural
    return np.asarray(CubicSpline(s, q)(s[at], 1))


def _velocities(ends: MovingEnds) -> tuple[Array, Array]:
    return ends.start_velocity, ends.end_velocity


def _angle(v: Array, t: Array) -> float:
    norm = float(np.linalg.norm(v) * np.linalg.norm(t))
    if not v.any():
        return 0.0
    return float(np.arccos(np.clip(float(v @ t) / norm, -1.0, 1.0))) if norm > 0.0 else np.pi


def _below(ends: MovingEnds, limits: JointLimits) -> bool:
    """Whether the rates keep the limits of the joints."""
    kept = all(
        ((v <= limits.velocity) & (v >= limits.velocity_lower)).all() for v in _velocities(ends)
    )
    pull = ends.start_acceleration
    return bool(
        kept and (pull <= limits.acceleration).all() and (pull >= limits.acceleration_lower).all()
    )


def _clipped(ends: MovingEnds, limits: JointLimits) -> MovingEnds:
    start, end = (np.clip(v, limits.velocity_lower, limits.velocity) for v in _velocities(ends))
    pull = np.clip(ends.start_acceleration, limits.acceleration_lower, limits.acceleration)
    if not start.any():
        pull = np.zeros_like(pull)
    return MovingEnds(start, pull, end)
