"""The planner's check for contact, against coal, closed forms and dense looks."""

from __future__ import annotations

import numpy as np
import pinocchio as pin
import pytest
from numpy.typing import NDArray

from ikplan import Robot, load_robot
from ikplan.collision.checker import CollisionChecker
from ikplan.scene.body import Body, CollisionModel, ConvexPiece
from tests.collision.models import coal_gaps, random_model

ROBOTS = ("panda", "ur5", "dobot_magician", "tiago", "eod_arm")
COAL_TOLERANCE = 5e-6
"""coal's distances are up to 2 um too large [m]."""


@pytest.mark.parametrize("name", ROBOTS)
def test_contacts_and_gaps_are_those_of_coal(name: str) -> None:
    robot, rng = load_robot(name), np.random.default_rng(3)
    touching = 0
    for _ in range(6):
        model = random_model(robot, rng)
        checker = CollisionChecker(robot, model)
        for _ in range(10):
            q = robot.random_configuration(rng)
            reference = coal_gaps(robot, model, q)
            gap, pair = checker.least_gap(q)
            assert gap == pytest.approx(max(reference.min(), 0.0), abs=COAL_TOLERANCE)
            if abs(reference.min()) > COAL_TOLERANCE:
                assert checker.free(q[None])[0] == (reference.min() > 0.0)
                touching += reference.min() < 0.0
            if gap > 0.0:
                names = [(model.bodies[a].name, model.bodies[b].name) for a, b in model.pairs]
                row = min(
                    (k for k, name in enumerate(names) if set(name) == set(pair)),
                    key=lambda k: reference[k],
                )
                assert reference[row] == pytest.approx(gap, abs=COAL_TOLERANCE)
    assert touching > 0


@pytest.mark.parametrize("name", ROBOTS)
def test_no_contact_is_missed_between_two_configurations(name: str) -> None:
    robot, rng = load_robot(name), np.random.default_rng(5)
    proven = refused = 0
    for _ in range(12):
        model = random_model(robot, rng, obstacles=3)
        checker = CollisionChecker(robot, model)
        q = robot.random_configuration(rng)
        step = rng.normal(size=robot.dof)
        ends = np.vstack([q, robot.clip(q + 0.6 * step / np.linalg.norm(step))])
        contact = checker.first_contact(ends)
        dense = ends[0] + np.linspace(0.0, 1.0, 400)[:, None] * (ends[1] - ends[0])
        free = checker.free(dense)
        if contact is None:
            proven += 1
            assert free.all()
        else:
            refused += 1
            gap, _ = checker.least_gap(contact.q)
            assert gap < 1e-4  # halving ends at motions of 0.02 mm
    assert refused > 0
    assert proven + refused == 12


def sphere(name: str, carrier: int, centre: tuple[float, float, float], radius: float) -> Body:
    return Body(name, carrier, (ConvexPiece(np.array([centre]), radius),))


def test_a_plate_thinner_than_the_step_is_met() -> None:
    robot = load_robot("ur5")
    T = robot.fk(robot.home)
    tip = robot.model.njoints - 1
    ends = np.vstack([robot.home, robot.home])
    ends[0, 0], ends[1, 0] = -0.5, 0.5
    plate = np.array([[0.2, y, z] for y in (-5e-4, 5e-4) for z in (0.0, 1.5)])
    plate = np.vstack([plate, plate + np.array([1.0, 0.0, 0.0])])
    middle = np.arctan2(T.translation[1], T.translation[0])
    c, s = np.cos(middle), np.sin(middle)
    turned = plate @ np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]]).T
    model = CollisionModel(
        (sphere("tool", tip, (0.0, 0.0, 0.0), 1e-3), Body("plate", 0, (ConvexPiece(turned, 0.0),))),
        np.array([[0, 1]]),
        0.0,
    )
    checker = CollisionChecker(robot, model)
    assert checker.free(ends).all()
    contact = checker.first_contact(ends)
    assert contact is not None
    assert set(contact.pair) == {"tool", "plate"}
    assert 0.3 < contact.share < 0.7


def wrist_origin(robot: Robot, q: NDArray[np.float64]) -> NDArray[np.float64]:
    data = robot.model.createData()
    pin.forwardKinematics(robot.model, data, robot.configuration(q))
    placed = robot.T_universe_base.inverse() * data.oMi[robot.model.njoints - 1]
    return np.array(placed.translation)


@pytest.mark.parametrize(
    ("gap", "clearance", "margin", "free"),
    [
        (0.1, 0.0, 0.0, True),
        (0.1, 0.09, 0.0, True),
        (0.1, 0.11, 0.0, False),
        (0.1, 0.09, 0.02, False),
        (-0.01, 0.0, 0.0, False),
    ],
)
def test_clearance_and_margin_are_required_of_the_gap_of_two_spheres(
    gap: float, clearance: float, margin: float, free: bool
) -> None:
    robot = load_robot("ur5")
    wrist = robot.model.njoints - 1
    x, y, z = wrist_origin(robot, robot.home)
    ball = sphere("ball", 0, (x + 0.15 + gap, y, z), 0.1)
    bodies = (sphere("tool", wrist, (0.0, 0.0, 0.0), 0.05), ball)
    checker = CollisionChecker(robot, CollisionModel(bodies, np.array([[0, 1]]), clearance), margin)
    assert checker.free(robot.home[None])[0] == free
    assert checker.least_gap(robot.home)[0] == pytest.approx(max(gap, 0.0), abs=1e-9)


def test_attached_bodies_count_in_their_segments_only() -> None:
    robot = load_robot("ur5")
    wrist = robot.model.njoints - 1
    part = sphere("part", wrist, (0.0, 0.0, 0.0), 0.1)
    part = Body(part.name, part.carrier, part.pieces, "attached", "", 0.0, 2, 3)
    base = sphere("table", 0, tuple(robot.fk(robot.home).translation), 0.2)
    checker = CollisionChecker(robot, CollisionModel((part, base), np.array([[0, 1]]), 0.0))
    q = robot.home[None]
    assert [bool(checker.free(q, k)[0]) for k in (1, 2, 3, 4)] == [True, False, False, True]
    assert checker.commonest(np.vstack([q, q]), 2) == [(("part", "table"), 2)]
    assert not checker.free(q)[0]


def test_a_model_without_pairs_is_free_everywhere() -> None:
    robot = load_robot("panda")
    model = CollisionModel((), np.empty((0, 2), dtype=np.int64), 0.0)
    checker = CollisionChecker(robot, model)
    q = np.vstack([robot.home, robot.home])
    assert checker.free(q).all()
    assert checker.first_contact(q) is None
    assert checker.least_gap(robot.home)[0] == np.inf
