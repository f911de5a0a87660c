"""The report: verdicts, tables of groups of targets, the summary."""

from __future__ import annotations

import dataclasses
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from benchmarks.papers import e9
from benchmarks.papers.claims import (
    Claim,
    against,
    held_to,
    one_of_ours,
    read_claims,
    smallest,
    write_claims,
)
from benchmarks.papers.document import Document
from benchmarks.papers.experiment import Results
from benchmarks.papers.li_tables import comparison, pose_tables, solved
from benchmarks.papers.report import Sections
from benchmarks.papers.rows import COLUMNS, Table
from benchmarks.papers.runner import find_experiment, run_experiment
from benchmarks.papers.series import Series
from benchmarks.papers.solving import run_series
from benchmarks.papers.statistics import Comparison, Estimate

positive = st.floats(1e-9, 1e9)


@given(published=positive, value=positive, below=st.floats(0.1, 1.0), above=st.floats(1.0, 10.0))
def test_a_figure_is_decided_by_its_whole_interval(
    published: float, value: float, below: float, above: float
) -> None:
    ours = Estimate(value, value * below, value * above, "")
    verdict = against(published, ours)
    low, high = ours.low / published, ours.high / published
    expected = {
        "reproduced": low >= 1.0 / 1.5 and high <= 1.5,
        "larger": low > 1.5,
        "smaller": high < 1.0 / 1.5,
    }
    assert verdict == next((word for word, holds in expected.items() if holds), "undecided")


@pytest.mark.parametrize("ours", [0.0, float("nan"), float("inf"), -1.0])
def test_a_figure_without_a_ratio_has_no_verdict(ours: float) -> None:
    with pytest.raises(ValueError, match="no ratio"):
        against(1.0, Estimate(ours, ours, ours, ""))


def test_a_published_run_is_held_to_its_rank_among_ours() -> None:
    runs = np.arange(1.0, 21.0)
    assert one_of_ours(runs, 0.5) == ("larger", 1 / 21, 1.0)
    assert one_of_ours(runs, 30.0) == ("smaller", 1.0, 1 / 21)
    assert one_of_ours(runs, 7.5)[0] == "reproduced"
    # A maximum over all runs would be far above; one run in twenty is as small.
    assert one_of_ours(runs, 1.0)[0] == "reproduced"
    assert one_of_ours(runs[:5], 0.5)[0] == "undecided"


def comparison_of(p: float, effect: float) -> Comparison:
    return Comparison(p, effect, effect, effect, "", "")


def test_smaller_than_each_needs_every_test() -> None:
    won, lost, open_ = (comparison_of(*c) for c in ((0.01, 0.9), (0.01, 0.1), (0.3, 0.9)))
    assert smallest([won, won]) == "holds"
    assert smallest([won, open_]) == "undecided"
    assert smallest([won, open_, lost]) == "does not hold"


def test_a_verdict_that_another_seed_turns_is_undecided() -> None:
    claim = Claim("a", "1", "2", "20 runs", "bootstrap", "reproduced")
    same, turned = claim, dataclasses.replace(claim, verdict="larger")
    assert held_to([claim], [[same]]) == [claim]
    (checked,) = held_to([claim], [[same], [turned]])
    assert checked.verdict == "undecided: reproduced; another seed: larger"
    assert held_to([claim], []) == [claim]
    with pytest.raises(ValueError, match="says nothing of 'a'"):
        held_to([claim], [[same], [dataclasses.replace(claim, subject="b")]])


def test_claims_are_kept(tmp_path: Path) -> None:
    claims = [Claim("a", "1", "2", "n", "t", "holds"), Claim("b", "-", "x", "n", "t", "larger")]
    write_claims(tmp_path / "E1.json", claims)
    assert read_claims(tmp_path / "E1.json") == claims


def test_a_verdict_is_one_of_a_few_words(tmp_path: Path) -> None:
    with pytest.raises(ValueError, match="is none of"):
        Document(tmp_path, "figures").claim("a", "1", "2", "n", "t", "44 times as large")


def table_of(errors: np.ndarray) -> Table:
    """Two runs with given position errors, shape (2, targets)."""
    runs, targets = errors.shape
    data = np.zeros((runs * targets, len(COLUMNS) + 6))
    data[:, COLUMNS.index("run")] = np.repeat(np.arange(runs), targets)
    data[:, COLUMNS.index("target")] = np.tile(np.arange(targets), runs)
    data[:, COLUMNS.index("eps_p")] = errors.ravel()
    data[:, COLUMNS.index("f")] = 1e3 * errors.ravel()
    data[:, COLUMNS.index("theta_deg")] = 90.0 * (errors.ravel() > 0.5)
    return Table(data)


def test_tables_of_a_group_have_nothing_of_the_others(tmp_path: Path) -> None:
    errors = np.array([[0.001, 7.0, 0.001, 7.0], [0.003, 7.0, 0.003, 7.0]])
    series = [Series("a", "cs"), Series("b", "cs"), Series("c", "cs")]
    tables = {("X", s.name): table_of((i + 1) * errors) for i, s in enumerate(series)}
    mask = np.array([True, False, True, False])
    document = Document(tmp_path, "figures")
    pose_tables("X", series, Results(tables, {}, 2), document, None, mask)
    comparison("X", series, Results(tables, {}, 2), document, mask)
    text = document.text()
    assert "| a | - | 2 / 2 | 2 |" in text  # millimetres: mean of the runs' max, median
    assert "7,000" not in text
    assert "7000" not in text
    assert "90" not in text


def test_solved_needs_position_and_orientation() -> None:
    table = table_of(np.array([[1e-5, 1e-5, 1e-3, 1.0]]))
    table.data[1, COLUMNS.index("theta_deg")] = 0.2
    assert solved(table) == 0.25


def test_convergence_of_groups_makes_up_that_of_all() -> None:
    study = find_experiment("E9").studies(40)[0]
    case = study.case
    assert 0 < case.reachable.sum() < case.count
    _, curve = run_series(case, study.series[0], 0)
    whole = np.ones(case.count, dtype=np.bool_)
    every = type(case)(**{**case.__dict__, "reachable": whole})
    _, together = run_series(every, study.series[0], 0)
    share = case.reachable.mean()
    mixed = share * np.log(curve[0]) + (1.0 - share) * np.log(curve[3])
    np.testing.assert_allclose(mixed, np.log(together[0]), atol=1e-9)
    np.testing.assert_allclose(share * curve[2] + (1.0 - share) * curve[5], together[2])
    assert np.isnan(together[3:]).all()


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return tmp_path_factory.mktemp("report")


def test_a_report_begins_with_its_claims(folder: Path) -> None:
    results = run_experiment("E8", 1, 1, 50, folder)
    sections = Sections(folder / "REPORT.md", folder / "sections")
    sections.write(find_experiment("E8"), results, 1, 50)
    sections.join(effort=0.01)
    text = (folder / "REPORT.md").read_text()
    head, _, rest = text.partition("## What was found")
    assert (
        "| E8a, Baxter: largest position error of BODE-CS over the poses of a run | 0.0062 mm |"
        in head
    )
    assert "28.07 / 28.15" in rest  # the published row of DE/rand/1
    assert "`python -m benchmarks.papers E8 --runs 1 --thin 50 --report" in head
    assert text.count("<details>") == text.count("</details>") == 2
    costs = rest.split("## Cost of the searches")[1]
    assert all(f"| {name} |" in costs for name in ("ik-ba", "gsa", "bode-cs"))
    figures = [line for line in text.splitlines() if line.startswith("![")]
    assert len(figures) == 2
    for line in figures:
        drawn = folder / line.rpartition("(")[2].rstrip(")")
        assert drawn.stat().st_size > 5_000


def test_reachable_and_unreachable_points_have_tables_of_their_own(folder: Path) -> None:
    results = run_experiment("E9", 1, 1, 50, folder)
    study = find_experiment("E9").studies(50)[0]
    document = Document(folder, "figures")
    e9._trajectory(study, results, document)
    inside, _, outside = document.text().partition(" unreachable points\n")
    assert "E9-1, 2 reachable points" in inside
    for series in ("ikplan, greedy", "closed form", "BODE-CS", "BODE-CS, warm"):
        assert f"| {series} |" in inside
        assert (f"| {series} |" in outside) == (series != "closed form")


@pytest.mark.parametrize(
    ("arguments", "message"),
    [(["E10"], "no experiment E10"), (["E1", "--runs", "0"], "at least 1")],
)
def test_a_wrong_command_says_what_is_right(arguments: list[str], message: str) -> None:
    ran = subprocess.run(
        [sys.executable, "-m", "benchmarks.papers", *arguments],
        capture_output=True,
        text=True,
        cwd=Path(__file__).parents[2],
        check=False,
    )
    assert ran.returncode == 2
    assert message in ran.stderr
