"""What takes the interpreter long is done by workers: the service answers others meanwhile."""

from __future__ import annotations

import asyncio
import gc
import json
import time
from typing import Any

import httpx
import pytest
import uvicorn
from fastapi import FastAPI

from ikplan.cli.server import Server

from .urdfs import ARM

LINKS = "".join(
    f'<link name="x{i}"/><joint name="y{i}" type="fixed"><parent link="l0"/>'
    f'<child link="x{i}"/></joint>'
    for i in range(600)
)
LONG_URDF = ARM.replace("</robot>", f"{LINKS}</robot>")
POINTS = "x,y,z,rx,ry,rz\n" + "".join(f"0.4,{1e-5 * i},0.3,3.14,0,0\n" for i in range(9000))
BOX = {"type": "box", "size": [0.1, 0.1, 0.1]}
SCENE = {
    "obstacles": [
        {"name": f"b{i}", "shape": BOX, "position": [1.0, 0.2 * i, 0.0]} for i in range(1000)
    ]
}
MOST_S = 0.05
"""Longest time that the service itself may hold the interpreter [s]."""


@pytest.fixture
def kinds(app: FastAPI, monkeypatch: pytest.MonkeyPatch) -> list[str]:
    """The tasks that are given to workers."""
    given: list[str] = []
    run = app.state.planner.run

    async def recorded(kind: str, document: bytes, **how: Any) -> Any:
        given.append(kind)
        return await run(kind, document, **how)

    monkeypatch.setattr(app.state.planner, "run", recorded)
    return given


def spent(http: httpx.Client, method: str, path: str, **what: Any) -> tuple[httpx.Response, float]:
    """An answer, and the least processor time of this process for it in three tries [s]."""
    times = []
    for _ in range(3):
        began = time.process_time()
        answer = http.request(method, path, **what)
        times.append(time.process_time() - began)
    return answer, min(times)


@pytest.mark.parametrize(
    ("kind", "path", "content", "media_type"),
    [
        ("read-points", "/v1/points?robot=ur5", POINTS, "text/csv"),
        ("read-scene", "/v1/scenes", json.dumps(SCENE), "application/json"),
        ("check-upload", "/v1/robots", LONG_URDF, "application/xml"),
    ],
)
def test_a_long_document_is_read_by_a_worker(
    kind: str, path: str, content: str, media_type: str, http: httpx.Client, kinds: list[str]
) -> None:
    headers = {"content-type": media_type}
    answer, took_s = spent(http, "POST", path, content=content.encode(), headers=headers)
    assert answer.status_code in (200, 201), answer.text[:500]
    assert kinds == [kind] * 3
    assert took_s < MOST_S


def test_a_robot_of_the_catalogue_is_described_by_a_worker_and_only_once(
    app: FastAPI, http: httpx.Client, kinds: list[str]
) -> None:
    app.state.described.pop("baxter_left", None)
    answer, took_s = spent(http, "GET", "/v1/robots/baxter_left")
    assert answer.json()["collision"]
    assert kinds == ["describe-robot"]
    assert took_s < MOST_S


def test_what_is_loaded_at_the_start_is_never_searched_for_garbage() -> None:
    warming: asyncio.Future[None]

    async def run() -> tuple[int, int]:
        nonlocal warming
        warming = asyncio.get_running_loop().create_future()

        async def app(scope: Any, receive: Any, send: Any) -> None:
            scope["state"]["warming"] = warming
            for word in ("startup", "shutdown"):
                await receive()
                await send({"type": f"lifespan.{word}.complete"})

        config = uvicorn.Config(app, lifespan="on", log_level="critical", port=0)
        server = Server(config)
        config.load()
        server.lifespan = config.lifespan_class(config)
        await server.startup()
        frozen = gc.get_freeze_count()
        kept: list[list[int]] = [[] for _ in range(1000)]
        names = {id(one) for one in kept}
        warming.set_result(None)
        await asyncio.sleep(0)
        # The collector lists what it searches, which is all that is not frozen.
        searched = sum(id(one) in names for one in gc.get_objects())
        await server.shutdown()
        return frozen, searched

    before = gc.get_freeze_count()
    try:
        started, searched = asyncio.run(run())
    finally:
        gc.unfreeze()
    assert started > before + 10_000
    assert searched == 0
