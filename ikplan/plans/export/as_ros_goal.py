"""A plan as the YAML of a ROS 2 ``control_msgs/action/FollowJointTrajectory`` goal."""

from __future__ import annotations

import json
from typing import TYPE_CHECKING, Any

from ikplan.plans.export.as_ros import message
from ikplan.plans.export.formats import Format

if TYPE_CHECKING:
    from ikplan.documents.plan_document import PlanDocument

__all__ = ["FORMAT"]


def encode(plan: PlanDocument) -> bytes:
    """Return the goal, one line a point; tolerances are left to the controller's own.

    It is what ``ros2 action send_goal ACTION control_msgs/action/FollowJointTrajectory --stdin``
    reads.
    """
    trajectory = message(plan)
    header = trajectory["header"]
    lines = [
        f"# plan {plan.id} for {plan.robot}: {len(trajectory['points'])} points in "
        f"{plan.duration:.9g} s",
        "trajectory:",
        f"  header: {_flow(header)}",
        f"  joint_names: {_flow(trajectory['joint_names'])}",
        "  points:",
        *(f"  - {_flow(point)}" for point in trajectory["points"]),
    ]
    return ("\n".join(lines) + "\n").encode()


def _flow(value: Any) -> str:
    """A value in YAML's flow style, as YAML 1.1 reads it too."""
    if isinstance(value, dict):
        return "{" + ", ".join(f"{key}: {_flow(each)}" for key, each in value.items()) + "}"
    if isinstance(value, list):
        return "[" + ", ".join(_flow(each) for each in value) + "]"
    if isinstance(value, float):
        text = repr(value)
        # Without a point, YAML 1.1 takes 1e-05 for text.
        return text if "." in text or "e" not in text else text.replace("e", ".0e")
    return json.dumps(value)


FORMAT = Format(
    name="ros-goal",
    title="a ROS 2 FollowJointTrajectory goal, in YAML",
    suffixes=(".goal.yaml", ".ros.yaml"),
    media_type="application/vnd.ros.follow-joint-trajectory-goal+yaml",
    encode=encode,
)
