"""Waypoints with velocities, and the motion that Ruckig makes between them, as franky plays it.

franky gives Ruckig one waypoint after the other: its joint values and velocities, accelerations of
zero, and a least time. Once a millisecond it takes a sample; with the first sample that is past the
end of one move the next move begins (franky 2.0, WaypointMotion and PositionWaypointMotion).
Ruckig: Berscheid and Kröger, Robotics: Science and Systems XVII, 2021, in its community version.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from ikplan.arrays import Array
from ikplan.errors import InvalidRequest
from ikplan.plans.playback import evaluate
from ikplan.plans.programs.certificate import ProgramCertificate
from ikplan.plans.programs.certifying import distances, limits_of
from ikplan.plans.programs.reference import Reference
from ikplan.plans.programs.thinning import ROTATION, SHIFT, TOLERANCE

if TYPE_CHECKING:
    from ikplan.documents.plan_document import PlanDocument
    from ikplan.robots import Robot

__all__ = ["CYCLE", "WaypointProgram", "waypoints"]

CYCLE = 0.001
"""Time between two samples [s]."""
_DIGITS = 6
_SHORTEST = 2
_SLOWER = 1.06
_ATTEMPTS = 40
_TIGHTER = 0.8
_SHARE = 0.9


@dataclass(frozen=True)
class WaypointProgram:
    """Waypoints of a program; the first one is where the arm waits.

    Attributes:
        least: Least time of the move to each waypoint but the first, shape (n - 1,) [ms].
        q: Joint values, shape (n, dof) [rad].
        dq: Joint velocities, shape (n, dof) [rad/s].
        limits: Joint velocities, accelerations and jerks that the moves keep, shape (3, dof).
        certificate: What holds of the motion.
    """

    least: list[int]
    q: Array
    dq: Array
    limits: Array
    certificate: ProgramCertificate


@dataclass
class _Played:
    """What has been played so far: a row each cycle."""

    q: list[Array]
    dq: list[Array]
    ddq: list[Array]
    place: list[float]

    def extend(self, other: _Played) -> None:
        self.q += other.q
        self.dq += other.dq
        self.ddq += other.ddq
        self.place += other.place


class _Moves:
    """Ruckig, with the limits of a plan."""

    def __init__(self, limits: Array) -> None:
        import ruckig

        self._working, self._finished = ruckig.Result.Working, ruckig.Result.Finished
        self._dof = limits.shape[1]
        self._ruckig = ruckig
        self._limits = limits

    def play(
        self, state: tuple[Array, Array, Array], q: Array, dq: Array, least: int
    ) -> tuple[Array, Array, Array, float] | None:
        """Rows of joint values, velocities and accelerations after each cycle, and the time.

        None: there is no such move, or it takes more than a cycle longer than its least time.
        """
        otg = self._ruckig.Ruckig(self._dof, CYCLE)
        ask: Any = self._ruckig.InputParameter(self._dof)
        out: Any = self._ruckig.OutputParameter(self._dof)
        ask.current_position, ask.current_velocity, ask.current_acceleration = (
            row.tolist() for row in state
        )
        ask.target_position, ask.target_velocity = q.tolist(), dq.tolist()
        ask.target_acceleration = [0.0] * self._dof
        ask.max_velocity, ask.max_acceleration, ask.max_jerk = self._limits.tolist()
        ask.minimum_duration = least * CYCLE
        rows: list[list[list[float]]] = []
        while len(rows) <= least:
            result = otg.update(ask, out)
            if result not in (self._working, self._finished):
                return None
            if out.trajectory.duration > least * CYCLE * (1.0 + 1e-9):
                return None
            rows.append([out.new_position, out.new_velocity, out.new_acceleration])
            out.pass_to_input(ask)
            if result == self._finished:
                found = np.array(rows)
                return found[:, 0], found[:, 1], found[:, 2], float(out.trajectory.duration)
        return None


def waypoints(
    plan: PlanDocument,
    robot: Robot,
    tolerance: float = TOLERANCE,
    rotation: float = ROTATION,
) -> WaypointProgram:
    """Return waypoints for a plan: from each, the farthest whose move keeps the tolerance.

    A move begins and ends without acceleration, so it needs more of it in between than the plan
    has. Where that is more than the limits allow, the whole program is slower.

    Args:
        plan: The plan.
        robot: Its robot, with jerk limits.
        tolerance: Largest distance of the tool from the path [m].
        rotation: Largest rotation of the tool from the plan's orientation [rad].

    Raises:
        InvalidRequest: The plan does not move, Ruckig is not installed, or no waypoints keep the
            tolerance.
    """
    if len(plan.time) == 1:
        raise InvalidRequest(
            "a plan that does not move has no program", field="format", allowed="a plan that moves"
        )
    try:
        import ruckig  # noqa: F401 - only whether it is there
    except ImportError as error:
        raise InvalidRequest(
            "a franky program is played by Ruckig to be certified: pip install 'ikplan[franky]'",
            field="format",
            allowed="another format than franky",
        ) from error
    assert robot.jerk_limit is not None
    # Rounded as a program has them, and not above the maker's.
    limits = np.floor(np.array([*limits_of(plan, robot), robot.jerk_limit]) * 1e9) / 1e9
    moves, reference = _Moves(limits), Reference.of(plan, robot)
    pace, share = 1.0, _SHARE
    for _ in range(_ATTEMPTS):
        made = _thinned(plan, reference, moves, pace, (share * tolerance, share * rotation))
        if made is None:
            pace *= _SLOWER
            continue
        least, q, dq, played = made
        found = _certified(plan, robot, limits, len(least) + 1, played, tolerance)
        if found.max_path_deviation <= tolerance and found.max_orientation_deviation <= rotation:
            return WaypointProgram(least, q, dq, limits, found)
        share *= _TIGHTER
    raise InvalidRequest(
        f"no waypoints keep {tolerance:g} m and {rotation:g} rad at {pace:.1f} times the time",
        field="tolerance",
        allowed="a larger tolerance",
    )


def _thinned(
    plan: PlanDocument, reference: Reference, moves: _Moves, pace: float, aim: tuple[float, float]
) -> tuple[list[int], Array, Array, _Played] | None:
    """Waypoints at a pace; None: even the shortest moves are too fast for the limits."""
    start = np.round(reference.q[0], _DIGITS)
    still = np.zeros_like(start)
    state = (start, still, still)
    played = _Played([start], [still], [still], [0.0])
    points, speeds, least = [start], [still], []
    place, guess = 0.0, 32
    while place < plan.duration:
        ticks = max(math.ceil((plan.duration - place) * pace / CYCLE - 1e-9), 1)

        def attempt(
            n: int,
            place: float = place,
            state: tuple[Array, Array, Array] = state,
            ticks: int = ticks,
        ) -> tuple[Array, Array, _Played, float] | None:
            to = plan.duration if n >= ticks else place + n * CYCLE / pace
            q, dq, _ = (row[0] for row in evaluate(plan, [to]))
            q, dq = np.round(q, _DIGITS), np.round(dq / pace, _DIGITS) + 0.0
            if n >= ticks:
                dq = np.zeros_like(dq)
            found = moves.play(state, q, dq, n)
            if found is None:
                return None
            rows, rates, changes, time = found
            through = np.arange(1, len(rows) + 1) * CYCLE / time
            at = np.minimum(place + through * (to - place), plan.duration)
            near = np.rint(at / reference.time[1]).astype(np.int64)
            near = np.minimum(near, len(reference.time) - 1)
            off = reference.errors(rows, near)
            if any(float(e.max()) > most for e, most in zip(off, (*aim, SHIFT), strict=True)):
                return None
            return q, dq, _Played(list(rows), list(rates), list(changes), at.tolist()), to

        # By doubling, then by halves: the longest move found that keeps the tolerance.
        low, high = 0, 0
        best: tuple[Array, Array, _Played, float] | None = None
        n = min(guess, ticks)
        while True:
            found = attempt(n)
            if found is not None:
                best, low = found, n
                if n == ticks:
                    break
                n = min(2 * n, ticks) if high == 0 else (low + high) // 2
            else:
                high = n
                n = (low + high) // 2 if low else n // 2
            if n < min(_SHORTEST, ticks) or (high and high - low <= 1):
                break
        if best is None:
            return None
        q, dq, part, to = best
        least.append(low)
        points.append(q)
        speeds.append(dq)
        played.extend(part)
        state = (part.q[-1], part.dq[-1], part.ddq[-1])
        place, guess = max(to, part.place[-1]), max(low, 8)
    return least, np.array(points), np.array(speeds), played


def _certified(
    plan: PlanDocument, robot: Robot, limits: Array, count: int, played: _Played, tolerance: float
) -> ProgramCertificate:
    off = distances(plan, robot, np.array(played.q), np.array(played.place))
    duration = (len(played.q) - 1) * CYCLE
    shares = [
        float((np.abs(np.array(rows)) / limits[k]).max())
        for k, rows in enumerate((played.dq, played.ddq))
    ]
    return ProgramCertificate(
        interpolation="waypoints",
        points=count,
        duration=duration,
        time_factor=max(duration / plan.duration, 1.0),
        tolerance=tolerance,
        max_path_deviation=off.path,
        max_orientation_deviation=off.orientation,
        max_joint_deviation=off.joints,
        max_time_shift=off.shift,
        velocity_limit_ratio=shares[0],
        acceleration_limit_ratio=shares[1],
    )
