"""``IKPLAN_SERVER``: the service that a user has set plans, if it runs."""

from __future__ import annotations

import argparse
import socket
from collections.abc import Iterator

import pytest

from ikplan.cli.parser import make_parser
from ikplan.cli.requests.service import choose_service
from ikplan.errors import InvalidRequest


@pytest.fixture
def listening() -> Iterator[str]:
    with socket.create_server(("127.0.0.1", 0)) as server:
        yield f"http://127.0.0.1:{server.getsockname()[1]}"


def parsed(*arguments: str) -> argparse.Namespace:
    options = make_parser().parse_args([*arguments])
    choose_service(options)
    return options


@pytest.mark.parametrize("command", [("plan", "a"), ("batch", "a"), ("time", "a")])
def test_a_service_that_runs_is_used(
    command: tuple[str, ...], listening: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("IKPLAN_SERVER", listening)
    assert parsed(*command).server == listening
    assert parsed(*command, "--server", "http://other").server == "http://other"
    assert parsed(*command, "--server", "").server is None


def test_a_robot_is_uploaded_only_where_it_is_asked_for(
    listening: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("IKPLAN_SERVER", listening)
    assert parsed("robots-add", "a.urdf").server is None
    assert not hasattr(parsed("fk", "ur5", "0"), "server")


def test_without_the_variable_nothing_is_asked(monkeypatch: pytest.MonkeyPatch) -> None:
    for value in (None, ""):
        if value is None:
            monkeypatch.delenv("IKPLAN_SERVER", raising=False)
        else:
            monkeypatch.setenv("IKPLAN_SERVER", value)
        assert parsed("plan", "a").server is None


def test_a_service_that_does_not_run_is_told_of(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    with socket.create_server(("127.0.0.1", 0)) as gone:
        address = f"http://127.0.0.1:{gone.getsockname()[1]}"
    monkeypatch.setenv("IKPLAN_SERVER", address)
    assert parsed("plan", "a").server is None
    said = capsys.readouterr().err
    assert said == f"ikplan: no service at {address} (IKPLAN_SERVER): planning here\n"
    assert parsed("plan", "a", "-q").server is None
    assert capsys.readouterr().err == ""


@pytest.mark.parametrize("value", ["127.0.0.1:8000", "http://", "http://a:b", "ftp://a"])
def test_what_is_no_address_is_refused(value: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("IKPLAN_SERVER", value)
    with pytest.raises(InvalidRequest, match=r"http://127\.0\.0\.1:8000"):
        parsed("plan", "a")
