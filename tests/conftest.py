"""What holds for every test: where its service writes, and which process runs it."""

import os
from multiprocessing import forkserver
from typing import Any

import pytest
from hypothesis import settings

from tests.sockets import free_local_sockets

settings.register_profile("untimed", deadline=None)
settings.load_profile("untimed")
os.environ["IKPLAN_STORE_PATH"] = ":memory:"
PAGE = "tests/page/"
WARM = ("ikplan.workers.single_threaded", "ikplan_api.workers.preload", "service.fleet.light")


def pytest_configure() -> None:
    """Fork every worker of this process from one that has loaded what any test's workers need.

    A process has one such parent, and whoever is first says what it loads: workers of the service
    that come after those of a batch would load every kernel each for itself.
    """
    preload = forkserver.set_forkserver_preload

    def preload_all(names: list[str]) -> None:
        preload([*dict.fromkeys([*WARM, *names])])

    setattr(forkserver, "set_forkserver_preload", preload_all)  # noqa: B010 a method, to mypy


def pytest_unconfigure() -> None:
    """Free what outlives the last test of a whole run."""
    free_local_sockets()


@pytest.hookimpl(optionalhook=True)
def pytest_xdist_make_scheduler(config: pytest.Config, log: Any) -> Any:
    """Give each file to one process, and the page to one: it has one browser, one service."""
    if config.getvalue("dist") != "loadfile":
        return None
    from xdist.scheduler import LoadFileScheduling

    class Scheduling(LoadFileScheduling):  # type: ignore[misc]
        def _split_scope(self, nodeid: str) -> str:
            return PAGE if nodeid.startswith(PAGE) else str(super()._split_scope(nodeid))

    return Scheduling(config, log)
