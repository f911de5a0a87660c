"""Joint legs beside bodies that the spline through their waypoints alone would touch."""

from __future__ import annotations

import itertools
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

import ikplan
from ikplan import load_robot
from ikplan.collision.checker import CollisionChecker
from ikplan.documents import parse
from ikplan.documents.scene import Scene
from ikplan.joint_path import JointPath
from ikplan.scene.model import collision_model

Array = NDArray[np.float64]
ROBOT = load_robot("ur5")


def _ball(place: Array, radius: float) -> dict[str, Any]:
    shape = {"type": "sphere", "radius": radius}
    return {"obstacles": [{"name": "ball", "shape": shape, "position": place.tolist()}]}


def _check(scene: dict[str, Any]) -> CollisionChecker:
    return CollisionChecker(ROBOT, collision_model(ROBOT, parse(Scene, scene)))


def _way(seed: int) -> tuple[Array, Array]:
    """Joint values, and where the tool is farthest off the straight motions between them [m]."""
    rng = np.random.default_rng(seed)
    reach = np.array([1.2, 0.5, 0.5, 0.8, 0.8, 0.8])
    way = np.vstack([ROBOT.home, ROBOT.home + rng.uniform(-1.0, 1.0, (3, 6)) * reach])
    path = JointPath.through(way)
    shares = np.linspace(0.0, 1.0, 60)[:, None]
    chords = np.vstack([a + shares * (b - a) for a, b in itertools.pairwise(way)])
    straight = np.array([ROBOT.fk(q).translation for q in chords])
    curved = np.array([ROBOT.fk(q).translation for q in path(np.linspace(0.0, path.length, 120))])
    off = np.linalg.norm(straight[None] - curved[:, None], axis=2).min(axis=1)
    return way, curved[int(np.argmax(off))]


def _nearest_ball(way: Array, place: Array, gap: float) -> dict[str, Any]:
    """A ball beyond a place that the straight motions pass by a gap and hardly more [m]."""
    tools = np.array([ROBOT.fk(q).translation for q in way])
    corner = tools[int(np.argmin(np.linalg.norm(tools - place, axis=1)))]
    along = (place - corner) / np.linalg.norm(place - corner)
    near, far = 0.0, 0.3
    while far - near > 0.05 * gap:
        middle = 0.5 * (near + far)
        check = _check(_ball(corner + middle * along, 0.02)).wider(gap)
        near, far = (near, middle) if check.first_contact(way) is None else (middle, far)
    return _ball(corner + far * along, 0.02)


def _planned(way: Array, scene: dict[str, Any]) -> ikplan.Plan:
    """The plan through joint values; the spline through them alone touches the ball."""
    request = {
        "robot": "ur5",
        "start": way[0].tolist(),
        "path": {"segments": [{"type": "joint", "q": q.tolist()} for q in way[1:]]},
        "scene": scene,
    }
    plain = ikplan.plan(request | {"scene": {"self_collision": False}})
    assert _check(scene).first_contact(plain.q) is not None
    plan = ikplan.plan(request)
    clearance = plan.certificate.clearance
    assert clearance is not None
    assert clearance.proven
    assert np.array_equal(plan.waypoints.q, way[1:])
    assert np.array_equal(ikplan.plan(request).q, plan.q)
    return plan


@pytest.mark.parametrize("seed", [0, 1, 3])
def test_joint_legs_pass_what_their_straight_motions_pass(seed: int) -> None:
    way, place = _way(seed)
    _planned(way, _ball(place, 0.02))


@pytest.mark.parametrize("gap", [1e-3, 1.2e-4])
@pytest.mark.parametrize("seed", [0, 1])
def test_joint_legs_pass_what_their_straight_motions_hardly_pass(seed: int, gap: float) -> None:
    way, place = _way(seed)
    plan = _planned(way, _nearest_ball(way, place, gap))
    assert plan.certificate.stops == []
