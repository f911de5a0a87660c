"""A motion of many nodes, fast and slow by turns, built through its nodes."""

from __future__ import annotations

import numpy as np

from ikplan.timing.jerk.through_nodes import slow_nodes
from ikplan.timing.jerk.warp import through

_WAVES, _LEAST, _END = 30, 0.005, 15.0


def test_slow_nodes_are_the_minima_and_both_ends() -> None:
    v = np.array([0.0, 1.0, 2.0, 1.0, 0.1, 1.0, 2.0, 1.9, 2.0, 1.0, 0.0])
    assert slow_nodes(v).tolist() == [0, 4, 10]
    assert slow_nodes(np.array([0.0, 1.0, 2.0, 1.0, 0.0])).tolist() == [0, 4]


def test_errors_made_where_it_is_fast_do_not_end_it_where_it_is_slow() -> None:
    """The speed is a raised cosine by _WAVES waves, 0 at both ends; between, hardly above."""
    time = np.linspace(0.0, _END, 3001)
    rate = 2.0 * np.pi * _WAVES / _END
    lift = _LEAST * np.sin(np.pi * time / _END) ** 2
    v = 0.5 * (1.0 - np.cos(rate * time)) + lift
    a = 0.5 * rate * np.sin(rate * time) + _LEAST * np.pi / _END * np.sin(2.0 * np.pi * time / _END)
    s = 0.5 * (time - np.sin(rate * time) / rate) + _LEAST * (
        0.5 * time - 0.25 * _END / np.pi * np.sin(2.0 * np.pi * time / _END)
    )
    motion = through(time, s, v, a)
    assert motion is not None
    assert motion.v[[0, -1]].tolist() == [0.0, 0.0]
    assert np.abs(motion.v - v).max() < 0.01
    assert abs(motion.time[-1] / _END - 1.0) < 0.01
