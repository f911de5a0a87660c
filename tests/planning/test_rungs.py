"""Steps between the rungs of a path, against a search step by step."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from numpy.typing import NDArray

from ikplan import load_robot
from ikplan.collision.checker import CollisionChecker
from ikplan.documents import parse
from ikplan.documents.scene import Scene
from ikplan.planning.around.path_ladder import LONGEST, PathLadder
from ikplan.planning.tracking.tracking_kernels import project_onto_targets
from ikplan.scene.model import collision_model
from tests.planning.planar import Polyline, positions, tracker_of

Array = NDArray[np.float64]

ROBOT = load_robot("ur5")


def candidates(rng: np.random.Generator, p: Array, spread: float, count: int) -> Array:
    """Configurations with the tool at p, shape (c, 6)."""
    tracker = tracker_of(ROBOT)
    q = ROBOT.home + spread * rng.normal(size=(count, 6))
    left, _ = project_onto_targets(
        tracker.arm.chain, positions(np.tile(p, (count, 1))), q, ROBOT.lower, ROBOT.upper
    )
    return q[left < 1e-9]


@pytest.mark.parametrize("seed", range(6))
def test_each_candidate_is_reached_by_the_shortest_way_whose_step_is_free(seed: int) -> None:
    rng = np.random.default_rng(seed)
    begin = ROBOT.fk(ROBOT.home).translation
    path = Polyline(np.array([begin, begin + 0.06 * rng.normal(size=3)]))
    ball = {"type": "sphere", "radius": 0.05}
    at = ROBOT.fk(ROBOT.home).translation + 0.16 * np.array([0.6, 0.0, 0.8])
    scene = {"obstacles": [{"name": "ball", "shape": ball, "position": at.tolist()}]}
    contact = CollisionChecker(ROBOT, collision_model(ROBOT, parse(Scene, scene)))
    tracker = replace(tracker_of(ROBOT), contact=contact)
    s = np.array([0.0, 0.5, 1.0]) * path.length
    ladder = PathLadder(tracker, path, s)
    before = candidates(rng, path.points[0], 0.4, 30)
    after = candidates(rng, path.points[1], 0.4, 30)
    cost = rng.uniform(0.0, 0.5, len(before))
    cost[::5] = np.inf
    reached, parent, middles = ladder.join(1, cost, before, after)

    half_way = positions(path.poses(s[1:2])[1])
    taken = touched = 0
    for j, q in enumerate(after):
        totals = cost + np.linalg.norm(before - q, axis=1)
        totals[np.abs(before - q).max(axis=1) > LONGEST] = np.inf
        best = -1
        for i in np.argsort(totals, kind="stable")[:12]:
            if not np.isfinite(totals[i]):
                break
            straight = 0.5 * (before[i] + q)
            middle = straight[None].copy()
            left, _ = project_onto_targets(
                tracker.arm.chain, half_way, middle, ROBOT.lower, ROBOT.upper
            )
            far = np.linalg.norm(middle[0] - straight) > 0.25 * np.linalg.norm(q - before[i])
            way = np.vstack([before[i], middle, q])
            if left[0] > 1e-9 or far:
                continue
            if contact.first_contact(way) is None:
                best = int(i)
                np.testing.assert_allclose(middles[j], middle[0], atol=1e-12)
                np.testing.assert_allclose(reached[j], totals[i], rtol=1e-12)
                break
            touched += 1
        assert parent[j] == best
        assert np.isfinite(reached[j]) == (best >= 0)
        taken += best >= 0
    assert taken > 0
    assert touched > 0
