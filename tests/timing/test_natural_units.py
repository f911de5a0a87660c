"""The units in which an engine solves: the same whether rows are written out or not."""

from __future__ import annotations

import numpy as np
import pytest

from ikplan.joint_path import JointPath
from ikplan.timing.engines.rows import interval_unit, natural_units
from ikplan.timing.time_joint_path import time_joint_path

from .cases import make_limits


@pytest.mark.parametrize("size", [1e-9, 1e-3, 1.0])
@pytest.mark.parametrize("count", [2, 3, 12])
def test_the_unit_of_intervals_is_that_of_their_rows(size: float, count: int) -> None:
    limits = make_limits(5, seed=count)
    rng = np.random.default_rng(count)
    path = JointPath.through(size * rng.uniform(-0.5, 0.5, (count, 5)), limits)
    (span,) = time_joint_path(path, limits).spans
    problem = span.problem
    rows = problem.rows()
    length = float(rows.s[-1] - rows.s[0])
    largest = np.abs(rows.a[:: max(1, len(rows.a) // 64)]).max(axis=1)
    unit = min(float(np.median(rows.x_max)), length / float(np.median(largest)))
    limits_of_pieces = problem.piece_limits[2:]
    found = interval_unit(length, problem.velocity_bounds, *problem.slopes, *limits_of_pieces)
    assert found == unit == natural_units(rows)[1]
