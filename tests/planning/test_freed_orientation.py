"""Paths whose orientation is asked for on a part, and becomes free in a rounded corner."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import ikplan
from ikplan import load_robot

START = [1.65513, 0.79899, -1.003729, 1.281842, 0.594687, -2.113092]


def request(blend: float) -> dict[str, Any]:
    """An arc of the MH5 that keeps its orientation, then a line without one."""
    arc = {
        "type": "arc",
        "centre": [-0.01413, 0.310955, 0.2688],
        "axis": [-0.10967, -0.056285, -1.289753],
        "angle": 6.195914,
        "orientation": "constant",
        "blend": blend,
    }
    line = {"type": "line", "to": {"position": [-0.020264, 0.161482, 0.136899]}}
    return {
        "robot": "mh5",
        "start": START,
        "path": {"segments": [arc, line], "tolerance": {"position": 1e-5, "orientation": 1e-3}},
        "scene": {"self_collision": False},
    }


@pytest.mark.parametrize("blend", [0.0, 0.02, 0.05])
def test_an_oriented_part_goes_over_into_a_free_one(blend: float) -> None:
    """The motion is continuous where the orientation becomes free, within the corner or at it."""
    plan = ikplan.plan(request(blend))
    robot = load_robot("mh5")
    R, _ = robot.poses(np.array(plan.q))
    off = np.array([np.linalg.norm(R[0].T @ rotation - np.eye(3)) for rotation in R])
    assert plan.certificate.valid
    assert (off[: len(off) // 2] < 2e-3).all()
    assert off[-1] > 0.05
    assert np.abs(np.diff(plan.trajectory.q, axis=0)).max() < 0.05
