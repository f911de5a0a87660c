"""The natural cubic spline against that of scipy."""

import numpy as np
import pytest
from numpy.testing import assert_allclose
from scipy.interpolate import CubicSpline

from ikplan.path.curves.natural_spline import NaturalSpline


@pytest.mark.parametrize("count", [2, 3, 4, 40])
def test_the_spline_is_that_of_scipy(count: int) -> None:
    draw = np.random.default_rng(count)
    # So uneven that rows are exchanged where the equations are solved.
    x = np.cumsum(10.0 ** draw.uniform(-3.0, 1.0, count))
    y = draw.normal(size=(count, 3))
    expected, spline = CubicSpline(x, y, bc_type="natural"), NaturalSpline(x, y)
    size = np.abs(expected.c).max(axis=(1, 2), keepdims=True)
    assert (np.abs(spline.c - expected.c) <= 1e-13 * size).all()
    at = np.concatenate([x, draw.uniform(x[0] - 0.1, x[-1] + 0.1, 100)])
    assert_allclose(spline(at), expected(at), rtol=0.0, atol=1e-13 * np.abs(expected(at)).max())


@pytest.mark.parametrize(
    ("x", "y"),
    [([0.0, 1.0, 1.0], [0.0, 1.0, 2.0]), ([0.0, 1.0, 2.0], [0.0, np.nan, 2.0])],
)
def test_a_spline_that_does_not_exist_is_refused(x: list[float], y: list[float]) -> None:
    with pytest.raises(ValueError, match="increase"):
        NaturalSpline(np.array(x), np.array(y)[:, None])
