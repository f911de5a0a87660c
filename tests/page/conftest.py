"""The service in this process, without its planner: what is served here needs none."""

from __future__ import annotations

from collections.abc import Iterator

import httpx
import pytest
from anyio.from_thread import start_blocking_portal

from ikplan_api.app import create_app
from ikplan_api.settings import Settings
from ikplan_api.store.document_store import MemoryDocumentStore
from tests.service.conftest import ADDRESS, PortalTransport


@pytest.fixture(scope="session")
def http() -> Iterator[httpx.Client]:
    """Plain HTTP."""
    with start_blocking_portal() as portal:
        transport = PortalTransport(
            create_app(Settings(workers=1), robots=MemoryDocumentStore(4, 2**20)), portal
        )
        with httpx.Client(base_url=ADDRESS, transport=transport) as client:
            yield client
