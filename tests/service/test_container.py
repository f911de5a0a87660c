"""No container engine is needed to see that the files fit the checkout."""

import fnmatch
import re
import shlex
from pathlib import Path

import pytest
import yaml

ROOT = Path(__file__).parents[2]
DOCKERFILE = (ROOT / "docker/Dockerfile").read_text()
COMPOSE = yaml.safe_load((ROOT / "docker/compose.yaml").read_text())


def copied() -> list[str]:
    """Paths of the checkout that the Dockerfile copies."""
    paths = []
    for line in re.findall(r"^COPY (?!--from)(.+)$", DOCKERFILE, re.MULTILINE):
        paths += shlex.split(line)[:-1]
    return paths


def test_every_path_that_is_copied_exists():
    assert len(copied()) >= 6
    for path in copied():
        assert (ROOT / path).exists(), path


def test_the_context_holds_what_is_copied_and_little_more():
    lines = (ROOT / ".dockerignore").read_text().split()
    allowed = {line[1:] for line in lines if line.startswith("!")}
    assert allowed == set(copied())
    assert "*" in lines


def test_the_package_is_built_from_what_is_copied():
    build = (ROOT / "pyproject.toml").read_text()
    for folder in re.findall(r'"(ikplan|api/ikplan_api)"', build):
        assert any(fnmatch.fnmatch(folder, f"{c}*") for c in copied())


def test_the_service_does_not_run_as_root():
    stages = DOCKERFILE.split("\nFROM ")
    user = re.search(r"^USER (\d+)$", stages[-1], re.MULTILINE)
    assert user is not None
    assert int(user[1]) > 0
    assert f"--uid {user[1]} " in stages[-1]


def test_kernels_are_compiled_for_the_folder_and_processor_they_are_used_with():
    builder, runtime = DOCKERFILE.split("\nFROM ")[-2:]
    for setting in ("NUMBA_CPU_NAME=generic", "IKPLAN_CACHE_DIR=/opt/ikplan-cache"):
        assert setting in builder
        assert setting in runtime


def test_the_health_check_is_python_that_compiles():
    match = re.search(r'CMD \["python", "-c", "(.+)"\]', DOCKERFILE)
    assert match is not None
    compile(match[1], "healthcheck", "exec")
    assert "/readyz" in match[1]


@pytest.mark.parametrize(
    ("key", "value"),
    [
        ("read_only", True),
        ("cap_drop", ["ALL"]),
        ("tmpfs", ["/tmp"]),
        ("security_opt", ["no-new-privileges:true"]),
    ],
)
def test_compose_takes_every_right_away(key, value):
    (service,) = COMPOSE["services"].values()
    assert service[key] == value


def test_compose_listens_on_this_machine_only_and_builds_this_dockerfile():
    (service,) = COMPOSE["services"].values()
    assert all(port.startswith("127.0.0.1:") for port in service["ports"])
    context = ROOT / "docker" / service["build"]["context"]
    assert (context / service["build"]["dockerfile"]).resolve() == ROOT / "docker/Dockerfile"
