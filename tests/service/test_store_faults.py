"""A store whose file is damaged, cut short, read-only or full, or whose nth operation fails."""

from __future__ import annotations

import asyncio
import os
import sqlite3
from collections.abc import Awaitable, Callable
from pathlib import Path
from typing import Any

import httpx
import numpy as np
import pytest

from ikplan import InvalidRequest
from ikplan.cli import main
from ikplan_api.app import create_app
from ikplan_api.settings import Settings, load_settings
from ikplan_api.store.document_store import StoredDocument
from ikplan_api.store.plan_store import Job, StoreFault
from ikplan_api.store.sqlite_documents import SqliteDocumentStore
from ikplan_api.store.sqlite_plans import SqlitePlanStore

from .conftest import ADDRESS
from .serving import WAIT_S
from .stand_in import StandIn
from .test_store import JOB, use


def fill(path: Path) -> None:
    async def write(store: SqlitePlanStore) -> None:
        await store.accept(JOB)
        for i in range(20):
            await store.put(f"p{i}", bytes(5000))

    use(write, path)


async def read(store: SqlitePlanStore) -> tuple[list[Job], list[bytes | None]]:
    return await store.pending(), [await store.get(f"p{i}") for i in range(20)]


@pytest.mark.parametrize("kept", [0.1, 0.3, 0.5, 0.7, 0.9])
def test_a_file_cut_short_is_told_in_one_line_and_set_aside_on_request(
    kept: float, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    path = tmp_path / "store.sqlite3"
    fill(path)
    length = int(path.stat().st_size * kept)
    os.truncate(path, length)
    monkeypatch.setenv("IKPLAN_STORE_PATH", str(path))
    assert main(["serve", "--port", "0"]) == 2
    lines = [line for line in capsys.readouterr().err.splitlines() if "ikplan: inv" in line]
    assert len(lines) == 1
    assert lines[0].startswith(f"ikplan: invalid-request: IKPLAN_STORE_PATH: {path} is damaged (")
    assert "IKPLAN_STORE_DAMAGED=set-aside" in lines[0]
    assert path.stat().st_size == length  # nothing is changed unasked
    assert use(read, path, replace_damaged=True) == ([], [None] * 20)
    (aside,) = tmp_path.glob("store.sqlite3.damaged-*")
    assert aside.stat().st_size == length


def test_a_store_that_cannot_be_read_is_a_503(tmp_path: Path) -> None:
    class Broken(SqlitePlanStore):
        async def problem(self, plan_id: str, owner: str = "") -> bytes | None:  # noqa: ARG002
            found: bytes | None = await self.row("SELECT problem FROM nowhere", (plan_id,))
            return found

    async def ask() -> httpx.Response:
        store = Broken(str(tmp_path / "store.sqlite3"), 10, 10**6, 3600.0)
        app = create_app(Settings(), planner=StandIn(), store=store)
        async with app.router.lifespan_context(app):
            transport = httpx.ASGITransport(app)
            async with httpx.AsyncClient(transport=transport, base_url=ADDRESS) as client:
                return await client.get("/v1/plans/x")

    answer = asyncio.run(ask())
    assert (answer.status_code, answer.headers["retry-after"]) == (503, "60")
    assert "nowhere" not in answer.text


@pytest.mark.parametrize("seed", range(12))
def test_damaged_pages_end_in_a_refusal_or_are_planned_again(seed: int, tmp_path: Path) -> None:
    path = tmp_path / "store.sqlite3"
    fill(path)
    content = bytearray(path.read_bytes())
    size = int.from_bytes(content[16:18])  # as the file itself says
    page = int(np.random.default_rng(seed).integers(1, len(content) // size))
    content[size * page : size * (page + 1)] = b"\xff" * size
    path.write_bytes(content)
    with pytest.raises(InvalidRequest, match="IKPLAN_STORE_PATH"):
        use(read, path)
    assert use(read, path, replace_damaged=True) == ([], [None] * 20)


def test_a_table_that_is_missing_is_told(tmp_path: Path) -> None:
    path = tmp_path / "store.sqlite3"
    fill(path)
    with sqlite3.connect(path) as file:
        file.execute("DROP TABLE robots")
    file.close()
    with pytest.raises(InvalidRequest, match="no such table: robots"):
        use(read, path)


def test_another_file_is_never_set_aside(tmp_path: Path) -> None:
    path = tmp_path / "thesis.txt"
    path.write_text("to be or not to be " * 100)
    with pytest.raises(InvalidRequest, match="IKPLAN_STORE_PATH"):
        use(read, path, replace_damaged=True)
    assert path.exists()


def test_a_store_that_became_read_only_refuses_jobs_and_still_reads(tmp_path: Path) -> None:
    async def write(store: SqlitePlanStore) -> None:
        await store.put("a", b"1")
        await store.change("PRAGMA query_only = ON", ())
        for refused in (store.accept(JOB), store.put("b", b"2"), store.fail("j", b"{}")):
            with pytest.raises(StoreFault, match="readonly"):
                await refused
        assert await store.get("a") == b"1"
        await store.change("PRAGMA query_only = OFF", ())
        await store.accept(JOB)

    use(write, tmp_path / "store.sqlite3")


class Failing:
    """A connection whose nth operation fails, as on a disk that is broken or full."""

    def __init__(self, inner: Any, nth: int) -> None:
        self._inner = inner
        self.left = nth

    def __getattr__(self, name: str) -> Any:
        made = getattr(self._inner, name)
        if name not in ("execute", "execute_fetchall"):
            return made

        def counted(statement: str, *arguments: Any) -> Any:
            if statement != "ROLLBACK":
                self.left -= 1
                if self.left == 0:
                    raise sqlite3.OperationalError("disk I/O error")
            return made(statement, *arguments)

        return counted


ROBOT = StoredDocument(b"{}", b'{"name": "urdf-1"}')


def operations(store: SqlitePlanStore) -> list[tuple[str, Callable[[], Awaitable[Any]]]]:
    robots = SqliteDocumentStore(store, "robots", 10, 10**6)
    other = JOB._replace(plan_id="k")
    return [
        ("accept j", lambda: store.accept(JOB)),
        ("accept k", lambda: store.accept(other)),
        ("put a", lambda: store.put("a", b"plan a")),
        ("put k", lambda: store.put("k", b"plan k")),
        ("fail j", lambda: store.fail("j", b"{}")),
        ("get a", lambda: store.get("a")),
        ("robot", lambda: robots.put("urdf-1", ROBOT)),
        ("delete a", lambda: store.delete("a")),
    ]


def state_after(done: list[str]) -> dict[str, Any]:
    """What the store must hold after the operations that did not fail."""
    pending = {name[-1] for name in done if name.startswith("accept")}
    failed = {"j"} & pending if "fail j" in done else set()
    if "put k" in done:
        pending -= {"k"}
    return {
        "pending": sorted(pending - failed),
        "a": b"plan a" if "put a" in done and "delete a" not in done else None,
        "k": b"plan k" if "put k" in done else None,
        "robots": ["urdf-1"] if "robot" in done else [],
    }


def test_whichever_operation_fails_nothing_accepted_is_lost(tmp_path: Path) -> None:
    async def look(store: SqlitePlanStore) -> dict[str, Any]:
        return {
            "pending": sorted(job.plan_id for job in await store.pending()),
            "a": await store.get("a"),
            "k": await store.get("k"),
            "robots": await SqliteDocumentStore(store, "robots", 10, 10**6).names(),
        }

    nth, failed_once = 0, True
    while failed_once:
        nth += 1
        path = tmp_path / f"{nth}.sqlite3"

        async def run(store: SqlitePlanStore, nth: int = nth) -> tuple[list[str], bool]:
            failing = Failing(store._connection, nth)
            store._connection = failing  # type: ignore[assignment]
            done = []
            for name, operation in operations(store):
                try:
                    await asyncio.wait_for(operation(), WAIT_S)
                    done.append(name)
                except StoreFault:
                    continue
            return done, failing.left <= 0

        done, failed_once = use(run, path, max_plans=1000, max_bytes=10**9)
        assert use(look, path) == state_after(done), nth
    assert nth > 15


def test_settings_that_cannot_work_are_refused_at_the_start(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setenv("IKPLAN_WORKER_MEMORY_BYTES", str(2**29))
    with pytest.raises(InvalidRequest, match="IKPLAN_WORKER_MEMORY_BYTES: a worker needs"):
        load_settings()
    monkeypatch.setenv("IKPLAN_WORKER_MEMORY_BYTES", "0")
    monkeypatch.setenv("IKPLAN_ROBOTS_PATH", str(tmp_path / "nowhere"))
    assert main(["serve", "--port", "0"]) == 2
    told = capsys.readouterr().err
    assert "ikplan: invalid-request: IKPLAN_ROBOTS_PATH names" in told
