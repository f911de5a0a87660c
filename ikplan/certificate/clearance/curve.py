"""A motion as joint values cubic in a parameter: what is handed out, exactly."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ikplan.certificate.clearance.path_time import PathTime
from ikplan.documents.timing_report import MotionPolynomials
from ikplan.errors import InvalidRequest

__all__ = ["JointCurve"]

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class JointCurve:
    """Joint values as cubics of a parameter u: piece k is passed while u goes from k to k + 1.

    Attributes:
        controls: Bezier control values of each piece, shape (n, 4, dof) [rad or m].
        interpolation: "polynomials" of a plan's motion, or "cubic" between samples.
        begins: Where each piece begins, and the last one ends, shape (n + 1,): path positions of
            "polynomials", times of "cubic" [s].
        timing: The path position at any time; None: ``begins`` has times.
    """

    controls: Array
    interpolation: str
    begins: Array
    timing: PathTime | None

    @classmethod
    def of_motion(cls, motion: MotionPolynomials) -> JointCurve:
        """Return the polynomials of a plan.

        Raises:
            InvalidRequest: The motion leaves its path.
        """
        s, q = motion.s_knots, motion.q_knots
        if len(s) == 1:
            end = float(motion.node_time[-1]) if len(motion.node_time) else 0.0
            return cls(np.repeat(q[:, None], 4, axis=1), "polynomials", np.array([0.0, end]), None)
        timing = PathTime(motion.node_time, motion.node_s, motion.node_sdot, motion.node_sddot)
        timing.check_within(float(s[0]), float(s[-1]))
        controls = _controls(np.diff(s), q, motion.tangents_start, motion.tangents_end)
        return cls(controls, "polynomials", np.asarray(s), timing)

    @classmethod
    def of_samples(cls, time: Array, q: Array, dq: Array) -> JointCurve:
        """Return the cubics between samples that have their positions and velocities.

        Args:
            time: Times, shape (m,), strictly increasing [s].
            q: Joint values, shape (m, dof) [rad or m].
            dq: Their velocities, shape (m, dof) [rad/s or m/s].

        Raises:
            InvalidRequest: The shapes do not fit, or the times do not increase.
        """
        time, q, dq = (np.asarray(a, dtype=np.float64) for a in (time, q, dq))
        if time.ndim != 1 or len(time) < 1 or q.ndim != 2 or q.shape != dq.shape:
            raise InvalidRequest("samples: time is (m,), q and dq are (m, dof)", field="samples")
        if len(q) != len(time) or not (np.diff(time) > 0.0).all():
            raise InvalidRequest("samples: one row a time, times increase", field="samples.time")
        if len(time) == 1:
            return cls(np.repeat(q[:, None], 4, axis=1), "cubic", np.repeat(time, 2), None)
        return cls(_controls(np.diff(time), q, dq[:-1], dq[1:]), "cubic", time, None)

    def __post_init__(self) -> None:
        if not np.isfinite(self.controls).all():
            raise InvalidRequest("the motion is not finite", field="motion", allowed="numbers")

    @property
    def duration(self) -> float:
        """When the motion ends [s]."""
        return float(self.begins[-1]) if self.timing is None else float(self.timing.time[-1])

    def serial(self, coupling: Array, offset: Array) -> Array:
        """Return the control values of the serial joints, shape (n, 4, n_serial) [rad or m]."""
        if np.array_equal(coupling, np.eye(len(coupling))) and not offset.any():
            return np.ascontiguousarray(self.controls)
        return np.ascontiguousarray(self.controls @ coupling.T + offset)

    def at(self, u: float) -> Array:
        """Return the joint values at a parameter, shape (dof,) [rad or m]."""
        k = max(0, min(int(u), len(self.controls) - 1))
        x = u - k
        r = 1.0 - x
        weights = np.array([r * r * r, 3 * r * r * x, 3 * r * x * x, x * x * x])
        value: Array = weights @ self.controls[k]
        return value

    def window(self, begin: float, end: float) -> tuple[float, float]:
        """Return a range of the parameter that holds all the motion between two times [s]."""
        if self.timing is None:
            return self._parameter(begin), self._parameter(end)
        low, high = self.timing.range(begin, end)
        return self._parameter(low), self._parameter(high)

    def time(self, u: float) -> float:
        """Return the time at which a parameter is passed first [s]."""
        k = max(0, min(int(u), len(self.begins) - 2))
        at = float(self.begins[k] + (u - k) * (self.begins[k + 1] - self.begins[k]))
        return at if self.timing is None else self.timing.when(at)

    def _parameter(self, at: float) -> float:
        begins = self.begins
        k = max(0, min(int(begins.searchsorted(at, side="right")) - 1, len(begins) - 2))
        begin = float(begins[k])
        length = float(begins[k + 1]) - begin
        x = (at - begin) / length if length > 0.0 else 0.0
        return k + max(0.0, min(x, 1.0))


def _controls(length: Array, q: Array, begin: Array, end: Array) -> Array:
    """Bezier control values of cubics with values q and slopes at both ends."""
    third = length[:, None] / 3.0
    controls = np.empty((len(length), 4, q.shape[1]))
    controls[:, 0], controls[:, 3] = q[:-1], q[1:]
    controls[:, 1], controls[:, 2] = q[:-1] + third * begin, q[1:] - third * end
    return controls
