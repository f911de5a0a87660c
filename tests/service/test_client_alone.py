"""The distribution of the client alone: installed with its own dependencies and no others."""

from __future__ import annotations

import json
import re
import subprocess
import sys
import zipfile
from importlib.metadata import distribution
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
LARGEST_MB = 130.0
USE = """
import json, sys, ikplan
from pathlib import Path

address, helix = sys.argv[1], json.loads(Path(sys.argv[2]).read_text())
found = {"file": ikplan.__file__}
with ikplan.Client(address) as client:
    plan = client.plan(helix)
    found["duration"] = plan.duration
    rows = list(client.batch([helix, {**helix, "robot": "nobody"}]))
    found["batch"] = [type(row).__name__ for row in rows]
    job = client.submit(helix)
    found["job"] = job.wait().id == plan.id
    for name in ("json", "csv", "npz", "ros"):
        plan.save(f"plan.{name}", name)
    found["at"] = len(plan.at(0.5 * plan.duration)[0])
try:
    ikplan.plan(helix)
except ModuleNotFoundError as error:
    found["told"] = str(error)
heavy = {"pinocchio", "numba", "scipy", "toppra", "matplotlib", "fastapi"}
found["heavy"] = sorted(heavy & {name.partition(".")[0] for name in sys.modules})
print(json.dumps(found))
"""


def requirements(name: str) -> set[str]:
    """A distribution and all that it needs, by their normalised names."""
    found, waiting = set(), [name]
    while waiting:
        one = waiting.pop()
        if one in found:
            continue
        found.add(one)
        for line in distribution(one).requires or []:
            if "extra ==" not in line and not re.search(r"python_version\s*<", line):
                waiting.append(re.split(r"[^\w.-]", line, maxsplit=1)[0].lower().replace("_", "-"))
    return found


@pytest.fixture(scope="module")
def environment(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with the client's wheel and its dependencies, and nothing else."""
    out, place = tmp_path_factory.mktemp("wheel"), tmp_path_factory.mktemp("site")
    command = [sys.executable, "-m", "hatchling", "build", "-t", "wheel", "-d", str(out)]
    subprocess.run(command, cwd=ROOT / "client", check=True, capture_output=True)
    (wheel,) = out.iterdir()
    with zipfile.ZipFile(wheel) as archive:
        archive.extractall(place)
        (told,) = (n for n in archive.namelist() if n.endswith(".dist-info/METADATA"))
        asked = re.findall(r"^Requires-Dist: ([\w.-]+)", archive.read(told).decode(), re.MULTILINE)
    for name in sorted(set().union(*(requirements(one) for one in asked))):
        held = distribution(name)
        for top in sorted(
            {Path(str(f)).parts[0] for f in held.files or []} - {"..", "__pycache__"}
        ):
            (place / top).symlink_to(Path(str(held.locate_file(top))))
    return place


def test_size_of_an_environment_is_bounded(environment: Path) -> None:
    files = [f for top in environment.iterdir() for f in top.resolve().rglob("*") if f.is_file()]
    megabytes = sum(f.stat().st_size for f in files) / 2**20
    assert megabytes < LARGEST_MB


def test_plans_batches_jobs_and_exports_work(
    environment: Path, live_address: str, tmp_path: Path
) -> None:
    program = [
        sys.executable,
        "-I",
        "-S",
        "-c",
        f"import sys; sys.path.append({str(environment)!r})",
    ]
    program[-1] += "\n" + USE
    helix = ROOT / "examples" / "helix_iiwa14.json"
    ran = subprocess.run(
        [*program, live_address, str(helix)],
        cwd=tmp_path,
        capture_output=True,
        text=True,
        check=False,
    )
    assert ran.returncode == 0, ran.stderr
    found = json.loads(ran.stdout)
    assert Path(found["file"]).is_relative_to(environment)
    assert found["duration"] > 0.0
    assert found["batch"] == ["Plan", "RobotNotFound"]
    assert found["job"]
    assert found["at"] == 7
    assert found["heavy"] == []
    assert "pip install ikplan" in found["told"]
    assert json.loads((tmp_path / "plan.json").read_text())["robot"] == "iiwa14"
