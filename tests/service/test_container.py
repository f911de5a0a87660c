"""No container engine is needed to see that the files fit the checkout."""

import fnmatch
import json
import os
import re
import runpy
import shlex
import socket
import subprocess
import sys
import threading
from http.server import BaseHTTPRequestHandler, HTTPServer
from pathlib import Path

import pytest
import yaml

import ikplan
from ikplan.errors import InvalidRequest
from ikplan_api.settings import Settings, load_settings
from tests.present import present

ROOT = Path(__file__).parents[2]
DOCKERFILE = (ROOT / "docker/Dockerfile").read_text()
BUILDER, RUNTIME = DOCKERFILE.split("\nFROM ")[-2:]
COMPOSE = yaml.safe_load((ROOT / "docker/compose.yaml").read_text())


def copied() -> list[str]:
    """Paths of the checkout that the Dockerfile copies."""
    paths = []
    for line in re.findall(r"^COPY (?!--from)(.+)$", DOCKERFILE, re.MULTILINE):
        paths += shlex.split(line)[:-1]
    return paths


def test_every_path_that_is_copied_exists() -> None:
    assert len(copied()) >= 6
    for path in copied():
        assert (ROOT / path).exists(), path


def test_the_context_holds_what_is_copied_and_little_more() -> None:
    lines = (ROOT / ".dockerignore").read_text().split()
    allowed = {line[1:] for line in lines if line.startswith("!")}
    assert allowed == set(copied())
    assert "*" in lines


def test_the_package_is_built_from_what_is_copied() -> None:
    build = (ROOT / "pyproject.toml").read_text()
    for folder in re.findall(r'"(ikplan|api/ikplan_api)"', build):
        assert any(fnmatch.fnmatch(folder, f"{c}*") for c in copied())


def line_of(pattern: str) -> re.Match[str]:
    """The line of the Dockerfile that is like this."""
    return present(re.search(pattern, RUNTIME, re.MULTILINE))


def test_the_service_does_not_run_as_root() -> None:
    user, group = line_of(r"^USER (\d+):(\d+)$").groups()
    assert int(user) > 0
    assert f"--uid {user} --gid {group} " in RUNTIME


def test_kernels_are_compiled_for_the_folder_and_processor_they_are_used_with() -> None:
    assert "NUMBA_CPU_NAME=generic" in BUILDER
    assert "NUMBA_CPU_NAME=generic" in RUNTIME
    assert "docker/warm.py /opt/ikplan/ikplan/kernels.pack" in BUILDER


def test_every_stage_begins_with_one_base_that_a_digest_can_pin() -> None:
    before, *stages = re.split(r"^FROM ", DOCKERFILE, flags=re.MULTILINE)
    (base,) = re.findall(r"^ARG BASE=(\S+)$", before, re.MULTILINE)
    python = runpy.run_path(str(ROOT / "docker/lock.py"))["PYTHON"]
    assert base.startswith(f"python:{python}-")
    names: set[str] = set()
    for stage in stages:
        image, *name = stage.splitlines()[0].split(" AS ")
        assert image == "${BASE}" or image in names
        names |= set(name)
    readme = (ROOT / "docker/README.md").read_text()
    assert f"--build-arg BASE={base}@sha256:" in readme


def test_the_image_keeps_plans_where_its_user_may_write() -> None:
    (volume,) = json.loads(line_of(r"^VOLUME (.+)$")[1])
    store = Path(image_settings()["IKPLAN_STORE_PATH"])
    assert store.parent == Path(volume)
    assert re.search(rf"install --directory --owner 10001 .* {volume}$", RUNTIME, re.MULTILINE)


def image_settings() -> dict[str, str]:
    """The service's settings that the image sets."""
    return dict(re.findall(r"\b(IKPLAN_\w+)=(\S+)", RUNTIME))


def test_the_image_does_not_start_without_a_key(monkeypatch: pytest.MonkeyPatch) -> None:
    for name, value in image_settings().items():
        monkeypatch.setenv(name, value)
    with pytest.raises(InvalidRequest, match="IKPLAN_API_KEYS"):
        load_settings()
    monkeypatch.setenv("IKPLAN_API_KEYS", "cell-7:" + "0" * 64)
    assert load_settings().host == "0.0.0.0"


def test_the_labels_tell_the_version() -> None:
    assert f'image.version="{ikplan.__version__}"' in RUNTIME


def health_check() -> list[str]:
    command: list[str] = json.loads(line_of(r"^ +CMD (\[.+\])$")[1])
    return command


@pytest.mark.parametrize(("status", "healthy"), [(200, True), (503, False)])
def test_the_health_check_asks_readyz(status: int, healthy: bool) -> None:
    asked = []

    class Answers(BaseHTTPRequestHandler):
        def do_GET(self) -> None:
            asked.append(self.path)
            self.send_response(status)
            self.end_headers()

        def log_message(self, *_: object) -> None:
            pass

    with HTTPServer(("127.0.0.1", 0), Answers) as server:
        thread = threading.Thread(target=server.handle_request)
        thread.start()
        _, *arguments = health_check()
        environment = {"IKPLAN_PORT": str(server.server_port)}
        done = subprocess.run([sys.executable, *arguments], env=environment, check=False)
        thread.join()
    assert asked == ["/readyz"]
    assert (done.returncode == 0) == healthy


def test_the_health_check_fails_where_nobody_listens() -> None:
    with socket.socket() as taken:
        taken.bind(("127.0.0.1", 0))
        environment = {"IKPLAN_PORT": str(taken.getsockname()[1])}
        _, *arguments = health_check()
        command = [sys.executable, *arguments]
        done = subprocess.run(command, env=environment, check=False, stderr=subprocess.DEVNULL)
    assert done.returncode == 1


@pytest.mark.parametrize(
    ("key", "value"),
    [
        ("read_only", True),
        ("cap_drop", ["ALL"]),
        ("tmpfs", ["/tmp:size=64m"]),
        ("security_opt", ["no-new-privileges:true"]),
        ("user", "10001:10001"),
    ],
)
def test_compose_takes_every_right_away(key: str, value: object) -> None:
    (service,) = COMPOSE["services"].values()
    assert service[key] == value


def seconds(text: str) -> int:
    return int(text.removesuffix("s"))


def test_compose_gives_the_service_the_time_to_stop() -> None:
    (service,) = COMPOSE["services"].values()
    assert seconds(service["stop_grace_period"]) >= Settings().stop_s + 5


def test_the_image_takes_what_an_extra_needs_where_it_is_asked_for() -> None:
    (command,) = re.findall(r"^RUN (set -- (?:.+\\\n)+.+)$", DOCKERFILE, re.MULTILINE)
    own, extra = "docker/requirements.txt", "docker/requirements-otel.txt"
    for extras, wanted in ((None, [own]), ("", [own]), ("otel", [own, extra])):
        given = {} if extras is None else {"EXTRAS": extras}
        environment = {"PATH": os.environ["PATH"], **given}
        # Not installed but told: a function in the place of pip.
        script = f"pip() {{ printf '%s\\n' \"$@\"; }}\n{command}"
        done = subprocess.run(
            ["sh", "-c", script], cwd=ROOT, env=environment, capture_output=True, check=True
        )
        words = done.stdout.decode().split()
        assert words[:2] == ["install", "--require-hashes"]
        assert words[2:] == [word for path in wanted for word in ("--requirement", path)]


def test_compose_listens_on_this_machine_only_and_builds_this_dockerfile() -> None:
    (service,) = COMPOSE["services"].values()
    assert all(port.startswith("127.0.0.1:") for port in service["ports"])
    context = ROOT / "docker" / service["build"]["context"]
    assert (context / service["build"]["dockerfile"]).resolve() == ROOT / "docker/Dockerfile"


def test_compose_keeps_plans_and_jobs_and_asks_for_keys() -> None:
    (service,) = COMPOSE["services"].values()
    (volume,) = service["volumes"]
    name, _, folder = volume.partition(":")
    assert name in COMPOSE["volumes"]
    assert image_settings()["IKPLAN_STORE_PATH"].startswith(f"{folder}/")
    assert service["environment"]["IKPLAN_API_KEYS"].startswith("${IKPLAN_API_KEYS:?")


def test_what_compose_sets_are_settings_of_the_service() -> None:
    (service,) = COMPOSE["services"].values()
    known = {f"IKPLAN_{name}".upper() for name in Settings.model_fields}
    assert set(service["environment"]) <= known
    assert set(image_settings()) - {"IKPLAN_CACHE_DIR"} <= known
