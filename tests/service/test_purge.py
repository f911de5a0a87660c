"""The SQLite file at its bounds: what is deleted, in which steps, and what the file gives back."""

from __future__ import annotations

import asyncio
import os
import time
from pathlib import Path

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from ikplan_api.store.sqlite_plans import SqlitePlanStore

from .serving import WAIT_S
from .test_store import use


@settings(max_examples=50)
@given(
    st.lists(st.tuples(st.sampled_from("abcdef"), st.integers(0, 12)), max_size=30),
    st.integers(0, 4),
    st.integers(0, 20),
)
def test_what_is_kept_is_what_was_used_last(
    puts: list[tuple[str, int]], max_plans: int, max_bytes: int
) -> None:
    """Against the model: a list in the order of use, cut where a bound is exceeded."""
    kept: list[tuple[str, int]] = []
    for name, size in puts:
        if size <= max_bytes and max_plans:
            kept = [(name, size), *(entry for entry in kept if entry[0] != name)]
            kept = [
                entry
                for i, entry in enumerate(kept)
                if i < max_plans and sum(s for _, s in kept[: i + 1]) <= max_bytes
            ]

    async def fill(store: SqlitePlanStore) -> list[tuple[str, int]]:
        for name, size in puts:
            await store.put(name, b"x" * size)
        rows = await store.rows("SELECT id, bytes FROM plans ORDER BY used DESC, id DESC", ())
        assert store._purge.sizes == dict(rows)
        assert store._purge._bytes == sum(size for _, size in rows)
        return [(str(name), int(size)) for name, size in rows]

    assert use(fill, max_plans=max_plans, max_bytes=max_bytes) == kept


def test_a_smaller_bound_is_reached_in_slices_while_plans_are_put(tmp_path: Path) -> None:
    path = tmp_path / "store.sqlite3"
    plans, size = 600, 20_000

    async def fill(store: SqlitePlanStore) -> int:
        for i in range(plans):
            await store.put(f"p{i}", os.urandom(size))
        return len(store._purge.sizes)

    async def purge(store: SqlitePlanStore) -> int:
        steps = 0
        before = len(store._purge.sizes)
        for i in range(3):
            await store.put(f"q{i}", os.urandom(size))
        while len(store._purge.sizes) > 60:
            steps += 1
            await asyncio.sleep(0)
        assert steps > (before - 60) / 64  # no statement deleted more than a slice
        deadline = time.monotonic() + 60
        (page,) = await store.row("PRAGMA page_size", ())
        while (await store.row("PRAGMA freelist_count", ()))[0] * page > 1.2e6:
            assert time.monotonic() < deadline
            await asyncio.sleep(0.01)
        return len(store._purge.sizes)

    assert use(fill, path, max_plans=1000, max_bytes=10**9) == plans
    full = path.stat().st_size
    assert use(purge, path, max_plans=60, max_bytes=10**9) == 60
    assert path.stat().st_size < 0.4 * full


@pytest.mark.parametrize("steps", range(5))
def test_a_purge_that_is_called_in_the_moment_it_is_stopped_ends(steps: int) -> None:
    async def stop(store: SqlitePlanStore) -> None:
        await asyncio.sleep(0.02)  # it waits
        store._purge._needed.set()
        for _ in range(steps):
            await asyncio.sleep(0)
        async with asyncio.timeout(WAIT_S):
            await store._purge.stop()

    use(stop)


def test_plans_that_are_too_old_go_without_being_asked_for(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    now = time.time()

    async def wait(store: SqlitePlanStore) -> int:
        for i in range(100):
            await store.put(f"p{i}", b"1")
        monkeypatch.setattr(time, "time", lambda: now + 1000.0)
        store._purge._needed.set()
        while store._purge.sizes:
            await asyncio.sleep(0.01)
        return int((await store.row("SELECT count(*) FROM documents", ()))[0])

    assert use(wait, max_age_s=100.0) == 0
