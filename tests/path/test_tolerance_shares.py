"""What leaves the path takes shares of its tolerance that together are no more than all of it."""

from __future__ import annotations

from typing import Any

import numpy as np
import pinocchio as pin
import pytest

import ikplan
from ikplan.documents.poses import Tolerance
from ikplan.kinematics.arm import arm_of
from ikplan.kinematics.target import no_freedom
from ikplan.limits import JointLimits
from ikplan.path.tolerance_shares import (
    MET,
    ROUNDING,
    SMOOTHING,
    TRACKING,
    TRACKING_SMOOTHED,
    TRACKING_WITHIN,
    left_to_tracking,
)
from ikplan.planning.within.tolerant_tracker import TolerantTracker
from ikplan.time_budget import TimeBudget
from tests.measured import off_polyline
from tests.planning.planar import Polyline

UR5 = ikplan.load_robot("ur5")


def test_shares_that_act_together_are_no_more_than_the_whole() -> None:
    assert ROUNDING + TRACKING < 1.0
    assert SMOOTHING + TRACKING_SMOOTHED < 1.0
    for taken in (0.0, ROUNDING, SMOOTHING):
        assert taken + left_to_tracking(taken) * TRACKING_WITHIN < 1.0
    assert MET < TRACKING_WITHIN


@pytest.mark.parametrize("taken", [0.0, ROUNDING])
def test_what_tracks_within_the_tolerance_has_what_corners_leave(taken: float) -> None:
    tracker = TolerantTracker(
        arm_of(UR5),
        JointLimits.from_robot(UR5),
        no_freedom(),
        False,
        Tolerance(position=1e-3, orientation=1e-2),
        TimeBudget(1e6),
    )
    line = Polyline(np.array([[0.4, 0.0, 0.4], [0.5, 0.0, 0.4]]), taken)
    tolerant = tracker.tolerant(line)
    assert tolerant.within
    share = tolerant.deviation_share * np.array(
        [tolerant.tolerance.position / 1e-3, tolerant.tolerance.orientation / 1e-2]
    )
    assert share == pytest.approx(0.95 * (1.0 - taken))
    assert max(tolerant.met[0] / 1e-3, tolerant.met[1] / 1e-2) <= share.max()


WRIST = [
    0.06315145819372611, -1.083063383852844, 1.4364425285417723, -3.494239105829305,
    0.13685149803514596, 1.8408668113445188,
]  # fmt: skip


def past_the_wrist(kink: Any, tolerance: float) -> tuple[dict[str, Any], np.ndarray]:
    """A line that passes the wrist singularity at 0.1 mrad, with a corner beside it."""
    begin = UR5.fk(WRIST).translation
    end = np.array([0.5428771873867462, 0.3853905253761375, 0.4235151450778662])
    middle = begin + 0.52 * (end - begin) + np.array(kink)
    turned = pin.Quaternion(UR5.fk(WRIST).rotation).normalized().coeffs().tolist()
    points = [{"position": p.tolist(), "quaternion_xyzw": turned} for p in (middle, end)]
    path = {
        "waypoints": points,
        "interpolation": "line",
        "tolerance": {"position": tolerance, "orientation": 10.0 * tolerance},
    }
    request = {
        "robot": "ur5",
        "start": WRIST,
        "path": path,
        "limits": {"jerk": False},
        "scene": {"self_collision": False},
    }
    return request, np.array([begin, middle, end])


@pytest.mark.parametrize("kink", [[0.0, 0.0, 2e-3], [1e-3, 0.0, -1e-3], [4e-3, 2e-3, 0.0]])
def test_rounded_corners_by_a_singularity_stay_within_the_tolerance(kink: Any) -> None:
    for tolerance in (3e-4, 2e-3):
        request, points = past_the_wrist(kink, tolerance)
        plan = ikplan.plan(request)
        p = UR5.poses(plan.q)[1]
        assert off_polyline(p, points).max() <= tolerance
        assert plan.certificate.max_orientation_deviation is not None
        assert plan.certificate.max_orientation_deviation <= 10.0 * tolerance
