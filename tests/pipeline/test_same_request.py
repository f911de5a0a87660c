"""The same request: the same id and the same plan, byte for byte."""

from __future__ import annotations

import copy
import os
import subprocess
import sys
import warnings
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from typing import Any

import numpy as np
import pytest

import ikplan
from ikplan import PlanRequest, load_robot
from ikplan.documents import Document
from ikplan.pipeline.identity import plan_id

from .paths import helix, helix_plan, lasting, on

SMALL = on("ur5", {"position": [0.3, 0.1, 0.4]}, {"position": [0.2, 0.3, 0.5]})


def test_planning_again_gives_the_same_bytes() -> None:
    first = lasting(helix_plan())
    ikplan.plan(SMALL)
    assert lasting(ikplan.plan(helix())) == first
    assert lasting(ikplan.plan(PlanRequest(**helix()))) == first


def test_another_process_gives_the_same_bytes() -> None:
    script = (
        "import ikplan, json, sys; request = json.load(sys.stdin); "
        "sys.stdout.write(ikplan.plan(request).model_dump_json(exclude={'stats'}))"
    )
    environment = {**os.environ, "PYTHONHASHSEED": "77", "NUMBA_NUM_THREADS": "1"}
    done = subprocess.run(
        [sys.executable, "-c", script],
        input=PlanRequest(**helix()).model_dump_json(),
        capture_output=True,
        text=True,
        env=environment,
        check=True,
    )
    assert done.stdout == lasting(helix_plan())


def test_threads_do_not_disturb_each_other() -> None:
    requests = [{**SMALL, "ik": {"seed": k % 3}} for k in range(12)]
    alone = [lasting(ikplan.plan(r)) for r in requests[:3]]
    with ThreadPoolExecutor(4) as pool:
        together = list(pool.map(lambda r: lasting(ikplan.plan(r)), requests))
    assert together == alone * 4


def test_the_request_is_left_as_it_was() -> None:
    document = helix()
    before = copy.deepcopy(document)
    ikplan.plan(document)
    assert document == before


def with_change(path: str, value: Any) -> dict[str, Any]:
    document = copy.deepcopy(SMALL)
    document.setdefault("start", [0.0, -1.5, 1.5, -1.5, -1.5, 0.0])
    at: Any = document
    *parents, last = path.split(".")
    for name in parents:
        at = at[int(name)] if name.isdigit() else at.setdefault(name, {})
    at[last] = value
    return document


CHANGES: dict[str, Any] = {
    "robot": "ur3",
    "start": [0.0, -1.5, 1.5, -1.5, -1.5, 1e-12],
    "tool.position": [0.0, 0.0, 1e-9],
    "tool.quaternion_xyzw": [1.0, 0.0, 0.0, 0.0],
    "path.frame.position": [0.0, 0.0, 1e-9],
    "path.waypoints.0.position": [0.3, 0.1, 0.4 + 1e-12],
    "path.waypoints.1.quaternion_xyzw": [0.0, 0.0, 0.0, 1.0],
    "path.tolerance.position": 2e-4,
    "path.tolerance.orientation": 2e-3,
    "ik.method": "lm",
    "ik.seed": 1,
    "ik.population": 13,
    "ik.iterations": "paper",
    "ik.params": {"alpha": 0.9},
    "ik.refine": False,
    "ik.elongation": "greedy",
    "limits.velocity_scale": 0.5,
    "limits.acceleration_scale": 0.999,
    "sampling.rate_hz": 100.0,
}


def identity(document: dict[str, Any]) -> str:
    request = PlanRequest(**document)
    return plan_id(request, load_robot(request.robot))


def test_the_id_changes_with_every_field_but_the_budget() -> None:
    plain = with_change("budget_s", 10.0)
    ids = {path: identity(with_change(path, value)) for path, value in CHANGES.items()}
    assert len({identity(plain), *ids.values()}) == len(CHANGES) + 1
    assert identity(with_change("budget_s", 3.0)) == identity(plain)
    assert identity(PlanRequest(**plain).model_dump()) == identity(plain)


def test_the_id_counts_every_field_there_is() -> None:
    """Every field of the request and of the documents in it, whatever is in it."""
    request = PlanRequest(**with_change("path.tolerance.position", 2e-4))
    plain = request.content_hash()

    def variants(document: Document) -> Iterator[tuple[str, Document]]:
        for name in type(document).model_fields:
            inner = getattr(document, name)
            if isinstance(inner, Document):
                for path, other in variants(inner):
                    yield f"{name}.{path}", document.model_copy(update={name: other})
            else:
                yield name, document.model_copy(update={name: "something else"})

    seen = {plain}
    for path, other in variants(request):
        assert isinstance(other, PlanRequest)
        with warnings.catch_warnings(action="ignore"):  # of pydantic, about what was put there
            changed = other.content_hash()
        assert (changed == plain) == (path == "budget_s"), path
        assert changed == plain or changed not in seen
        seen.add(changed)
    assert len(seen) > 20


def test_the_id_is_that_of_the_robot_too() -> None:
    robot = load_robot("ur5")
    plain = ikplan.plan(SMALL)
    assert plain.id == ikplan.plan(SMALL, robot=robot).id == identity(SMALL)
    slower = ikplan.plan(SMALL, robot=robot.with_limits(velocity=0.5 * robot.velocity_limit))
    assert slower.id != plain.id
    assert slower.duration > plain.duration
    assert len(plain.id) == 32
    assert set(plain.id) <= set("0123456789abcdef")


@pytest.mark.parametrize("spelling", ["arrays", "tuples", "model"])
def test_a_request_may_hold_what_python_has(spelling: str) -> None:
    start = [0.0, -1.5, 1.5, -1.5, -1.5, 0.0]
    plain = {**SMALL, "start": start}
    spelled: Any = {
        "arrays": {**plain, "start": np.array(start)},
        "tuples": {**plain, "start": tuple(start)},
        "model": PlanRequest(**plain),
    }[spelling]
    assert lasting(ikplan.plan(spelled)) == lasting(ikplan.plan(plain))
