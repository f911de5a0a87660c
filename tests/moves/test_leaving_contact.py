"""A start in contact: left only where the request asks for it, and said."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import ikplan
from ikplan import InCollision, InvalidRequest, load_robot
from ikplan.robots import Robot
from tests.moves.cells import box, moving, pose, turned


def touching(robot: Robot, depth: float = 0.005) -> dict[str, Any]:
    """A scene whose crate the arm touches at its home, at the side of the tip."""
    x, y, z = robot.fk(robot.home).translation

    def scene(aside: float) -> dict[str, Any]:
        return {"obstacles": [box("crate", (x, y + aside, z), [0.2] * 3)]}

    aside = 0.6
    while robot.clearance(robot.home, scene(aside)).distance > 0.0:
        aside -= 0.001
    return scene(aside - depth)


@pytest.mark.parametrize("name", ["ur5", "panda"])
def test_a_start_in_contact_is_left_if_asked_for_and_said(name: str) -> None:
    robot = load_robot(name)
    scene = touching(robot)
    assert robot.clearance(robot.home, scene).distance <= 0.0
    segments = [{"type": "move", "q": turned(robot, -0.8).tolist()}]
    with pytest.raises(InCollision) as caught:
        ikplan.plan(moving(name, segments, scene=scene))
    assert caught.value.waypoint == -1
    asked = moving(name, segments, scene={**scene, "leave_contact": True})
    plan = ikplan.plan(asked)
    assert np.array_equal(plan.q[0], robot.home)
    clearance = plan.certificate.clearance
    assert clearance is not None
    assert clearance.proven
    assert clearance.left is not None
    assert all("crate" in pair for pair in clearance.left.pairs)
    assert 0.0 < clearance.left.until < 1.0
    assert len(clearance.segments) == 1
    later = plan.q[plan.time >= clearance.left.until]
    assert min(robot.clearance(q, scene).distance for q in later) > 0.0
    # What does not touch at the start is kept apart from the first instant on.
    assert clearance.least is not None
    assert ikplan.plan(asked).q.tobytes() == plan.q.tobytes()


def test_a_free_start_is_not_changed_by_asking() -> None:
    robot = load_robot("ur5")
    segments = [{"type": "move", "q": turned(robot, 0.5).tolist()}]
    plain = ikplan.plan(moving("ur5", segments, scene={}))
    asked = ikplan.plan(moving("ur5", segments, scene={"leave_contact": True}))
    assert plain.id != asked.id
    assert plain.q.tobytes() == asked.q.tobytes()
    assert asked.certificate.clearance is not None
    assert asked.certificate.clearance.left is None
    same = ikplan.plan(moving("ur5", segments, scene={"leave_contact": False}))
    assert same.id == plain.id


def test_where_there_is_no_way_out_the_start_is_refused() -> None:
    robot = load_robot("ur5")
    crate = box("crate", robot.fk(robot.home).translation, [1.0] * 3)
    segments = [{"type": "move", "q": turned(robot, 2.5).tolist()}]
    scene = {"obstacles": [crate], "leave_contact": True}
    with pytest.raises(InCollision, match="no way out") as caught:
        ikplan.plan(moving("ur5", segments, scene=scene))
    assert caught.value.waypoint == -1
    assert caught.value.proven


def test_a_tool_path_does_not_begin_in_contact() -> None:
    robot = load_robot("ur5")
    line = {"type": "line", "to": pose(robot, turned(robot, -0.1))}
    scene = {**touching(robot), "leave_contact": True}
    with pytest.raises(InvalidRequest) as caught:
        ikplan.plan(moving("ur5", [line], scene=scene))
    assert caught.value.field == "scene.leave_contact"


def test_requests_that_do_not_ask_keep_the_ids_they_had() -> None:
    path = {"waypoints": [{"position": [0.4, 0.1, 0.3]}]}
    known = ikplan.PlanRequest.model_validate({"robot": "ur5", "path": path})
    assert known.content_hash() == "7e1f20c0d668e3d99810957738651138"
