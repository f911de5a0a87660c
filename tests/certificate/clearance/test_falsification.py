"""What is proven is held to dense distances by coal and Pinocchio; so are planted faults."""

from __future__ import annotations

from collections.abc import Callable

import pytest

from benchmarks.collision.falsify import falsify
from tests.certificate.clearance.faults import (
    halve_motion_bounds,
    ignore_radii,
    look_at_middles_only,
)
from tests.kinematics.synthetic import Joint, robot_of

SIMPLE = (
    robot_of([Joint("prismatic", axis=(1.0, 0.0, 0.0))]),
    robot_of([Joint("revolute")], tip=Joint("fixed", xyz=(0.4, 0.0, 0.0))),
)
"""Arms whose motion bounds are nearly met."""


def test_no_dense_distance_falls_below_a_proven_bound() -> None:
    """Six robots with turning, endless, sliding and coupled joints, links of several pieces."""
    verdicts = falsify(30, reach=0.25)
    assert verdicts.broken == []
    assert verdicts.false == []
    assert verdicts.proven >= 15
    assert verdicts.refused >= 2
    assert max(verdicts.slack) <= 1e-3 + 1e-5  # the tolerance asked for, and coal's error


def test_no_bound_on_the_robots_own_bodies_is_broken() -> None:
    verdicts = falsify(6, reach=0.1, step=2e-3, own=True)
    assert verdicts.broken == []
    assert verdicts.false == []
    assert verdicts.proven > 0


def test_the_bounds_of_simple_arms_hold() -> None:
    assert falsify(10, robots=SIMPLE).broken == []


@pytest.mark.parametrize("plant", [halve_motion_bounds, look_at_middles_only, ignore_radii])
def test_a_planted_fault_is_found(
    plant: Callable[[pytest.MonkeyPatch], None], monkeypatch: pytest.MonkeyPatch
) -> None:
    plant(monkeypatch)
    assert falsify(10, robots=SIMPLE).broken
