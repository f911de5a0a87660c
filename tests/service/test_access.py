"""Who may ask, how often, from where, and what browsers are told."""

from __future__ import annotations

import asyncio
import hashlib
import hmac
import re
from collections.abc import Mapping
from typing import Any

import httpx
import pytest
from fastapi import FastAPI
from starlette.types import Message

from ikplan import AccessDenied, AsyncClient, Client, InvalidRequest, RateLimited
from ikplan.cli import main
from ikplan.client.api_keys import key_hash, new_key
from ikplan_api.app import create_app
from ikplan_api.settings import Settings, load_settings
from ikplan_api.settings.access import is_loopback

from .conftest import ADDRESS
from .stand_in import Idle

KEY, OTHER = new_key(), new_key()
KEYS = f"cell:{key_hash(KEY)}, {key_hash(OTHER)}"
OPEN = [
    *("/", "/docs", "/openapi.json", "/livez", "/readyz", "/version", "/page/x.js"),
    *("/docs/start.js", "/problems", "/problems/access-denied"),
]


def bearer(key: str) -> dict[str, str]:
    return {"authorization": f"Bearer {key}"}


def app_with(**settings: Any) -> FastAPI:
    return create_app(Settings(**settings), planner=Idle())


def ask(
    app: FastAPI, *requests: tuple[str, str, Mapping[str, str]], **transport: Any
) -> list[httpx.Response]:
    async def exchange() -> list[httpx.Response]:
        carrier = httpx.ASGITransport(app, **transport)
        base = transport.get("base", ADDRESS)
        async with httpx.AsyncClient(transport=carrier, base_url=base) as http:
            return [await http.request(m, path, headers=headers) for m, path, headers in requests]

    return asyncio.run(exchange())


def test_a_key_is_long_random_and_kept_only_as_its_hash() -> None:
    assert len({new_key() for _ in range(100)}) == 100
    assert re.fullmatch(r"ikp_[A-Za-z0-9_-]{43}", KEY)
    assert key_hash(KEY) == hashlib.sha256(KEY.encode()).hexdigest()


def test_the_command_makes_a_key_that_opens_the_service(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["keys", "new", "--name", "cell-7"]) == 0
    key_line, hash_line = capsys.readouterr().out.splitlines()
    key, setting = key_line.split()[-1], hash_line.split("IKPLAN_API_KEYS=")[1]
    assert setting.startswith("cell-7:")
    (answer,) = ask(app_with(api_keys=setting), ("GET", "/v1/solvers", bearer(key)))
    assert answer.status_code == 200
    assert main(["keys", "new", "--name", "a:b"]) == 2


@pytest.mark.parametrize(
    "headers",
    [
        {},
        bearer(""),
        bearer(new_key()),
        bearer(key_hash(KEY)),
        bearer(KEY[:-1]),
        bearer(KEY + "x"),
        {"authorization": KEY},
        {"authorization": f"Basic {KEY}"},
        {"authorization": "Bearer"},
        {"x-api-key": KEY},
    ],
)
def test_without_a_known_key_nothing_is_told(headers: dict[str, str]) -> None:
    app = app_with(api_keys=KEYS)
    paths = ["/v1/robots", "/v1/plans/x", "/metrics", "/nowhere"]
    for answer in ask(app, *(("GET", path, headers) for path in paths)):
        assert answer.status_code == 401
        problem = answer.json()
        assert problem["type"] == "urn:ikplan:access-denied"
        assert answer.headers["www-authenticate"].startswith("Bearer")
        assert answer.headers["x-request-id"] in problem["instance"]
        assert KEY not in answer.text


def test_a_body_is_not_read_before_the_key_is_known() -> None:
    statuses = []

    async def receive() -> Message:
        raise AssertionError("read")

    async def send(message: Message) -> None:
        statuses.append(message.get("status"))

    scope = {
        "type": "http", "method": "POST", "path": "/v1/plans", "raw_path": b"/v1/plans",
        "query_string": b"", "headers": [(b"content-type", b"application/json")],
        "http_version": "1.1", "scheme": "http", "server": ("127.0.0.1", 80),
        "client": ("127.0.0.1", 1), "root_path": "",
    }  # fmt: skip
    asyncio.run(app_with(api_keys=KEYS)(scope, receive, send))
    assert statuses[0] == 401


@pytest.mark.parametrize("key", [KEY, OTHER], ids=["first", "second"])
def test_every_known_key_opens_everything(key: str) -> None:
    app = app_with(api_keys=KEYS)
    for answer in ask(app, ("GET", "/v1/solvers", bearer(key)), ("GET", "/nowhere", bearer(key))):
        assert answer.status_code in (200, 404)


def test_every_hash_is_compared_whichever_key_is_shown(monkeypatch: pytest.MonkeyPatch) -> None:
    compared = []

    def compare(known: str, asked: str) -> bool:
        compared.append(known)
        return known == asked

    monkeypatch.setattr(hmac, "compare_digest", compare)
    app = app_with(api_keys=KEYS)
    for key in (KEY, OTHER, new_key()):
        compared.clear()
        ask(app, ("GET", "/v1/solvers", bearer(key)))
        assert compared == [key_hash(KEY), key_hash(OTHER)]


def test_probes_and_pages_need_no_key() -> None:
    for answer in ask(app_with(api_keys=KEYS), *(("GET", path, {}) for path in OPEN)):
        assert answer.status_code in (200, 404)


def test_the_clients_show_the_key_they_are_given_or_find(monkeypatch: pytest.MonkeyPatch) -> None:
    app = app_with(api_keys=KEYS)
    transport = httpx.ASGITransport(app)

    async def solvers(**key: Any) -> list[Any]:
        async with AsyncClient(ADDRESS, transport=transport, **key) as client:
            return await client.solvers()

    monkeypatch.delenv("IKPLAN_KEY", raising=False)
    with pytest.raises(AccessDenied, match="an API key is required"):
        asyncio.run(solvers())
    with pytest.raises(AccessDenied, match="invalid API key"):
        asyncio.run(solvers(key="x"))
    assert asyncio.run(solvers(key=KEY))
    monkeypatch.setenv("IKPLAN_KEY", OTHER)
    assert asyncio.run(solvers())
    for made in (Client, AsyncClient):
        with pytest.raises(InvalidRequest, match="printable"):
            made(ADDRESS, key="a\nb")


def test_a_key_that_asks_too_often_has_to_wait_and_others_need_not() -> None:
    app = app_with(api_keys=KEYS, rate_limit="2/minute")
    once = ("GET", "/v1/solvers", bearer(KEY))
    *fine, refused, probe, other = ask(
        app, once, once, once, ("GET", "/livez", bearer(KEY)), (*once[:2], bearer(OTHER))
    )
    assert [a.status_code for a in fine] == [200, 200]
    assert refused.status_code == 429
    assert 1 <= int(refused.headers["retry-after"]) <= 60
    assert refused.json()["type"] == "urn:ikplan:rate-limited"
    assert refused.json()["limit"] == "2 per 1 minute"
    assert (probe.status_code, other.status_code) == (200, 200)

    async def client_call() -> None:
        transport = httpx.ASGITransport(app)
        async with AsyncClient(ADDRESS, transport=transport, key=KEY, retries=0) as client:
            await client.solvers()

    with pytest.raises(RateLimited) as caught:
        asyncio.run(client_call())
    assert caught.value.retry_after_s > 0


@pytest.mark.parametrize(
    ("host", "status"),
    [
        ("127.0.0.1", 200),
        ("[::1]", 200),
        ("10.0.0.7", 403),
        ("[::ffff:10.0.0.7]", 403),
        ("0.0.0.0", 403),
    ],
)
def test_without_keys_only_loopback_connections_are_answered(host: str, status: int) -> None:
    async def exchange() -> httpx.Response:
        carrier = httpx.ASGITransport(app_with())
        async with httpx.AsyncClient(transport=carrier, base_url=f"http://{host}:8000") as http:
            assert (await http.get("/livez")).status_code == 200
            return await http.get("/v1/solvers")

    answer = asyncio.run(exchange())
    assert answer.status_code == status
    if status == 403:
        assert answer.json()["type"] == "urn:ikplan:access-denied"
        assert "www-authenticate" not in answer.headers


@pytest.mark.parametrize("host", ["127.0.0.1", "127.1.2.3", "localhost", "::1", "[::1]",
                                  "::ffff:127.0.0.1"])  # fmt: skip
def test_loopback_needs_no_keys(host: str) -> None:
    assert is_loopback(host)
    Settings(host=host)


@pytest.mark.parametrize(
    "host", ["0.0.0.0", "", "::", "192.168.1.5", "cell.example", "127.0.0.1.x"]
)
def test_beyond_loopback_the_service_does_not_start_without_keys(
    host: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("IKPLAN_HOST", host)
    with pytest.raises(InvalidRequest, match="IKPLAN_API_KEYS must contain"):
        create_app()
    monkeypatch.setenv("IKPLAN_API_KEYS", KEYS)
    assert [key.name for key in load_settings().api_keys] == ["cell", "key-2"]


def test_the_command_that_serves_refuses_too(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    for variable in ("IKPLAN_HOST", "IKPLAN_PORT"):  # what it sets for the service
        monkeypatch.setenv(variable, "")
    assert main(["serve", "--host", "0.0.0.0", "--port", "0"]) == 2
    (line,) = capsys.readouterr().err.splitlines()
    assert "IKPLAN_API_KEYS must contain the hash of at least one key" in line


@pytest.mark.parametrize(
    ("variable", "value", "said"),
    [
        ("IKPLAN_API_KEYS", KEY, "entry 1 is not a SHA-256"),
        ("IKPLAN_API_KEYS", f"{key_hash(KEY)},x", "entry 2"),
        ("IKPLAN_API_KEYS", f"a:{key_hash(KEY)},a:{key_hash(OTHER)}", "the same name"),
        ("IKPLAN_RATE_LIMIT", "often", "give a rate such as"),
        ("IKPLAN_RATE_LIMIT", "0/minute", "at least 1 request"),
        ("IKPLAN_CORS_ORIGINS", "*", "every web page"),
        ("IKPLAN_CORS_ORIGINS", "https://a.example, b.example", "'b.example'"),
        ("IKPLAN_CORS_ORIGINS", "https://a.example/path", "is not an origin"),
    ],
    ids=range(8),  # the keys are new ones in each process
)
def test_unsafe_settings_are_refused_by_name_without_repeating_secrets(
    variable: str, value: str, said: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv(variable, value)
    with pytest.raises(InvalidRequest, match=re.escape(said)) as caught:
        create_app()
    assert caught.value.field == variable
    assert KEY not in str(caught.value)
    assert KEY not in str(caught.value.errors)


PAGE = {"origin": "https://cell.example"}
LEAVE = {
    **PAGE,
    "access-control-request-method": "POST",
    "access-control-request-headers": "authorization,content-type",
}


def test_other_origins_may_not_ask_unless_they_are_named() -> None:
    closed, opened = app_with(), app_with(cors_origins="https://cell.example", api_keys=KEYS)
    for answer in ask(closed, ("GET", "/v1/solvers", PAGE), ("OPTIONS", "/v1/plans", LEAVE)):
        assert not [name for name in answer.headers if name.startswith("access-control")]
    leave, answer, stranger = ask(
        opened,
        ("OPTIONS", "/v1/plans", LEAVE),
        ("GET", "/v1/solvers", {**PAGE, **bearer(KEY)}),
        ("GET", "/v1/solvers", {"origin": "https://evil.example", **bearer(KEY)}),
    )
    assert leave.status_code == 200
    assert leave.headers["access-control-allow-origin"] == PAGE["origin"]
    assert "authorization" in leave.headers["access-control-allow-headers"]
    assert answer.headers["access-control-allow-origin"] == PAGE["origin"]
    assert "access-control-allow-origin" not in stranger.headers


def test_every_answer_tells_browsers_what_not_to_do() -> None:
    app = app_with(api_keys=KEYS)
    paths = ["/docs", "/livez", "/v1/solvers", "/nowhere"]
    for answer in ask(app, *(("GET", path, bearer(KEY)) for path in paths)):
        assert answer.headers["x-content-type-options"] == "nosniff"
        assert answer.headers["x-frame-options"] == "DENY"
        assert answer.headers["referrer-policy"] == "no-referrer"
        assert "default-src 'none'" in answer.headers["content-security-policy"]
        assert len(answer.headers.get_list("content-security-policy")) == 1


def test_the_document_tells_where_a_key_is_needed(http: httpx.Client) -> None:
    document = http.get("/openapi.json").json()
    assert document["components"]["securitySchemes"]["key"]["scheme"] == "bearer"
    for path, methods in document["paths"].items():
        for operation in methods.values():
            assert ("security" in operation) == path.startswith("/v1/")
            assert ({"401", "429"} <= operation["responses"].keys()) == path.startswith("/v1/")
