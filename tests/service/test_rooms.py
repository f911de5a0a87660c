"""The faults of the service."""

import asyncio

import httpx
import pytest

from ikplan_api.app import create_app
from ikplan_api.settings import Settings
from ikplan_api.telemetry.load import Load
from ikplan_api.workers.tasks import TaskResult

from .conftest import ADDRESS


class Crashing:
    """A planner with a fault of its own."""

    ready = True
    load = Load(1, 0, 0)

    def check_capacity(self) -> None:
        return None

    async def run(self, *_: object, **__: object) -> TaskResult:
        raise ZeroDivisionError("secret")

    async def warm_up(self) -> None:
        return None

    async def close(self) -> None:
        return None


def test_an_unforeseen_fault_is_a_problem_without_a_traceback() -> None:
    app = create_app(Settings(workers=1), planner=Crashing())

    async def ask() -> httpx.Response:
        transport = httpx.ASGITransport(app, raise_app_exceptions=False)
        async with httpx.AsyncClient(transport=transport, base_url=ADDRESS) as http:
            return await http.post("/v1/fk", json={"robot": "iiwa14", "q": [0.0] * 7})

    answer = asyncio.run(ask())
    assert answer.status_code == 500
    assert answer.headers["content-type"] == "application/problem+json"
    assert answer.headers["x-request-id"] in answer.json()["instance"]
    assert "secret" not in answer.text


class Unready(Crashing):
    """A planner whose warm-up fails."""

    ready = False

    async def warm_up(self) -> None:
        raise RuntimeError("no compiler")


def test_a_service_that_cannot_warm_up_is_alive_but_not_ready_and_says_why(
    caplog: pytest.LogCaptureFixture,
) -> None:
    app = create_app(Settings(), planner=Unready())

    async def ask() -> tuple[httpx.Response, httpx.Response]:
        transport = httpx.ASGITransport(app)
        async with (
            app.router.lifespan_context(app),
            httpx.AsyncClient(transport=transport, base_url=ADDRESS) as http,
        ):
            await asyncio.sleep(0.01)
            return await http.get("/livez"), await http.get("/readyz")

    alive, ready = asyncio.run(ask())
    assert alive.status_code == 200
    assert ready.status_code == 503
    assert ready.headers["retry-after"] == "1"
    assert "no compiler" in caplog.text
