"""A box's axes are the same for the planner and for the certificate, whatever is oriented."""

from __future__ import annotations

from typing import Any

import numpy as np
import pinocchio as pin
import pytest

import ikplan

from .requests import START, arm, pose_after, request

HALF = np.array([0.02, 0.0, 0.01])
TOLERANCE = 1e-5


@pytest.mark.parametrize("interpolation", ["joint", "line"])
@pytest.mark.parametrize("frame", [None, "tool", "path"])
@pytest.mark.parametrize("free", [None, "all", {"about": "tool_z"}])
@pytest.mark.parametrize("oriented", [True, False])
def test_the_tool_is_within_the_box_along_the_axes_of_the_words(
    interpolation: str, frame: str | None, free: Any, oriented: bool
) -> None:
    """``tool``: of the orientation asked for, of the base where none is; ``path``: of the path."""
    robot = arm()
    T_base_path = pin.SE3(pin.exp3(np.array([0.3, -0.4, 0.5])), np.array([0.1, 0.0, 0.2]))
    asked = pose_after(robot, [0.06, 0.08, 0.05], [0.3, -0.2, 0.4])
    T = T_base_path.inverse() * pin.XYZQUATToSE3(
        np.array([*asked["position"], *asked["quaternion_xyzw"]])
    )
    waypoint: dict[str, Any] = {"position": T.translation.tolist()}
    if oriented:
        waypoint["quaternion_xyzw"] = pin.Quaternion(T.rotation).coeffs().tolist()
    box: dict[str, Any] = {"position": HALF.tolist()}
    if frame:
        box["frame"] = frame
    placement = pin.SE3ToXYZQUAT(T_base_path)
    document: dict[str, Any] = {
        "frame": {
            "position": placement[:3].tolist(),
            "quaternion_xyzw": placement[3:].tolist(),
        },
        "waypoints": [waypoint],
        "interpolation": interpolation,
        "tolerance": {"position": TOLERANCE, "orientation": 1e-3, "box": box},
    }
    if free is not None:
        document["orientation_free"] = free
    plan = ikplan.plan(request(document))
    reached = robot.fk(plan.waypoints.q[0])
    axes = np.eye(3)
    if frame == "path":
        axes = T_base_path.rotation
    elif oriented and free != "all":
        axes = (T_base_path * T).rotation
    apart = axes.T @ (reached.translation - (T_base_path * T).translation)
    assert (np.abs(apart) <= HALF + TOLERANCE).all()
    assert plan.certificate.max_position_error is not None
    beyond = np.linalg.norm(np.maximum(np.abs(apart) - HALF, 0.0))
    assert plan.certificate.max_position_error == pytest.approx(beyond, abs=1e-12)
    np.testing.assert_array_equal(plan.q[0], START)
