"""Formats of a robot, and measures of a plan over time, over HTTP."""

from __future__ import annotations

import json
from pathlib import Path

import httpx
import numpy as np
import pinocchio as pin
import pytest

import ikplan
from ikplan.documents.plan_request import PlanRequest
from ikplan.errors import InvalidRequest
from ikplan.pipeline.measures.series import plan_series
from ikplan.plans.export import FORMATS
from ikplan.plans.export.formats import Arm
from ikplan.robots import catalogue_robot

EXAMPLES = Path(__file__).parents[2] / "examples"


@pytest.mark.parametrize("name", ["ur5", "panda"])
def test_a_robots_formats_are_those_that_the_library_grants_it(
    http: httpx.Client, client: ikplan.Client, name: str
) -> None:
    arm = Arm.of_robot(catalogue_robot(name).info())
    granted = []
    for form in FORMATS:
        try:
            form.check(arm)
        except InvalidRequest:
            continue
        granted.append(form.media_type)
    listed = http.get(f"/v1/robots/{name}/formats").json()["formats"]
    assert [form["media_type"] for form in listed] == granted
    assert http.get("/v1/robots/nobody/formats").status_code == 404
    assert client.formats(name) == listed
    with pytest.raises(ikplan.RobotNotFound):
        client.formats("nobody")


def test_the_measures_of_a_plan_are_those_of_its_certificate(
    http: httpx.Client, client: ikplan.Client
) -> None:
    request = json.loads((EXAMPLES / "curve_ur5.json").read_text())
    request["scene"] = {
        "obstacles": [
            {"name": "ball", "shape": {"type": "sphere", "radius": 0.1}, "position": [0, 0, 1.3]}
        ],
        "clearance": 0.001,
    }
    assert http.post("/v1/series", json=request).status_code == 404
    with pytest.raises(ikplan.PlanNotFound):
        client.series(request)
    made = http.post("/v1/plans", json=request).json()
    certificate, time = made["certificate"], made["trajectory"]["time"]
    series = http.post("/v1/series", json=request).json()
    assert series["time"] == time
    assert client.series(request).model_dump(mode="json") == series
    deviation = [value for value in series["deviation"] if value is not None]
    assert max(deviation) == pytest.approx(certificate["max_path_deviation"], abs=1e-12)
    turns = [value for value in series["turn"] if value is not None]
    assert max(turns) == pytest.approx(certificate["max_orientation_deviation"], abs=1e-12)
    assert series["clearance_limit"] == 0.001
    assert min(series["clearance"]) >= certificate["clearance"]["least"] - 1e-9
    assert min(series["clearance"]) == pytest.approx(certificate["clearance"]["found"], abs=2e-3)


def test_the_torques_are_pinocchios() -> None:
    request = {"robot": "panda", "path": {"waypoints": [{"position": [0.5, 0.1, 0.5]}]}}
    made = ikplan.plan(request)
    series = plan_series(PlanRequest.model_validate(request), made)
    robot = catalogue_robot("panda")
    data = robot.model.createData()
    k = len(made.time) // 2
    wanted = pin.rnea(robot.model, data, robot.configurations(made.q)[k], made.dq[k], made.ddq[k])
    assert series.torque is not None
    np.testing.assert_allclose(series.torque[k], wanted, atol=1e-9)
    assert series.torque_limit == robot.effort_limit.tolist()
