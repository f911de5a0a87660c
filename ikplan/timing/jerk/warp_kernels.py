"""The shortest time along a motion played at another speed: an interior-point method, compiled."""

from __future__ import annotations

import numpy as np

from ikplan._jit import kernel
from ikplan.arrays import Array
from ikplan.joint_path.evaluation import interval_of
from ikplan.timing.jerk.barrier_kernels import excess_of, longest_step, time_and_room
from ikplan.timing.jerk.barrier_lanes import SpeedSpline, WarpLimits
from ikplan.timing.jerk.course_kernels import FIRST, spline_basis
from ikplan.timing.jerk.jerk_kernels import spread
from ikplan.timing.jerk.newton_kernels import newton_step

__all__ = ["fastest_warp"]

_MAX_STEPS = 40
_HALVINGS = 30
# A squared speed within the limits as a share of that asked for, above which little is to do.
_NEAR = 0.8
# Where a motion exceeds limits it is slowed at first: by so much more than needed, over these
# multiples of the time in which accelerations build up, so many times.
_BELOW = 0.03
# On fewer intervals the whole is slowed and steps are halved: that costs little there, and its
# local optima are a little shorter.
_FEW = 1_500
_REACHES = (20.0, 60.0, 6.0)
_DIPS = 6
# Where that does not do, so many steps at most lead it in, by a barrier of this weight, within
# limits so much wider than it needs.
_ENTERING, _ENTERING_MU, _WIDER = 20, 0.3, 1.1


@kernel
def _running_mean(values: Array, tau: Array, reach: float) -> Array:
    """Return the means of values over a reach each way, the ends going on for ever, shape (n,)."""
    n = len(values)
    below = np.zeros(n + 1)
    for i in range(n):
        below[i + 1] = below[i] + values[i] * (tau[i + 1] - tau[i])
    out = np.empty(n)
    for i in range(n):
        middle = 0.5 * (tau[i] + tau[i + 1])
        ends = np.empty(2)
        for side in range(2):
            at = middle + (reach if side == 1 else -reach)
            if at <= tau[0]:
                ends[side] = values[0] * (at - tau[0])
            elif at >= tau[n]:
                ends[side] = below[n] + values[n - 1] * (at - tau[n])
            else:
                k = interval_of(tau, at)
                ends[side] = below[k] + values[k] * (at - tau[k])
        out[i] = (ends[1] - ends[0]) / (2.0 * reach)
    return out


@kernel
def _dipped(excess: Array, tau: Array, reach: float) -> Array:
    """Return logarithms of what to slow a motion by: smooth, at least what is asked, (n,)."""
    needed = np.zeros(len(excess))
    for i in range(len(excess)):
        if excess[i] > 1.0 - 0.5 * _BELOW:
            needed[i] = np.log(min(excess[i], 10.0)) + _BELOW
    wide = spread(needed, tau, reach)
    for _ in range(3):
        wide = _running_mean(wide, tau, reach / 3.0)
    return wide


@kernel
def _widened(limits: WarpLimits, wider: Array) -> WarpLimits:
    """Return limits that allow a squared rate higher by a factor, interval by interval, (n,)."""
    rates = limits.rates.copy()
    rates[:, :, 2:] = rates[:, :, 2:] / (wider * np.sqrt(wider))
    return WarpLimits(
        rates,
        limits.most * wider,
        limits.up / wider,
        limits.down / wider,
        limits.rows_b / wider,
        limits.rows_d / wider,
    )


@kernel
def _entered(c: Array, spline: SpeedSpline, limits: WarpLimits) -> Array:
    """Lead a motion into its limits by Newton's steps within wider ones.

    Where it exceeds limits they are wider than needed by a little. The barrier leads it away from
    them, and they are narrowed again.

    Returns:
        Coefficients, shape (n + 2,); all zero where the limits are not reached.
    """
    excess = excess_of(c, spline, limits)
    wider = np.maximum(_WIDER * excess, 1.0)
    for _ in range(_ENTERING):
        if not excess.max() < np.inf:
            break
        wide = _widened(limits, wider)
        step, _ = newton_step(c, _ENTERING_MU / len(excess), spline, wide)
        c = c + longest_step(c, step, spline, wide) * step
        excess = excess_of(c, spline, limits)
        if excess.max() < 0.999:
            return c
        wider = np.minimum(wider, np.maximum(_WIDER * excess, 1.0))
    return np.zeros(len(c))


@kernel
def _begin(tau: Array, spline: SpeedSpline, limits: WarpLimits, swing: float, led: bool) -> Array:
    """Return coefficients within the limits, slowed smoothly about the places that exceed them.

    The arguments are those of fastest_warp.

    Returns:
        Coefficients, shape (n + 2,); where neither smooth dips nor steps within wider limits do,
        the whole is slowed; all zero where not even that does.
    """
    n = len(tau) - 1
    for reach in _REACHES:
        if n <= _FEW or reach * swing > 0.25:
            break
        slower = np.zeros(n)
        for _ in range(_DIPS):
            c = np.empty(n + 2)
            for i in range(n + 2):
                c[i] = 0.98 * np.exp(-0.5 * (slower[max(i - 2, 0)] + slower[min(i, n - 1)]))
            excess = excess_of(c, spline, limits)
            if excess.max() < 0.999:
                return c
            if not excess.max() < np.inf:
                break
            slower += _dipped(excess, tau, reach * swing)
    c = np.full(n + 2, 0.98)
    if led and n > _FEW:
        entered = _entered(c, spline, limits)
        if entered.any():
            return entered
    for _ in range(100):
        excess = excess_of(c, spline, limits)
        if excess.max() < 1.0:
            return c
        c *= 0.9
    return np.zeros(n + 2)


@kernel
def fastest_warp(
    tau: Array,
    limits: WarpLimits,
    weights: tuple[float, float, float],
    shrink: float,
    swing: float,
    led: bool,
) -> Array:
    """Play a motion as fast as limits allow, at a speed that varies along it.

    A motion r(tau) is played at tau(t). With b = (dtau/dt)^2, velocities are r' sqrt(b),
    accelerations r'' b + r' b' / 2, and jerks sqrt(b) (r''' b + 3 r'' b' / 2 + r' b'' / 2). b is
    a quadratic spline; the time is the integral of b^(-1/2). A barrier of logarithms keeps the
    limits.

    Args:
        tau: Knots of the spline, shape (n + 1,), strictly increasing.
        limits: The limits, at the nodes of Gauss of each interval.
        weights: First weight of the barrier for a motion that exceeds limits by much, first
            weight for another, and last weight.
        shrink: Factor from one to the next, below 1.
        swing: About the time in which accelerations build up, as a share of the duration.
        led: Whether a motion that smooth dips do not bring within the limits is led there before
            the whole is slowed: soon found, a little longer at times.

    Returns:
        The coefficients of b, shape (n + 2,); all zero where not even a slow motion keeps the
        limits.
    """
    spline = _spline(tau)
    c = _begin(tau, spline, limits, swing, led)
    mu, again_mu, last_mu = weights
    total, room = time_and_room(c, spline, limits)
    if not total < np.inf:
        return np.zeros(len(c))
    if c.max() > _NEAR:
        mu = again_mu
    while True:
        merit = total - mu * room
        for _ in range(_MAX_STEPS):
            step, fall = newton_step(c, mu, spline, limits)
            if not fall > 0.02 * mu * len(spline.h):
                break
            size, moved = 1.0, False
            if len(spline.h) > _FEW:
                size = longest_step(c, step, spline, limits)
            for _ in range(_HALVINGS):
                trial = c + size * step
                new_total, new_room = time_and_room(trial, spline, limits)
                new = new_total - mu * new_room
                if new < merit - 1e-3 * size * fall:
                    moved = True
                    break
                size *= 0.5
            if not moved:
                break
            c, merit, total, room = trial, new, new_total, new_room
        if mu <= last_mu:
            return c
        mu = max(mu * shrink, last_mu)


@kernel
def _spline(tau: Array) -> SpeedSpline:
    """Return the spline at the nodes of Gauss, one row of numbers for all intervals."""
    value, slope, bend = spline_basis(tau, np.array([FIRST, 1.0 - FIRST]))
    return SpeedSpline(
        np.diff(tau),
        np.ascontiguousarray(value.transpose(1, 2, 0)),
        np.ascontiguousarray(slope.transpose(1, 2, 0)),
        np.ascontiguousarray(bend.T),
    )
