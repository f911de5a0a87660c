"""What the clients do by themselves, whatever answers."""

import asyncio
import json
import subprocess
import sys
from collections.abc import Callable
from typing import Any

import httpx
import numpy as np
import pytest

import ikplan
from ikplan import AsyncClient, Client, InvalidRequest, PlanRequest, ServiceUnavailable, Unreachable

ADDRESS = "http://cell-7.example:8000"
REQUEST: dict[str, Any] = {
    "robot": "iiwa14",
    "path": {"waypoints": [{"position": [0.6, 0.0, 0.4]}]},
}


def answering(response: httpx.Response) -> Client:
    return Client(ADDRESS, transport=httpx.MockTransport(lambda _: response), retries=0)


def sent(request: Any, method: str = "plan") -> dict[str, Any]:
    """The document that a client sends for a request."""
    bodies: list[dict[str, Any]] = []

    def answer(request: httpx.Request) -> httpx.Response:
        bodies.append(json.loads(request.content))
        return httpx.Response(200, content=b"{}")

    with (
        Client(ADDRESS, transport=httpx.MockTransport(answer)) as client,
        pytest.raises(ServiceUnavailable),
    ):
        getattr(client, method)(request)
    return bodies[0]


def test_a_request_goes_out_as_it_was_given() -> None:
    odd = {**REQUEST, "nonsense": [1, "x", None, {"y": True}]}
    assert sent(odd) == odd


def test_arrays_and_numpy_scalars_go_out_as_numbers() -> None:
    document = {
        "robot": "iiwa14",
        "start": np.linspace(0, 0.3, 7),
        "path": {"waypoints": [{"position": np.array([1, 2, 3])}, {"position": (0.1, 0.2, 0.3)}]},
        "ik": {"seed": np.int64(3)},
        "budget_s": np.float32(0.5),
    }
    assert sent(document) == {
        "robot": "iiwa14",
        "start": np.linspace(0, 0.3, 7).tolist(),
        "path": {"waypoints": [{"position": [1, 2, 3]}, {"position": [0.1, 0.2, 0.3]}]},
        "ik": {"seed": 3},
        "budget_s": 0.5,
    }


def test_a_model_goes_out_without_the_defaults_it_did_not_set() -> None:
    assert sent(PlanRequest(**REQUEST)) == REQUEST


@pytest.mark.parametrize(
    ("change", "field"),
    [
        ({"start": [0.0, float("nan")]}, "start[1]"),
        ({"start": np.array([[0.0, 1.0], [2.0, np.inf]])}, "start[1][1]"),
        ({"budget_s": np.float32("nan")}, "budget_s"),
        ({"path": {"waypoints": [{"position": (0.0, -float("inf"), 0.0)}]}},
         "path.waypoints[0].position[1]"),
    ],
)  # fmt: skip
def test_nan_is_refused_before_it_is_sent_and_its_field_named(
    change: dict[str, Any], field: str
) -> None:
    def answer(_: httpx.Request) -> httpx.Response:
        raise AssertionError("nothing may be sent")

    client = Client(ADDRESS, transport=httpx.MockTransport(answer))
    with pytest.raises(InvalidRequest, match="NaN and infinities") as caught:
        client.plan({**REQUEST, **change})
    assert caught.value.field == field


@pytest.mark.parametrize("request_", [None, [1], "text", {"robot": object()}, {"robot": {1, 2}}])
def test_what_json_cannot_hold_is_an_invalid_request(request_: Any) -> None:
    with pytest.raises(InvalidRequest):
        answering(httpx.Response(200)).plan(request_)


def test_a_circular_request_is_an_invalid_request() -> None:
    circular: dict[str, Any] = {}
    circular["again"] = circular
    with pytest.raises(InvalidRequest, match="JSON"):
        answering(httpx.Response(200)).plan(circular)


@pytest.mark.parametrize(
    "response",
    [
        pytest.param(httpx.Response(502, text="<html>bad gateway"), id="a proxy's page"),
        pytest.param(httpx.Response(404, json={"detail": "Not Found"}), id="another service"),
        pytest.param(httpx.Response(302, headers={"location": "/login"}), id="a redirect"),
        pytest.param(httpx.Response(200, text="hello"), id="no JSON"),
        pytest.param(httpx.Response(200, json=[1, 2]), id="no object"),
        pytest.param(httpx.Response(200, json={"id": "x"}), id="no plan"),
        pytest.param(
            httpx.Response(
                422, content=b"{", headers={"content-type": "application/problem+json"}
            ),
            id="half a problem",
        ),
        pytest.param(
            httpx.Response(
                422, content=b"[]", headers={"content-type": "application/problem+json"}
            ),
            id="no problem",
        ),
        pytest.param(
            httpx.Response(
                422,
                content=json.dumps(
                    {"type": "urn:ikplan:unreachable", "detail": "?", "waypoint": 0,
                     "position_error": 1, "orientation_error": 1, "q": "x", "reason": 1,
                     "limits": 3, "waypoints": 4, "repairs": 5}
                ),
                headers={"content-type": "application/problem+json"},
            ),
            id="a problem with the wrong data",
        ),
    ],
)  # fmt: skip
@pytest.mark.parametrize("method", ["plan", "ik", "fk"])
def test_an_answer_of_something_else_is_told_with_its_address_and_status(
    response: httpx.Response, method: str
) -> None:
    with pytest.raises(ServiceUnavailable) as caught:
        getattr(answering(response), method)(REQUEST)
    assert caught.value.status_code == response.status_code
    assert caught.value.url.startswith(ADDRESS + "/v1/")
    assert caught.value.url in caught.value.detail


def test_a_problem_of_ours_comes_back_as_its_error() -> None:
    error = Unreachable(
        "waypoint 3 is out of reach", waypoint=3, position_error=0.1, orientation_error=None,
        q=[0.0, 1.0], reason="too far", limits=["A2"],
    )  # fmt: skip
    response = httpx.Response(
        422, content=json.dumps(error.to_problem()),
        headers={"content-type": "application/problem+json; charset=utf-8"},
    )  # fmt: skip
    with pytest.raises(Unreachable) as caught:
        answering(response).plan(REQUEST)
    assert caught.value.to_problem() == error.to_problem()


def test_a_busy_service_says_when_to_ask_again() -> None:
    error = ServiceUnavailable("busy", url="/v1/plans", status_code=503, retry_after_s=2.0)
    response = httpx.Response(
        503, content=json.dumps(error.to_problem()),
        headers={"content-type": "application/problem+json"},
    )  # fmt: skip
    with pytest.raises(ServiceUnavailable) as caught:
        answering(response).plan(REQUEST)
    assert caught.value.data == {
        "url": f"{ADDRESS}/v1/plans", "status_code": 503, "retry_after_s": 2.0,
    }  # fmt: skip


@pytest.mark.parametrize(
    ("failure", "words"),
    [
        (httpx.ConnectError("connection refused"), "connection refused"),
        (httpx.ReadTimeout("x"), "no answer in time"),
        (httpx.RemoteProtocolError("x"), "cannot reach"),
        (httpx.UnsupportedProtocol("no scheme"), "not an address"),
    ],
)
def test_no_answer_is_service_unavailable_with_the_address(failure: Exception, words: str) -> None:
    def fail(_: httpx.Request) -> httpx.Response:
        raise failure

    async def twin() -> ServiceUnavailable:
        async with AsyncClient(ADDRESS, transport=httpx.MockTransport(fail), retries=0) as client:
            with pytest.raises(ServiceUnavailable) as caught:
                await client.plan(REQUEST)
        return caught.value

    with (
        Client(ADDRESS, transport=httpx.MockTransport(fail), retries=0) as client,
        pytest.raises(ServiceUnavailable, match=words) as caught,
    ):
        client.plan(REQUEST)
    assert caught.value.url == f"{ADDRESS}/v1/plans"
    assert caught.value.to_problem() == asyncio.run(twin()).to_problem()


@pytest.mark.parametrize("address", ["", "cell-7:8000", "http://", "http://[::1", "ftp://x"])
def test_what_is_no_address_is_service_unavailable(address: str) -> None:
    with pytest.raises(ServiceUnavailable):
        Client(address).robots()


@pytest.mark.parametrize(
    ("call", "path"),
    [
        (lambda c: c.get_plan("a/b?c"), "/v1/plans/a%2Fb%3Fc"),
        (lambda c: c.robot("../livez"), "/v1/robots/..%2Flivez"),
        (lambda c: c.version(), "/version"),
    ],
)
def test_names_never_leave_their_place_in_the_address(
    call: Callable[[Client], object], path: str
) -> None:
    seen = []

    def answer(request: httpx.Request) -> httpx.Response:
        seen.append(request.url.raw_path.decode())
        return httpx.Response(500)

    with (
        Client(ADDRESS, transport=httpx.MockTransport(answer)) as client,
        pytest.raises(ServiceUnavailable),
    ):
        call(client)
    assert seen == [path]


def test_a_client_needs_neither_pinocchio_nor_a_compiler() -> None:
    code = (
        "import sys, ikplan; ikplan.Client('http://127.0.0.1:9').close(); ikplan.AsyncClient;"
        "heavy = {'pinocchio', 'numba', 'toppra', 'scipy', 'matplotlib', 'fastapi'};"
        "print(sorted(heavy & sys.modules.keys()))"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout == "[]\n"


def test_clients_are_public_names() -> None:
    assert ikplan.Client is Client
    assert ikplan.AsyncClient is AsyncClient
