"""What is impossible is proven and said; what is not found is not; what fails is repaired."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import ikplan
from ikplan import InCollision, Unreachable, load_robot
from ikplan.arrays import Array, Flags
from ikplan.pipeline import assemble
from ikplan.pipeline.collisions import prove_motion
from ikplan.planning.moves import move_planner
from ikplan.planning.moves.piece_check import PieceCheck, piece_check
from tests.moves.cells import box, pose, post, turned


def test_a_pose_at_which_the_tool_itself_touches_is_proven_impossible() -> None:
    robot = load_robot("ur5")
    goal = pose(robot, turned(robot, 1.0))
    crate = box("crate", goal["position"], (0.15, 0.15, 0.15))
    with pytest.raises(InCollision, match="no configuration") as caught:
        ikplan.move("ur5", None, goal, {"obstacles": [crate]})
    assert caught.value.proven
    assert caught.value.waypoint == 0
    assert "crate" in caught.value.pair
    # Without an orientation the tool may come from elsewhere: nothing is proven.
    point = {"position": goal["position"]}
    with pytest.raises(InCollision) as open_ended:
        ikplan.move("ur5", None, point, {"obstacles": [crate]})
    assert not open_ended.value.proven


def test_a_pose_of_which_every_configuration_found_touches_is_not_called_impossible() -> None:
    robot = load_robot("ur5")
    q = turned(robot, 1.0)
    # In the way of every branch, and away from what moves with the tool.
    x, y, z = (0.5 * robot.fk(q).translation).tolist()
    pillar = box("pillar", (x, y, z + 0.1), (0.25, 0.25, 1.0))
    start = turned(robot, -1.6)
    with pytest.raises(InCollision, match="configurations found") as caught:
        ikplan.move("ur5", start, pose(robot, q), {"obstacles": [pillar]})
    assert not caught.value.proven


def test_a_pose_out_of_reach_is_said_to_be() -> None:
    with pytest.raises(Unreachable) as caught:
        ikplan.move("ur5", None, {"position": [2.0, 0.0, 0.3]})
    assert caught.value.waypoint == 0
    assert caught.value.position_error > 0.9


def test_a_move_on_which_the_timed_proof_fails_is_rounded_anew(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    robot = load_robot("ur5")
    goal, scene = turned(robot, 1.6), {"obstacles": [post(robot)]}

    def blind(*arguments: Any) -> PieceCheck | None:
        check = piece_check(*arguments)
        assert check is not None

        def without_a_gap(s: Array, q: Array, m: tuple[Array, Array], extra: float) -> Flags:
            if extra == 0.0:
                return np.zeros(len(s) - 1, dtype=bool)
            return check(s, q, m, extra)

        return without_a_gap

    failed: list[InCollision] = []

    def watched(*arguments: Any) -> Any:
        try:
            return prove_motion(*arguments)
        except InCollision as violation:
            failed.append(violation)
            raise

    monkeypatch.setattr(move_planner, "piece_check", blind)
    monkeypatch.setattr(assemble, "prove_motion", watched)
    plans = [ikplan.move("ur5", None, goal, scene, seed=seed, budget_s=300.0) for seed in range(6)]
    assert failed
    for plan in plans:
        assert plan.certificate.clearance is not None
        assert plan.certificate.clearance.proven
