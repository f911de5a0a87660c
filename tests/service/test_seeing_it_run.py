"""What an operator sees: figures, logs, traces, probes."""

from __future__ import annotations

import asyncio
import json
import logging
import logging.config
import re
import sys
from typing import Any

import httpx
import pytest
from fastapi import FastAPI
from opentelemetry import trace
from opentelemetry.sdk.trace import TracerProvider
from opentelemetry.sdk.trace.export import SimpleSpanProcessor
from opentelemetry.sdk.trace.export.in_memory_span_exporter import InMemorySpanExporter
from prometheus_client.parser import text_string_to_metric_families

from ikplan import Client, IkplanError
from ikplan.cli import serving
from ikplan.errors import Unreachable
from ikplan_api.app import create_app
from ikplan_api.settings import Settings, load_settings
from ikplan_api.telemetry import logs
from ikplan_api.workers import instrumented_planner
from ikplan_api.workers.tasks import TaskResult
from tests.present import present

from .bad_requests import GOOD
from .conftest import ADDRESS
from .stand_in import StandIn

JSON = {"content-type": "application/json"}


def figures(http: httpx.Client) -> dict[str, float]:
    """Every sample by its name and labels."""
    answer = http.get("/metrics")
    assert answer.headers["content-type"].startswith("text/plain")
    return {
        sample.name + str(sorted(sample.labels.items())): sample.value
        for family in text_string_to_metric_families(answer.text)
        for sample in family.samples
    }


def grown(before: dict[str, float], after: dict[str, float], name: str, **labels: str) -> float:
    key = name + str(sorted(labels.items()))
    return after.get(key, 0.0) - before.get(key, 0.0)


def test_a_plan_is_counted_with_its_stages_and_margins(http: httpx.Client, client: Client) -> None:
    before = figures(http)
    request = {**GOOD, "sampling": {"rate_hz": 101}}
    plan = client.plan(request)
    client.plan(request)  # kept: not made again
    after = figures(http)
    assert grown(before, after, "ikplan_tasks_total", kind="plan", outcome="done") == 1
    assert grown(before, after, "ikplan_task_seconds_count", kind="plan") == 1
    for stage, seconds in plan.stats.seconds.items():
        assert grown(before, after, "ikplan_stage_seconds_count", stage=stage) == 1
        spent = grown(before, after, "ikplan_stage_seconds_sum", stage=stage)
        assert spent == pytest.approx(seconds, abs=1e-6)
    margin = 1.0 - plan.certificate.velocity_limit_ratio
    told = grown(before, after, "ikplan_certificate_margin_sum", limit="velocity")
    assert told == pytest.approx(margin, abs=1e-9)
    assert grown(before, after, "ikplan_plan_samples_sum") == len(plan.trajectory.time)
    route = {"method": "POST", "route": "/v1/plans", "status": "200"}
    assert grown(before, after, "ikplan_http_request_seconds_count", **route) == 2


def test_a_failure_is_counted_by_its_type(http: httpx.Client, client: Client) -> None:
    before = figures(http)
    with pytest.raises(Unreachable):
        client.ik({"robot": "iiwa14", "position": [9.0, 0.0, 0.0]})
    after = figures(http)
    assert grown(before, after, "ikplan_tasks_total", kind="ik", outcome="unreachable") == 1
    route = {"method": "POST", "route": "/v1/ik", "status": "422"}
    assert grown(before, after, "ikplan_http_request_seconds_count", **route) == 1


def test_names_made_up_by_callers_make_no_series(http: httpx.Client) -> None:
    before = figures(http)
    for i in range(20):
        http.get(f"/v1/plans/none-{i}")
        http.get(f"/nowhere/{i}")
        http.request(f"M{i}", "/livez")
    after = figures(http)
    new = {re.sub(r"le'.*?'\)", "", key) for key in after.keys() - before.keys() if "http" in key}
    assert not any(re.search(r"none-\d|/nowhere|M\d", key) for key in new)
    route = {"method": "GET", "route": "/v1/plans/{plan_id}", "status": "404"}
    assert grown(before, after, "ikplan_http_request_seconds_count", **route) == 20


def test_the_load_of_the_workers_is_told(http: httpx.Client, app: FastAPI) -> None:
    now = figures(http)
    assert now["ikplan_ready[]"] == 1.0
    assert now["ikplan_workers[]"] == app.state.planner.load.workers == 2
    assert now["ikplan_tasks_running[]"] == now["ikplan_tasks_queued[]"] == 0.0
    assert now["ikplan_http_requests_in_flight[]"] == 1.0  # this one
    assert now["process_resident_memory_bytes[]"] > 1e6


def test_tasks_that_wait_and_that_nobody_wants_any_more_are_told() -> None:
    stand_in = StandIn()
    app = create_app(Settings(store_path=":memory:"), planner=stand_in)

    async def use() -> list[str]:
        run = app.state.planner.run
        waiting = [asyncio.create_task(run("plan", b"{}")) for _ in range(3)]
        await asyncio.sleep(0)
        waiting[0].cancel()
        await asyncio.wait(waiting[:1])
        stand_in.fail(IkplanError("x"))
        await asyncio.wait(waiting[1:2])
        stand_in.answer()
        await waiting[2]
        told: list[str] = app.state.metrics.text().decode().splitlines()
        return told

    lines = asyncio.run(use())
    for outcome in ("cancelled", "error", "done"):
        assert f'ikplan_tasks_total{{kind="plan",outcome="{outcome}"}} 1.0' in lines


def test_every_request_is_logged_once_with_the_id_of_its_answer(
    http: httpx.Client, caplog: pytest.LogCaptureFixture
) -> None:
    caplog.set_level(logging.DEBUG, logger="ikplan")
    caplog.handler.addFilter(logs.RequestFilter())
    line: Any
    refused = http.post("/v1/fk", content="{", headers={**JSON, "x-request-id": "cell-7.42"})
    (line,) = [r for r in caplog.records if r.name == "ikplan.access"]
    assert refused.json()["instance"] == "urn:ikplan:request:cell-7.42"
    assert line.request_id == "cell-7.42"
    assert (line.status, line.route, line.problem) == (422, "/v1/fk", "invalid-request")
    assert line.levelno == logging.INFO
    assert line.bytes == len(refused.content)
    assert 0.0 < line.seconds < 60.0
    caplog.clear()
    http.get("/livez")
    (line,) = [r for r in caplog.records if r.name == "ikplan.access"]
    assert line.levelno == logging.DEBUG


def written(record: logging.LogRecord, monkeypatch: pytest.MonkeyPatch, form: str) -> str:
    monkeypatch.setenv("IKPLAN_LOG_FORMAT", form)
    logs.RequestFilter().filter(record)
    return logs.formatter().format(record)


def record(**extra: object) -> logging.LogRecord:
    made = logging.LogRecord("ikplan.x", logging.ERROR, "f.py", 1, "so %d\nmany", (3,), None)
    made.__dict__.update(extra)
    return made


def test_the_log_is_json_a_line_or_text(monkeypatch: pytest.MonkeyPatch) -> None:
    token = logs.request_id.set("abc")
    try:
        line = written(record(status=418), monkeypatch, "json")
        assert "\n" not in line
        told = json.loads(line)
        assert told["time"].endswith("+00:00")
        del told["time"]
        assert told == {
            "level": "ERROR", "logger": "ikplan.x", "message": "so 3\nmany",
            "request_id": "abc", "status": 418,
        }  # fmt: skip
        assert written(record(), monkeypatch, "text") == "ERROR: so 3\nmany [abc]"
        monkeypatch.setattr(sys.stderr, "isatty", lambda: True, raising=False)
        assert written(record(), monkeypatch, "auto").startswith("ERROR:")
        monkeypatch.setattr(sys.stderr, "isatty", lambda: False, raising=False)
        assert written(record(), monkeypatch, "auto").startswith("{")
    finally:
        logs.request_id.reset(token)


def test_the_command_logs_as_the_settings_say(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("IKPLAN_LOG_LEVEL", "error")
    config = serving._logging()
    logging.config.DictConfigurator(config)  # names what exists
    assert config["loggers"]["ikplan"]["level"] == "ERROR"
    assert load_settings().log_level == "error"
    monkeypatch.setenv("IKPLAN_LOG_LEVEL", "loud")
    assert serving._logging()["loggers"]["ikplan"]["level"] == "INFO"
    with pytest.raises(IkplanError, match="IKPLAN_LOG_LEVEL"):
        load_settings()


def test_work_is_traced_under_its_request_and_the_callers_trace(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    spans, provider = InMemorySpanExporter(), TracerProvider()
    provider.add_span_processor(SimpleSpanProcessor(spans))
    monkeypatch.setattr(trace, "get_tracer_provider", lambda: provider)
    monkeypatch.setattr(instrumented_planner, "_tracer", provider.get_tracer("test"))
    planner = StandIn()
    app = create_app(Settings(store_path=":memory:"), planner=planner)

    async def run(*_: object, **__: object) -> TaskResult:
        return TaskResult(b"{}")

    monkeypatch.setattr(planner, "run", run)
    trace_id = "0af7651916cd43dd8448eb211c80319c"

    async def ask() -> None:
        async with httpx.AsyncClient(transport=httpx.ASGITransport(app), base_url=ADDRESS) as http:
            caller = {"traceparent": f"00-{trace_id}-b7ad6b7169203331-01"}
            await http.post("/v1/fk", json={"robot": "ur5", "q": [0.0]}, headers=caller)
            await http.get("/livez")

    asyncio.run(ask())
    by_name = {span.name: span for span in spans.get_finished_spans()}
    task = by_name["ikplan fk"]
    assert present(task.attributes)["ikplan.outcome"] == "done"
    assert f"{task.context.trace_id:032x}" == trace_id
    request = by_name["POST /v1/fk"]
    assert request.context.trace_id == task.context.trace_id
    assert "GET /livez" not in by_name
    provider.shutdown()
