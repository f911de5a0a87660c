"""A PostgreSQL for the tests of this folder."""

from __future__ import annotations

import os
from collections.abc import Iterator

import pytest

from benchmarks.fleet.postgres import WHY_NOT, Postgres, binaries, postgres


@pytest.fixture(scope="session")
def server() -> Iterator[Postgres]:
    if binaries() is None:
        if os.environ.get("POSTGRES_TESTS") == "required":
            pytest.fail(WHY_NOT)
        pytest.skip(WHY_NOT)
    with postgres() as running:
        yield running


@pytest.fixture
def database(server: Postgres) -> str:
    """An empty database."""
    return server.new_database()
