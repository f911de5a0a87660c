"""Which of many starts are tracked in full: none that leads to the end is left out."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.typing import NDArray

from ikplan.planning.tracking.farthest_starts import farthest_starts
from ikplan.planning.tracking.tracked_path import TrackingFailed

Array = NDArray[np.float64]


@pytest.mark.parametrize("seed", range(5))
def test_starts_that_lead_to_the_end_are_kept_and_four_that_nearly_do(seed: int) -> None:
    reach = np.random.default_rng(seed).permutation(
        [1.0, 1.0, 1.0, 1.0, 1.0, 0.9, 0.8, 0.7, 0.6, 0.5]
    )
    starts = np.arange(10.0)[:, None]

    def track(q: Array) -> None:
        if reach[int(q[0])] < 1.0:
            raise TrackingFailed(float(reach[int(q[0])]), q)

    kept = farthest_starts(track, starts, 1.0)
    np.testing.assert_array_equal(kept, np.flatnonzero(reach == 1.0))
    reach = np.where(reach == 1.0, 0.1, reach)
    kept = farthest_starts(track, starts, 1.0)
    np.testing.assert_array_equal(kept, np.flatnonzero(reach > 0.55))
