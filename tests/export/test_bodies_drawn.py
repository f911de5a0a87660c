"""Clearance over time, obstacles and the nearest pair in figures."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from mpl_toolkits.mplot3d.art3d import Poly3DCollection

import ikplan
from ikplan import load_robot
from ikplan.documents.scene import Scene
from ikplan.plans.clearance_samples import clearance_over_time
from ikplan.plans.figures.plan import draw_plan
from ikplan.scene.model import collision_model
from tests.service.test_scenes import request, tool_at

TABLE = {
    "name": "table",
    "shape": {"type": "box", "size": [0.3, 0.3, 0.05]},
    "position": tool_at([0.0, 0.0, -0.2]),
}
BALL = {"name": "ball", "shape": {"type": "sphere", "radius": 0.05}}
SCENE: dict[str, Any] = {
    "obstacles": [TABLE, {**BALL, "position": tool_at([0.0, 0.35, 0.1])}],
    "clearance": 0.002,
}


@pytest.fixture(scope="module")
def plan() -> ikplan.Plan:
    return ikplan.plan(request(scene=SCENE))


def solid_lines(axes: Any) -> dict[str, Any]:
    return {line.get_label(): line for line in axes.get_lines()}


def test_the_curve_is_the_distance_at_samples_and_never_below_what_is_proven(
    plan: ikplan.Plan,
) -> None:
    robot = load_robot("ur5")
    model = collision_model(robot, Scene.model_validate(SCENE))
    time, distance = clearance_over_time(plan, robot, model)
    clearance = plan.certificate.clearance
    assert clearance is not None
    assert clearance.least is not None
    assert (distance >= clearance.least - 5e-6).all()
    rows = np.searchsorted(plan.time, time)
    for row, found in list(zip(rows, distance, strict=True))[::20]:
        assert found == robot.clearance(plan.q[row], SCENE).distance


def test_what_is_carried_counts_while_it_is_carried() -> None:
    part = {**BALL, "shape": {"type": "sphere", "radius": 0.14}, "touches": []}
    carried = {**SCENE, "attached": [{**part, "name": "part", "first_segment": 1}]}
    document = request()
    ends = [tool_at([0.0, 0.05, 0.0]), tool_at([0.0, 0.05, 0.05])]
    document["path"] |= {"waypoints": [{"position": p} for p in ends], "corners": "exact"}
    made = ikplan.plan({**document, "scene": SCENE})
    robot = load_robot("ur5")
    model = collision_model(robot, Scene.model_validate({**carried, "self_collision": False}))
    time, distance = clearance_over_time(made, robot, model)
    begin = made.waypoints.time[0]
    off = {**SCENE, "self_collision": False}
    on = {**carried, "self_collision": False}
    for t, found in zip(time[::10], distance[::10], strict=True):
        q = made.q[np.searchsorted(made.time, t)]
        scene = off if t < begin - 1e-9 else on
        assert found == max(robot.clearance(q, scene).distance, 0.0)
    assert distance[time < begin].min() > distance[time > begin].max()


def test_obstacles_the_nearest_pair_and_the_clearance_are_drawn(plan: ikplan.Plan) -> None:
    robot = load_robot("ur5")
    model = collision_model(robot, Scene.model_validate(SCENE))
    figure = draw_plan(plan, robot=robot, model=model)
    (curves,) = (a for a in figure.axes if a.get_title(loc="left") == "Clearance, dashed: proven")
    lines = solid_lines(curves)
    assert {"arm from itself", "from obstacles", "asked for"} <= lines.keys()
    assert lines["asked for"].get_ydata()[0] == 2.0
    space: Any
    (space,) = (a for a in figure.axes if a.name == "3d")
    clearance = plan.certificate.clearance
    assert clearance is not None
    assert clearance.points is not None
    nearest: Any
    (nearest,) = (line for line in space.get_lines() if line.get_label() == "nearest")
    assert np.allclose(np.array(nearest.get_data_3d()).T, clearance.points)
    shown = [c for c in space.collections if isinstance(c, Poly3DCollection)]
    assert len(shown) >= 3
    low, high = np.array([space.get_xlim(), space.get_ylim(), space.get_zlim()]).T
    for faces in shown:
        corners = np.array(faces._faces).reshape(-1, 3)
        assert (corners >= low - 1e-9).all()
        assert (corners <= high + 1e-9).all()


def test_without_the_scene_the_figure_is_of_the_arm_from_itself(
    plan: ikplan.Plan, tmp_path: Path
) -> None:
    figure = draw_plan(plan)
    (curves,) = (a for a in figure.axes if a.get_title(loc="left") == "Clearance, dashed: proven")
    assert "arm from itself" in solid_lines(curves)
    assert "from obstacles" not in solid_lines(curves)
    images = []
    for k in range(2):
        plan.plot(tmp_path / f"{k}.svg", SCENE)
        images.append((tmp_path / f"{k}.svg").read_bytes())
    assert images[0] == images[1]
    assert b"from obstacles" in images[0]


def test_a_plan_that_was_not_checked_has_no_such_curve() -> None:
    made = ikplan.plan(request(scene={"self_collision": False}))
    titles = [a.get_title(loc="left") for a in draw_plan(made).axes]
    assert "Clearance, dashed: proven" not in titles
