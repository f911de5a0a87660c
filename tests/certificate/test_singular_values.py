"""The smallest singular value counts the rows that the target at that instant asks for."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import ikplan

from .requests import arm, paths, request

FULL, LINEAR = [0, 1, 2, 3, 4, 5], [0, 1, 2]
ROWS = {
    "line": FULL,
    "circle": FULL,
    "spline": FULL,
    "joint pose": FULL,
    "joint values": FULL,
    "led to an orientation": FULL,
    "positions only": LINEAR,
    "free about an axis": [0, 1, 2, 3, 4],
    "cone": [0, 1, 2, 4, 5],
}


@pytest.fixture(scope="module")
def documents() -> dict[str, Any]:
    return paths()


@pytest.mark.parametrize("name", ROWS)
def test_it_is_that_of_the_rows_asked_for(name: str, documents: dict[str, Any]) -> None:
    plan = ikplan.plan(request(documents[name]))
    robot, rows = arm(), ROWS[name]
    values = [np.linalg.svd(robot.jacobian(q)[rows])[1][-1] for q in plan.q]
    certificate = plan.certificate
    assert certificate.min_singular_value == pytest.approx(min(values), rel=1e-6)
    at = int(np.argmin(np.abs(plan.time - certificate.min_singular_value_time)))
    assert values[at] == pytest.approx(min(values), rel=1e-6)


def test_only_positions_count_where_every_orientation_is_as_good(documents: dict[str, Any]) -> None:
    plan = ikplan.plan(request({**documents["line"], "orientation_free": "all"}))
    values = [np.linalg.svd(arm().jacobian(q)[LINEAR])[1][-1] for q in plan.q]
    assert plan.certificate.min_singular_value == pytest.approx(min(values), rel=1e-6)


def test_each_part_of_a_path_has_its_own_rows(documents: dict[str, Any]) -> None:
    """An oriented line, then one without an orientation: six rows, then three."""
    near, bare = documents["line"], documents["positions only"]
    plan = ikplan.plan(request({"segments": [*near["segments"], *bare["segments"]]}))
    robot, turns = arm(), plan.waypoints.time[0]
    values = [
        np.linalg.svd(robot.jacobian(q)[FULL if t <= turns else LINEAR])[1][-1]
        for t, q in zip(plan.time, plan.q, strict=True)
    ]
    assert plan.certificate.min_singular_value == pytest.approx(min(values), rel=1e-6)


def test_an_orientation_of_the_last_joint_waypoint_counts_on_the_way_to_it(
    documents: dict[str, Any],
) -> None:
    """Two waypoints without an orientation, then one with: three rows, then six."""
    near, far = (w["position"] for w in documents["joint waypoints"]["waypoints"])
    middle = [0.5 * (a + b) for a, b in zip(near, far, strict=True)]
    waypoints = [
        {"position": far},
        {"position": middle},
        *documents["joint waypoints"]["waypoints"][:1],
    ]
    plan = ikplan.plan(request({**documents["joint waypoints"], "waypoints": waypoints}))
    robot, turns = arm(), plan.waypoints.time[1]
    values = [
        np.linalg.svd(robot.jacobian(q)[FULL if t > turns else LINEAR])[1][-1]
        for t, q in zip(plan.time, plan.q, strict=True)
    ]
    assert plan.certificate.min_singular_value == pytest.approx(min(values), rel=1e-6)
    assert plan.certificate.min_singular_value_time > turns
