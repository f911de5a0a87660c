"""JSON as it arrives: every key once, objects of bounded size, short messages."""

from __future__ import annotations

import json
import time
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from ikplan.documents import load_json, parse_json
from ikplan.documents.plan_request import PlanRequest
from ikplan.errors import InvalidRequest

LEAVES = st.none() | st.booleans() | st.integers(-(10**17), 10**17) | st.text(max_size=5)
VALUES = st.recursive(
    LEAVES | st.sampled_from([":", '"', '\\":', "{:", '{"a":1}']),
    lambda inner: st.lists(inner, max_size=4) | st.dictionaries(st.text(max_size=4), inner),
    max_leaves=20,
)


def doubled(value: Any) -> str | None:
    """The value as JSON with the first key of its first object given twice, or None."""
    if isinstance(value, dict) and value:
        key = next(iter(value))
        return "{" + f"{json.dumps(key)}: [1], " + json.dumps(value)[1:]
    if isinstance(value, list):
        for i, item in enumerate(value):
            if (text := doubled(item)) is not None:
                parts = [json.dumps(v) for v in value]
                parts[i] = text
                return "[" + ", ".join(parts) + "]"
    return None


@given(VALUES, st.booleans())
def test_a_key_given_twice_is_refused_and_all_else_is_read(value: Any, raw: bool) -> None:
    text = json.dumps(value)
    assert load_json(text.encode() if raw else text) == value
    assert load_json(json.dumps(value, ensure_ascii=False)) == value
    wrong = doubled(value)
    if wrong is not None:
        with pytest.raises(InvalidRequest, match="given twice"):
            load_json(wrong.encode() if raw else wrong)


@pytest.mark.parametrize(
    "text",
    [
        '{"robot": "ur5", "path": {}, "robot": "iiwa14"}',
        '{"a": 12345678901234567890, "robot": 1, "robot": 2}',  # read by the slow parser
        '{"r\\u006fbot": "ur5", "robot": "iiwa14"}',
        '{"a": [{"b": {"c": ":", "c": ":"}}]}',
    ],
)
def test_a_duplicate_key_is_named(text: str) -> None:
    with pytest.raises(InvalidRequest) as told:
        load_json(text)
    assert told.value.field in ("robot", "c")


@pytest.mark.parametrize(
    "document",
    [
        {f"x{i}": 1 for i in range(300_000)},
        {"robot": "ur5", "path": {"waypoints": [{f"x{i}": 1 for i in range(300_000)}]}},
        {"x" * 7_000_000: 1},
        {"robot": "ur5", "path": {"x" * 7_000_000: 1}},
        {"robot": "ur5", "path": {"segments": [{"type": "x" * 7_000_000}]}},
        {"robot": "x" * 7_000_000, "path": {"waypoints": [{"position": [0.1, 0.2, 0.3]}]}},
    ],
)
def test_a_large_fault_is_told_briefly_and_fast(document: dict[str, Any]) -> None:
    body = json.dumps(document).encode()
    began = time.process_time()
    with pytest.raises(InvalidRequest) as told:
        parse_json(PlanRequest, body)
    assert time.process_time() - began < 1.0
    assert len(json.dumps(told.value.to_problem())) < 5000


def test_at_most_a_hundred_faults_are_described_and_all_are_counted() -> None:
    with pytest.raises(InvalidRequest, match=r"\(and 901 more\)") as told:
        parse_json(PlanRequest, json.dumps({f"x{i}": 1 for i in range(900)}).encode())
    assert len(told.value.errors) == 100


@pytest.mark.parametrize("digits", [17, 18, 19, 20, 40])
@pytest.mark.parametrize("digit", "179")
def test_whole_numbers_of_any_length_are_read_to_the_last_digit(digits: int, digit: str) -> None:
    number = int(digit * digits)
    text = f'{{"Grüße": [-{number}, {number}.5]}}'
    for written in (text, text.encode()):
        read, rounded = load_json(written)["Grüße"]
        assert read == -number
        assert rounded == float(f"{number}.5")
