"""Plans in other forms than JSON, and answers compressed on request."""

from __future__ import annotations

import asyncio
import gzip
import io
import json
from collections.abc import Callable
from typing import NamedTuple

import httpx
import numpy as np
import pytest
import zstandard
from anyio.from_thread import BlockingPortal
from fastapi import FastAPI
from starlette.types import Message

from ikplan import Client
from ikplan.plans.export import FORMATS, encode
from ikplan.plans.plan import Plan
from ikplan_api.middleware.install import COMPRESSED_FROM

from .bad_requests import GOOD
from .urdfs import ARM

NAMES = {known.name: known.media_type for known in FORMATS}
UR5 = {
    "robot": "ur5",
    "waypoints": [[0.0, -1.5, 1.5, 0.0, 1.0, 0.0], [0.3, -1.2, 1.2, 0.0, 1.0, 0]],
}


@pytest.fixture(scope="module")
def plan(client: Client) -> Plan:
    return client.plan(GOOD)


@pytest.mark.parametrize("name", ["json", "csv", "npz", "ros"])
def test_accept_picks_the_form_for_new_and_for_kept_plans(
    name: str, http: httpx.Client, plan: Plan
) -> None:
    headers = {"accept": NAMES[name]}
    made = http.post("/v1/plans", json=GOOD, headers=headers)
    kept = http.get(f"/v1/plans/{plan.id}", headers=headers)
    for answer in (made, kept):
        assert answer.status_code == 200
        assert answer.headers["content-type"].partition(";")[0] == NAMES[name]
        assert "accept" in answer.headers["vary"].lower()
    if name == "json":
        assert Plan.load(made.content).id == plan.id
    else:
        assert made.content == kept.content == encode(plan, name)
    if name == "npz":
        assert np.array_equal(np.load(io.BytesIO(made.content))["q"], plan.trajectory.q)


def test_a_timing_has_the_same_forms_and_a_program_where_the_arm_has_one(
    http: httpx.Client,
) -> None:
    timed = Plan.load(http.post("/v1/timings", json=UR5).content)
    for name in ("csv", "ros", "urscript"):
        answer = http.post("/v1/timings", json=UR5, headers={"accept": NAMES[name]})
        assert answer.content == encode(timed, name)


@pytest.mark.parametrize(
    ("accept", "name"),
    [
        ("", "json"),
        ("*/*", "json"),
        ("application/*", "json"),
        ("text/*", "csv"),
        ("text/html, */*;q=0.1", "json"),
        ("text/csv;q=0.4, application/json;q=0.5", "json"),
        ("text/csv;q=0.5, application/json;q=0.4", "csv"),
        ("application/json;q=0, */*", "csv"),
        ("application/x-npz, application/problem+json", "npz"),
        ("application/json, application/problem+json", "json"),
        ("TEXT/CSV", "csv"),
        ("text/csv; header=present", "csv"),
    ],
)
def test_the_preferred_form_is_answered(
    accept: str, name: str, http: httpx.Client, plan: Plan
) -> None:
    answer = http.get(f"/v1/plans/{plan.id}", headers={"accept": accept})
    assert answer.headers["content-type"].partition(";")[0] == NAMES[name]


@pytest.mark.parametrize("accept", ["image/png", "text/html", "application/json;q=0", "nonsense"])
def test_another_form_is_refused_with_those_there_are(
    accept: str, http: httpx.Client, plan: Plan
) -> None:
    for answer in (
        http.get(f"/v1/plans/{plan.id}", headers={"accept": accept}),
        http.post("/v1/plans", content=b"{", headers={"accept": accept}),
    ):
        assert answer.status_code == 406
        assert answer.headers["content-type"] == "application/problem+json"
        assert answer.json()["allowed"] == list(NAMES.values())


def test_a_program_for_another_arm_is_not_to_be_had(http: httpx.Client, plan: Plan) -> None:
    answer = http.get(f"/v1/plans/{plan.id}", headers={"accept": NAMES["urscript"]})
    assert answer.status_code == 406
    assert "no URScript program for 'iiwa14'" in answer.json()["detail"]


def test_an_uploaded_arm_has_a_program_where_its_controller_runs_urscript(
    http: httpx.Client,
) -> None:
    controller = {
        "title": "mine",
        "cycle": 0.002,
        "languages": [{"name": "urscript", "variant": "e-series"}],
    }
    known = http.post("/v1/robots", json={"urdf": ARM, "controller": controller}).json()
    assert known["controller"]["cycle"] == 0.002
    request = {"robot": known["name"], "waypoints": [[0.0] * 6, [0.2] * 6]}
    for name, words in (("urscript", b"ikplan_trajectory()\n"), ("ros-goal", b"trajectory:\n")):
        answer = http.post("/v1/timings", json=request, headers={"accept": NAMES[name]})
        assert answer.status_code == 200
        assert words in answer.content
    assert http.delete(f"/v1/robots/{known['name']}").status_code == 204
    assert http.get("/v1/robots/ur5").json()["controller"]["cycle"] == 0.008


class Served(NamedTuple):
    headers: httpx.Headers
    body: bytes
    pieces: int


Ask = Callable[[str, str], Served]


@pytest.fixture(scope="module")
def served(app: FastAPI, portal: BlockingPortal) -> Ask:
    """An answer as it is sent: compressed, in pieces."""

    def ask(path: str, coding: str) -> Served:
        sent: list[Message] = []

        asked = iter([{"type": "http.request", "body": b"", "more_body": False}])

        async def receive() -> Message:
            for message in asked:
                return message
            await asyncio.sleep(60)
            raise AssertionError("nobody hangs up")

        async def send(message: Message) -> None:
            sent.append(message)

        scope = {
            "type": "http", "method": "GET", "path": path, "raw_path": path.encode(),
            "query_string": b"",
            "headers": [(b"host", b"localhost"), (b"accept-encoding", coding.encode())],
            "http_version": "1.1", "scheme": "http", "server": ("127.0.0.1", 80),
            "client": ("127.0.0.1", 1), "root_path": "",
        }  # fmt: skip
        portal.call(app, scope, receive, send)
        bodies = [m["body"] for m in sent[1:] if m.get("body")]
        return Served(httpx.Headers(sent[0]["headers"]), b"".join(bodies), len(bodies))

    return ask


@pytest.fixture(scope="module")
def listing(http: httpx.Client) -> bytes:
    return http.get("/v1/robots", headers={"accept-encoding": "identity"}).content


@pytest.mark.parametrize(
    ("coding", "applied"),
    [
        ("gzip", "gzip"),
        ("zstd", "zstd"),
        ("gzip, zstd", "zstd"),
        ("br", None),
        ("identity", None),
        ("gzip;q=0", None),
    ],
)
def test_an_answer_is_compressed_as_asked(
    coding: str, applied: str | None, served: Ask, listing: bytes
) -> None:
    answer = served("/v1/robots", coding)
    assert answer.headers.get("content-encoding") == applied
    decoders: dict[str | None, Callable[[bytes], bytes]] = {
        None: lambda b: b,
        "gzip": gzip.decompress,
        "zstd": lambda b: zstandard.ZstdDecompressor().decompressobj().decompress(b),
    }
    assert decoders[applied](answer.body) == listing
    assert len(listing) > 20 * COMPRESSED_FROM
    if applied:
        assert len(answer.body) < 0.5 * len(listing)
        assert "accept-encoding" in answer.headers["vary"].lower()


def test_short_answers_are_left_alone(served: Ask) -> None:
    assert "content-encoding" not in served("/livez", "gzip").headers


def test_long_plans_are_compressed_piece_by_piece_and_whole(
    served: Ask, client: Client, http: httpx.Client
) -> None:
    request = {**GOOD, "sampling": {"rate_hz": 5000}}
    plan = client.plan(request)
    whole = http.get(f"/v1/plans/{plan.id}", headers={"accept-encoding": "identity"})
    assert len(whole.content) > 2**20
    answer = served(f"/v1/plans/{plan.id}", "gzip")
    assert gzip.decompress(answer.body) == whole.content
    assert answer.pieces > 4
    assert json.loads(whole.content)["id"] == plan.id


def test_every_form_has_a_tag_of_its_own(http: httpx.Client, plan: Plan) -> None:
    path, tags = f"/v1/plans/{plan.id}", set()
    for name in ("json", "csv", "npz"):
        tag = http.get(path, headers={"accept": NAMES[name]}).headers["etag"]
        for accept, status in ((NAMES[name], 304), (NAMES["ros"], 200)):
            headers = {"accept": accept, "if-none-match": tag}
            assert http.get(path, headers=headers).status_code == status
        tags.add(tag)
    assert len(tags) == 3
