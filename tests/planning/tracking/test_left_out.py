"""A joint spline that is never far from the path, and leaves parts of it out, is found to stray.

The path is a square wave about a line, finer than the tolerance; the tool goes along the line.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import ikplan
from ikplan.documents.poses import Tolerance
from ikplan.joint_path import JointPath
from ikplan.kinematics.arm import arm_of
from ikplan.kinematics.target import Freedom, no_freedom
from ikplan.limits import JointLimits
from ikplan.planning.tracking.path_deviation import deviation_ratios
from ikplan.planning.tracking.path_tracker import PathTracker
from ikplan.time_budget import TimeBudget
from tests.kinematics.synthetic import Joint, robot_of
from tests.planning.planar import line

TOLERANCE, WIDTH, TEETH = 1e-3, 3e-4, 6
GANTRY = robot_of(
    [Joint("prismatic", axis=(1.0, 0.0, 0.0)), Joint("prismatic", axis=(0.0, 1.0, 0.0))]
)
LIMITS = JointLimits.from_robot(GANTRY)


def share_used(
    height: float, box: float | None = None, along: float = 1.0, taken: float = 0.0
) -> float:
    """Share of the tolerance used by a tool that goes along the middle of a wave of this height."""
    points = [(0.0, 0.0)]
    for k in range(TEETH):
        y = height * (-1.0) ** k
        points += [(k * WIDTH, y), ((k + 1) * WIDTH, y)]
    guide = replace(line(*points, (TEETH * WIDTH, 0.0)), taken=taken)
    freedom: Freedom = no_freedom()
    if box is not None:
        half = np.array([0.0, 0.6 * box, 0.8 * box, 0.0, 0.0, 0.0])
        freedom = freedom._replace(boxed=True, box=half)
    arm, tolerance = arm_of(GANTRY), Tolerance(position=TOLERANCE)
    tracker = PathTracker(arm, LIMITS, freedom, False, tolerance, TimeBudget(1e6))
    q = np.array([[0.0, 0.0], [along * TEETH * WIDTH, 0.0]])
    s = np.array([0.0, guide.length])
    shares, _ = deviation_ratios(
        arm.chain, guide, lambda at: tracker.targets_at(guide, at), s,
        JointPath.through(q, LIMITS), tracker.tolerance, 0.5, bounded=False,
    )  # fmt: skip
    assert shares.shape == (1,)
    return float(shares[0])


@pytest.mark.parametrize("share", [0.85, 1.0, 1.5, 4.0])
def test_it_strays_by_what_it_misses_most(share: float) -> None:
    assert share_used(share * TOLERANCE) == pytest.approx(share, rel=1e-6)


@pytest.mark.parametrize("share", [0.3, 0.75])
def test_what_is_well_within_the_tolerance_is_not_left_out(share: float) -> None:
    """The tool crosses a strand of the path at every width of a tooth."""
    assert share_used(share * TOLERANCE) <= min(share, 0.5)


@pytest.mark.parametrize("taken", [0.4, 0.8])
def test_rounded_corners_leave_less_of_the_tolerance_to_be_left_out(taken: float) -> None:
    """What the rounded path misses of the path asked for, and the tool of it, add up."""
    left = 1.0 - taken
    assert share_used(0.9 * left * TOLERANCE, taken=taken) == pytest.approx(0.9 * left, rel=1e-6)
    assert share_used(0.7 * left * TOLERANCE, taken=taken) <= 0.5


@pytest.mark.parametrize("box", [0.5 * TOLERANCE, 3.0 * TOLERANCE])
@pytest.mark.parametrize(("share", "left_out"), [(0.5, False), (0.9, True), (2.0, True)])
def test_a_box_may_be_left_out_besides(box: float, share: float, left_out: bool) -> None:
    used = share_used(box + share * TOLERANCE, box)
    if left_out:
        assert used == pytest.approx(share, rel=1e-6)
    else:
        assert used <= 0.5


def test_a_way_as_long_as_the_path_is_not_looked_at_for_what_it_leaves_out() -> None:
    """The tool goes along the line to far beyond: it strays, by what it is beside the path."""
    assert share_used(TOLERANCE, along=12.0) > 3.0


def test_the_teeth_of_a_saw_with_rounded_tips_are_gone_along() -> None:
    """Of the tolerance the rounding takes 40 %, and what the joints leave out comes on top."""
    saw = {
        "type": "sawtooth",
        "length": 0.0546,
        "height": -0.0032,
        "teeth": 21,
        "fall": 0.0,
        "quaternion_xyzw": [-0.0372, -0.0493, -0.0286, 0.9977],
        "frame": {
            "position": [-0.0301, -0.008, -0.0015],
            "quaternion_xyzw": [-0.0181, -0.0021, -0.0064, 0.9998],
        },
    }
    frame = {
        "position": [-0.3303, -0.2786, 0.2422],
        "quaternion_xyzw": [0.8757, -0.1981, 0.4202, -0.1319],
    }
    tolerance = {"position": 1e-4, "orientation": 1e-3}
    plan = ikplan.plan(
        {
            "robot": "ur3",
            "start": [0.8565, 3.6532, -0.1316, 3.5869, -4.1262, -3.6458],
            "path": {"frame": frame, "segments": [saw], "tolerance": tolerance},
            "scene": {"self_collision": False},
            "sampling": {"rate_hz": 1000.0},
        }
    )
    assert plan.certificate.valid
