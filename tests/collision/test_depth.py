"""How deep bodies are in each other, against closed forms and coal."""

from __future__ import annotations

import itertools
from typing import Any

import numpy as np
import pinocchio as pin
import pytest

import ikplan
from ikplan import load_robot
from ikplan.certificate.clearance.penetration import depth_at_most
from ikplan.collision.checker import CollisionChecker
from ikplan.collision.depth import overlap_depth
from ikplan.documents import parse
from ikplan.documents.scene import Scene
from ikplan.scene.body import Body, CollisionModel, ConvexPiece
from ikplan.scene.model import collision_model
from tests.collision.models import coal_gaps, random_model

BOX = np.array(list(itertools.product((-0.3, 0.3), (-0.2, 0.2), (-0.1, 0.1))))


def _shortfall(ball: ConvexPiece, clearance: float) -> float:
    """By how much a piece at the UR5's base and a box there are too near."""
    robot = load_robot("ur5")
    wrist = robot.model.njoints - 1
    T = robot.fk(robot.home)
    placed = ConvexPiece((ball.points + T.translation), ball.radius)
    far = Body("tool", wrist, (ConvexPiece(np.array([[0.0, 0.0, 5.0]]), 0.1),))
    bodies = (far, Body("ball", 0, (placed,)))
    # The box moves with the wrist, and stands along the axes of the wrist.
    data = robot.model.createData()
    pin.forwardKinematics(robot.model, data, robot.configuration(robot.home))
    M = robot.T_universe_base.inverse() * data.oMi[wrist]
    corners = (BOX + T.translation - M.translation) @ M.rotation
    box = Body("box", wrist, (ConvexPiece(corners, 0.0),))
    model = CollisionModel((*bodies, box), np.array([[0, 1], [1, 2]]), clearance)
    return CollisionChecker(robot, model).shortfall(robot.home, ("ball", "box"))


@pytest.mark.parametrize(
    ("points", "radius", "depth"),
    [
        ([[0.0, 0.0, 0.05]], 0.02, 0.05 + 0.02),  # a sphere inside, 50 mm from the top
        ([[0.0, 0.0, 0.0]], 0.5, 0.1 + 0.5),
        ([[0.29, 0.0, 0.0]], 0.05, 0.01 + 0.05),
        ([[0.32, 0.0, 0.0]], 0.05, 0.03),  # its centre is outside
        ([[-0.1, 0.0, 0.04], [0.1, 0.0, 0.06]], 0.02, 0.06 + 0.02),  # a capsule that leans
        ([[0.4, 0.0, 0.0]], 0.05, 0.0),
    ],
)
def test_the_depth_of_a_sphere_or_capsule_in_a_box_is_the_way_out(
    points: list[list[float]], radius: float, depth: float
) -> None:
    piece = ConvexPiece(np.array(points), radius)
    assert _shortfall(piece, 0.0) == pytest.approx(depth, abs=1e-9)


def test_the_clearance_comes_on_top_of_the_depth() -> None:
    ball = ConvexPiece(np.array([[0.0, 0.0, 0.05]]), 0.02)
    assert _shortfall(ball, 0.01) == pytest.approx(0.08, abs=1e-9)
    apart = ConvexPiece(np.array([[0.358, 0.0, 0.0]]), 0.05)
    assert _shortfall(apart, 0.01) == pytest.approx(0.002, abs=1e-9)
    assert _shortfall(apart, 0.0) == 0.0


@pytest.mark.parametrize("name", ["panda", "ur5"])
def test_depths_are_those_of_coal(name: str) -> None:
    robot, rng = load_robot(name), np.random.default_rng(11)
    deep = 0
    for _ in range(12):
        model = random_model(robot, rng)
        checker = CollisionChecker(robot, model)
        for _ in range(4):
            q = robot.random_configuration(rng)
            reference = coal_gaps(robot, model, q)
            for (a, b), gap in zip(model.pairs, reference, strict=True):
                if gap < -1e-3:
                    pair = model.bodies[a].name, model.bodies[b].name
                    assert checker.shortfall(q, pair) == pytest.approx(-gap, abs=2e-5)
                    deep += 1
    assert deep > 3


def test_the_bound_of_the_certificate_is_never_below_the_depth_and_near_to_it() -> None:
    rng = np.random.default_rng(4)
    for _ in range(20):
        a, b = rng.normal(size=(12, 3)), rng.normal(size=(30, 3)) + 0.3
        exact = overlap_depth(a, b)
        assert exact > 0.0
        assert exact - 1e-9 <= depth_at_most(a, b, 0.0) <= 1.05 * exact


def test_a_refusal_tells_how_deep_a_waypoint_is_in_a_box() -> None:
    robot = load_robot("panda")
    box = {"name": "box", "shape": {"type": "box", "size": [0.3, 0.3, 0.3]}}
    scene: dict[str, Any] = {"obstacles": [box | {"position": [0.5, 0.0, 0.4]}], "clearance": 0.01}
    path = {"waypoints": [{"position": [0.5, 0.0, 0.4]}]}
    with pytest.raises(ikplan.InCollision) as caught:
        ikplan.plan({"robot": "panda", "path": path, "scene": scene}, robot=robot)
    error = caught.value
    assert error.pair is not None
    model = collision_model(robot, parse(Scene, scene))
    names = [tuple(model.bodies[k].name for k in pair) for pair in model.pairs]
    oracle_gap = coal_gaps(robot, model, np.array(error.q))[names.index(tuple(error.pair))]
    assert error.depth == pytest.approx(0.01 - oracle_gap, abs=2e-5)
    assert error.depth > 0.02
