"""The service in this process: its event loop in a thread, its lifespan run, no network."""

from __future__ import annotations

import asyncio
import socket
import time
from collections.abc import Iterator

import httpx
import pytest
import uvicorn
from anyio.from_thread import BlockingPortal, start_blocking_portal
from fastapi import FastAPI
from starlette.types import ASGIApp, Receive, Scope, Send

from ikplan import Client
from ikplan_api.app import create_app
from ikplan_api.settings import Settings

ADDRESS = "http://localhost"


class PortalTransport(httpx.BaseTransport):
    """Carries a synchronous client's requests to an app that lives in another thread's loop."""

    def __init__(self, app: FastAPI, portal: BlockingPortal) -> None:
        self._inner = httpx.ASGITransport(app)
        self._portal = portal

    def handle_request(self, request: httpx.Request) -> httpx.Response:
        content = request.read()

        async def exchange() -> httpx.Response:
            outgoing = httpx.Request(
                request.method, request.url, headers=request.headers, content=content
            )
            answer = await self._inner.handle_async_request(outgoing)
            # As it came: the client is the one who decompresses.
            body = b"".join([piece async for piece in answer.aiter_raw()])
            return httpx.Response(answer.status_code, headers=answer.headers, content=body)

        return self._portal.call(exchange)


class OneLoop:
    """Lets nobody use the shared app in another event loop than its own: its locks have one."""

    def __init__(self, app: ASGIApp, loop: asyncio.AbstractEventLoop) -> None:
        self._app = app
        self._loop = loop

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        assert asyncio.get_running_loop() is self._loop, "ask the shared app by portal.call"
        await self._app(scope, receive, send)


@pytest.fixture(scope="session")
def portal() -> Iterator[BlockingPortal]:
    with start_blocking_portal() as running:
        yield running


@pytest.fixture(scope="session")
def app(portal: BlockingPortal) -> Iterator[FastAPI]:
    made = create_app(Settings(workers=2, max_queued=1000, max_body_bytes=2**22))
    made.add_middleware(OneLoop, loop=portal.call(asyncio.get_running_loop))
    with portal.wrap_async_context_manager(made.router.lifespan_context(made)):
        portal.call(made.state.planner.warm_up)  # tells why, if it cannot
        yield made


@pytest.fixture(scope="session")
def transport(app: FastAPI, portal: BlockingPortal) -> PortalTransport:
    return PortalTransport(app, portal)


@pytest.fixture(scope="session")
def http(transport: PortalTransport) -> Iterator[httpx.Client]:
    """Plain HTTP, for what the client hides."""
    with httpx.Client(base_url=ADDRESS, transport=transport) as plain:
        yield plain


@pytest.fixture(scope="session")
def client(transport: PortalTransport) -> Iterator[Client]:
    with Client(ADDRESS, transport=transport) as made:
        yield made


@pytest.fixture(scope="session")
def live_address(app: FastAPI, portal: BlockingPortal) -> Iterator[str]:
    """The same service on a socket, for programs that have no loop to share with it."""
    with socket.create_server(("127.0.0.1", 0)) as listening:
        config = uvicorn.Config(app, lifespan="off", log_level="critical", access_log=False)
        server = uvicorn.Server(config)
        serving = portal.start_task_soon(server.serve, [listening])
        while not server.started:
            time.sleep(0.01)
        yield f"http://127.0.0.1:{listening.getsockname()[1]}"
        server.should_exit = True
        serving.result(timeout=30)
