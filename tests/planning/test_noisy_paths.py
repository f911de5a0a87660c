"""Recorded tool paths: noise within the tolerance costs no time, and the tolerance is kept."""

from __future__ import annotations

import math
import re
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

import ikplan
from tests.measured import off_polyline

Array = NDArray[np.float64]
TOLERANCE = 1e-4
"""That of a path which names none [m]."""


def line(share: Array) -> Array:
    return np.outer(share - 0.5, [0.2, 0.05, 0.03])


def circle(share: Array) -> Array:
    turn = 2.0 * math.pi * share
    return 0.05 * np.stack([np.cos(turn), np.sin(turn), 0.0 * turn], axis=1)


def planned(robot: str, points: Array, turned: Array) -> ikplan.Plan:
    """The plan of lines through points, the tool down but for small rotations."""
    quaternion = np.hstack([np.ones((len(points), 1)), 0.5 * turned])
    quaternion /= np.linalg.norm(quaternion, axis=1)[:, None]
    waypoints: list[dict[str, Any]] = [
        {"position": p.tolist(), "quaternion_xyzw": q.tolist()}
        for p, q in zip(points, quaternion, strict=True)
    ]
    return ikplan.plan(
        {
            "robot": robot,
            "start": "free",
            "path": {"interpolation": "line", "waypoints": waypoints},
            "budget_s": 300,
        }
    )


@pytest.mark.parametrize("shape", [line, circle])
@pytest.mark.parametrize(
    ("robot", "middle"), [("ur5", [0.45, 0.1, 0.3]), ("panda", [0.45, 0, 0.4])]
)
def test_noise_within_the_tolerance_costs_no_time(
    robot: str, middle: list[float], shape: Any
) -> None:
    """A line of the UR5 took 3 s instead of 0.43 s once, and half a minute to plan."""
    arm, rng = ikplan.load_robot(robot), np.random.default_rng(4)
    points = shape(np.linspace(0.0, 1.0, 400)) + middle
    still = np.zeros_like(points)
    clean = planned(robot, points, still)
    noise = rng.normal(scale=2e-5, size=points.shape)
    noise *= np.minimum(1.0, 8e-5 / np.linalg.norm(noise, axis=1))[:, None]
    turned = rng.uniform(-1e-4, 1e-4, size=points.shape)
    noisy = planned(robot, points + noise, turned)
    assert noisy.duration <= 1.05 * clean.duration
    assert off_polyline(arm.poses(noisy.q)[1], points + noise).max() <= TOLERANCE
    deviation = noisy.certificate.max_path_deviation
    assert deviation is not None
    assert deviation <= TOLERANCE
    errors = arm.poses(noisy.waypoints.q)[1] - points - noise
    assert np.linalg.norm(errors, axis=1).max() <= TOLERANCE
    stops = noisy.certificate.stops
    assert stops is not None
    assert len(stops) == 0


def test_noise_beyond_the_tolerance_is_followed_within_it() -> None:
    arm, rng = ikplan.load_robot("ur5"), np.random.default_rng(5)
    points = line(np.linspace(0.0, 1.0, 60)) + np.array([0.45, 0.1, 0.3])
    points[1:-1] += rng.uniform(-6e-4, 6e-4, size=(58, 3))
    plan = planned("ur5", points, np.zeros_like(points))
    assert off_polyline(arm.poses(plan.q)[1], points).max() <= TOLERANCE
    errors = arm.poses(plan.waypoints.q)[1] - points
    assert np.linalg.norm(errors, axis=1).max() <= TOLERANCE


def test_a_motion_that_follows_noise_says_so_and_what_passes_it() -> None:
    rng = np.random.default_rng(6)
    points = circle(np.linspace(0.0, 1.0, 200)) + np.array([0.45, 0.1, 0.3])
    clean = [{"position": p.tolist(), "quaternion_xyzw": [1.0, 0.0, 0.0, 0.0]} for p in points]
    points += rng.normal(scale=1e-4, size=points.shape)
    noisy = [{"position": p.tolist(), "quaternion_xyzw": [1.0, 0.0, 0.0, 0.0]} for p in points]

    def planned_by(
        interpolation: str, waypoints: list[dict[str, Any]], **more: Any
    ) -> tuple[float, list[str]]:
        path = {"interpolation": interpolation, "waypoints": waypoints, **more}
        plan = ikplan.plan({"robot": "ur5", "start": "free", "path": path})
        assert plan.timing is not None
        return plan.duration, plan.timing.hints

    assert not planned_by("spline", clean)[1]
    duration, hints = planned_by("line", clean)
    assert not hints
    (told,) = planned_by("spline", noisy)[1]
    assert "noisy" in told
    assert '`path.interpolation` "line"' in told
    given = re.search(r"`path.tolerance.position`, such as ([0-9.e-]+),", told)
    assert given is not None
    tolerance = float(given.group(1))
    assert 3e-4 < tolerance < 2e-3
    # The hint is right: the motion takes about as long as the one past points without noise.
    eased = planned_by("line", noisy, tolerance={"position": tolerance})
    assert eased[0] <= 1.1 * duration
    assert not eased[1]
