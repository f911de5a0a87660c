"""The SQLite file at its bounds: the worst put, the purge, and the length of the file."""

from __future__ import annotations

import asyncio
import os
import statistics
import tempfile
import time
from pathlib import Path
from typing import Any

from ikplan_api.store.sqlite_plans import SqlitePlanStore

__all__ = ["sqlite_puts"]


def sqlite_puts(plans: int, size: int, further: int) -> dict[str, Any]:
    """Fill a file to its bound, put more plans, then open it with half of the bound.

    Args:
        plans: Bound of the number of plans.
        size: Size of a plan [bytes].
        further: Plans put beyond the bound, each timed.
    """
    with tempfile.TemporaryDirectory() as folder:
        return asyncio.run(_run(Path(folder) / "store.sqlite3", plans, size, further))


async def _run(path: Path, plans: int, size: int, further: int) -> dict[str, Any]:
    store = SqlitePlanStore(str(path), plans, 10**12, 1e9)
    await store.open()
    for i in range(plans):
        await store.put(f"{i:032x}", os.urandom(size), robot="ur5")
    wall, processor = [], []
    for i in range(plans, plans + further):
        document = os.urandom(size)
        began, busy = time.perf_counter(), time.process_time()
        await store.put(f"{i:032x}", document, robot="ur5")
        wall.append(time.perf_counter() - began)
        processor.append(time.process_time() - busy)
    count = await store.row("SELECT count(*) FROM plans", ())
    full = os.path.getsize(path)
    await store.close()
    store = SqlitePlanStore(str(path), plans // 2, 10**12, 1e9)
    began, busy = time.perf_counter(), time.process_time()
    await store.open()
    opened_s = time.process_time() - busy
    during: list[float] = []
    while len(store._purge.sizes) > plans // 2 or not await _small(store):
        document = os.urandom(size)
        put = time.process_time()
        await store.put(f"p{len(during):031x}", document, robot="ur5")
        during.append(time.process_time() - put)
        await asyncio.sleep(0.01)
    purged_s, purge_busy_s = time.perf_counter() - began, time.process_time() - busy
    await store.close()
    return {
        "plans": plans,
        "put, processor time: median / worst [ms]": _both(processor),
        "put, wall: median / worst [ms]": _both(wall),
        "plans kept": count[0],
        "open, processor time [s]": round(opened_s, 2),
        "purge of half: wall / processor [s]": (round(purged_s, 1), round(purge_busy_s, 1)),
        "put during the purge, processor time: median / worst [ms]": _both(during),
        "file before / after [MB]": (full >> 20, os.path.getsize(path) >> 20),
    }


async def _small(store: SqlitePlanStore) -> bool:
    (free,) = await store.row("PRAGMA freelist_count", ())
    (pages,) = await store.row("PRAGMA page_count", ())
    return bool(free <= max(256, pages / 8 + 64))


def _both(seconds: list[float]) -> tuple[float, float]:
    return round(1e3 * statistics.median(seconds), 2), round(1e3 * max(seconds), 2)
