"""The timed samples as the JSON of a ROS 2 ``trajectory_msgs/msg/JointTrajectory``."""

from __future__ import annotations

import json
from typing import TYPE_CHECKING, Any

from ikplan.plans.export.formats import Format

if TYPE_CHECKING:
    from ikplan.documents.plan_document import PlanDocument

__all__ = ["FORMAT", "message"]

_NANO = 1_000_000_000


def message(plan: PlanDocument) -> dict[str, Any]:
    """Return the message as plain values, its fields as the message definition names them.

    Positions are in rad or m, velocities and accelerations by seconds; efforts are left out. The
    stamp is zero: the trajectory starts when the controller receives it.
    """
    motion = plan.trajectory
    points = []
    for t, q, dq, ddq in zip(
        motion.time.tolist(),
        motion.q.tolist(),
        motion.dq.tolist(),
        motion.ddq.tolist(),
        strict=True,
    ):
        seconds, nanoseconds = divmod(round(t * _NANO), _NANO)
        points.append(
            {
                "positions": q,
                "velocities": dq,
                "accelerations": ddq,
                "effort": [],
                "time_from_start": {"sec": seconds, "nanosec": nanoseconds},
            }
        )
    return {
        "header": {"stamp": {"sec": 0, "nanosec": 0}, "frame_id": ""},
        "joint_names": plan.joint_names,
        "points": points,
    }


def encode(plan: PlanDocument) -> bytes:
    """Return the message as JSON."""
    return json.dumps(message(plan), allow_nan=False, separators=(",", ":")).encode()


FORMAT = Format(
    name="ros",
    title="the timed samples as a ROS trajectory_msgs/JointTrajectory, in JSON",
    suffixes=(".ros.json",),
    media_type="application/vnd.ros.joint-trajectory+json",
    encode=encode,
)
