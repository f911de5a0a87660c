"""Moves in the certificate: where they end counts, and nothing of their way."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

import ikplan
from ikplan import CertificateViolated, load_robot
from ikplan.certificate.requested import read_motion
from ikplan.documents.path import PathRequest
from ikplan.planning.moves import move_planner
from ikplan.planning.moves.rounding import round_way
from tests.moves.cells import moving, pose, turned

ROBOT = "ur5"


def _ending_elsewhere(function: Any) -> Any:
    def faulty(*args: Any, **kwargs: Any) -> Any:
        rounded = function(*args, **kwargs)
        q = rounded.q.copy()
        q[-1, 0] += 2e-3
        return replace(rounded, q=q)

    return faulty


@pytest.mark.parametrize(
    "target",
    [
        {"q": turned(load_robot(ROBOT), 0.5).tolist()},
        {"to": pose(load_robot(ROBOT), turned(load_robot(ROBOT), 0.5))},
        {"any": [{"q": turned(load_robot(ROBOT), angle).tolist()} for angle in (0.5, 0.9)]},
    ],
)
def test_a_move_that_ends_elsewhere_is_refused(
    target: dict[str, Any], monkeypatch: pytest.MonkeyPatch
) -> None:
    request = moving(ROBOT, [{"type": "move", **target}])
    assert ikplan.plan(request).certificate.valid
    monkeypatch.setattr(move_planner, "round_way", _ending_elsewhere(round_way))
    with pytest.raises(CertificateViolated, match="waypoint 0"):
        ikplan.plan(request)


def test_another_target_of_several_is_met_as_well_as_the_first() -> None:
    robot = load_robot(ROBOT)
    goals = [turned(robot, angle) for angle in (1.2, -0.4)]
    request = moving(ROBOT, [{"type": "move", "any": [{"q": q.tolist()} for q in goals]}])
    plan = ikplan.plan(request)
    assert np.allclose(plan.waypoints.q[0], goals[1])
    bound, total = plan.certificate.elongation_lower_bound, plan.certificate.elongation_sum
    assert 0.0 < bound <= total


@pytest.mark.parametrize("seed", range(6))
def test_random_walks_of_moves_are_read_as_planned(seed: int) -> None:
    rng = np.random.default_rng(seed)
    robot = load_robot(ROBOT)
    q = robot.home.copy()
    segments: list[dict[str, Any]] = []
    for _ in range(4):
        q = q + np.array([*rng.uniform(-0.3, 0.3, 3), 0.0, 0.0, rng.uniform(-0.5, 0.5)])
        kind = rng.integers(4)
        if kind == 0:
            segments.append({"type": "move", "q": q.tolist()})
        elif kind == 1:
            segments.append({"type": "move", "to": pose(robot, q)})
        elif kind == 2:
            other = {"q": (q + 1.0).tolist()}
            segments.append({"type": "move", "any": [{"q": q.tolist()}, other]})
            segments.append({"type": "joint", "q": q.tolist()})
        else:
            segments.append({"type": "joint", "to": pose(robot, q)})
    path = PathRequest.model_validate({"segments": segments})
    read = read_motion(robot, path, robot.home)
    assert len(read.waypoints) == len(segments)
    assert [part.end_row for part in read.joint_segments] == list(range(len(segments)))
    assert not read.legs
    plan = ikplan.plan(moving(ROBOT, segments))
    assert plan.certificate.valid
    assert len(plan.waypoints.q) == len(segments)
    moves = [k for k, segment in enumerate(segments) if segment["type"] == "move"]
    assert [move.field for move in plan.stats.moves] == [f"path.segments[{k}]" for k in moves]


def test_limits_of_a_move_hold_between_its_ends() -> None:
    robot = load_robot(ROBOT)
    q = turned(robot, 0.8)
    slow = {"type": "move", "q": q.tolist(), "limits": {"velocity_scale": 0.1}}
    back = {"type": "move", "q": robot.home.tolist()}
    plan = ikplan.plan(moving(ROBOT, [slow, back]))
    (segment,) = plan.certificate.segments
    assert segment.field == "path.segments[0]"
    inside = plan.time < segment.end - 1e-6
    assert np.abs(plan.dq[inside, 0]).max() <= 0.1 * robot.velocity_limit[0] * (1.0 + 1e-6)
    assert np.abs(plan.dq[~inside, 0]).max() > 0.2 * robot.velocity_limit[0]
