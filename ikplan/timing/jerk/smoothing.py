"""One search for a jerk-limited motion: a window, and the path speed held back on bends."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ikplan.arrays import Array
from ikplan.joint_path.joint_path import JointPath
from ikplan.timing.engines.compiled_engine import CompiledEngine
from ikplan.timing.engines.engine import Check, EngineFailed
from ikplan.timing.engines.rows import StageRows, natural_units
from ikplan.timing.jerk.cubic_kernels import moving_average
from ikplan.timing.jerk.cubic_motion import CubicMotion
from ikplan.timing.jerk.jerk_kernels import path_rates, slowdown_factors, spread
from ikplan.timing.problem import SpanProblem
from ikplan.timing.profile import LimitProfile

__all__ = ["JointSlowdown", "Smoothing"]


# How much of a local factor above 1 is taken at once, and when it is small enough.
_STEP = 0.5
_ENOUGH = 1.002
_POINTS = 3


@dataclass(frozen=True, eq=False)
class JointSlowdown:
    """By what factor of time a motion would keep the limits of its joints, place by place.

    Attributes:
        path: The path.
        profile: Joint limits on every piece of it.
        third: Third derivatives of the pieces.
    """

    path: JointPath
    profile: LimitProfile
    third: Array

    def __call__(self, motion: CubicMotion, points: int, places: Array) -> Array:
        """Return the factors; see slowdown_factors."""
        path, profile = self.path, self.profile
        return slowdown_factors(
            path.s_knots,
            path.q_knots,
            path.tangents_start,
            path.tangents_end,
            self.third,
            motion.time,
            motion.s,
            motion.v,
            motion.a,
            profile.velocity,
            profile.velocity_lower,
            profile.acceleration,
            profile.acceleration_lower,
            profile.jerk,
            points,
            places,
        )


class Smoothing:
    """The search for the shortest motion with one window.

    The path speed is smoothed by a moving average over time. Where the result exceeds a limit, the
    path is timed again with the motion slowed there and within the window about it.

    Args:
        problem: The path and its limits, those of the jerk apart.
        x: Squared path velocities within them, shape (n + 1,).
        window: Length of the window [s].
        slowdown: What judges the motions.

    Attributes:
        best: The shortest motion so far, None before the first round.
    """

    def __init__(
        self, problem: SpanProblem, x: Array, window: float, slowdown: JointSlowdown
    ) -> None:
        self._problem, self._window, self._slowdown = problem, window, slowdown
        self._rows, self._unit = natural_units(problem.rows())
        self._free, self._x = x, x
        self._slower = np.ones(len(problem.h))
        self._done = False
        self.best: CubicMotion | None = None

    @property
    def duration(self) -> float:
        """Duration of the shortest motion so far [s]."""
        return float(self.best.time[-1]) if self.best is not None else np.inf

    def run(self, rounds: int, check: Check) -> None:
        """Search on.

        Args:
            rounds: For at most so many rounds.
            check: Is called before each, and may end the search by an error of its own.
        """
        problem, s = self._problem, self._problem.grid.s
        for _ in range(rounds):
            if self._done:
                return
            check()
            time = np.concatenate([[0.0], np.cumsum(problem.times(self._x))])
            motion = CubicMotion(*moving_average(time, s, np.sqrt(self._x), self._window))
            slowdown = self._slowdown(motion, _POINTS, s)
            if problem.constraints:
                slowdown = np.maximum(slowdown, _constraint_slowdown(problem, motion))
            largest = float(slowdown.max())
            if largest * motion.time[-1] < self.duration:
                self.best = motion.slowed(largest)
            self._slower *= np.maximum(spread(slowdown, time, 0.5 * self._window), 1.0) ** _STEP
            self._done = largest <= _ENOUGH or not self._slow()

    def _slow(self) -> bool:
        """Find the path speed with every interval passed slower by its own factor, if there is."""
        square = np.square(self._slower)
        at_nodes = np.maximum(np.append(square, square[-1]), np.append(square[0], square))
        rows, tight = self._rows, square[:, None]
        capped = np.minimum(rows.x_max, self._free / self._unit / at_nodes)
        try:
            x = CompiledEngine().solve(StageRows(rows.s, rows.a * tight, rows.b * tight, capped))
        except EngineFailed:
            return False
        self._x = x * self._unit
        return True


def _constraint_slowdown(problem: SpanProblem, motion: CubicMotion) -> Array:
    """Return by what factor of time a motion would keep the constraints, shape (n,)."""
    s = problem.grid.s
    places = np.array([s[:-1], 0.5 * (s[:-1] + s[1:]), s[1:]])
    v, u = path_rates(motion.time, motion.s, motion.v, motion.a, places.ravel())
    return problem.others.slowdown_factors(
        u.reshape(places.shape), np.square(v).reshape(places.shape)
    )
