"""Once over a real socket: the command that serves, the clients, the shell, the signal to stop."""

import asyncio
import contextlib
import io
import json
import os
import re
import signal
import socket
import subprocess
import sys
import threading
import time
from collections.abc import Iterator
from pathlib import Path

import httpx
import pytest

import ikplan
from ikplan import AsyncClient, Client, RobotNotFound, ServiceUnavailable
from ikplan.cli import main, serving
from ikplan.plans.export import encode
from tests.measured import waypoint_errors

from .bad_requests import GOOD
from .serving import WAIT_S, bound_s


@contextlib.contextmanager
def service() -> Iterator[tuple[subprocess.Popen[str], str]]:
    """A service on a free port, as its own process; it is stopped whatever happens."""
    arguments = ["-m", "ikplan", "serve", "--port", "0", "--workers", "1"]
    process = subprocess.Popen([sys.executable, *arguments], stderr=subprocess.PIPE, text=True)
    assert process.stderr is not None
    overdue = threading.Timer(WAIT_S, process.kill)
    overdue.start()
    said = []
    try:
        for line in process.stderr:
            said.append(line)
            if match := re.search(r"http://127\.0\.0\.1:\d+", line):
                break
        else:
            raise AssertionError("".join(said))
        overdue.cancel()
        drain = threading.Thread(target=process.stderr.read)
        drain.start()
        yield process, match[0]
        process.kill()
        drain.join()
    finally:
        overdue.cancel()
        process.kill()
        process.wait()
        process.stderr.close()


@pytest.fixture(scope="module")
def address() -> Iterator[str]:
    with service() as (_, address):
        assert httpx.get(f"{address}/livez").status_code == 200
        deadline = time.monotonic() + WAIT_S
        with httpx.Client(base_url=address) as client:
            while client.get("/readyz").status_code != 200:
                assert time.monotonic() < deadline
                time.sleep(0.1)
        yield address


def test_the_clients_get_the_plan_that_python_makes(address: str) -> None:
    async def twin() -> ikplan.Plan:
        async with AsyncClient(address) as client:
            return await client.plan(GOOD)

    with Client(address) as client:
        plans = [client.plan(GOOD), client.get_plan(client.plan(GOOD).id), asyncio.run(twin())]
        with pytest.raises(RobotNotFound, match="iiwa14"):
            client.plan({**GOOD, "robot": "iiwa41"})
    local = ikplan.plan(GOOD)
    assert {encode(plan, "npz") for plan in plans} == {encode(local, "npz")}


def test_the_command_plans_by_the_service(
    address: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    request, out = tmp_path / "request.json", tmp_path / "plan.csv"
    request.write_text(json.dumps(GOOD))
    assert main(["plan", str(request), "--server", address, "-o", str(out)]) == 0
    assert out.read_bytes() == encode(ikplan.plan(GOOD), "csv")
    request.write_text(json.dumps({**GOOD, "start": [0.0]}))
    capsys.readouterr()
    assert main(["plan", str(request), "--server", address]) == 2
    assert capsys.readouterr().err.startswith("ikplan: invalid-request: start")


def test_the_service_that_a_user_has_set_plans_without_a_compiler_here(
    address: str, tmp_path: Path
) -> None:
    request = tmp_path / "request.json"
    request.write_text(json.dumps(GOOD))
    code = (
        "import sys; from ikplan.cli import main\n"
        f"assert main(['plan', {str(request)!r}, '--json', '-q']) == 0\n"
        "print(sorted({'numba', 'pinocchio', 'scipy', 'toppra'} & {*sys.modules}), file=sys.stderr)"
    )
    done = subprocess.run(
        [sys.executable, "-c", code],
        env={**os.environ, "IKPLAN_SERVER": address},
        capture_output=True,
        text=True,
        check=True,
    )
    assert json.loads(done.stdout)["id"] == ikplan.plan(GOOD).id
    assert done.stderr == "[]\n"


def test_the_command_shows_the_progress_of_a_service(
    address: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    class Terminal(io.StringIO):
        def isatty(self) -> bool:
            return True

    terminal = Terminal()
    monkeypatch.setattr(sys, "stderr", terminal)
    request, out = tmp_path / "request.json", tmp_path / "plan.csv"
    new = {**GOOD, "ik": {"seed": 77}}
    request.write_text(json.dumps(new))
    assert main(["plan", str(request), "--server", address, "-o", str(out)]) == 0
    assert out.read_bytes() == encode(ikplan.plan(new), "csv")
    assert re.search(r"(ik|certificate|finished) \d", terminal.getvalue())


def test_timing_shows_the_progress_of_a_service_too(
    address: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    class Terminal(io.StringIO):
        def isatty(self) -> bool:
            return True

    monkeypatch.setattr(sys, "stderr", terminal := Terminal())
    document = {"robot": "ur5", "waypoints": [[0.0] * 6, [0.3] * 6], "sampling": {"rate_hz": 99}}
    request, out = tmp_path / "request.json", tmp_path / "plan.csv"
    request.write_text(json.dumps(document))
    assert main(["time", str(request), "--server", address, "-o", str(out)]) == 0
    assert out.read_bytes() == encode(ikplan.time_request(document), "csv")
    assert re.search(r"(queued|planning|timing|certificate|finished) \d", terminal.getvalue())


def test_events_come_while_the_plan_is_made_and_a_caller_who_leaves_ends_it(address: str) -> None:
    slow = {
        **GOOD,
        "path": {"waypoints": [{"position": [0.5, 0.01 * i, 0.5]} for i in range(50)]},
        "ik": {"population": 1000, "iterations": 1000},
        "budget_s": 100,
    }
    with Client(address) as client:
        job = client.submit(slow)
        heard = []

        class Enough(Exception):
            pass

        def hear(status: ikplan.PlanStatus) -> None:
            heard.append(status)
            if status.done >= 1:
                raise Enough

        with pytest.raises(Enough):
            job.wait(progress=hear)
        assert heard[-1].stage == "ik"
        assert heard[-1].total == 50
        begin = time.monotonic()
        assert client.version()["version"] == ikplan.__version__
        assert time.monotonic() - begin < bound_s(2.0)
        job.cancel()
        with pytest.raises(httpx.ReadTimeout):
            httpx.post(f"{address}/v1/plans", json=slow, timeout=httpx.Timeout(WAIT_S, read=1.0))
        # The only worker is free again.
        plan = client.plan({**GOOD, "ik": {"seed": 78}})
        assert waypoint_errors(plan, GOOD["path"]).max() <= 1e-8


def test_raw_bytes_do_not_disturb_the_service(address: str) -> None:
    host, port = address.removeprefix("http://").split(":")
    for noise in (b"\x00" * 100, b"POST /v1/plans HTTP/1.1\r\ncontent-length: x\r\n\r\n"):
        with socket.create_connection((host, int(port)), timeout=WAIT_S) as raw:
            raw.sendall(noise)
            raw.shutdown(socket.SHUT_WR)
            while raw.recv(4096):
                pass
    assert httpx.get(f"{address}/livez").json() == {"status": "alive"}


def test_a_taken_port_is_told_in_one_line(capsys: pytest.CaptureFixture[str]) -> None:
    with socket.create_server(("127.0.0.1", 0)) as other:
        port = other.getsockname()[1]
        assert main(["serve", "--port", str(port)]) == 2
    (line,) = capsys.readouterr().err.splitlines()
    assert line.startswith(f"ikplan: file-error: cannot listen on 127.0.0.1 port {port}: ")


def test_an_interrupt_stops_the_service_cleanly() -> None:
    with service() as (process, address):
        assert httpx.get(f"{address}/livez", timeout=WAIT_S).status_code == 200
        process.send_signal(signal.SIGINT)
        begin = time.monotonic()
        assert process.wait(timeout=WAIT_S) == 0
        assert time.monotonic() - begin < bound_s(10.0)  # its worker still loads kernels
        with Client(address) as client, pytest.raises(ServiceUnavailable, match="cannot reach"):
            client.version()


def test_short_answers_do_not_wait_for_more_to_send() -> None:
    with (
        serving._listen("127.0.0.1", 0) as listening,
        socket.create_connection(listening.getsockname()[:2]),
        listening.accept()[0] as connection,
    ):
        assert connection.getsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY)
