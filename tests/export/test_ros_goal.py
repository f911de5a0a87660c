"""FollowJointTrajectory goals: YAML that reads back as the message."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import yaml

from ikplan.plans.export import encode

from .plans import rest_to_rest


def test_a_goal_reads_back_exactly_by_a_yaml_1_1_reader(tmp_path: Path) -> None:
    plan = rest_to_rest(3, 17, ("rad", "m", "rad"))
    # Numbers that YAML 1.1 takes for text unless they are written with a point.
    tiny = plan.trajectory.model_copy(update={"dq": plan.dq + 1e-5, "ddq": plan.ddq * 0 + 1e-17})
    plan = plan.model_copy(update={"trajectory": tiny})
    plan.save(tmp_path / "plan.goal.yaml")
    goal = yaml.safe_load((tmp_path / "plan.goal.yaml").read_text())
    assert list(goal) == ["trajectory"]
    trajectory = goal["trajectory"]
    assert list(trajectory) == ["header", "joint_names", "points"]
    assert trajectory["joint_names"] == plan.joint_names
    for key, known in (("positions", plan.q), ("velocities", plan.dq), ("accelerations", plan.ddq)):
        assert np.array_equal([p[key] for p in trajectory["points"]], known)
    stamps = [p["time_from_start"] for p in trajectory["points"]]
    time = np.array([s["sec"] + 1e-9 * s["nanosec"] for s in stamps])
    assert np.abs(time - plan.time).max() <= 0.5e-9 + 1e-15
    assert all(isinstance(s["nanosec"], int) and 0 <= s["nanosec"] < 10**9 for s in stamps)
    # The fields of trajectory_msgs/JointTrajectoryPoint, and no others.
    fields = {"positions", "velocities", "accelerations", "effort", "time_from_start"}
    assert set(trajectory["points"][0]) == fields


def test_joint_names_of_any_kind_read_back() -> None:
    plan = rest_to_rest(2).model_copy(update={"joint_names": ["on", 'a: "b" # c']})
    goal = yaml.safe_load(encode(plan, "ros-goal"))
    assert goal["trajectory"]["joint_names"] == plan.joint_names
