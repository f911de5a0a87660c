"""Single moves on the command line."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import ikplan
from ikplan import load_robot
from tests.moves.cells import box, post, turned

from .conftest import Done

Ask = Callable[..., Done]


def written(folder: Path, obstacles: list[dict[str, Any]]) -> Path:
    file = folder / "scene.json"
    file.write_text(json.dumps({"obstacles": obstacles}))
    return file


def test_a_move_goes_around_the_scene_of_a_file(ask: Ask, tmp_path: Path) -> None:
    robot = load_robot("ur5")
    goal, scene = turned(robot, 1.6), written(tmp_path, [post(robot)])
    out = tmp_path / "plan.json"
    done = ask("move", "ur5", "--goal", *goal, "--scene", scene, "--seed", 3, "-o", out)
    assert done.code == 0, done.err
    assert "clearance" in done.out
    plan = ikplan.Plan.load(out.read_bytes())
    same = ikplan.move("ur5", None, goal, json.loads(scene.read_text()), seed=3)
    assert plan.q.tobytes() == same.q.tobytes()
    assert np.allclose(plan.q[-1], goal)


def test_the_goal_may_be_a_pose_or_one_of_several(ask: Ask, tmp_path: Path) -> None:
    robot = load_robot("ur5")
    T = robot.fk(turned(robot, 0.4))
    out = tmp_path / "plan.json"
    done = ask("move", "ur5", "--position", *T.translation, "--rate", 100, "-o", out)
    assert done.code == 0, done.err
    plan = ikplan.Plan.load(out.read_bytes())
    assert np.allclose(robot.fk(plan.q[-1]).translation, T.translation, atol=1e-6)
    goals = [turned(robot, angle) for angle in (1.0, -0.3)]
    start = turned(robot, 0.1)
    done = ask("move", "ur5", "--start", *start, "--goal", *goals[0], "--goal", *goals[1], "--json")
    assert done.code == 0, done.err
    assert np.allclose(json.loads(done.out)["trajectory"]["q"][-1], goals[1])


def test_exit_codes_of_moves_are_those_of_plans(ask: Ask, tmp_path: Path) -> None:
    robot = load_robot("ur5")
    goal = turned(robot, 1.0)
    crate = written(tmp_path, [box("crate", robot.fk(goal).translation, (0.1, 0.1, 0.1))])
    refused = ask("move", "ur5", "--goal", *goal, "--scene", crate)
    assert (refused.code, refused.out) == (1, "")
    assert "crate" in refused.err
    assert ask("move", "ur5", "--position", 9, 0, 0).code == 1


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        ([], "--goal"),
        (["--goal", 0, "--position", 0, 0, 1], "--goal"),
        (["--goal", 0, "--quaternion", 0, 0, 0, 1], "--goal"),
        (["--goal", 0, 0], "6 values expected"),
    ],
)
def test_wrong_goals_are_wrong_usage(ask: Ask, arguments: list[Any], words: str) -> None:
    done = ask("move", "ur5", *arguments)
    assert done.code == 2
    assert words in done.err


def test_a_robot_that_there_is_not_is_wrong_input(ask: Ask, tmp_path: Path) -> None:
    assert ask("move", "no-such-robot", "--goal", 0).code == 2
    assert ask("move", tmp_path / "no.urdf", "--goal", 0).code == 2
