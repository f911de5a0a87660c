"""What a command imports before it answers: counted, since seconds depend on the machine."""

from __future__ import annotations

import json
import subprocess
import sys
from pathlib import Path

import pytest

from ikplan.robots import load_robot, robot_names
from ikplan.robots.listing import listed_robots

POSE = ["--position", "0.4", "0.1", "0.5"]
COMMANDS = {
    "help": ["--help"],
    "robots": ["robots"],
    "fk": ["fk", "iiwa14", *["0.1"] * 7],
    "completion": ["completion", "bash"],
    "keys": ["keys", "new"],
}
DRAWING = {"matplotlib", "PIL"}
COMPILER = {"numba", "llvmlite"}
SCIENCE = {"numpy", "pinocchio", "coal", "scipy"}
SERVICE = {"httpx", "fastapi", "uvicorn"}
HEAVY = DRAWING | COMPILER | SCIENCE | SERVICE | {"toppra"}
PLAN = Path(__file__).parents[2] / "examples" / "helix_iiwa14.json"


def modules_of(arguments: list[str], *, also: str = "") -> set[str]:
    """The modules that are imported when a command has answered."""
    code = (
        "import contextlib, io, json, sys\n"
        "from ikplan.cli import main\n"
        "with contextlib.redirect_stdout(io.StringIO()), contextlib.suppress(SystemExit):\n"
        f"    assert main({arguments!r}) == 0\n"
        f"{also}\n"
        "print(json.dumps([*sys.modules]))"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    return set(json.loads(done.stdout.splitlines()[-1]))


def packages(modules: set[str]) -> set[str]:
    return {name.partition(".")[0] for name in modules}


@pytest.mark.parametrize(
    ("command", "none_of", "most"),
    [
        ("help", HEAVY | {"pydantic", "yaml", "orjson"}, 140),
        ("robots", HEAVY | {"pydantic", "orjson"}, 220),
        ("keys", HEAVY | {"pydantic", "yaml"}, 220),
        ("completion", HEAVY | {"pydantic", "yaml"}, 220),
        ("fk", DRAWING | COMPILER | SERVICE | {"scipy", "toppra"}, 560),
    ],
)
def test_a_command_imports_what_it_uses(command: str, none_of: set[str], most: int) -> None:
    modules = modules_of(COMMANDS[command])
    assert not packages(modules) & none_of
    assert len(modules) < most


def test_an_ik_needs_neither_toppra_nor_drawing() -> None:
    modules = modules_of(["ik", "ur5", *POSE])
    assert not packages(modules) & (DRAWING | SERVICE | {"toppra"})


def test_a_plan_is_timed_by_toppra_without_its_drawing_library() -> None:
    plan = ["plan", str(PLAN), "-q"]
    modules = modules_of(plan, also="import toppra.algorithm.algorithm")
    assert "toppra.solverwrapper" in modules
    assert not packages(modules) & (DRAWING | SERVICE)


def test_toppra_draws_as_ever_afterwards() -> None:
    code = (
        "import sys\n"
        "before = list(sys.meta_path)\n"
        "from ikplan.timing.engines.toppra_import import libraries_on_first_use\n"
        "with libraries_on_first_use():\n"
        "    import toppra\n"
        "import toppra.algorithm.algorithm as algorithm, toppra.parametrizer as parametrizer\n"
        "assert sys.meta_path == before\n"
        "assert 'matplotlib' not in sys.modules\n"
        "assert callable(algorithm.plt.plot) and callable(parametrizer.plt.subplots)\n"
        "import matplotlib.pyplot\n"
        "assert algorithm.plt.plot is matplotlib.pyplot.plot\n"
        "import inspect\n"
        "assert 'import matplotlib.pyplot as plt' in inspect.getsource(algorithm)\n"
    )
    environment = {"MPLBACKEND": "agg", "PYTHONPATH": ":".join(sys.path)}
    subprocess.run([sys.executable, "-c", code], check=True, env=environment)


def test_a_program_that_has_pyplot_already_shares_it_with_toppra() -> None:
    code = (
        "import matplotlib.pyplot\n"
        "from ikplan.timing.engines.toppra_import import libraries_on_first_use\n"
        "with libraries_on_first_use():\n"
        "    import toppra\n"
        "import toppra.algorithm.algorithm as algorithm\n"
        "assert algorithm.plt is matplotlib.pyplot\n"
    )
    environment = {"MPLBACKEND": "agg", "PYTHONPATH": ":".join(sys.path)}
    subprocess.run([sys.executable, "-c", code], check=True, env=environment)


def test_the_list_of_robots_is_what_loading_them_gives() -> None:
    loaded = [load_robot(name) for name in robot_names()]
    assert listed_robots() == [(robot.name, robot.title, robot.dof) for robot in loaded]
