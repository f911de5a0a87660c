"""Everything that the README shows is run."""

from __future__ import annotations

import json
import re
import shlex
import socket
import threading
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import httpx
import pytest
import uvicorn

from ikplan import Plan, load_robot
from ikplan.cli import main
from ikplan.documents import parse
from ikplan.documents.plan_request import PlanRequest
from ikplan.pipeline.plan import plan
from tests.measured import check_motion, waypoint_errors

ROOT = Path(__file__).parents[2]
README = (ROOT / "README.md").read_text()
BLOCKS = re.findall(r"^```(\w+)\n(.*?)^```$", README, re.MULTILINE | re.DOTALL)
PORT = "http://127.0.0.1:8000"


def blocks(language: str) -> list[str]:
    found = [text for kind, text in BLOCKS if kind == language]
    assert found, f"the README has no {language} block"
    return found


def commands(program: str) -> list[str]:
    lines = [line.split("  #")[0].strip() for text in blocks("sh") for line in text.splitlines()]
    return [line.rstrip("& ").strip() for line in lines if line.startswith(program)]


@pytest.fixture(scope="module")
def service() -> Iterator[str]:
    """The address of a service on a free port of the loopback."""
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        port = probe.getsockname()[1]
    config = uvicorn.Config(
        "ikplan_api.app:create_app", factory=True, host="127.0.0.1", port=port, log_level="error"
    )
    server = uvicorn.Server(config)
    thread = threading.Thread(target=server.run)
    thread.start()
    deadline = time.monotonic() + 120
    while not server.started and time.monotonic() < deadline:
        time.sleep(0.05)
    assert server.started
    yield f"http://127.0.0.1:{port}"
    server.should_exit = True
    thread.join(30)


@pytest.fixture
def checkout(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A folder with the examples, to write into."""
    (tmp_path / "examples").symlink_to(ROOT / "examples")
    monkeypatch.chdir(tmp_path)
    return tmp_path


def check_plan(made: Plan, document: dict[str, Any]) -> None:
    """The motion is one, and meets the waypoints where the path is given by them."""
    robot, tool = load_robot(made.robot), document.get("tool")
    if tool:
        robot = robot.with_tool(tool["position"], tool.get("quaternion_xyzw", [0, 0, 0, 1]))
    check_motion(made.trajectory, robot)
    if "waypoints" in document["path"]:
        assert waypoint_errors(made, document["path"], robot).max() <= 1e-6


@pytest.mark.usefixtures("checkout")
@pytest.mark.filterwarnings("ignore:unclosed file:ResourceWarning")  # of a line for readers
@pytest.mark.parametrize("code", blocks("python"))
def test_python_runs(code: str, service: str) -> None:
    exec(compile(code.replace(PORT, service), "README.md", "exec"), {"__name__": "__main__"})


@pytest.mark.parametrize(
    "line", [c for c in commands("ikplan") if not c.startswith("ikplan serve")]
)
def test_shell_commands_run(line: str, checkout: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(shlex.split(line)[1:]) == 0
    assert capsys.readouterr().out
    if "-o plan.json" in line:
        assert (checkout / "plan.json").stat().st_size > 0
        assert (checkout / "plan.png").stat().st_size > 0


def test_the_curl_line_gets_a_plan(service: str) -> None:
    (line,) = commands("curl")
    words = shlex.split(line)
    url = next(w for w in words if w.startswith("http")).replace(PORT, service)
    body = (ROOT / words[words.index("--data") + 1].lstrip("@")).read_bytes()
    header = words[words.index("-H") + 1].split(": ")
    answer = httpx.post(url, content=body, headers=[(header[0], header[1])], timeout=60)
    assert answer.status_code == 200
    check_plan(Plan.load(answer.content), json.loads(body))


@pytest.mark.parametrize("text", blocks("json"))
def test_the_requests_shown_are_planned(text: str) -> None:
    document = json.loads(text)
    check_plan(plan(parse(PlanRequest, document)), document)


def test_make_targets_shown_exist() -> None:
    makefile = (ROOT / "Makefile").read_text()
    shown = set(re.findall(r"make ([a-z]+)", README))
    assert shown
    for target in shown:
        assert re.search(rf"^{target}:", makefile, re.MULTILINE), target


def test_links_lead_somewhere() -> None:
    for link in re.findall(r"\]\(([^)]+)\)", README):
        assert (ROOT / link).exists(), link


def test_every_error_class_shown_exists() -> None:
    import ikplan

    table = README.split("## Errors")[1].split("##")[0]
    for name in re.findall(r"^\| `(\w+)`|, `(\w+)` \|", table, re.MULTILINE):
        assert issubclass(getattr(ikplan, name[0] or name[1]), ikplan.IkplanError)
