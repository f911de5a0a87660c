"""Solvers that a test registers are gone after it."""

from __future__ import annotations

from collections.abc import Iterator

import pytest

from ikplan.ik import registry


@pytest.fixture(autouse=True)
def nothing_registered() -> Iterator[None]:
    before = dict(registry._registered)
    yield
    registry._registered.clear()
    registry._registered.update(before)
    registry._installed.cache_clear()
