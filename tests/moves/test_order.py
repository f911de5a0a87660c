"""Paths in free order: the order found, what stays together, what the certificate holds it to."""

from __future__ import annotations

import itertools
import json
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import ikplan
from benchmarks.moves.pick import pick_request
from ikplan import CertificateViolated, InvalidRequest, load_robot
from ikplan.certificate.clearance.in_order import counted_in_order
from ikplan.certificate.requested import broken_order
from ikplan.documents.path import PathRequest
from ikplan.documents.scene import Scene
from ikplan.planning.order.tasks import Task, tasks_of
from ikplan.robots import Robot
from ikplan.scene.model import collision_model
from tests.moves.cells import box, moving, pose, post, turned

EXAMPLE = Path(__file__).parents[2] / "examples" / "pick_and_place" / "three_parts_ur5.json"

pytest.importorskip("ortools", reason="the extra ikplan[order]")


def scattered(robot: Robot, count: int, seed: int) -> list[list[float]]:
    """Configurations about the home of a robot."""
    rng = np.random.default_rng(seed)
    q = robot.home + rng.uniform(-0.6, 0.6, (count, robot.dof))
    return [[float(v) for v in row] for row in q]


def move(q: list[float]) -> dict[str, Any]:
    return {"type": "move", "q": q}


def free(request: dict[str, Any], **more: Any) -> dict[str, Any]:
    return {**request, "path": {**request["path"], "order": "free", **more}}


def test_six_moves_take_within_two_percent_of_the_best_of_all_orders() -> None:
    robot = load_robot("ur5")
    goals = scattered(robot, 6, 4)
    scene = {"obstacles": [post(robot, 0.4)]}
    goals = [q for q in goals if robot.clearance(np.array(q), scene).distance > 0.01]
    assert len(goals) == 6
    places = [robot.home.tolist(), *goals]
    # Moves begin and end at rest: their times add up.
    seconds = np.full((7, 7), np.inf)
    for i, j in itertools.permutations(range(7), 2):
        if j > 0:
            plan = ikplan.move("ur5", places[i], places[j], scene, budget_s=300.0)
            assert plan.timing is not None
            seconds[i, j] = plan.duration
    orders = np.array([(0, *order) for order in itertools.permutations(range(1, 7))])
    all_seconds = seconds[orders[:, :-1], orders[:, 1:]].sum(axis=1)
    request = moving("ur5", [move(q) for q in goals], scene=scene)
    plan = ikplan.plan(free(request))
    assert plan.order is not None
    assert plan.order.given_duration is not None
    assert plan.duration <= 1.02 * all_seconds.min()
    assert plan.order.given_duration == pytest.approx(all_seconds[0], rel=0.01)
    assert plan.duration < 0.95 * all_seconds[0]
    assert plan.order.gain == pytest.approx(1.0 - plan.duration / plan.order.given_duration)
    for row, number in enumerate(plan.order.waypoints):
        assert np.allclose(plan.waypoints.q[row], goals[number], atol=1e-9)
    assert (np.diff(plan.waypoints.time) > 0.0).all()


@pytest.mark.parametrize("seed", range(3))
def test_a_free_order_takes_no_longer_and_moves_no_farther_than_the_given_one(seed: int) -> None:
    robot = load_robot("panda")
    poses = [pose(robot, np.array(q)) for q in scattered(robot, 5, seed)]
    request = {"robot": "panda", "path": {"waypoints": poses}, "budget_s": 300.0}
    given, plan = ikplan.plan(request), ikplan.plan(free(request))
    assert plan.order is not None
    assert plan.order.given_duration is not None
    assert plan.order.given_length is not None
    assert plan.duration <= given.duration + 1e-9
    assert plan.order.duration <= plan.order.given_duration
    assert plan.order.length <= plan.order.given_length
    assert sorted(plan.order.parts) == list(range(5))
    for row, number in enumerate(plan.order.waypoints):
        T = robot.fk(plan.waypoints.q[row])
        assert np.allclose(T.translation, poses[number]["position"], atol=1e-6)


def test_a_free_start_begins_at_any_waypoint() -> None:
    robot = load_robot("ur5")
    angles = [0.6, 0.0, 0.9, 0.3]
    poses = [pose(robot, turned(robot, angle)) for angle in angles]
    path = {"waypoints": poses, "order": "free"}
    plan = ikplan.plan({"robot": "ur5", "start": "free", "path": path, "budget_s": 300.0})
    assert plan.order is not None
    passed = [angles[k] for k in plan.order.parts]
    assert passed in (sorted(angles), sorted(angles, reverse=True))


def test_parts_are_picked_and_placed_in_one_proven_plan() -> None:
    request = json.loads(EXAMPLE.read_text())
    assert request == {**pick_request(3), "budget_s": 60.0}
    plan, again = ikplan.plan(request), ikplan.plan(request)
    assert plan.order is not None
    assert plan.order.gain is not None
    assert plan.order.gain >= 0.0
    clearance = plan.certificate.clearance
    assert clearance is not None
    assert clearance.proven
    # Each part is picked and placed before the next one.
    tasks = np.array(plan.order.parts).reshape(3, 6)
    assert (np.diff(tasks, axis=1) == 1).all()
    assert sorted(tasks[:, 0]) == [0, 6, 12]
    # The proof says of each segment, by its number, when it is passed.
    begins = [clearance.segments[k].begin for k in plan.order.parts]
    assert begins == sorted(begins)
    assert plan.q.tobytes() == again.q.tobytes()
    assert plan.order == again.order
    given = ikplan.plan(pick_request(3, "given"))
    assert plan.duration <= given.duration + 1e-9


def test_what_is_written_first_and_what_is_to_stay_last_do() -> None:
    robot = load_robot("ur5")
    at = pose(robot, robot.home)
    up = {**at, "position": [*at["position"][:2], at["position"][2] + 0.05]}
    goals = [turned(robot, angle).tolist() for angle in (0.9, 0.3, 0.6)]
    segments = [{"type": "line", "to": up}, *map(move, goals), move(robot.home.tolist())]
    plan = ikplan.plan(free(moving("ur5", segments), stay_last=1))
    assert plan.order is not None
    assert plan.order.parts == [0, 2, 3, 1, 4]
    assert np.allclose(plan.q[-1], robot.home, atol=1e-9)


def test_a_request_in_the_given_order_keeps_its_id() -> None:
    robot = load_robot("ur5")
    request = moving("ur5", [move(robot.home.tolist())])
    one = ikplan.PlanRequest.model_validate(request)
    same = {**request, "path": {**request["path"], "order": "given", "stay_last": 0}}
    assert one.content_hash() == ikplan.PlanRequest.model_validate(same).content_hash()
    other = ikplan.PlanRequest.model_validate(free(request))
    assert one.content_hash() != other.content_hash()
    assert ikplan.plan(request).order is None


def test_without_the_extra_the_error_says_how_to_install_it(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setitem(sys.modules, "ortools.constraint_solver.pywrapcp", None)
    robot = load_robot("ur5")
    goals = [turned(robot, angle).tolist() for angle in (0.9, 0.3)]
    with pytest.raises(InvalidRequest, match=r"ikplan\[order\]") as caught:
        ikplan.plan(free(moving("ur5", [move(q) for q in goals])))
    assert caught.value.field == "path.order"


@pytest.mark.parametrize(
    ("path", "words"),
    [
        ({"interpolation": "line", "order": "free"}, "joint"),
        ({"stay_last": 1}, "stay_last"),
        ({"order": "free", "stay_last": 3}, "stay_last"),
    ],
)
def test_an_order_that_makes_no_sense_is_refused(path: dict[str, Any], words: str) -> None:
    waypoints = [{"position": [0.4, 0.1, 0.3]}, {"position": [0.4, 0.2, 0.3]}]
    with pytest.raises(InvalidRequest, match=words):
        ikplan.plan({"robot": "ur5", "path": {"waypoints": waypoints, **path}})


def carried(first: int | None, last: int | None) -> dict[str, Any]:
    part = {"name": "part", "shape": {"type": "sphere", "radius": 0.01}}
    return {**part, "first_segment": first, "last_segment": last}


@pytest.mark.parametrize(
    ("window", "tasks"),
    [
        (None, [Task(0, 1), Task(2, 2), Task(3, 4)]),
        ((1, 2), [Task(0, 2), Task(3, 4)]),
        ((None, 1), [Task(0, 1, "first"), Task(2, 2), Task(3, 4)]),
        ((3, None), [Task(0, 1), Task(2, 2), Task(3, 4, "last")]),
        ((None, None), [Task(0, 1), Task(2, 2), Task(3, 4)]),
    ],
)
def test_what_is_carried_keeps_tasks_together(
    window: tuple[int | None, int | None] | None, tasks: list[Task]
) -> None:
    to = {"position": [0.4, 0.1, 0.3]}
    line, go = {"type": "line", "to": to}, {"type": "move", "to": to}
    path = PathRequest.model_validate({"segments": [go, line, go, go, line], "order": "free"})
    attached = [] if window is None else [carried(*window)]
    scene = Scene.model_validate({"attached": attached})
    assert tasks_of(path, scene.attached) == tasks


@pytest.mark.parametrize(
    ("order", "words"),
    [
        ([2, 0, 1, 3], None),
        ([0, 1, 2, 3], None),
        ([0, 1, 2, 2], "these are passed"),
        ([1, 0, 2, 3], "does not follow"),
        ([0, 2, 1, 3], "does not follow"),
        ([3, 0, 1, 2], "stay last"),
    ],
)
def test_the_certificate_knows_which_orders_are_allowed(
    order: list[int], words: str | None
) -> None:
    to = {"position": [0.4, 0.1, 0.3]}
    line, go = {"type": "line", "to": to}, {"type": "move", "to": to}
    path = PathRequest.model_validate(
        {"segments": [go, line, go, go], "order": "free", "stay_last": 1}
    )
    wrong = broken_order(path, order)
    assert (words is None) == (wrong == [])
    assert words is None or any(words in line for line in wrong)


def test_a_body_carried_over_segments_that_are_passed_apart_is_no_plan() -> None:
    robot = load_robot("ur5")
    scene = Scene.model_validate(
        {"attached": [carried(1, 2)], "obstacles": [box("b", [9, 0, 0], [1, 1, 1])]}
    )
    model = collision_model(robot, scene)
    (body,) = (b for b in counted_in_order(model, [3, 1, 2, 0]).bodies if b.name == "part")
    assert (body.first_segment, body.last_segment) == (1, 2)
    with pytest.raises(CertificateViolated):
        counted_in_order(model, [1, 0, 2, 3])
