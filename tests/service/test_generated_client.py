"""A client that a generator makes of the OpenAPI document plans the helix."""

from __future__ import annotations

import importlib
import json
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path
from types import ModuleType
from typing import Any

import httpx
import numpy as np
import pytest

import ikplan
from ikplan import Client
from tests.measured import check_motion

HELIX = Path(__file__).parents[2] / "examples" / "helix_iiwa14.json"
PACKAGE = "generated_ikplan_client"


@pytest.fixture(scope="module")
def generated(http: httpx.Client, tmp_path_factory: pytest.TempPathFactory) -> Iterator[ModuleType]:
    """The package that openapi-python-client makes, imported."""
    folder = tmp_path_factory.mktemp("generated")
    document, config = folder / "openapi.json", folder / "config.yaml"
    document.write_bytes(http.get("/openapi.json").content)
    config.write_text("post_hooks: []\n")  # they only make it prettier
    subprocess.run(
        [
            *(sys.executable, "-m", "openapi_python_client", "generate"),
            *("--path", str(document), "--config", str(config), "--meta", "none"),
            *("--output-path", str(folder / PACKAGE)),
        ],
        check=True,
        capture_output=True,
        timeout=120,
    )
    sys.path.insert(0, str(folder))
    yield importlib.import_module(PACKAGE)
    sys.path.remove(str(folder))


def part(name: str) -> Any:
    return importlib.import_module(f"{PACKAGE}.{name}")


def test_it_plans_the_helix_as_python_does(
    generated: ModuleType, live_address: str, client: Client
) -> None:
    document = json.loads(HELIX.read_text())
    request = part("models").PlanRequest.from_dict(document)
    with generated.Client(live_address, timeout=120.0) as made:
        plan = part("api.plans.create_plan").sync(client=made, body=request)
    assert isinstance(plan, part("models").Plan)
    own = client.plan(document)
    assert plan.id == own.id
    assert np.array_equal(plan.trajectory.q, own.trajectory.q)
    check_motion(plan.trajectory, ikplan.load_robot(plan.robot), ends=(document["start"],))
    assert ikplan.PlanRequest.model_validate(document)


def test_it_reads_problems_as_what_they_are(generated: ModuleType, live_address: str) -> None:
    far = part("models").IkRequest.from_dict({"robot": "iiwa14", "position": [9.0, 0.0, 0.0]})
    with generated.Client(live_address, timeout=60.0) as made:
        problem = part("api.poses.solve_ik").sync(client=made, body=far)
        names = part("api.robots_and_solvers.list_robots").sync(client=made)
    assert isinstance(problem, part("models").UnreachableProblem)
    assert problem.position_error > 1.0
    assert "iiwa14" in [robot.name for robot in names.robots]
