"""The endpoints as plain HTTP."""

import asyncio
import json
import re
from typing import Any

import httpx
import numpy as np
import pytest
from starlette.types import Message

import ikplan
from ikplan import InvalidRequest
from ikplan_api.app import create_app
from ikplan_api.settings import Settings, load_settings

from .bad_requests import GOOD

JSON = {"content-type": "application/json"}
TYPE = [(b"content-type", b"application/json")]


def post(http: httpx.Client, path: str, document: object) -> httpx.Response:
    return http.post(path, content=json.dumps(document), headers=JSON)


def test_fk_is_the_robots_own(http: httpx.Client) -> None:
    q = [0.1, -1.2, 1.5, 0.2, 1.0, 0.3]
    tool = {"position": [0.0, 0.1, 0.2]}
    answer = post(http, "/v1/fk", {"robot": "ur5", "q": q, "tool": tool})
    pose = ikplan.load_robot("ur5").with_tool(tool["position"]).fk(q)
    assert answer.status_code == 200
    assert np.array_equal(answer.json()["position"], pose.translation)


def test_ik_brings_the_tool_there(http: httpx.Client) -> None:
    position = [0.5, 0.1, 0.5]
    answer = post(http, "/v1/ik", {"robot": "iiwa14", "position": position}).json()
    reached = ikplan.load_robot("iiwa14").fk(answer["q"]).translation
    assert np.linalg.norm(reached - position) <= 1e-6
    assert answer["orientation_error"] is None


def test_a_plan_is_kept_under_its_id(http: httpx.Client) -> None:
    answer = post(http, "/v1/plans", GOOD)
    assert answer.status_code == 200
    again = http.get(answer.headers["content-location"])
    assert again.content == answer.content
    assert again.json()["id"] in answer.headers["content-location"]


def test_an_unknown_plan_is_a_problem(http: httpx.Client) -> None:
    answer = http.get("/v1/plans/none")
    assert answer.status_code == 404
    assert answer.json()["type"] == "urn:ikplan:plan-not-found"
    assert answer.json()["id"] == "none"


def test_robots_are_listed_as_they_are_described(http: httpx.Client) -> None:
    listed = http.get("/v1/robots").json()["robots"]
    catalogue = [r for r in listed if not r["name"].startswith("urdf-")]  # uploads come after
    assert [r["name"] for r in catalogue] == ikplan.robot_names()
    # The bodies are shown for a single robot only.
    assert {**http.get("/v1/robots/panda").json(), "collision": None} in listed
    missing = http.get("/v1/robots/pandas").json()
    assert missing["type"] == "urn:ikplan:robot-not-found"
    assert missing["near"][0] == "panda"


def test_solvers_are_listed_with_their_parameters(http: httpx.Client) -> None:
    listed = {s["name"]: s for s in http.get("/v1/solvers").json()["solvers"]}
    names = [p["name"] for p in listed["ik-ba"]["parameters"]]
    assert {"fmin", "fmax", "alpha"} <= set(names)
    assert "module" not in listed["ik-ba"]


def test_version_and_health(http: httpx.Client) -> None:
    assert http.get("/version").json() == {"version": ikplan.__version__}
    assert http.get("/livez").json() == {"status": "alive"}
    assert http.get("/readyz").json() == {"status": "ready"}


@pytest.mark.parametrize(
    ("method", "path", "status"),
    [
        ("GET", "/v1", 404),
        ("GET", "/v1/plans/a/b", 404),
        ("GET", "/v1/robots/..%2F..%2Fetc%2Fpasswd", 404),
        ("GET", "/redoc", 404),
        ("GET", "/v1/robots/", 404),
        ("POST", "/v1/plans/", 404),
        ("PUT", "/v1/plans", 405),
        ("DELETE", "/v1/robots", 405),
        ("PUT", "/livez", 405),
    ],
)
def test_what_is_not_there_is_a_problem_too(
    method: str, path: str, status: int, http: httpx.Client
) -> None:
    answer = http.request(method, path)
    assert answer.status_code == status
    assert answer.headers["content-type"] == "application/problem+json"
    problem = answer.json()
    assert problem["type"] == "about:blank"
    assert problem["status"] == status
    if status == 405:
        assert answer.headers["allow"]


@pytest.mark.parametrize(
    ("path", "methods"),
    [
        ("/v1/robots", "GET, POST"),
        ("/v1/robots/ur5", "DELETE, GET"),
        ("/v1/plans", "GET, POST"),
        ("/livez", "GET"),
        ("/docs", "GET"),
    ],
)
def test_a_wrong_method_is_told_the_right_ones(path: str, methods: str, http: httpx.Client) -> None:
    answer = http.request("PATCH", path)
    assert (answer.status_code, answer.headers["allow"]) == (405, methods)


@pytest.mark.parametrize(
    "content_type",
    [None, "", "text/plain", "application/x-www-form-urlencoded", "multipart/form-data; boundary=x",
     "application/jsonx", "*/*"],
)  # fmt: skip
def test_a_body_that_does_not_say_it_is_json_is_refused(
    content_type: str | None, http: httpx.Client
) -> None:
    headers = {} if content_type is None else {"content-type": content_type}
    answer = http.post("/v1/plans", content=json.dumps(GOOD).encode(), headers=headers)
    assert answer.status_code == 415
    assert answer.json()["type"] == "urn:ikplan:invalid-request"
    assert "application/json" in answer.json()["detail"]


@pytest.mark.parametrize("content_type", ["application/json; charset=utf-8", "Application/JSON"])
def test_a_content_type_may_be_spelt_in_many_ways(content_type: str, http: httpx.Client) -> None:
    answer = http.post("/v1/fk", content=b"{}", headers={"content-type": content_type})
    assert answer.status_code == 422


@pytest.mark.parametrize("coding", ["gzip", "br", "identity, zstd", "x"])
def test_a_body_in_a_content_encoding_is_refused_and_never_read_as_text(
    coding: str, http: httpx.Client
) -> None:
    answer = http.post("/v1/plans", json=GOOD, headers={"content-encoding": coding})
    assert answer.status_code == 415
    assert answer.headers["accept-encoding"] == "identity"
    assert coding.split(", ")[-1] in answer.json()["detail"]
    assert http.post("/v1/fk", json={}, headers={"content-encoding": "identity"}).json()["field"]


def test_a_body_in_another_charset_is_refused(http: httpx.Client) -> None:
    for charset, status in (("utf-16", 415), ("latin-1", 415), ("UTF-8", 422)):
        headers = {"content-type": f"application/json; charset={charset}"}
        assert http.post("/v1/fk", content=b"{}", headers=headers).status_code == status


def test_what_a_client_sent_does_not_come_back_as_a_whole(http: httpx.Client) -> None:
    long = "x" * 2_000_000
    for document in ({long: 1}, {**GOOD, "robot": long}, {**GOOD, "path": {"waypoints": long}}):
        answer = http.post("/v1/plans", json=document)
        assert answer.status_code in (404, 422)
        assert len(answer.content) < 10_000


def test_a_body_that_is_too_long_is_refused_by_its_announced_length(http: httpx.Client) -> None:
    answer = http.post("/v1/plans", content=b" " * (2**22 + 1), headers=JSON)
    assert answer.status_code == 413
    assert answer.json()["allowed"] == f"at most {2**22} bytes"


def raw_exchange(headers: list[tuple[bytes, bytes]], chunk: bytes) -> tuple[int, int]:
    """Send a body of 100 chunks straight to an app; return the status and what it read."""
    read = 0
    statuses: list[Any] = []

    async def receive() -> Message:
        nonlocal read
        read += len(chunk)
        more = read < 100 * len(chunk)
        return {"type": "http.request", "body": chunk, "more_body": more}

    async def send(message: Message) -> None:
        statuses.append(message.get("status"))

    scope = {
        "type": "http", "method": "POST", "path": "/v1/plans", "raw_path": b"/v1/plans",
        "query_string": b"", "headers": [(b"host", b"localhost"), *TYPE, *headers],
        "http_version": "1.1", "scheme": "http", "server": ("test", 80), "client": ("test", 1),
        "root_path": "",
    }  # fmt: skip
    asyncio.run(create_app(Settings(workers=1, max_body_bytes=5000))(scope, receive, send))
    return statuses[0], read


def test_a_streamed_body_is_read_only_up_to_the_limit() -> None:
    status, read = raw_exchange([], b" " * 1000)
    assert status == 413
    assert 5000 < read <= 7000


@pytest.mark.parametrize(
    ("length", "status"), [(b"9" * 5000, 413), (b"-1", 422), (b"x", 422), (b"1", 422)]
)
def test_an_announced_length_is_not_believed(length: bytes, status: int) -> None:
    assert raw_exchange([(b"content-length", length)], b" ")[0] == status


def test_every_answer_carries_a_request_id(http: httpx.Client) -> None:
    answers = [http.get("/livez"), http.get("/nowhere"), post(http, "/v1/fk", {})]
    ids = [a.headers["x-request-id"] for a in answers]
    assert len(set(ids)) == 3
    assert all(re.fullmatch(r"[0-9a-f]{32}", i) for i in ids)
    assert answers[1].json()["instance"] == f"urn:ikplan:request:{ids[1]}"
    assert answers[2].json()["instance"] == f"urn:ikplan:request:{ids[2]}"


def test_a_plain_request_id_of_the_caller_is_kept_and_any_other_replaced(
    http: httpx.Client,
) -> None:
    kept = http.get("/livez", headers={"x-request-id": "cell-7.plan_42"})
    assert kept.headers["x-request-id"] == "cell-7.plan_42"
    for odd in ("a b", "x" * 65, "<script>", "é"):
        answer = http.get("/livez", headers={b"x-request-id": odd.encode()})
        assert re.fullmatch(r"[0-9a-f]{32}", answer.headers["x-request-id"])


def test_settings_come_from_the_environment(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("IKPLAN_MAX_QUEUED", "3")
    monkeypatch.setenv("IKPLAN_PORT", "9000")
    assert (load_settings().max_queued, load_settings().port) == (3, 9000)


@pytest.mark.parametrize(("name", "value"), [("IKPLAN_WORKERS", "-1"), ("IKPLAN_PORT", "x")])
def test_a_wrong_setting_names_its_variable(
    name: str, value: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv(name, value)
    with pytest.raises(InvalidRequest, match=name) as caught:
        create_app()
    assert caught.value.field == name
