"""What is said of the motion of bodies within an interval holds everywhere in it."""

from __future__ import annotations

import numpy as np
import pytest

from ikplan.arrays import Array
from ikplan.collision.checker import CollisionChecker
from ikplan.collision.motion import reach_of
from ikplan.collision.pair_gaps import place_pieces
from ikplan.collision.scratch import Scratch
from ikplan.collision.sweep import move_links, move_piece, sweep_pair
from ikplan.robots import load_robot
from tests.collision.models import random_model


def _seen_from(inner: int, carrier: int, local: Array, w: Scratch) -> tuple[Array, Array]:
    """Points of a carrier in the frame of an inner link, and in the base."""
    world = local @ w.R[carrier].T + w.p[carrier]
    return np.asarray((world - w.p[inner]) @ w.R[inner]), np.asarray(world)


@pytest.mark.parametrize("name", ["panda", "tiago"])
def test_no_point_of_a_body_leaves_what_its_sweep_says(name: str) -> None:
    robot, rng = load_robot(name), np.random.default_rng(4)
    model = random_model(robot, rng)
    arrays = CollisionChecker(robot, model).arrays(None)
    chain, bodies, w = arrays.chain, arrays.bodies, arrays.scratch
    tight = 0
    for _ in range(40):
        w.queue.curve[:] = rng.normal(size=(4, robot.dof)) * np.array([[1.0], [1.0], [0.6], [0.3]])
        t, h = rng.uniform(0.2, 0.8), rng.choice([0.01, 0.05, 0.2])
        reach_of(chain, w.queue, t, h)
        place_pieces(chain, bodies, w.queue.q, w)
        move_links(chain, w.queue, w)
        j = int(rng.choice(bodies.moving))
        carrier = bodies.carrier[j]
        a = int(rng.integers(0, carrier))
        i = int(np.flatnonzero(bodies.carrier == a)[0])
        move_piece(chain, bodies, w.queue, j, w)
        sweep_pair(bodies, i, j, w)
        sweep = w.sweep.copy()
        local = bodies.points[bodies.first[j] : bodies.first[j + 1]]
        R_mid = w.R[a].copy()
        middle, world = _seen_from(a, carrier, local, w)
        centre = w.centre[j].copy()
        speed = sweep[:3] + np.cross(sweep[3:6], world - centre)
        for share in np.linspace(-1.0, 1.0, 9):
            at = t + share * h
            q = np.array([1.0, at, at**2, at**3]) @ w.queue.curve
            place_pieces(chain, bodies, q, w)
            moved = (_seen_from(a, carrier, local, w)[0] - middle) @ R_mid.T
            assert (np.linalg.norm(moved, axis=1) <= sweep[8] + 1e-12).all()
            off = np.linalg.norm(moved - share * speed, axis=1)
            assert (off <= sweep[7] + 1e-12).all()
            tight += int((off > 0.1 * sweep[7]).any())
    assert tight > 20
