"""The store, the planner and the faults of the service, each by itself."""

import asyncio
import threading

import httpx
import pytest

from ikplan import AsyncClient, IkplanError, ServiceUnavailable
from ikplan_api import tasks
from ikplan_api.app import create_app
from ikplan_api.planner import ThreadPlanner
from ikplan_api.settings import Settings
from ikplan_api.store import MemoryStore
from ikplan_api.tasks import Answer

from .conftest import ADDRESS


def test_the_store_forgets_what_was_unused_for_longest():
    async def use() -> list[bytes | None]:
        store = MemoryStore(max_plans=2, max_bytes=1000)
        await store.put("a", b"1")
        await store.put("b", b"2")
        await store.get("a")
        await store.put("c", b"3")
        return [await store.get(key) for key in "abc"]

    assert asyncio.run(use()) == [b"1", None, b"3"]


def test_the_store_is_bounded_in_bytes():
    async def use() -> list[bytes | None]:
        store = MemoryStore(max_plans=100, max_bytes=10)
        await store.put("a", b"1" * 6)
        await store.put("a", b"2" * 7)
        await store.put("b", b"3" * 3)
        first = [await store.get("a"), await store.get("b")]
        await store.put("c", b"4")
        await store.put("too long", b"5" * 11)
        return [*first, await store.get("a"), await store.get("c"), await store.get("too long")]

    assert asyncio.run(use()) == [b"2" * 7, b"3" * 3, None, b"4", None]


def test_a_plan_that_is_put_again_but_too_long_is_not_kept_in_its_old_form():
    async def use() -> bytes | None:
        store = MemoryStore(max_plans=1, max_bytes=2)
        await store.put("a", b"1")
        await store.put("a", b"123")
        return await store.get("a")

    assert asyncio.run(use()) is None


@pytest.fixture
def gate(monkeypatch: pytest.MonkeyPatch):
    """Makes every task wait until the gate is opened."""
    opened = threading.Event()

    def wait(*_: object) -> Answer:
        assert opened.wait(30)
        return Answer(b"{}")

    monkeypatch.setitem(tasks.TASKS, "fk", wait)
    yield opened
    opened.set()


def test_beyond_the_queue_the_service_says_it_is_busy(gate):
    app = create_app(Settings(workers=1, max_queued=2))

    async def flood() -> tuple[list[httpx.Response], httpx.Response]:
        async with httpx.AsyncClient(transport=httpx.ASGITransport(app), base_url=ADDRESS) as http:
            waiting = [asyncio.create_task(http.post("/v1/fk", json={})) for _ in range(8)]
            done, _ = await asyncio.wait(waiting, return_when=asyncio.FIRST_COMPLETED, timeout=10)
            while len(done) < 5:
                done, _ = await asyncio.wait(waiting, timeout=0.01)
            alive = await http.get("/livez")
            gate.set()
            return await asyncio.gather(*waiting), alive

    answers, alive = asyncio.run(flood())
    asyncio.run(app.state.planner.close())
    assert alive.status_code == 200
    assert sorted(a.status_code for a in answers) == [200] * 3 + [503] * 5
    refused = next(a for a in answers if a.status_code == 503)
    assert refused.headers["retry-after"] == "1"
    assert refused.json()["type"] == "urn:ikplan:service-unavailable"


def test_the_client_learns_when_to_ask_a_busy_service_again(gate):
    app = create_app(Settings(workers=1, max_queued=0))

    async def ask() -> ServiceUnavailable:
        transport = httpx.ASGITransport(app)
        async with AsyncClient(ADDRESS, transport=transport) as client:
            first = asyncio.create_task(client.fk({}))
            while not app.state.planner._taken:
                await asyncio.sleep(0.001)
            with pytest.raises(ServiceUnavailable) as caught:
                await client.fk({})
            gate.set()
            with pytest.raises(ServiceUnavailable):  # {} is no FkResult
                await first
            return caught.value

    error = asyncio.run(ask())
    assert error.data == {"url": f"{ADDRESS}/v1/fk", "status_code": 503, "retry_after_s": 1.0}


def test_room_is_given_back_whatever_becomes_of_a_task(monkeypatch: pytest.MonkeyPatch):
    def fail(*_: object) -> Answer:
        raise IkplanError("no")

    monkeypatch.setitem(tasks.TASKS, "fk", fail)

    async def use() -> None:
        planner = ThreadPlanner(workers=1, max_queued=0)
        for _ in range(5):
            with pytest.raises(IkplanError):
                await planner.run("fk", b"")
            await asyncio.sleep(0.01)
        await planner.close()
        with pytest.raises(ServiceUnavailable, match="stopping"):
            await planner.run("fk", b"")
        assert planner._taken == 0

    asyncio.run(use())


def test_an_unforeseen_fault_is_a_problem_without_a_traceback(monkeypatch: pytest.MonkeyPatch):
    def crash(*_: object) -> Answer:
        raise ZeroDivisionError("secret")

    monkeypatch.setitem(tasks.TASKS, "fk", crash)
    app = create_app(Settings(workers=1))

    async def ask() -> httpx.Response:
        transport = httpx.ASGITransport(app, raise_app_exceptions=False)
        async with httpx.AsyncClient(transport=transport, base_url=ADDRESS) as http:
            return await http.post("/v1/fk", json={})

    answer = asyncio.run(ask())
    assert answer.status_code == 500
    assert answer.headers["content-type"] == "application/problem+json"
    assert answer.headers["x-request-id"] in answer.json()["instance"]
    assert "secret" not in answer.text


class Unready:
    """A planner whose warm-up fails."""

    ready = False

    async def run(self, kind: str, document: bytes, *, robot: bytes | None = None) -> Answer:
        raise NotImplementedError

    async def warm_up(self) -> None:
        raise RuntimeError("no compiler")

    async def close(self) -> None:
        return None


def test_a_service_that_cannot_warm_up_is_alive_but_not_ready_and_says_why(caplog):
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
