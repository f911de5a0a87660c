"""Paths past a place where two branches come near each other."""

from __future__ import annotations

import numpy as np

import ikplan
from benchmarks.planning.turns import arc_request, goes_through
from ikplan.robots import load_robot


def test_an_arc_past_two_branches_near_each_other_is_tracked_on_one() -> None:
    """Two shoulder branches come near halfway; steps of 40 mm go from one over to the other."""
    robot = load_robot("ur5")
    q = np.array([-1.27643473, -0.95429656, -1.11395707, -2.35598306, 1.25687444, 2.40380486])
    arc = q, robot.fk(q).rotation[:, 2], 0.0662146197, -11.518918844
    assert goes_through(robot, arc)
    plan = ikplan.plan(arc_request(robot, arc))
    moved = float(np.linalg.norm(np.diff(plan.q, axis=0), axis=1).sum())
    assert moved < 11.88  # 11.87 rad in 3,000 steps of Newton's method
