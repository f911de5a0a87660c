"""The same request has the same id and the same trajectory, whichever way it is asked."""

import asyncio
import json
from pathlib import Path
from typing import Any

import httpx
import pytest
from anyio.from_thread import BlockingPortal
from fastapi import FastAPI

import ikplan
from ikplan import AsyncClient, Client, Plan, PlanRequest
from ikplan.cli import main
from ikplan.plans.export import encode

from .bad_requests import GOOD
from .conftest import ADDRESS

SPELLINGS = {
    "as given": GOOD,
    "keys the other way round": dict(reversed(GOOD.items())),
    "defaults written out": PlanRequest(**GOOD).model_dump(mode="json"),
    "another budget": {**GOOD, "budget_s": 20.0},
}


@pytest.fixture(scope="module")
def plan() -> Plan:
    return ikplan.plan(GOOD)


def lasting(document: bytes | str) -> dict[str, Any]:
    """A plan's document without ``stats``, whose seconds are those of the clock."""
    return {key: value for key, value in json.loads(document).items() if key != "stats"}


def trajectory(document: bytes) -> bytes:
    """The bytes of the trajectory in a plan's document."""
    start = document.index(b'"trajectory":')
    return document[start : document.index(b'"certificate":', start)]


@pytest.mark.parametrize("spelling", SPELLINGS)
def test_http_answers_the_bytes_that_python_makes(
    spelling: str, plan: Plan, http: httpx.Client
) -> None:
    answer = http.post("/v1/plans", json=SPELLINGS[spelling])
    assert answer.json()["id"] == plan.id
    assert trajectory(answer.content) == trajectory(plan.model_dump_json().encode())
    assert lasting(answer.content) == lasting(plan.model_dump_json())


def test_the_client_returns_the_plan_that_python_makes(plan: Plan, client: Client) -> None:
    for remote in (client.plan(GOOD), client.plan(PlanRequest(**GOOD)), client.get_plan(plan.id)):
        assert remote.id == plan.id
        assert lasting(remote.model_dump_json()) == lasting(plan.model_dump_json())
        assert encode(remote, "npz") == encode(plan, "npz")
        assert encode(remote, "csv") == encode(plan, "csv")


def test_the_twin_returns_what_the_client_returns(
    plan: Plan, app: FastAPI, client: Client, portal: BlockingPortal
) -> None:
    async def ask() -> tuple[Any, ...]:
        transport = httpx.ASGITransport(app)
        async with AsyncClient(ADDRESS, transport=transport) as twin:
            made = await twin.plan(GOOD)
            others = (
                await twin.fk({"robot": "ur5", "q": [0.1] * 6}),
                await twin.ik({"robot": "ur5", "position": [0.4, 0.1, 0.4]}),
            )
            lists = (await twin.robots(), await twin.robot("ur5"), await twin.solvers())
            return made, await twin.get_plan(made.id), others, lists, await twin.version()

    made, kept, others, lists, version = portal.call(ask)
    assert lasting(made.model_dump_json()) == lasting(plan.model_dump_json())
    assert kept.model_dump_json() == made.model_dump_json()
    expected = (
        client.fk({"robot": "ur5", "q": [0.1] * 6}),
        client.ik({"robot": "ur5", "position": [0.4, 0.1, 0.4]}),
    )
    assert [o.model_dump_json() for o in others] == [e.model_dump_json() for e in expected]
    assert lists == (client.robots(), client.robot("ur5"), client.solvers())
    assert version == client.version()


def test_the_command_writes_the_plan_that_python_makes(
    plan: Plan, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    request = tmp_path / "request.json"
    request.write_text(json.dumps(GOOD))
    outputs = [tmp_path / f"plan.{suffix}" for suffix in ("json", "csv", "npz")]
    options = [option for output in outputs for option in ("-o", str(output))]
    assert main(["plan", str(request), *options]) == 0
    assert plan.id in capsys.readouterr().out
    written = [output.read_bytes() for output in outputs]
    assert trajectory(written[0]) == trajectory(plan.model_dump_json().encode())
    assert lasting(written[0]) == lasting(plan.model_dump_json())
    assert written[1:] == [encode(plan, "csv"), encode(plan, "npz")]


def test_requests_at_the_same_time_do_not_disturb_each_other(
    plan: Plan, app: FastAPI, portal: BlockingPortal
) -> None:
    others = [{**GOOD, "ik": {"seed": seed}} for seed in range(4)]

    async def ask() -> list[Plan]:
        async with AsyncClient(ADDRESS, transport=httpx.ASGITransport(app)) as twin:
            return await asyncio.gather(*(twin.plan(r) for r in [GOOD, *others, GOOD]))

    answers = portal.call(ask)
    assert {a.id for a in answers if a.id == plan.id} == {plan.id}
    for answer, request in zip(answers, [GOOD, *others, GOOD], strict=True):
        assert encode(answer, "npz") == encode(ikplan.plan(request), "npz")
