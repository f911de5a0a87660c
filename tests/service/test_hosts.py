"""Who a browser thinks it asks: DNS rebinding, foreign pages, and headers of every answer."""

from __future__ import annotations

from typing import Any

import httpx
import pytest
from fastapi import FastAPI
from hypothesis import given
from hypothesis import strategies as st

from ikplan import InvalidRequest
from ikplan.client.api_keys import key_hash, new_key
from ikplan_api.app import create_app
from ikplan_api.http.security_headers import SECURITY_HEADERS
from ikplan_api.middleware.hosts import host_name
from ikplan_api.settings import Settings, load_settings

from .stand_in import Idle
from .test_access import KEY, KEYS, ask, bearer


def app_with(**settings: Any) -> FastAPI:
    return create_app(Settings(store_path=":memory:", **settings), planner=Idle())


@pytest.mark.parametrize(
    "host", ["localhost", "localhost:8000", "127.0.0.1:9", "127.9.9.9", "[::1]:80", "LOCALHOST"]
)
def test_loopback_names_are_served(host: str) -> None:
    (answer,) = ask(app_with(), ("GET", "/version", {"host": host}))
    assert answer.status_code == 200


@pytest.mark.parametrize(
    "host",
    ["evil.example", "evil.example:8000", "localhost.evil.example", "10.0.0.1", "x@localhost"],
)
def test_another_host_is_refused_but_for_probes(host: str) -> None:
    paths = ["/", "/version", "/v1/plans/x", "/metrics", "/nowhere", "/livez", "/readyz"]
    answers = ask(app_with(), *(("GET", path, {"host": host}) for path in paths))
    assert [a.status_code for a in answers] == [403] * 5 + [200, 200]
    assert answers[0].json()["type"] == "urn:ikplan:access-denied"
    assert "IKPLAN_HOSTS" in answers[0].json()["detail"]


def test_with_keys_any_host_is_served_unless_hosts_are_named() -> None:
    elsewhere = {"host": "cell.example:8000", **bearer(KEY)}
    (answer,) = ask(app_with(api_keys=KEYS), ("GET", "/nowhere", elsewhere))
    assert answer.status_code == 404
    named = app_with(api_keys=KEYS, hosts="Cell.example, [fd00::1]")
    hosts = ["cell.example", "CELL.example:1", "[fd00::1]:80", "other.example", "localhost"]
    answers = ask(named, *(("GET", "/nowhere", {"host": h, **bearer(KEY)}) for h in hosts))
    assert [a.status_code for a in answers] == [404, 404, 404, 403, 403]


@pytest.mark.parametrize(
    ("origin", "status"),
    [
        ("http://localhost:8000", 404),
        ("https://cell.example", 404),
        ("http://localhost:9000", 403),
        ("http://localhost", 403),
        ("https://evil.example", 403),
        ("null", 403),
        ("http://[", 403),
    ],
)
def test_a_foreign_page_does_not_write(origin: str, status: int) -> None:
    app = app_with(cors_origins="https://cell.example")
    headers = {"host": "localhost:8000", "origin": origin}
    read, posted, deleted = ask(
        app, *((method, "/nowhere", headers) for method in ("GET", "POST", "DELETE"))
    )
    assert (read.status_code, posted.status_code, deleted.status_code) == (404, status, status)


@given(st.from_regex(r"[a-z0-9.-]{1,20}", fullmatch=True), st.integers(0, 65535))
def test_the_name_of_a_host_is_without_its_port(name: str, port: int) -> None:
    assert host_name(name) == host_name(f"{name}:{port}") == name
    assert host_name("[::1]") == host_name(f"[::1]:{port}") == "::1"


@pytest.mark.parametrize("host", ["*", "https://cell.example", "abc:80", "a b", "/x"])
def test_a_host_that_is_none_is_refused_at_the_start(
    host: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("IKPLAN_HOSTS", host)
    with pytest.raises(InvalidRequest, match="IKPLAN_HOSTS: "):
        load_settings()


def test_every_answer_has_the_security_headers_also_an_unexpected_failure() -> None:
    app = app_with(api_keys=f"a:{key_hash(new_key())}, b:{key_hash(KEY)}")

    @app.get("/broken")
    def broken() -> None:
        raise RuntimeError("planted")

    headers = bearer(KEY)
    answers = ask(
        app,
        *(("GET", path, headers) for path in ("/livez", "/nowhere", "/broken", "/openapi.json")),
        ("GET", "/v1/robots", {}),
        ("PUT", "/v1/plans", headers),
        raise_app_exceptions=False,
    )
    assert [a.status_code for a in answers] == [200, 404, 500, 200, 401, 405]
    for answer in answers:
        missing = SECURITY_HEADERS.keys() - answer.headers.keys()
        assert not missing, (answer.url, missing)
        assert answer.headers["cache-control"] == "private, no-store"


def test_plans_are_kept_by_no_cache(http: httpx.Client) -> None:
    request = {"robot": "ur5", "waypoints": [[0.0] * 6, [0.1] * 6]}
    posted = http.post("/v1/timings", json=request)
    fetched = http.get(posted.headers["content-location"], headers={"accept": "text/csv"})
    again = http.get(
        posted.headers["content-location"], headers={"if-none-match": posted.headers["etag"]}
    )
    assert [a.status_code for a in (posted, fetched, again)] == [200, 200, 304]
    assert {a.headers["cache-control"] for a in (posted, fetched, again)} == {"private, no-store"}
