"""Many requests in one."""

import asyncio
import io
import json
import sys
import time
from pathlib import Path
from typing import Any

import httpx
import pytest
from starlette.types import Message

import ikplan
from ikplan import Client
from ikplan.cli import main
from ikplan_api.app import create_app
from ikplan_api.handlers.batch_lines import NDJSON
from ikplan_api.settings import Settings
from tests.two_joints import URDF

from .bad_requests import GOOD
from .conftest import ADDRESS
from .serving import WAIT_S
from .stand_in import StandIn

HEADERS = {"content-type": NDJSON}


def lines(*requests: object) -> bytes:
    return b"\n".join(json.dumps(r).encode() for r in requests)


def at(x: float) -> dict[str, Any]:
    return {**GOOD, "path": {"waypoints": [{"position": [x, 0.0, 0.5]}]}}


def test_every_line_is_answered_in_its_place_and_none_spoils_another(http: httpx.Client) -> None:
    requests: list[Any] = [at(0.5), at(9.0), {"robot": "x"}, at(0.55), [1], at(0.5)]
    body = lines(*requests[:3]) + b"\n\n  \n{not JSON\n" + lines(*requests[3:]) + b"\r\n"
    answer = http.post("/v1/batches", content=body, headers=HEADERS)
    assert answer.status_code == 200
    assert answer.headers["content-type"] == NDJSON
    told = [json.loads(line) for line in answer.text.splitlines()]
    assert [t["index"] for t in told] == list(range(7))
    assert [t["status"] for t in told] == [200, 422, 422, 422, 200, 422, 200]
    assert [t["problem"]["type"] if "problem" in t else None for t in told] == [
        None, "urn:ikplan:unreachable", "urn:ikplan:invalid-request",
        "urn:ikplan:invalid-request", None, "urn:ikplan:invalid-request", None,
    ]  # fmt: skip
    assert told[1]["problem"]["instance"].endswith(answer.headers["x-request-id"])
    alone = ikplan.plan(requests[0]).model_dump(mode="json", exclude={"stats"})
    for k in (0, 6):
        assert {**told[k]["plan"], "stats": None} == {**alone, "stats": None}
    kept = http.get(f"/v1/plans/{told[4]['plan']['id']}")
    assert kept.json() == told[4]["plan"]


def test_the_command_hands_the_lines_to_a_service(
    live_address: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    requests, out = tmp_path / "requests.jsonl", tmp_path / "plans.jsonl"
    requests.write_bytes(lines(at(0.5), at(9.0)) + b"\n\n{not JSON\n" + lines(at(0.51)))
    assert main(["batch", str(requests), "--server", live_address, "-o", str(out)]) == 1
    told = [json.loads(line) for line in out.read_bytes().splitlines()]
    assert [(t["index"], t["status"]) for t in told] == [(0, 200), (1, 422), (2, 422), (3, 200)]
    alone = ikplan.plan(at(0.51)).model_dump(mode="json")
    assert {**told[3]["plan"], "stats": None} == {**alone, "stats": None}
    said = capsys.readouterr()
    assert said.out.splitlines() == ["2 of 4 requests planned", f"wrote {out}"]
    assert "1 invalid-request, 1 unreachable" in said.err


def test_the_command_uploads_the_robot_that_all_lines_are_for(
    live_address: str, tmp_path: Path
) -> None:
    urdf, requests, out = (tmp_path / name for name in ("two.urdf", "in.jsonl", "out.jsonl"))
    urdf.write_text(URDF)
    waypoints = {"path": {"waypoints": [{"position": [0.4, 0.2, 0.0]}]}, "start": [0.0, 0.1]}
    requests.write_bytes(lines({"robot": "any", **waypoints}, waypoints, [1]))
    options = ["--robot", str(urdf), "--tip", "tip", "-o", str(out)]
    assert main(["batch", str(requests), "--server", live_address, *options]) == 1
    told = [json.loads(line) for line in out.read_bytes().splitlines()]
    assert [t["status"] for t in told] == [200, 200, 422]
    assert told[0]["plan"]["robot"].startswith("urdf-")


def test_a_bar_shows_how_many_lines_are_done(
    live_address: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    class Terminal(io.StringIO):
        def isatty(self) -> bool:
            return True

    monkeypatch.setattr(sys, "stderr", terminal := Terminal())
    requests = tmp_path / "requests.jsonl"
    requests.write_bytes(lines(at(0.5), at(0.51)))
    out = str(tmp_path / "out.jsonl")
    assert main(["batch", str(requests), "--server", live_address, "-o", out]) == 0
    assert "1 line, 50.0 %" in terminal.getvalue()


def test_a_request_may_be_json_already(client: Client) -> None:
    pretty = json.dumps(at(0.5), indent=2).encode()
    plans = list(client.batch([pretty, at(0.5)]))
    first, second = (plan for plan in plans if isinstance(plan, ikplan.Plan))
    assert first.id == second.id
    with pytest.raises(ikplan.InvalidRequest, match="blank"):
        list(client.batch([b" "]))


def test_a_body_of_line_feeds_is_refused_before_it_is_split(http: httpx.Client) -> None:
    body = b"\n" * 2**22 * 4
    began = time.process_time()
    answer = http.post("/v1/batches", content=body, headers=HEADERS)
    assert time.process_time() - began < 0.5  # 0.6 s to split it
    assert (answer.status_code, answer.json()["allowed"]) == (413, "at most 10000 requests")


def test_a_line_that_is_longer_than_a_request_is_refused_by_itself(http: httpx.Client) -> None:
    body = b"{" + b" " * 2**22 + b"\n" + lines({"robot": "x"})
    told = http.post("/v1/batches", content=body, headers=HEADERS).text.splitlines()
    assert [json.loads(line)["status"] for line in told] == [413, 422]


@pytest.mark.parametrize(
    ("body", "status"), [(b"", 422), (b"\n \n", 422), (b"1\n" * 4, 413), (b" " * 5000, 413)]
)
def test_a_batch_that_is_none_or_too_long_is_refused(body: bytes, status: int) -> None:
    app = create_app(Settings(max_batch_lines=3, max_batch_bytes=4000), planner=StandIn())

    async def ask() -> httpx.Response:
        transport = httpx.ASGITransport(app)
        async with httpx.AsyncClient(transport=transport, base_url=ADDRESS) as plain:
            return await plain.post("/v1/batches", content=body, headers=HEADERS)

    answer = asyncio.run(ask())
    assert answer.status_code == status
    assert answer.json()["type"] == "urn:ikplan:invalid-request"


def test_a_batch_says_that_it_is_json_lines(http: httpx.Client) -> None:
    answer = http.post("/v1/batches", json=GOOD)
    assert answer.status_code == 415
    assert NDJSON in answer.json()["allowed"]


def test_a_batch_is_answered_as_it_goes_and_stopped_when_nobody_reads_on() -> None:
    planner = StandIn()
    app = create_app(Settings(), planner=planner)
    body = lines(*(at(0.5 + 0.001 * i) for i in range(50)))
    sent: list[bytes] = []
    gone = asyncio.Event()

    async def run() -> None:
        asked = iter([{"type": "http.request", "body": body, "more_body": False}])

        async def receive() -> Message:
            if (message := next(asked, None)) is not None:
                return message
            await gone.wait()
            return {"type": "http.disconnect"}

        async def send(message: Message) -> None:
            if message.get("body"):
                sent.append(message["body"])

        scope = {
            "type": "http", "method": "POST", "path": "/v1/batches", "raw_path": b"/v1/batches",
            "query_string": b"",
            "headers": [(b"host", b"localhost"), (b"content-type", NDJSON.encode())],
            "http_version": "1.1", "scheme": "http", "server": ("127.0.0.1", 80),
            "client": ("127.0.0.1", 1), "root_path": "",
        }  # fmt: skip
        async with asyncio.timeout(WAIT_S), app.router.lifespan_context(app):
            serving = asyncio.create_task(app(scope, receive, send))
            for k in range(3):
                while planner.load.running < 2:
                    await asyncio.sleep(0.005)
                assert planner.load.running == 2  # twice the one worker: no more at once
                planner.answer()
                while len(sent) < k + 1:
                    await asyncio.sleep(0.005)
            gone.set()
            await serving
            while planner.load.running:
                await asyncio.sleep(0.005)

    asyncio.run(run())
    assert [json.loads(line)["index"] for line in sent] == [0, 1, 2]
    assert len(planner.asked) <= 5
    assert planner.cancelled
