"""What the tests of the page share: plain HTTP, a service, a browser.

They end with the last test of the page: while a browser runs, its event loop is that of the thread,
and no test beside it could run another.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator

import httpx
import pytest
from anyio.from_thread import start_blocking_portal
from playwright.sync_api import Browser, Page

from ikplan_api.app import create_app
from ikplan_api.settings import Settings
from ikplan_api.store.document_store import MemoryDocumentStore
from tests.service.conftest import ADDRESS, PortalTransport
from tests.sockets import free_local_sockets

from .browser import Visit, chromium, served


@pytest.fixture(scope="package", autouse=True)
def freed() -> Iterator[None]:
    """Set up first, and so the last to end: the service and the browser have ended then."""
    yield
    free_local_sockets()


@pytest.fixture(scope="package")
def http() -> Iterator[httpx.Client]:
    """Plain HTTP."""
    with start_blocking_portal() as portal:
        transport = PortalTransport(
            create_app(Settings(workers=1), robots=MemoryDocumentStore(4, 2**20)), portal
        )
        with httpx.Client(base_url=ADDRESS, transport=transport) as client:
            yield client


@pytest.fixture(scope="package")
def address() -> Iterator[str]:
    """The service that the tests of the page share."""
    with served(Settings(workers=1)) as running:
        yield running


@pytest.fixture(scope="package")
def browser() -> Iterator[Browser]:
    """The browser that they share."""
    with chromium() as running:
        yield running


@pytest.fixture(scope="module")
def visit(address: str, browser: Browser) -> Iterator[Callable[..., Page]]:
    """Opens the page with an example, in a window of its own."""
    visits: list[Visit] = []

    def start(
        name: str = "",
        *,
        width: int = 760,
        height: int = 560,
        dark: bool = False,
        meshes: bool = False,
    ) -> Page:
        visits.append(Visit(browser, address, width=width, height=height, dark=dark))
        return visits[-1].open(name, meshes=meshes)

    yield start
    for each in visits:
        each.close()
