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
SCIPY = {"scipy.interpolate", "scipy.linalg", "scipy.optimize", "scipy.sparse", "scipy.spatial"}
"""Of SciPy numba imports its first page, to know its version."""
NUMBA = {"numba.np.arraymath", "numba.np.linalg", "numba.typed.typeddict"}
"""How things are compiled, which nothing is here."""
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


def without_measuring(modules: set[str]) -> set[str]:
    """Modules but those of what measures tests, which numba imports where it is installed."""
    return {name for name in modules if name.partition(".")[0] not in ("coverage", "sqlite3")}


def packages(modules: set[str]) -> set[str]:
    return {name.partition(".")[0] for name in modules}


@pytest.mark.parametrize(
    ("command", "none_of", "most"),
    [
        ("help", HEAVY | {"pydantic", "yaml", "orjson"}, 135),
        ("robots", HEAVY | {"pydantic", "orjson"}, 175),
        ("keys", HEAVY | {"pydantic", "yaml"}, 160),
        ("completion", HEAVY | {"pydantic", "yaml"}, 220),
        ("fk", DRAWING | COMPILER | SERVICE | {"scipy", "toppra"}, 490),
    ],
)
def test_a_command_imports_what_it_uses(command: str, none_of: set[str], most: int) -> None:
    modules = modules_of(COMMANDS[command])
    assert not packages(modules) & none_of
    assert len(modules) < most


def test_an_fk_needs_no_scene() -> None:
    assert "ikplan.documents.scene" not in modules_of(COMMANDS["fk"])


def test_an_ik_needs_neither_toppra_nor_drawing() -> None:
    modules = modules_of(["ik", "ur5", *POSE])
    assert not packages(modules) & (DRAWING | SERVICE | {"toppra"})
    assert not modules & (SCIPY | NUMBA | {"ikplan.documents.plan_request"})
    assert len(without_measuring(modules)) < 850


def test_a_plan_is_timed_by_toppra_without_its_drawing_library() -> None:
    plan = ["plan", str(PLAN), "-q"]
    modules = modules_of(plan, also="import toppra.algorithm.algorithm")
    assert "toppra.solverwrapper" in modules
    assert not packages(modules) & (DRAWING | SERVICE)
    assert not modules & (SCIPY | NUMBA)


def test_a_plan_in_the_order_given_imports_neither_orders_nor_repairs_nor_exports() -> None:
    modules = modules_of(["plan", str(PLAN), "-q"])
    assert not modules & {
        "ikplan.planning.order.free_order",
        "ikplan.planning.repairs",
        "ikplan.plans.export",
        "ikplan.points.reading",
        "ikplan.gcode.reading",
    }
    assert len(without_measuring(modules)) < 1180


def test_a_spline_needs_no_scipy(tmp_path: Path) -> None:
    points = [[0.6, -0.1, 0.4], [0.55, 0.0, 0.45], [0.6, 0.1, 0.4]]
    path = {"waypoints": [{"position": p} for p in points], "interpolation": "spline"}
    request = tmp_path / "spline.json"
    request.write_text(json.dumps({"robot": "iiwa14", "path": {**path, "approach": "joint"}}))
    assert not modules_of(["plan", str(request), "-q"]) & SCIPY


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


def test_toppra_computes_with_scipy_as_ever_afterwards() -> None:
    code = (
        "import sys\n"
        "from ikplan.timing.engines.toppra_import import libraries_on_first_use\n"
        "with libraries_on_first_use():\n"
        "    import toppra, toppra.interpolator as interpolator\n"
        "    import toppra.solverwrapper.ecos_solverwrapper as ecos\n"
        "assert not {'scipy.interpolate', 'scipy.sparse'} & set(sys.modules)\n"
        "path = toppra.SplineInterpolator([0.0, 1.0, 2.0], [[0.0], [1.0], [4.0]])\n"
        "import numpy, scipy.interpolate\n"
        "own = scipy.interpolate.CubicSpline([0.0, 1.0, 2.0], [[0.0], [1.0], [4.0]])\n"
        "grid = numpy.linspace(0.0, 2.0, 9)\n"
        "assert numpy.array_equal(path(grid), own(grid))\n"
        "assert type(path.cspl) is scipy.interpolate.CubicSpline\n"
        "assert isinstance(own, interpolator.CubicSpline)\n"
        "assert interpolator.PPoly.construct_fast == scipy.interpolate.PPoly.construct_fast\n"
        "simple = toppra.SimplePath(numpy.array([0.0, 1.0]), numpy.array([[0.0], [1.0]]))\n"
        "assert simple(0.5).shape == (1,)\n"
        "assert ecos.scipy.sparse.csc_matrix is not None\n"
    )
    environment = {"PYTHONPATH": ":".join(sys.path)}
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
