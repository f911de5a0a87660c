"""A headless browser on the page of a service that runs, or a clear word why there is none."""

from __future__ import annotations

import contextlib
import os
import shutil
import threading
import time
from collections.abc import Iterator
from typing import NoReturn

import httpx
import pytest
import uvicorn
from playwright.sync_api import Browser, ConsoleMessage, Page, sync_playwright

from ikplan_api.app import create_app
from ikplan_api.routes.page import BUNDLE_HINT, bundle_folder
from ikplan_api.settings import Settings
from ikplan_api.telemetry.load import Load
from ikplan_api.workers.planner import Planner
from ikplan_api.workers.tasks import TaskResult

REQUIRED = "PAGE_TESTS"
"""Set to "required", what is missing fails the tests and does not skip them."""

_NAMES = ("chromium", "chromium-browser", "google-chrome")
_FLAGS = (
    "--no-sandbox",
    "--disable-quic",
    "--no-first-run",
    "--disable-background-networking",
    "--disable-component-update",
    "--disable-sync",
    "--use-gl=angle",
    "--use-angle=swiftshader",
    "--enable-unsafe-swiftshader",
)
_WAIT_S = 600.0
"""Where nothing is compiled yet, getting warm takes minutes."""


def missing(what: str) -> NoReturn:
    if os.environ.get(REQUIRED) == "required":
        pytest.fail(what)
    pytest.skip(what)


@contextlib.contextmanager
def served(settings: Settings, planner: Planner | None = None) -> Iterator[str]:
    """The address of a service on a free port of the loopback, warm unless it has a planner."""
    if not (bundle_folder() / "index.html").is_file():
        missing(f"there is no page; {BUNDLE_HINT} makes it")
    in_memory = settings.model_copy(update={"store_path": ":memory:"})
    app = create_app(in_memory, planner=planner)
    server = uvicorn.Server(uvicorn.Config(app, host="127.0.0.1", port=0, log_level="error"))
    thread = threading.Thread(target=server.run)
    thread.start()
    try:
        deadline = time.monotonic() + _WAIT_S
        while not server.started and time.monotonic() < deadline:
            time.sleep(0.02)
        (listener,) = server.servers[0].sockets
        address = f"http://127.0.0.1:{listener.getsockname()[1]}"
        ready = planner is not None
        with httpx.Client(base_url=address) as client:
            while not ready and time.monotonic() < deadline:
                time.sleep(0.05)
                ready = client.get("/readyz").status_code == 200
        assert ready, "the service did not get warm"
        yield address
    finally:
        server.should_exit = True
        thread.join(30)


class NoPlanner:
    """Does not plan: for pages on which nothing is planned."""

    ready = False
    load = Load(0, 0, 0)

    def check_capacity(self) -> None:
        pass

    async def run(self, kind: str, document: bytes, **_: object) -> TaskResult:
        raise AssertionError(f"{kind} was asked for: {document!r}")

    async def warm_up(self) -> None:
        pass

    async def close(self) -> None:
        pass


@contextlib.contextmanager
def chromium() -> Iterator[Browser]:
    """A browser of the machine."""
    path = next(filter(None, map(shutil.which, _NAMES)), None)
    if path is None:
        missing(f"there is none of {', '.join(_NAMES)} on this machine")
    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=path, args=list(_FLAGS))
        yield browser
        browser.close()


class Visit:
    """One visit of the page, in a profile of its own.

    Attributes:
        page: The page.
        faults: What the page's console told as errors, and exceptions nobody caught.
        foreign: Addresses outside the service that the page asked for.
    """

    def __init__(
        self, browser: Browser, address: str, *, width: int, height: int, dark: bool
    ) -> None:
        self._address = address
        self.faults: list[str] = []
        self.foreign: list[str] = []
        self._context = browser.new_context(
            viewport={"width": width, "height": height},
            color_scheme="dark" if dark else "light",
            accept_downloads=True,
        )
        self.page: Page = self._context.new_page()
        self.page.set_default_timeout(120_000)
        self.page.on("console", self._listen)
        self.page.on("pageerror", lambda error: self.faults.append(str(error)))
        self.page.on("request", self._note)

    def _listen(self, message: ConsoleMessage) -> None:
        # A refusal is an answer; that the browser logs its status is no fault of the page.
        if (
            message.type == "error"
            and "the server responded with a status of 4" not in message.text
        ):
            self.faults.append(message.text)

    def _note(self, request: object) -> None:
        url = str(getattr(request, "url", ""))
        if not url.startswith((f"{self._address}/", "data:", f"blob:{self._address}/")):
            self.foreign.append(url)

    def open(self, example: str = "", *, meshes: bool = False, fine: bool = False) -> Page:
        """Load the page with an example; without meshes, unless they are what is tested."""
        if not meshes:
            self.page.route("**/meshes/**", lambda route: route.fulfill(status=404, body=""))
        self.page.goto(f"{self._address}/{'?fine' if fine else ''}#{example}")
        self.page.wait_for_selector("#stage[data-meshes=ready]")
        return self.page

    def close(self) -> None:
        """End the visit; nothing went wrong in it unseen."""
        self._context.close()
        assert self.faults == []
        assert self.foreign == []
