"""Where a motion on a grid turns from speeding up to slowing down."""

from __future__ import annotations

import numpy as np
import pytest

from ikplan.timing.together.switch_points import switch_points


@pytest.mark.parametrize("place", [0.31, 0.5 + 1e-3, 0.77])
@pytest.mark.parametrize("fall", [0.5, 1.0, 3.0])
def test_the_peak_between_two_nodes_is_found(place: float, fall: float) -> None:
    """A motion that speeds up to a place and slows down from there has its peak there."""
    s = np.linspace(0.0, 1.0, 18)
    x = np.minimum(2.0 * s, 2.0 * place - 2.0 * fall * (s - place))
    loss = np.zeros(17)
    loss[int(np.searchsorted(s, place)) - 1] = 1.0
    found = switch_points(s, x, loss, np.array([0, 17]), 0.1, 0.0)
    assert found == pytest.approx([place], abs=1e-12)


def test_even_intervals_and_ends_of_spans_are_left_alone() -> None:
    s = np.linspace(0.0, 2.0, 21)
    x = np.abs(np.sin(np.pi * s))
    loss = np.zeros(20)
    loss[[0, 9, 10, 19]] = 1.0  # beside the rests of two spans
    assert len(switch_points(s, x, loss, np.array([0, 10, 20]), 0.1, 0.0)) == 0
    assert len(switch_points(s, 2.0 * s, np.ones(20), np.array([0, 10, 20]), 0.01, 0.0)) == 0
