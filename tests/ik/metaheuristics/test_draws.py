"""Random draws, Halton points, order, bounds."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays
from scipy.stats import qmc

from ikplan.ik.metaheuristics.bounds import CLIP, REFLECT, RESAMPLE, bound, bound_flight
from ikplan.ik.metaheuristics.draw import (
    distinct,
    levy_deviation,
    levy_step,
    permutation,
    subset,
)
from ikplan.ik.metaheuristics.halton import halton_into
from ikplan.ik.metaheuristics.order import ascending


@settings(max_examples=60, deadline=None)
@given(n=st.integers(6, 40), count=st.integers(1, 5), seed=st.integers(0, 99), data=st.data())
def test_distinct_indices_differ_from_each_other_and_from_the_excluded(
    n: int, count: int, seed: int, data: st.DataObject
) -> None:
    exclude = data.draw(st.integers(-1, n - 1))
    out = np.empty(count, dtype=np.int64)
    distinct(n, exclude, out, np.random.default_rng(seed))
    assert len(set(out.tolist())) == count
    assert exclude not in out
    assert all(0 <= i < n for i in out)


def test_permutations_are_uniform() -> None:
    rng, out = np.random.default_rng(1), np.empty(3, dtype=np.int64)
    counts: dict[tuple[int, ...], int] = {}
    for _ in range(6000):
        permutation(3, out, rng)
        counts[tuple(out)] = counts.get(tuple(out), 0) + 1
    assert len(counts) == 6
    assert min(counts.values()) > 850


def test_subset_draws_each_index_equally_often() -> None:
    rng, out, hits = np.random.default_rng(1), np.empty(5, dtype=np.int64), np.zeros(5)
    for _ in range(5000):
        subset(5, 2, out, rng)
        hits[out[:2]] += 1
    np.testing.assert_allclose(hits / 5000, 0.4, atol=0.03)


def test_deviation_of_mantegnas_step() -> None:
    assert levy_deviation(1.5) == pytest.approx(0.696575, abs=5e-7)
    # Of the Cauchy law, beta = 1, it is 1.
    assert levy_deviation(1.0) == pytest.approx(1.0, abs=1e-12)


def test_levy_steps_have_the_tail_of_their_law() -> None:
    rng = np.random.default_rng(0)
    steps = np.abs([levy_step(levy_deviation(1.5), 1.5, rng) for _ in range(60_000)])
    far, farther = (steps > 5.0).mean(), (steps > 20.0).mean()
    # P(|s| > x) falls as x^-beta.
    assert math.log(far / farther) / math.log(4.0) == pytest.approx(1.5, abs=0.15)


def test_halton_points_are_scipys() -> None:
    X = np.empty((60, 7))
    halton_into(X)
    expected = qmc.Halton(7, scramble=False).random(61)[1:]
    np.testing.assert_allclose(X, expected, rtol=1e-13)


@settings(max_examples=60, deadline=None)
@given(values=arrays(np.float64, st.integers(1, 40), elements=st.integers(0, 9).map(float)))
def test_ascending_is_a_stable_sort(values: np.ndarray) -> None:
    np.testing.assert_array_equal(ascending(values), np.argsort(values, kind="stable"))


@settings(max_examples=60, deadline=None)
@given(
    x=arrays(np.float64, 4, elements=st.floats(-20, 20)),
    mode=st.sampled_from([CLIP, REFLECT, RESAMPLE]),
)
def test_bounds_hold_and_leave_what_is_inside(x: np.ndarray, mode: int) -> None:
    lower, upper = np.full(4, -1.0), np.full(4, 3.0)
    y, v = x.copy(), np.full(4, 0.5)
    z = x.copy()
    bound_flight(y, v, lower, upper, mode, np.random.default_rng(0))
    bound(z, lower, upper, mode, np.random.default_rng(0))
    np.testing.assert_array_equal(y, z)
    assert ((y >= lower) & (y <= upper)).all()
    inside = (x >= lower) & (x <= upper)
    np.testing.assert_array_equal(y[inside], x[inside])
    np.testing.assert_array_equal(v[inside], 0.5)
    np.testing.assert_array_equal(v[~inside], -0.5 if mode == REFLECT else 0.0)
    if mode == CLIP:
        np.testing.assert_array_equal(y, np.clip(x, lower, upper))


def test_reflection_by_hand() -> None:
    x = np.array([-1.5, 3.25, 99.0])
    bound(x, np.full(3, -1.0), np.full(3, 3.0), REFLECT, np.random.default_rng(0))
    # Beyond one width a reflection would leave on the other side: it ends at the bound.
    np.testing.assert_allclose(x, [-0.5, 2.75, -1.0])
