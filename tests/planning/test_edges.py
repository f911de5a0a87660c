"""What leaves a cone or a box between the places looked at is found from those places."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.testing import assert_allclose

from ikplan.kinematics.target import Freedom, no_freedom
from ikplan.path.rotation.so3 import exp
from ikplan.planning.ladder.ik_candidates import Targets
from ikplan.planning.tracking.tolerance_bounds import violation_between

SHARES = np.array([0.0, 0.3, 0.6, 1.0])
BUMP = 0.1 + 0.02 * SHARES * (0.15 - SHARES)
"""Above 0.1 before a share of 0.15 only, by 0.02 * 0.075^2 at most."""
PEAK = 0.02 * 0.075**2


def targets(freedom: Freedom, oriented: bool = True) -> Targets:
    R = np.broadcast_to(exp(np.array([0.3, -0.2, 0.5])), (4, 3, 3))
    return Targets(R, np.zeros((4, 3)), np.full(4, oriented), np.full(4, 0.3), freedom)


@pytest.mark.parametrize("axis", [0, 1, 2])
def test_a_lean_out_of_the_cone_between_places_is_found(axis: int) -> None:
    wanted = targets(no_freedom()._replace(axis=axis, cone=0.1))
    lean = np.zeros((4, 3))
    lean[:, (axis + 1) % 3] = BUMP
    spin = np.zeros(3)
    spin[axis] = 1.0
    R = wanted.R @ exp(lean) @ exp(spin)
    distance, angle = violation_between(wanted, R, wanted.p, SHARES)
    assert_allclose(angle, PEAK, rtol=1e-6)
    assert_allclose(distance, 0.0)
    free = targets(wanted.freedom, oriented=False)
    assert_allclose(violation_between(free, R, wanted.p, SHARES)[1], 0.0)


@pytest.mark.parametrize("in_tool", [True, False])
@pytest.mark.parametrize("sign", [1.0, -1.0])
@pytest.mark.parametrize("row", range(6))
def test_an_offset_out_of_the_box_between_places_is_found(
    row: int, sign: float, in_tool: bool
) -> None:
    R_box = exp(np.array([0.0, 0.4, 0.2]))
    freedom = no_freedom()._replace(boxed=True, box=np.full(6, 0.1), in_tool=in_tool, R_box=R_box)
    wanted = targets(freedom)
    axes = wanted.R[0] if in_tool else R_box
    moved = sign * BUMP[:, None] * axes[:, row % 3]
    p, R = (moved, wanted.R) if row < 3 else (wanted.p, exp(moved) @ wanted.R)
    distance, angle = violation_between(wanted, R, p, SHARES)
    assert_allclose((distance[0], angle[0]), (PEAK, 0) if row < 3 else (0, PEAK), rtol=1e-6)
