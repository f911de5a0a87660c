"""The file of plans and jobs: what it keeps, what it forgets, what keeps it from either."""

import asyncio
import os
import subprocess
import sys
import time
from collections.abc import Awaitable, Callable
from pathlib import Path
from typing import Any

import pytest

from ikplan import InvalidRequest
from ikplan.cli import main
from ikplan_api.settings import Settings
from ikplan_api.store.lock_holder import lock_holder
from ikplan_api.store.plan_store import Job, StoreFault
from ikplan_api.store.recent_plans import RecentPlans
from ikplan_api.store.sqlite_plans import IN_MEMORY, SqlitePlanStore
from tests.present import present

JOB = Job("j", "plan", b"{}", None, 10.0)


def use(
    scenario: Callable[[SqlitePlanStore], Awaitable[Any]], path: object = IN_MEMORY, **limits: Any
) -> Any:
    bounds: dict[str, Any] = {"max_plans": 100, "max_bytes": 10**6, "max_age_s": 3600.0, **limits}

    async def run() -> Any:
        store = SqlitePlanStore(str(path), **bounds)
        await store.open()
        try:
            return await scenario(store)
        finally:
            await store.close()

    return asyncio.run(run())


def test_the_store_forgets_what_was_unused_for_longest() -> None:
    async def fill(store: SqlitePlanStore) -> list[bytes | None]:
        await store.put("a", b"1")
        await store.put("b", b"2")
        await store.get("a")
        await store.put("c", b"3")
        return [await store.get(key) for key in "abc"]

    assert use(fill, max_plans=2) == [b"1", None, b"3"]


def test_the_store_is_bounded_in_bytes() -> None:
    async def fill(store: SqlitePlanStore) -> list[bytes | None]:
        await store.put("a", b"1" * 6)
        await store.put("a", b"2" * 7)
        await store.put("b", b"3" * 3)
        first = [await store.get("a"), await store.get("b")]
        await store.put("c", b"4")
        await store.put("too long", b"5" * 11)
        return [*first, await store.get("a"), await store.get("too long")]

    assert use(fill, max_bytes=10) == [b"2" * 7, b"3" * 3, None, None]


def test_the_store_is_bounded_in_age(monkeypatch: pytest.MonkeyPatch) -> None:
    now = time.time()

    async def wait(store: SqlitePlanStore) -> list[object]:
        await store.put("a", b"1")
        await store.accept(JOB)
        await store.fail("j", b"{}")
        monkeypatch.setattr(time, "time", lambda: now + 101.0)
        gone = await store.get("a")
        await store.accept(JOB._replace(plan_id="k"))
        await store.fail("k", b"{}")
        return [gone, await store.problem("j"), await store.problem("k")]

    assert use(wait, max_age_s=100.0) == [None, None, b"{}"]


def test_what_was_kept_is_there_when_the_file_is_opened_again(tmp_path: Path) -> None:
    path = tmp_path / "new" / "folder" / "store.sqlite3"
    jobs = [JOB._replace(plan_id=name, robot=name.encode()) for name in ("z", "a", "m")]

    async def fill(store: SqlitePlanStore) -> None:
        await store.put("p", b"plan")
        for job in jobs:
            await store.accept(job)
        await store.fail("a", b"why")

    async def read(store: SqlitePlanStore) -> list[object]:
        return [await store.get("p"), await store.pending(), await store.problem("a")]

    use(fill, path)
    assert use(read, path) == [b"plan", [jobs[0], jobs[2]], b"why"]


def test_a_plan_that_is_kept_ends_its_job_and_a_deleted_one_is_gone() -> None:
    async def end(store: SqlitePlanStore) -> list[object]:
        await store.accept(JOB)
        await store.put("j", b"plan")
        left = await store.pending()
        return [left, await store.delete("j"), await store.delete("j"), await store.get("j")]

    assert use(end) == [[], True, False, None]


def test_a_job_accepted_again_after_it_failed_is_pending_again() -> None:
    async def again(store: SqlitePlanStore) -> list[object]:
        await store.accept(JOB)
        await store.fail("j", b"why")
        await store.accept(JOB)
        return [await store.problem("j"), await store.pending()]

    assert use(again) == [None, [JOB]]


def test_two_services_never_share_a_file(tmp_path: Path) -> None:
    path = tmp_path / "store.sqlite3"

    async def second(_: SqlitePlanStore) -> None:
        other = SqlitePlanStore(str(path), 1, 1, 1.0)
        with pytest.raises(InvalidRequest, match="another service uses it") as caught:
            await other.open()
        assert caught.value.field == "IKPLAN_STORE_PATH"

    use(second, path)


def test_the_process_that_has_the_file_is_named(tmp_path: Path) -> None:
    path, locks = tmp_path / "store.sqlite3", tmp_path / "locks"
    path.touch()
    file = path.stat()
    device = f"{os.major(file.st_dev):02x}:{os.minor(file.st_dev):02x}"
    others = f"1: FLOCK  ADVISORY  WRITE 12 {device}:{file.st_ino + 1} 0 EOF\n2: -> POSIX\n"
    held = f"3: POSIX  ADVISORY  WRITE {{}} {device}:{file.st_ino} 1073741824 1073741824\n"
    for text, holder in (
        (others + held.format(4711), 4711),
        (others + held.format(0), None),  # of another container
        (others, None),
    ):
        locks.write_text(text)
        assert lock_holder(str(path), locks) == holder
    assert lock_holder(str(path), tmp_path / "none") is None
    assert lock_holder(str(tmp_path / "gone"), locks) is None


@pytest.mark.skipif(not Path("/proc/locks").exists(), reason="nothing tells locks here")
def test_a_second_service_on_the_same_file_says_whose_it_is(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = str(tmp_path / "store.sqlite3")
    hold = (
        "import sqlite3, sys; c = sqlite3.connect(sys.argv[1], isolation_level=None); "
        "c.execute('PRAGMA locking_mode = EXCLUSIVE'); c.execute('BEGIN IMMEDIATE'); "
        "c.execute('CREATE TABLE t (x)'); print('held', flush=True); sys.stdin.read()"
    )
    pipes: dict[str, Any] = {"stdin": subprocess.PIPE, "stdout": subprocess.PIPE, "text": True}
    with subprocess.Popen([sys.executable, "-c", hold, path], **pipes) as process:
        assert process.stdout is not None
        assert process.stdout.readline() == "held\n"
        with pytest.MonkeyPatch.context() as patch:
            for name, value in (("STORE_PATH", path), ("HOST", "127.0.0.1"), ("PORT", "0")):
                patch.setenv(f"IKPLAN_{name}", value)
            assert main(["serve", "--port", "0"]) == 2
        process.communicate()
    (line,) = capsys.readouterr().err.splitlines()
    assert line.startswith("ikplan: invalid-request: IKPLAN_STORE_PATH: ")
    assert f"{path}: another service uses it (process {process.pid}); name another file" in line


@pytest.mark.parametrize("path", ["/proc/nowhere/store", "/dev/null/store", "/"])
def test_a_place_that_cannot_be_used_is_named_with_its_setting(path: str) -> None:
    async def never(_: SqlitePlanStore) -> None:
        raise AssertionError

    with pytest.raises(InvalidRequest, match=f"IKPLAN_STORE_PATH.*{path}"):
        use(never, path)


def test_a_file_that_is_none_of_ours_is_left_alone(tmp_path: Path) -> None:
    path = tmp_path / "thesis.txt"
    path.write_text("to be or not to be " * 100)

    async def never(_: SqlitePlanStore) -> None:
        raise AssertionError

    with pytest.raises(InvalidRequest, match="IKPLAN_STORE_PATH"):
        use(never, path)
    assert path.read_text().startswith("to be")


def test_a_full_disk_loses_nothing_that_was_kept(tmp_path: Path) -> None:
    async def fill(store: SqlitePlanStore) -> None:
        await store.accept(JOB)
        await store.put("a", b"1")
        connection = store._connection
        assert connection is not None
        async with connection.execute("PRAGMA page_count") as cursor:
            (pages,) = present(await cursor.fetchone())
        await connection.execute(f"PRAGMA max_page_count = {pages + 2}")
        for name in ("b", "c"):
            with pytest.raises(StoreFault, match="full"):
                await store.put(name, bytes(100_000))
        with pytest.raises(StoreFault, match="full"):
            await store.accept(JOB._replace(plan_id="k", document=bytes(100_000)))
        assert await store.get("a") == b"1"
        assert await store.pending() == [JOB]
        await connection.execute(f"PRAGMA max_page_count = {pages + 1000}")
        await store.put("b", bytes(100_000))

    use(fill, tmp_path / "store.sqlite3")


def test_plans_that_were_not_saved_are_bounded() -> None:
    recent = RecentPlans(max_plans=2, max_bytes=10)
    for name, document in (("a", b"1"), ("b", b"2"), ("c", b"3" * 8), ("d", b"4" * 11)):
        recent.put(name, document)
    assert [recent.get(name) for name in "abcd"] == [None, b"2", b"3" * 8, None]
    recent.put("b", b"5" * 11)
    assert recent.get("b") is None
    assert (recent.delete("c"), recent.delete("c")) == (True, False)


def test_plans_are_kept_in_the_users_data_folder_unless_told_otherwise(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.delenv("IKPLAN_STORE_PATH")
    monkeypatch.setenv("XDG_DATA_HOME", "/data")
    assert Settings().store_path == "/data/ikplan/service.sqlite3"
    monkeypatch.delenv("XDG_DATA_HOME")
    monkeypatch.setenv("HOME", "/home/me")
    assert Settings().store_path == "/home/me/.local/share/ikplan/service.sqlite3"
