"""The order of values is that of NumPy, equal ones and NaN included."""

from __future__ import annotations

import numpy as np
import pytest

from ikplan.sorting import stable_order


@pytest.mark.parametrize("count", [0, 1, 2, 15, 16, 17, 32, 33, 47, 1000])
def test_order_is_that_of_a_stable_sort(count: int) -> None:
    random = np.random.default_rng(count)
    values = np.round(random.random(count), 1)
    values[random.random(count) < 0.2] = np.inf
    np.testing.assert_array_equal(stable_order(values), np.argsort(values, kind="stable"))
    values[random.random(count) < 0.3] = np.nan
    np.testing.assert_array_equal(stable_order(values), np.argsort(values, kind="stable"))
