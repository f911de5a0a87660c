"""Moves on which the tool keeps within a cone or a box."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

import ikplan
from ikplan import Disconnected, InvalidRequest, load_robot
from ikplan.certificate.clearance import JointCurve
from ikplan.certificate.regions import RegionLeft, prove_regions
from ikplan.certificate.requested import read_motion
from ikplan.documents.path import PathRequest
from ikplan.robots import Robot
from tests.moves.cells import moving, post, turned

Array = NDArray[np.float64]
DOWN = [0.0, 0.0, -1.0]


def dense(plan: ikplan.Plan) -> Array:
    """Configurations of a plan between its samples too."""
    curve = JointCurve.of_samples(plan.time, plan.q, plan.dq)
    return np.array([curve.at(u) for u in np.linspace(0.0, len(curve.controls), 4000)])


def angles(robot: Robot, q: Array, direction: list[float]) -> Array:
    """Angle of the tool's z axis from a direction, shape (m,) [rad]."""
    axes = np.array([robot.fk(row).rotation[:, 2] for row in q])
    return np.asarray(np.arccos(np.clip(axes @ np.array(direction), -1.0, 1.0)))


def around_a_post(robot: Robot, within: dict[str, Any] | None, **more: Any) -> dict[str, Any]:
    segment: dict[str, Any] = {"type": "move", "q": turned(robot, 1.6).tolist()}
    if within is not None:
        segment["within"] = within
    scene = {"obstacles": [post(robot, height=0.9)]}
    return moving(robot.name or "", [segment], scene=scene, **more)


@pytest.mark.parametrize("seed", range(2))
def test_the_tool_is_kept_upright_around_a_post(seed: int) -> None:
    robot = load_robot("panda")
    cone = {"direction": DOWN, "angle": 0.15}
    free = ikplan.plan(around_a_post(robot, None, ik={"seed": seed}))
    assert angles(robot, dense(free), DOWN).max() > 0.3
    plan = ikplan.plan(around_a_post(robot, {"cone": cone}, ik={"seed": seed}))
    assert plan.stats.moves[0].samples > 0
    assert plan.certificate.clearance is not None
    assert plan.certificate.clearance.proven
    (region,) = plan.certificate.regions
    assert region.field == "path.segments[0]"
    assert region.begin == 0.0
    assert region.end == pytest.approx(plan.duration)
    assert region.box_left is None
    assert region.cone_left is not None
    assert 0.0 <= region.cone_left <= 0.15 - angles(robot, dense(plan), DOWN).max() + 1e-6
    again = ikplan.plan(around_a_post(robot, {"cone": cone}, ik={"seed": seed}))
    assert plan.q.tobytes() == again.q.tobytes()


def test_the_tool_stays_in_a_box() -> None:
    robot = load_robot("ur5")
    p = robot.fk(robot.home).translation
    box = {"frame": {"position": [0.0, 0.0, float(p[2])]}, "size": [4.0, 4.0, 0.24]}
    free = ikplan.plan(around_a_post(robot, None))
    plan = ikplan.plan(around_a_post(robot, {"box": box}))
    heights, others = (
        np.array([robot.fk(q).translation[2] for q in dense(made)]) for made in (plan, free)
    )
    assert np.abs(others - p[2]).max() > 0.12
    (region,) = plan.certificate.regions
    assert region.cone_left is None
    assert region.box_left is not None
    assert 0.0 <= region.box_left <= 0.12 - np.abs(heights - p[2]).max() + 1e-6


def test_a_straight_motion_that_keeps_within_is_taken() -> None:
    robot = load_robot("ur5")
    direction = robot.fk(robot.home).rotation[:, 2].tolist()
    cone = {"direction": [0.0, 0.0, direction[2]], "angle": 1.2}
    segment = {"type": "move", "q": turned(robot, 0.5).tolist(), "within": {"cone": cone}}
    scenes: list[dict[str, Any]] = [{}, {"self_collision": False}]
    for scene in scenes:
        plan = ikplan.plan(moving("ur5", [segment], scene=scene))
        assert plan.stats.moves[0].samples == 0
        assert len(plan.certificate.regions) == 1


def test_a_begin_or_a_goal_outside_is_refused() -> None:
    robot = load_robot("panda")
    aside = {"cone": {"direction": [1.0, 0.0, 0.0], "angle": 0.3}}
    with pytest.raises(InvalidRequest, match="no goal") as caught:
        ikplan.plan(around_a_post(robot, aside))
    assert caught.value.field == "path.segments[0].within"
    tilted = robot.home.copy()
    tilted[5] += 0.6
    down = {"cone": {"direction": DOWN, "angle": 0.3}}
    with pytest.raises(InvalidRequest, match="begin"):
        ikplan.plan(around_a_post(robot, down, start=tilted.tolist()))


def test_no_way_within_the_region_is_not_called_impossible() -> None:
    robot = load_robot("panda")
    goal = turned(robot, 1.0)
    goal[3] += 0.5
    direction = robot.fk(goal).rotation[:, 2].tolist()
    least = float(angles(robot, robot.home[None], direction)[0])
    cone = {"direction": direction, "angle": least + 1e-3}
    segment = {"type": "move", "q": goal.tolist(), "within": {"cone": cone}}
    with pytest.raises(Disconnected, match="does not prove") as caught:
        ikplan.plan(moving("panda", [segment], ik={"effort": 1}))
    assert caught.value.waypoints == [-1, 0]


def test_the_certificate_does_not_believe_a_motion_that_leaves_its_region() -> None:
    robot = load_robot("panda")
    plan = ikplan.plan(around_a_post(robot, None))
    far = float(angles(robot, dense(plan), DOWN).max())
    curve = JointCurve.of_samples(plan.time, plan.q, plan.dq)
    for angle, held in ((far + 1e-3, True), (far - 1e-3, False)):
        request = around_a_post(robot, {"cone": {"direction": DOWN, "angle": angle}})
        path = PathRequest.model_validate(request["path"])
        motion = read_motion(robot, path, robot.home)
        if held:
            (region,) = prove_regions(robot, path, motion, plan.waypoints.time, curve)
            assert region.cone_left is not None
            assert 0.0 <= region.cone_left <= 1e-3 + 1e-6
            continue
        with pytest.raises(RegionLeft):
            prove_regions(robot, path, motion, plan.waypoints.time, curve)


def test_a_move_without_a_region_keeps_its_id() -> None:
    robot = load_robot("panda")
    bare, empty = around_a_post(robot, None), around_a_post(robot, None)
    empty["path"]["segments"][0]["within"] = None
    cone = {"cone": {"direction": DOWN, "angle": 0.3}}
    ids = [
        ikplan.PlanRequest.model_validate(request).content_hash()
        for request in (bare, empty, around_a_post(robot, cone))
    ]
    assert ids[0] == ids[1] != ids[2]


@pytest.mark.parametrize(
    "within",
    [
        {},
        {"cone": {"direction": [0, 0, 0], "angle": 0.1}},
        {"box": {"frame": {}, "size": [1, 0, 1]}},
    ],
)
def test_a_region_that_makes_no_sense_is_refused(within: dict[str, Any]) -> None:
    robot = load_robot("panda")
    with pytest.raises(InvalidRequest, match=r"within"):
        ikplan.plan(around_a_post(robot, within))
