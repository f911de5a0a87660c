"""What is taken of short arrays in less time is what NumPy takes, to the last digit."""

from __future__ import annotations

import numpy as np
import pytest

from ikplan.arrays import length_of, lengths_of, steps_of


@pytest.mark.parametrize("columns", [1, 2, 3, 6, 7, 9])
@pytest.mark.parametrize("count", [0, 1, 2, 100])
def test_lengths_and_steps_are_those_of_numpy(count: int, columns: int) -> None:
    rows = np.random.default_rng(count).normal(size=(count, columns))
    assert lengths_of(rows).tobytes() == np.linalg.norm(rows, axis=1).tobytes()
    assert steps_of(rows).tobytes() == np.diff(rows, axis=0).tobytes()
    assert [length_of(row) for row in rows] == [float(np.linalg.norm(row)) for row in rows]
