"""The clients and their jobs are twins: the synchronous code is the other's without waiting."""

from __future__ import annotations

import ast
import inspect
import re

from ikplan.client import asynchronous, synchronous
from ikplan.client.jobs import AsyncPlanJob, PlanJob

WORDS = (
    # Each class names the other as its twin.
    (r"(its twin is :class:`~ikplan\.)Client`", r"\1Twin`"),
    (r"; its twin is PlanJob\.", "."),
    (r"\bThe asynchronous\b", "The synchronous"),
    (r"\bimport asyncio\b", "import time"),
    (r"\bAsyncIterator, Iterable, Mapping", "Iterable, Iterator, Mapping"),
    (r"\basyncio\.sleep\b", "time.sleep"),
    (r"\basync (def|with|for)\b", r"\1"),
    (r"\bawait ", ""),
    (r"\bAsync(Client|Connection|PlanJob|Iterator|BaseTransport)\b", r"\1"),
    (r"\b__a(enter|exit)__", r"__\1__"),
    (r"\ba(close|read|iter_\w+)\(", r"\1("),
    (r"for (\w+) in (page\.\w+):\n\s+yield \1\n", r"yield from \2\n"),
    (r"~ikplan\.Twin`", "~ikplan.AsyncClient`"),
)


def parsed(source: str) -> str:
    """What the code and its docstrings are, however its lines are broken."""
    return ast.dump(ast.parse(source))


def without_waiting(source: str) -> str:
    assert "await" in source
    for pattern, word in WORDS:
        source = re.sub(pattern, word, source)
    return parsed(source)


def test_the_synchronous_client_is_the_asynchronous_one_without_waiting() -> None:
    twin = without_waiting(inspect.getsource(asynchronous))
    assert twin == parsed(inspect.getsource(synchronous))


def test_its_jobs_are_those_of_the_other_without_waiting() -> None:
    assert without_waiting(inspect.getsource(AsyncPlanJob)) == parsed(inspect.getsource(PlanJob))
