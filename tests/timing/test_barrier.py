"""The barrier of a motion played at another speed, against its formulas written out."""

from __future__ import annotations

import numpy as np
import pytest

from ikplan.arrays import Array
from ikplan.timing.jerk.barrier_kernels import excess_of, longest_step, time_and_room
from ikplan.timing.jerk.barrier_lanes import SpeedSpline, WarpLimits
from ikplan.timing.jerk.course_kernels import FIRST, spline_basis
from ikplan.timing.jerk.newton_kernels import newton_step

SIZES = (1, 63, 64, 65, 130)  # about one block and about two


def drawn(n: int, dof: int, rows: int, seed: int = 0) -> tuple[Array, SpeedSpline, WarpLimits]:
    """A squared rate inside limits, its spline and the limits."""
    rng = np.random.default_rng(seed)
    tau = np.append(0.0, np.cumsum(rng.uniform(0.5, 1.5, n)))
    tau /= tau[-1]
    value, slope, bend = spline_basis(tau, np.array([FIRST, 1.0 - FIRST]))
    values, slopes = (np.ascontiguousarray(x.transpose(1, 2, 0)) for x in (value, slope))
    spline = SpeedSpline(np.diff(tau), values, slopes, np.ascontiguousarray(bend.T))
    small = 0.1 / n**2
    rates = (
        rng.uniform(-1.0, 1.0, (2, dof, 5, n)) * np.array([1.0, small, 0.2, small, small])[:, None]
    )
    most = np.where(rng.uniform(size=(2, n)) < 0.5, np.inf, 2.0)
    up, down = rng.uniform(0.1, 0.6, (2, 2, dof, n))
    rows_b, rows_d = rng.uniform(-0.5, 0.5, (2, 2, rows, n))
    limits = WarpLimits(rates, most, up, -down, rows_b, small * rows_d)
    return rng.uniform(0.7, 0.9, n + 2), spline, limits


def rooms(c: Array, spline: SpeedSpline, limits: WarpLimits) -> tuple[float, Array]:
    """The time and the rooms to all limits, written out."""
    windows = np.stack([c[:-2], c[1:-1], c[2:]])
    b, b1 = (spline.value * windows).sum(axis=1), (spline.slope * windows).sum(axis=1)
    b2 = (spline.bend * windows).sum(axis=0)
    w = b**-0.5
    r = limits.rates.transpose(2, 1, 0, 3)
    pull, jerk = r[0] * b + r[1] * b1, r[2] * b + r[3] * b1 + r[4] * b2
    of_rows = limits.rows_b * b[:, None] + limits.rows_d * b1[:, None]
    found = [
        1.0 - b / limits.most,
        1.0 - pull * limits.up.transpose(1, 0, 2),
        1.0 - pull * limits.down.transpose(1, 0, 2),
        w - jerk,
        w + jerk,
        1.0 - of_rows,
    ]
    return float((0.5 * spline.h * w).sum()), np.concatenate([x.ravel() for x in found])


@pytest.mark.parametrize("n", SIZES)
@pytest.mark.parametrize(("dof", "rows", "share"), [(7, 0, 1.0), (2, 5, 1.0), (150, 5, 0.01)])
def test_time_and_room_are_those_of_the_formulas(n: int, dof: int, rows: int, share: float) -> None:
    # The product of the rooms of very many joints that move slowly would overflow.
    c, spline, limits = drawn(n, dof, rows)
    c = share * c
    total, found = rooms(c, spline, limits)
    assert found.min() > 0.0
    assert time_and_room(c, spline, limits) == pytest.approx((total, np.log(found).sum()), rel=1e-9)
    assert excess_of(c, spline, limits).max() < 1.0


@pytest.mark.parametrize("n", SIZES)
def test_outside_a_limit_there_is_no_room(n: int) -> None:
    c, spline, limits = drawn(n, 3, 2)
    for field, value in (("most", 0.1), ("up", 1e4), ("down", -1e4), ("rows_b", 9.0)):
        array = getattr(limits, field).copy()
        array[-1, ..., -1] = value
        beyond = limits._replace(**{field: array})
        if rooms(c, spline, beyond)[1].min() < 0.0:
            assert time_and_room(c, spline, beyond) == (np.inf, 0.0)
            assert excess_of(c, spline, beyond)[-1] > 1.0
            assert (excess_of(c, spline, beyond)[:-1] < 1.0).all()


@pytest.mark.parametrize("n", SIZES)
@pytest.mark.parametrize("mu", [1e-2, 1e-4])
def test_a_step_lowers_the_merit_by_its_slope_and_keeps_inside(n: int, mu: float) -> None:
    c, spline, limits = drawn(n, 7, 3)

    def merit(place: Array) -> float:
        total, room = time_and_room(place, spline, limits)
        return total - mu * room

    step, fall = newton_step(c, mu, spline, limits)
    share = 1e-5 * longest_step(c, step, spline, limits)
    slope = (merit(c + share * step) - merit(c - share * step)) / (2.0 * share)
    assert fall > 0.0
    assert slope == pytest.approx(-fall, rel=1e-4)
    total, room = time_and_room(c + longest_step(c, step, spline, limits) * step, spline, limits)
    assert np.isfinite(total)
    assert np.isfinite(room)
