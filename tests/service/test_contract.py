"""What the OpenAPI document says is what is answered: schemathesis, a few examples of each.

``python -m benchmarks.contract`` does the same with thousands.
"""

from __future__ import annotations

from typing import Any

import pytest
import schemathesis
from hypothesis import HealthCheck, Phase, given, settings
from hypothesis import strategies as st
from schemathesis.specs.openapi.checks import negative_data_rejection, positive_data_acceptance

from benchmarks.contract.hooks import EXCLUDED

from .test_openapi import OPERATIONS

CALM = settings(
    deadline=None,
    derandomize=True,
    database=None,
    max_examples=20,
    phases=[Phase.generate],
    suppress_health_check=list(HealthCheck),
)
STREAMED = {"watch_plan"}
"""Lasts as long as a plan takes; nothing is answered in one piece."""


@pytest.fixture(scope="module")
def schema(live_address: str) -> schemathesis.BaseSchema:
    return schemathesis.openapi.from_url(f"{live_address}/openapi.json")


EXCLUDED_CHECKS = [positive_data_acceptance]
ANY_TEXT = {"create_batch"}
"""Takes whatever it is sent, and says of each line what is wrong with it."""


def test_the_same_checks_are_left_out_as_in_the_long_run() -> None:
    assert tuple(check.__name__ for check in EXCLUDED_CHECKS) == EXCLUDED


@pytest.mark.parametrize("operation", sorted(OPERATIONS.keys() - STREAMED))
def test_every_answer_is_as_documented(operation: str, schema: schemathesis.BaseSchema) -> None:
    method, path = OPERATIONS[operation]
    excluded: list[Any] = [
        *EXCLUDED_CHECKS,
        *([negative_data_rejection] if operation in ANY_TEXT else []),
    ]

    @CALM
    @given(data=st.data())
    def ask(data: st.DataObject) -> None:
        case = data.draw(schema[path][method.upper()].as_strategy())
        case.call_and_validate(excluded_checks=excluded, timeout=60)

    ask()


def test_what_is_answered_can_be_followed(schema: schemathesis.BaseSchema) -> None:
    machine = schema.as_state_machine()

    class Following(machine):  # type: ignore[misc, valid-type]
        def validate_response(self, response: Any, case: Any, **_: Any) -> None:
            case.validate_response(response, excluded_checks=EXCLUDED_CHECKS)

    Following.run(settings=settings(CALM, max_examples=10, stateful_step_count=5))
