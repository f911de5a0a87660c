"""Comparisons: budgets are kept, rows repeat, tests find what is there and nothing else."""

from __future__ import annotations

import csv
import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from scipy.stats import mannwhitneyu

import ikplan
from ikplan.arena.compared_runs import TARGET_VALUES
from ikplan.arena.comparison import Comparison
from ikplan.arena.statistics import a12, compare_values, holm
from ikplan.cli import main
from ikplan.errors import InvalidRequest
from ikplan.robots import Robot

BUDGET = 600


@pytest.fixture(scope="module")
def robot() -> Robot:
    return ikplan.load_robot("ur5")


@pytest.fixture(scope="module")
def found(robot: Robot) -> Comparison:
    bat = ("bat 0.1", {"method": "ik-ba", "noise": "normal", "eps_scale": 0.1})
    return ikplan.compare(["ik-ba", bat, "de-best-1"], robot, targets=4, seeds=3, budget=BUDGET)


def test_no_run_exceeds_its_budget(found: Comparison) -> None:
    for rows in found.runs.values():
        for row in rows:
            for run in row:
                assert 0.8 * BUDGET <= run.evaluations <= BUDGET
                assert (np.diff(run.values) <= 0.0).all()
                assert run.values[-1] == run.value == pytest.approx(run.position_error, abs=1e-12)


def test_rows_repeat(robot: Robot, found: Comparison) -> None:
    again = ikplan.compare(["de-best-1"], robot, targets=4, seeds=3, budget=BUDGET)
    rows = [row for row in found.rows() if row["solver"] == "de-best-1"]
    assert json.dumps(again.rows()) == json.dumps(rows)


def test_first_hits_are_those_of_the_best_values(found: Comparison) -> None:
    counts = np.arange(1.0, BUDGET + 1)
    for name in found.solvers:
        best = found.best_values(name, counts)
        reached = best[..., None] <= TARGET_VALUES
        first = np.where(reached.any(axis=2), reached.argmax(axis=2) + 1.0, np.inf)
        np.testing.assert_array_equal(found.first_hits[name], first)


def test_starts_are_as_near_as_asked_for(robot: Robot) -> None:
    near = ikplan.compare(
        ["ik-ba"], robot, 5, 1, BUDGET, kind="pose", start_distance=0.05, params={"warm": "cloud"}
    )
    far = ikplan.compare(["ik-ba"], robot, 5, 1, BUDGET, kind="pose", params={"warm": "cloud"})
    assert near.oriented
    assert near.values("ik-ba").mean() < far.values("ik-ba").mean()


@pytest.mark.parametrize(
    ("given", "match"),
    [
        ({"solvers": []}, "solvers"),
        ({"solvers": ["ik-ba", "ik-ba"]}, "label"),
        ({"solvers": ["lm"]}, "minimises nothing"),
        ({"solvers": ["ik-bat"]}, "no solver named"),
        ({"seeds": []}, "seeds"),
        ({"seeds": [1, 1]}, "seeds"),
        ({"budget": 0}, "budget"),
        ({"budget": 10}, "budget"),
        ({"targets": 0}, "targets"),
        ({"targets": []}, "targets"),
        ({"kind": "both"}, "kind"),
        ({"start_distance": -1.0}, "start_distance"),
        ({"params": {"weight_motion": -1.0}}, "weight_motion"),
        ({"params": {"wait_motion": 1.0}}, "wait_motion"),
    ],
)
def test_wrong_arguments_are_named(robot: Robot, given: dict[str, Any], match: str) -> None:
    asked = {"solvers": ["de-best-1"], "targets": 1, "seeds": 1, "budget": 100, **given}
    with pytest.raises(InvalidRequest, match=match):
        ikplan.compare(asked.pop("solvers"), robot, **asked)


def test_effect_size_is_that_of_mann_and_whitney() -> None:
    rng = np.random.default_rng(0)
    a, b = rng.integers(0, 9, 20).astype(float), rng.integers(2, 11, 30).astype(float)
    assert a12(a, b) == pytest.approx(mannwhitneyu(b, a).statistic / (20 * 30))
    assert a12(a, b) + a12(b, a) == pytest.approx(1.0)


def test_holm_corrects_step_down() -> None:
    assert holm([0.01, 0.04, 0.03]) == pytest.approx([0.03, 0.06, 0.06])
    assert holm([0.9, 0.8]) == [1.0, 1.0]


def test_equal_solvers_do_not_differ_and_others_do() -> None:
    rng = np.random.default_rng(3)
    base = rng.lognormal(size=(30, 1))
    values = {
        "a": base * rng.lognormal(sigma=0.3, size=(30, 9)),
        "b": base * rng.lognormal(sigma=0.3, size=(30, 9)),
        "worse": 30.0 * base * rng.lognormal(sigma=0.3, size=(30, 9)),
    }
    tests = compare_values(values)
    assert tests.friedman_p < 1e-6
    assert tests.groups() == [sorted(["a", "b"], key=lambda n: tests.ranks[n])]
    worse = [pair for pair in tests.pairs if pair.b == "worse"]
    assert len(worse) == 2
    assert all(pair.p_holm < 0.01 and pair.effect_interval[0] > 0.9 for pair in worse)
    same = compare_values({"a": values["a"], "b": values["a"]})
    assert same.pairs[0].p == 1.0


def test_false_alarms_are_as_rare_as_the_level_says() -> None:
    rng = np.random.default_rng(4)
    alarms = sum(
        any(p.p_holm <= 0.05 for p in compare_values(_noise(rng)).pairs) for _ in range(200)
    )
    assert alarms <= 20  # 5 % of 200 in the mean; 20 or more has a probability below 1e-3


def _noise(rng: np.random.Generator) -> dict[str, Any]:
    return {name: rng.standard_normal((12, 5)) for name in "abcd"}


def test_files_hold_every_run(found: Comparison, tmp_path: Path) -> None:
    files = found.save(tmp_path)
    assert all(file.stat().st_size > 0 for file in files)
    with (tmp_path / "rows.csv").open() as file:
        rows = list(csv.DictReader(file))
    assert len(rows) == 3 * 4 * 3
    assert float(rows[0]["value"]) == found.rows()[0]["value"]
    info = (tmp_path / "coco" / "bat_0.1" / "bbobexp_f1.info").read_text()
    assert "DIM = 6" in info
    assert info.count("|") == 12
    data = (tmp_path / "coco" / "bat_0.1" / "data_f1" / "bbobexp_f1_DIM6.dat").read_text()
    runs = [block.splitlines()[1:] for block in data.split("% ")[1:]]
    assert len(runs) == 12
    last = [float(block[-1].split()[2]) for block in runs]
    np.testing.assert_allclose(last, found.values("bat 0.1").ravel(), rtol=1e-9)
    before = {file: file.read_bytes() for file in files}
    found.save(tmp_path)
    assert all(file.read_bytes() == bytes_ for file, bytes_ in before.items())


def test_figure_takes_axes(found: Comparison) -> None:
    from matplotlib.figure import Figure

    figure = Figure()
    assert found.plot(figure.subplots(1, 4)) is figure
    with pytest.raises(InvalidRequest, match="four"):
        found.plot(figure.subplots(1, 3))


def test_command_registers_compares_and_writes(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    module = tmp_path / "mine.py"
    module.write_text(
        "import ikplan\n\n\ndef minimise(objective, rng):\n    while True:\n        "
        "objective(rng.uniform(objective.lower, objective.upper, (50, objective.dof)))\n\n\n"
        "def register():\n    ikplan.register_solver('uniform', minimise, replace=True)\n"
    )
    output = tmp_path / "out"
    asked = [
        "compare",
        "ik-ba:eps_scale=0.15",
        "uniform",
        "--module",
        str(module),
        "--robot",
        "ur5",
    ]
    asked += ["--targets", "2", "--seeds", "2", "--budget", "300", "--json", "--quiet"]
    assert main([*asked, "-o", str(output)]) == 0
    told = json.loads(capsys.readouterr().out)
    assert {row["solver"] for row in told["rows"]} == {"ik-ba:eps_scale=0.15", "uniform"}
    assert all(r["evaluations"] == 300 for r in told["rows"] if r["solver"] == "uniform")
    assert (output / "comparison.png").stat().st_size > 10_000
    assert main(["compare", "ik-ba", "--robot", "ur5", "--param", "x"]) == 2
    assert main(["compare", "ik-ba", "--robot", "ur5", "--module", str(tmp_path / "no.py")]) == 2
