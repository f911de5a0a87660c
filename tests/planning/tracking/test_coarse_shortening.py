"""Long sequences are shortened at few points first."""

from __future__ import annotations

import numpy as np
import pinocchio as pin

from ikplan import load_robot
from ikplan.kinematics.arm import arm_of
from ikplan.kinematics.target import pose_target
from ikplan.planning.ladder.motion_cost import plain_cost, sequence_cost
from ikplan.planning.tracking.coarse_shortening import shortened, shortened_coarse_first
from ikplan.planning.tracking.tracking_kernels import errors_at, project_onto_targets
from ikplan.planning.waypoints.stack import stack_targets


def test_a_long_sequence_stays_on_its_targets_and_is_no_longer() -> None:
    """Along a circle that the redundant arm drifts away on, in both ways from one sequence."""
    robot = load_robot("iiwa14")
    arm, n = arm_of(robot), 600
    begin = robot.fk(np.array(robot.home))
    turn = np.linspace(0.0, 4.0 * np.pi, n + 1)[1:]
    circle = 0.08 * np.stack([np.cos(turn) - 1.0, np.sin(turn), 0.0 * turn], axis=1)
    poses = [pin.SE3(begin.rotation, begin.translation + step) for step in circle]
    targets = stack_targets([pose_target(pose.translation, pose.rotation) for pose in poses])
    home = np.array(robot.home)
    drift = np.outer(np.sin(0.5 * turn), [0.4, 0.0, -0.4, 0.0, 0.0, 0.0, 0.0])
    q = np.clip(home + drift, arm.lower, arm.upper)
    left, _ = project_onto_targets(arm.chain, targets, q, arm.lower, arm.upper)
    assert left.max() <= 1e-9
    cost = plain_cost(arm.dof)
    at_once, _ = shortened(arm, targets, q, home, cost)
    coarse, _ = shortened_coarse_first(arm, targets, q, home, cost)
    distance, angle = errors_at(arm.chain, targets, coarse)
    assert max(distance.max(), angle.max()) <= 1e-9
    assert (coarse >= arm.lower).all()
    assert (coarse <= arm.upper).all()
    lengths = [sequence_cost(rows, home, False, cost) for rows in (q, at_once, coarse)]
    assert lengths[2] <= lengths[1] * (1.0 + 1e-4)
    assert lengths[2] < lengths[0]
