"""A request is parsed and hashed once, wherever it is planned."""

from __future__ import annotations

import asyncio
import json
import pickle
from collections import Counter
from typing import Any

import httpx
import pytest

from ikplan.documents import parse_json
from ikplan.documents.plan_request import PlanRequest
from ikplan.documents.timing_request import TimingRequest
from ikplan.pipeline.identity import UNKNOWN, KnownRequest
from ikplan_api.app import create_app
from ikplan_api.settings import Settings
from ikplan_api.telemetry.load import Load
from ikplan_api.workers.tasks import SHORT, TaskInput, TaskResult, run_task

from .urdfs import chain

HOME = [0.0, -1.2, 1.5, -0.8, -1.2, 0.3]
PLAN = {"robot": "ur5", "start": HOME, "path": {"waypoints": [{"position": [0.49, 0.33, 0.25]}]}}
TIMING = {"robot": "ur5", "waypoints": [HOME, [0.1, *HOME[1:]]]}


class Here:
    """Runs tasks in this process, on what would travel to a worker."""

    ready = True
    load = Load(1, 0, 0)

    def check_capacity(self) -> None:
        pass

    async def run(
        self,
        kind: str,
        document: bytes,
        *,
        robot: bytes | None = None,
        known: KnownRequest = UNKNOWN,
        **_: object,
    ) -> TaskResult:
        travelled = pickle.loads(
            pickle.dumps(TaskInput(document if known.request is None else b"", robot, known))
        )
        return await asyncio.to_thread(run_task, kind, travelled)

    async def warm_up(self) -> None:
        pass

    async def close(self) -> None:
        pass


@pytest.fixture
def count(monkeypatch: pytest.MonkeyPatch) -> Counter[str]:
    """How often a request for a plan was parsed and hashed."""
    for kind, document in (("plan", PLAN), ("time", TIMING)):  # warms up, and counts for nothing
        run_task(kind, TaskInput(json.dumps(document).encode()))
    counted: Counter[str] = Counter()

    def parsing(model: Any, document: bytes) -> Any:
        counted["parsed"] += model in (PlanRequest, TimingRequest)
        return parse_json(model, document)

    monkeypatch.setattr("ikplan_api.workers.tasks.parse_json", parsing)
    for model in (PlanRequest, TimingRequest):
        content_hash = model.content_hash

        def hashing(self: Any, *context: str, _hash: Any = content_hash) -> str:
            counted["hashed"] += 1
            return str(_hash(self, *context))

        monkeypatch.setattr(model, "content_hash", hashing)
    return counted


def answers(path: str, *documents: dict[str, Any], upload: str | None = None) -> list[Any]:
    async def ask() -> list[Any]:
        app = create_app(Settings(store_path=":memory:"), planner=Here())
        transport = httpx.ASGITransport(app)
        async with (
            app.router.lifespan_context(app),
            httpx.AsyncClient(transport=transport, base_url="http://localhost") as client,
        ):
            name = None
            if upload is not None:
                made = await client.post("/v1/robots", json={"urdf": upload})
                name = made.raise_for_status().json()["name"]
            found = []
            for document in documents:
                sent = {**document, "robot": name or document["robot"]}
                answer = await client.post(path, json=sent)
                found.append(answer.raise_for_status().json())
            return found

    return asyncio.run(ask())


@pytest.mark.parametrize(("path", "document"), [("/v1/plans", PLAN), ("/v1/timings", TIMING)])
def test_a_short_request_is_parsed_and_hashed_once(
    path: str, document: dict[str, Any], count: Counter[str]
) -> None:
    (plan,) = answers(path, document)
    assert count == {"parsed": 1, "hashed": 1}
    assert len(plan["id"]) == 32


def test_a_request_for_an_uploaded_robot_is_parsed_and_hashed_once(count: Counter[str]) -> None:
    (plan,) = answers(
        "/v1/timings",
        {**TIMING, "waypoints": [[0.0, 0.0], [0.1, 0.2]], "limits": {"jerk": False}},
        upload=chain(2),
    )
    assert count == {"parsed": 1, "hashed": 1}
    assert plan["robot"].startswith("urdf-")


def test_a_long_request_is_parsed_by_workers_only_and_identified_once(count: Counter[str]) -> None:
    rows = [[0.001 * k, *HOME[1:]] for k in range(400)]
    long = {**TIMING, "waypoints": rows}
    assert len(json.dumps(long)) > SHORT
    answers("/v1/timings", long)
    assert count == {"parsed": 2, "hashed": 1}


def test_the_id_that_travels_is_the_one_that_a_plan_of_its_own_has(count: Counter[str]) -> None:
    (plan,) = answers("/v1/plans", PLAN)
    own = run_task("plan", TaskInput(json.dumps(PLAN).encode()))
    assert own.plan_id == plan["id"]
    assert count == {"parsed": 2, "hashed": 2}
