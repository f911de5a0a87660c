"""The hard cases of tests/vectors/planning, each with its expected outcome."""

from __future__ import annotations

import json
import math
from pathlib import Path
from typing import Any

import numpy as np
import pinocchio as pin
import pytest

import ikplan
from ikplan import errors

FOLDER = Path(__file__).parents[1] / "vectors" / "planning"
VECTORS: dict[str, dict[str, Any]] = {
    path.stem: json.loads(path.read_text()) for path in sorted(FOLDER.glob("*.json"))
}
GOOD = [name for name, vector in VECTORS.items() if "error" not in vector["expect"]]
BAD = [name for name, vector in VECTORS.items() if "error" in vector["expect"]]


def test_there_are_vectors_of_both_kinds() -> None:
    assert len(GOOD) >= 20
    assert len(BAD) >= 7


@pytest.mark.parametrize("name", GOOD)
def test_a_hard_path_is_planned_and_certified(name: str) -> None:
    vector = VECTORS[name]
    plan = ikplan.plan(vector["request"])
    certificate, expected = plan.certificate, vector["expect"]
    assert certificate.valid
    assert certificate.elongation_lower_bound <= certificate.elongation_sum + 1e-12
    exact = not vector["request"]["path"].get("blend")
    if exact:
        assert certificate.max_position_error <= 1e-8
    robot = ikplan.load_robot(plan.robot)
    assert ((robot.lower <= plan.q) & (plan.q <= robot.upper)).all()
    if vector["request"].get("start", "free") != "free":
        np.testing.assert_array_equal(plan.q[0], vector["request"]["start"])
    tolerance = vector["request"]["path"].get("tolerance", {}).get("position", 1e-4)
    if certificate.max_path_deviation is not None:
        assert certificate.max_path_deviation <= tolerance
    if "elongation_deg" in expected:
        most = expected["elongation_deg"] * (1.0 + expected["within"])
        assert math.degrees(certificate.elongation_sum) <= most
    if "closed" in expected:
        np.testing.assert_allclose(plan.q[-1], plan.q[0], atol=1e-6)


@pytest.mark.parametrize("name", BAD)
def test_a_path_that_cannot_be_is_refused_with_its_cause(name: str) -> None:
    expected = VECTORS[name]["expect"]
    with pytest.raises(getattr(errors, expected["error"])) as caught:
        ikplan.plan(VECTORS[name]["request"])
    for words in expected["says"]:
        assert words in caught.value.detail
    for field, value in expected.get("data", {}).items():
        assert getattr(caught.value, field) == value
    check_place(caught.value, VECTORS[name]["request"])


def check_place(error: ikplan.IkplanError, request: dict[str, Any]) -> None:
    """What is told of where the tool was to be fits what is told of how far it is from there."""
    if not isinstance(error, errors.Unreachable | errors.Disconnected):
        return
    tool = request.get("tool", {})
    robot = ikplan.load_robot(request["robot"])
    if tool:
        robot = robot.with_tool(tool["position"], tool.get("quaternion_xyzw", [0, 0, 0, 1]))
    q = np.array(error.q)
    assert ((robot.lower <= q) & (q <= robot.upper)).all()
    if isinstance(error, errors.Disconnected):
        return
    pose, target = robot.fk(q), error.target
    assert target is not None
    distance = np.linalg.norm(pose.translation - target["position"])
    assert distance == pytest.approx(error.position_error, abs=1e-9)
    if error.orientation_error is not None:
        R = pin.Quaternion(np.array(target["quaternion_xyzw"])).matrix()
        angle = np.linalg.norm(pin.log3(R.T @ pose.rotation))
        assert angle == pytest.approx(error.orientation_error, abs=1e-6)
    for row in error.waypoints[:1]:
        assert row["target"] == target


@pytest.mark.parametrize("seed", [1, 2, 3])
@pytest.mark.parametrize("name", [name for name in GOOD if name.startswith("helix_")])
def test_every_seed_comes_within_half_a_percent_of_the_best_known(name: str, seed: int) -> None:
    vector = VECTORS[name]
    plan = ikplan.plan({**vector["request"], "ik": {"seed": seed}})
    best = vector["expect"]["elongation_deg"]
    assert math.degrees(plan.certificate.elongation_sum) <= 1.005 * best
