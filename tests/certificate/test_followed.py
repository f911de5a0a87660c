"""Where a span that asks for an orientation meets one that does not, samples keep to their own."""

from __future__ import annotations

import numpy as np
import pytest

from ikplan import load_robot
from ikplan.certificate.paths import TimedSpan, follow_checks
from ikplan.path.rotation import exp
from ikplan.path.steady import line
from ikplan.path.tool_path import ToolPath
from ikplan.request import PathRequest


@pytest.mark.parametrize(("after", "angle"), [(-1e-5, 0.02), (1e-5, 0.0)])
def test_a_sample_beside_the_joint_is_measured_on_the_span_it_belongs_to(after, angle):
    robot = load_robot("ur5")
    q = np.array([[0.4, -1.2, 1.5, -0.8, -1.2, 0.3]])
    R, p = (part[0] for part in robot.poses(q))
    along = np.array([0.0, 1.0, 0.0])
    tilted = R @ exp(np.array([0.02, 0.0, 0.0]))
    joint = p + 1e-5 * along
    path = ToolPath((line(joint - 0.1 * along, joint, tilted), line(joint, joint + 0.1 * along)))
    stations = np.linspace(0.0, path.length, 201)
    request = PathRequest.model_validate({"waypoints": [{"position": list(joint)}]})
    span = TimedSpan(path, stations, stations)
    followed = follow_checks(robot, request, [span], path.begins[1:2] + after, q)
    assert followed.angle == pytest.approx(angle, abs=1e-9)
    assert followed.distance == pytest.approx(max(after, 0.0), abs=1e-9)


@pytest.mark.parametrize("freedom", [{"about": "tool_z"}, {"about": "tool_x", "cone": 1e-4}, None])
@pytest.mark.parametrize(("off", "kept"), [(5e-6, True), (9e-5, True), (3e-4, False)])
def test_a_tool_that_turns_faster_than_it_moves_is_measured_in_both_at_one_place(
    freedom, off, kept
):
    robot = load_robot("ur5")
    q = np.array([[0.4, -1.2, 1.5, -0.8, -1.2, 0.3]])
    R, p = (part[0] for part in robot.poses(q))
    along, turn = R[:, 1] * 5e-4, np.array([1.4, 1.4, 0.0])
    # Its middle is the pose of the arm, but beside it along the path, where it is turned.
    middle = p + off * R[:, 1]
    path = ToolPath((line(middle - along, middle + along, R @ exp(-0.5 * turn), turn),))
    request = PathRequest.model_validate(
        {"waypoints": [{"position": list(p)}], "orientation_free": freedom}
    )
    span = TimedSpan(path, np.linspace(0.0, 1.0, 5), path.length * np.linspace(0.0, 1.0, 5))
    followed = follow_checks(robot, request, [span], np.array([0.5]), q)
    assert followed.distance is not None
    assert followed.angle is not None
    held = followed.distance <= request.tolerance.position
    assert (held and followed.angle <= request.tolerance.orientation) == kept
    assert followed.distance <= off + 1e-9
