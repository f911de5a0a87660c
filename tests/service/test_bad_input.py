"""A wrong request gets the same verdict in Python, in the shell, over HTTP and by the client."""

import io
import json
from pathlib import Path
from typing import Any

import httpx
import pytest

import ikplan
from ikplan import (
    BudgetExceeded,
    Client,
    Disconnected,
    InvalidRequest,
    TimingFailed,
    Unreachable,
)
from ikplan.cli import main
from ikplan.errors import IkplanError, error_from_problem

from .bad_requests import BAD, NOT_FINITE, NOT_JSON, Bad

JSON = {"content-type": "application/json"}


def by_http(http: httpx.Client, body: bytes, path: str = "/v1/plans") -> IkplanError:
    answer = http.post(path, content=body, headers=JSON)
    assert answer.headers["content-type"] == "application/problem+json"
    problem = answer.json()
    assert problem["status"] == answer.status_code
    return error_from_problem(problem)


def by_shell(
    body: bytes,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
    *,
    code: int = 2,
    repairs: int = 0,
) -> str:
    """The line that the command writes on stderr before the repairs."""
    capsys.readouterr()
    monkeypatch.setattr("sys.stdin", io.TextIOWrapper(io.BytesIO(body)))
    assert main(["plan", "-"]) == code
    output = capsys.readouterr()
    assert output.out == ""
    line, *others = output.err.splitlines()
    assert len(others) == (repairs + 1 if repairs else 0)
    assert "Traceback" not in output.err
    return line


@pytest.mark.parametrize("bad", BAD, ids=lambda b: b.name)
def test_every_way_tells_the_same_error(
    bad: Bad,
    http: httpx.Client,
    client: Client,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    body = json.dumps(bad.document).encode()
    with pytest.raises(IkplanError) as caught:
        ikplan.plan(bad.document)
    error = caught.value
    assert type(error) is bad.error
    for word in bad.words:
        assert word in error.detail
    assert {key: error.data[key] for key in bad.data} == bad.data
    assert bad.check(error)

    told = by_http(http, body)
    assert type(told) is bad.error
    assert told.to_problem() == json.loads(json.dumps(error.to_problem()))

    with pytest.raises(IkplanError) as caught:
        client.plan(bad.document)
    assert caught.value.to_problem() == told.to_problem()

    no_plan = isinstance(error, Unreachable | Disconnected | TimingFailed | BudgetExceeded)
    repairs = len(getattr(error, "repairs", []))
    line = by_shell(body, monkeypatch, capsys, code=1 if no_plan else 2, repairs=repairs)
    assert line == f"ikplan: {error.slug}: {' '.join(error.detail.split())}"


@pytest.mark.parametrize("bad", NOT_FINITE, ids=lambda b: b.name)
def test_what_is_not_finite_is_refused_everywhere(
    bad: Bad,
    http: httpx.Client,
    client: Client,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    body = json.dumps(bad.document).encode()
    assert b"NaN" in body or b"Infinity" in body
    with pytest.raises(InvalidRequest) as local:
        ikplan.plan(bad.document)
    with pytest.raises(InvalidRequest) as remote:
        client.plan(bad.document)
    assert local.value.field == remote.value.field != ""
    assert type(by_http(http, body)) is InvalidRequest
    assert "ikplan: invalid-request: " in by_shell(body, monkeypatch, capsys)


@pytest.mark.parametrize("body", [b for _, b in NOT_JSON], ids=[n for n, _ in NOT_JSON])
def test_what_is_not_json_is_refused_everywhere(
    body: bytes,
    http: httpx.Client,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    errors = [by_http(http, body, path) for path in ("/v1/plans", "/v1/ik", "/v1/fk")]
    assert {type(e) for e in errors} == {InvalidRequest}
    line = by_shell(body, monkeypatch, capsys)
    assert line == f"ikplan: invalid-request: {errors[0].detail}"


def test_the_place_of_malformed_json_is_told(http: httpx.Client) -> None:
    error = by_http(http, b'{"robot": "iiwa14",\n  "path": }')
    assert "line 2, column 11" in error.detail


@pytest.mark.parametrize(
    ("path", "document", "field"),
    [
        ("/v1/fk", {"robot": "ur5", "q": [0.0] * 5}, "q"),
        ("/v1/fk", {"robot": "ur5"}, "q"),
        ("/v1/ik", {"robot": "ur5", "position": [0.1, 0.2]}, "position"),
        ("/v1/ik", {"robot": "ur5", "position": [0.1, 0.2, 0.3], "start": [0.0]}, "start"),
        ("/v1/ik", {"robot": "ur5", "position": [0.1, 0.2, 0.3], "ik": {"seed": -1}}, "ik.seed"),
    ],
)
def test_single_poses_name_the_wrong_field(
    path: str, document: dict[str, Any], field: str, http: httpx.Client
) -> None:
    error = by_http(http, json.dumps(document).encode(), path)
    assert isinstance(error, InvalidRequest)
    assert error.field == field


@pytest.mark.parametrize("path", ["/v1/fk", "/v1/ik", "/v1/plans"])
def test_no_name_reaches_a_file(path: str, http: httpx.Client, tmp_path: Path) -> None:
    urdf = tmp_path / "mine.urdf"
    urdf.write_text("<robot name='mine'/>")
    document = {
        "robot": str(urdf),
        "q": [0.0],
        "position": [0.0, 0.0, 1.0],
        "path": {"waypoints": [{"position": [0.0, 0.0, 1.0]}]},
    }
    wanted = {"/v1/fk": ("q",), "/v1/ik": ("position",), "/v1/plans": ("path",)}[path]
    document = {key: document[key] for key in ("robot", *wanted)}
    error = by_http(http, json.dumps(document).encode(), path)
    assert type(error).__name__ == "RobotNotFound"
