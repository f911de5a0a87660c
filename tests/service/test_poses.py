"""Single poses: how long they may take, and how long their documents may be."""

import asyncio
import time
from typing import Any

import httpx
import pytest

from ikplan import BudgetExceeded, Client, InvalidRequest
from ikplan_api.app import create_app
from ikplan_api.settings import Settings
from ikplan_api.workers.tasks import TaskResult

from .conftest import ADDRESS
from .serving import bound_s
from .stand_in import StandIn

IK = {"robot": "ur5", "position": [0.4, 0.1, 0.4]}
FK = {"robot": "ur5", "q": [0.0] * 6}


def test_a_search_that_takes_longer_than_its_budget_is_stopped(client: Client) -> None:
    slow = {**IK, "ik": {"population": 10_000, "iterations": 1000}, "budget_s": 0.3}
    begin = time.monotonic()
    with pytest.raises(BudgetExceeded) as caught:
        client.ik(slow)
    assert time.monotonic() - begin < bound_s(5.0)
    assert (caught.value.stage, caught.value.budget_s, caught.value.status) == ("ik", 0.3, 422)
    assert client.ik(IK).position_error < 1e-6


@pytest.mark.parametrize(
    ("path", "document", "limit_s"),
    [
        ("/v1/ik", IK, 10.0),
        ("/v1/ik", {**IK, "budget_s": 2}, 2.0),
        ("/v1/ik", {**IK, "budget_s": 3000}, 20.0),
        ("/v1/fk", FK, 10.0),
    ],
)
def test_a_worker_is_given_no_more_time_than_the_budget_and_the_operator_allow(
    path: str, document: dict[str, Any], limit_s: float
) -> None:
    given: list[float] = []

    class Fast(StandIn):
        async def run(self, *_: object, **how: Any) -> TaskResult:
            given.append(how["limit_s"])
            return TaskResult(b"{}")

    async def ask() -> int:
        app = create_app(Settings(store_path=":memory:", max_budget_s=20), planner=Fast())
        transport = httpx.ASGITransport(app)
        async with httpx.AsyncClient(transport=transport, base_url=ADDRESS) as plain:
            return (await plain.post(path, json=document)).status_code

    assert asyncio.run(ask()) == 200
    assert given == [limit_s]


@pytest.mark.parametrize(("path", "document"), [("/v1/ik", IK), ("/v1/fk", FK)])
def test_a_pose_is_no_long_document(
    http: httpx.Client, path: str, document: dict[str, Any]
) -> None:
    answer = http.post(path, json={**document, "robot": "x" * 70_000})
    assert answer.status_code == 413
    assert answer.json()["type"] == "urn:ikplan:invalid-request"


def test_many_poses_are_answered_each_as_it_is_alone(client: Client) -> None:
    poses = [{"position": [0.4, 0.01 * k, 0.4]} for k in range(2000)]
    poses[7] = {"position": [9.0, 0.0, 0.0]}
    asked = {"robot": "ur5", "poses": poses, "verdict": False}
    many = client.ik_batch(asked)
    assert many.solved.dtype == bool
    assert [k for k in range(50) if not many.solved[k]] == [7]
    for k in (0, 49):
        one = client.ik({"robot": "ur5", **poses[k], "ik": {"method": "lm"}})
        assert one.q.tolist() == many.q[k].tolist()
    explained = client.ik_batch({**asked, "poses": poses[6:9], "verdict": True})
    assert [refused.pose for refused in explained.refused] == [1]
    with pytest.raises(InvalidRequest) as caught:
        client.ik_batch({**asked, "poses": [{"position": [0.4, 0.1]}]})
    assert caught.value.field == "poses[0].position"
    mixed = [poses[0], {**poses[1], "quaternion_xyzw": [0.0, 1.0, 0.0, 0.0]}]
    with pytest.raises(InvalidRequest, match="all poses have an orientation, or none"):
        client.ik_batch({**asked, "poses": mixed})
    slow = {"method": "lm", "params": {"restarts": 100_000}}
    far = [{"position": [1.2, 0.0, 0.001 * k]} for k in range(100)]  # the solver has to try
    with pytest.raises(BudgetExceeded):
        client.ik_batch({"robot": "ur5", "poses": far, "ik": slow, "verdict": False, "budget_s": 1})


@pytest.mark.parametrize("budget_s", [0, -1, 3601, "1"])
def test_a_budget_that_is_none_is_refused_by_name(client: Client, budget_s: Any) -> None:
    with pytest.raises(InvalidRequest) as caught:
        client.ik({**IK, "budget_s": budget_s})
    assert caught.value.field == "budget_s"
