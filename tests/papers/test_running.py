"""Experiments run, resume and report."""

from __future__ import annotations

import dataclasses
from collections.abc import Generator, Iterable
from pathlib import Path

import numpy as np
import pytest

from benchmarks.papers.document import number
from benchmarks.papers.rows import COLUMNS, read_rows, write_rows
from benchmarks.papers.runner import UnitWork, _keep, find_experiment, run_experiment
from benchmarks.papers.series import Series
from benchmarks.papers.solving import run_series
from ikplan.batch.chunks import Chunk, Done
from ikplan.batch.executor import run_on


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return tmp_path_factory.mktemp("papers")


def test_rows_are_kept_and_not_made_again(tmp_path: Path) -> None:
    results = run_experiment("E7", 1, 1, 50, tmp_path)
    files = {p: p.stat().st_mtime_ns for p in tmp_path.rglob("*.csv")}
    assert len(files) == len(results.tables)
    more = run_experiment("E7", 2, 1, 50, tmp_path)
    kept = {p: p.stat().st_mtime_ns for p in files}
    assert kept == files
    for key, table in results.tables.items():
        np.testing.assert_array_equal(more.tables[key].data[: len(table)], table.data)


def test_rows_are_what_the_joint_values_give(folder: Path) -> None:
    results = run_experiment("E7", 1, 1, 50, folder)
    case = find_experiment("E7").studies(50)[0].case
    for (name, _), table in results.tables.items():
        if name != case.name:
            continue
        assert len(table) == case.count
        for k, q in enumerate(table.q):
            pose = case.robot.fk(q)
            distance = np.linalg.norm(pose.translation - case.p[k])
            assert table["eps_p"][k] == pytest.approx(distance, abs=1e-12)
            rotation = np.linalg.norm(pose.rotation - case.R[k])
            assert table["delta_R"][k] == pytest.approx(rotation, abs=1e-12)
            fitness = 1000.0 * distance + case.weight_orientation * rotation
            assert table["f"][k] == pytest.approx(fitness, rel=1e-9, abs=1e-9)


def test_the_closed_form_and_the_planner_solve_every_pose(folder: Path) -> None:
    results = run_experiment("E7", 1, 1, 50, folder)
    for series in ("closed form", "ikplan"):
        table = results.tables["E7a", series]
        assert table["eps_p"].max() < 1e-9
        assert table["theta_deg"].max() < 1e-6
        assert table["violations"].sum() == 0


def test_a_run_can_be_made_again_bit_for_bit(folder: Path) -> None:
    results = run_experiment("E7", 2, 1, 50, folder)
    study = find_experiment("E7").studies(50)[0]
    series = next(s for s in study.series if s.name == "BODE-CS")
    rows, curve = run_series(study.case, series, 1)
    timeless = [i for i, c in enumerate(COLUMNS) if not c.endswith("seconds")]
    stored = results.tables["E7a", "BODE-CS"].data[study.case.count :]
    np.testing.assert_array_equal(np.array(rows)[:, timeless], stored[:, timeless])
    assert curve.shape == (6, series.iterations + 1)
    assert (np.diff(curve[0]) <= 0.0).all()


def test_other_parameters_are_other_rows() -> None:
    series = Series("IK-BA", "ik-ba", 50, 200)
    assert series.digest() != dataclasses.replace(series, iterations=100).digest()
    assert series.digest() != dataclasses.replace(series, params={"preset": "bat-code"}).digest()
    case = find_experiment("E7").studies(50)[0].case
    assert case.digest() != dataclasses.replace(case, weight_orientation=1.0).digest()


@pytest.mark.parametrize(
    ("value", "written"),
    [(1.5e-9, "1.5e-09"), (0.25, "0.25"), (3.0, "3"), (float("nan"), "-"), (123456.7, "1.23e+05")],
)
def test_numbers_are_written_briefly(value: float, written: str) -> None:
    assert number(value) == written


def test_csv_keeps_every_bit(tmp_path: Path) -> None:
    row = [*np.random.default_rng(0).random(len(COLUMNS) + 2), float("nan")]
    write_rows(tmp_path / "rows.csv", [row], 3)
    np.testing.assert_array_equal(read_rows([tmp_path / "rows.csv"]).data[0], row)


def test_units_on_an_executor_give_the_rows_that_are_made_here(
    folder: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    class Here:
        """An executor whose worker is this process."""

        def __init__(self, work: UnitWork) -> None:
            self.answer = work.answer

        def run(self, chunks: Iterable[Chunk]) -> Generator[Done, None, None]:
            yield from run_on([self], chunks)

        def close(self) -> None:
            """There is nothing to end."""

    monkeypatch.setattr(
        "benchmarks.papers.runner.executor_for", lambda _on, work, _jobs: Here(work)
    )
    expected = run_experiment("E7", 1, 1, 50, folder)
    found = run_experiment("E7", 1, 2, 50, tmp_path, on="ray")
    assert {p.relative_to(tmp_path) for p in tmp_path.rglob("*.*")} <= {
        p.relative_to(folder) for p in folder.rglob("*.*")
    }
    for key, table in expected.tables.items():
        timed = {COLUMNS.index("seconds"), COLUMNS.index("cpu_seconds")}
        kept = [k for k in range(table.data.shape[1]) if k not in timed]
        np.testing.assert_array_equal(found.tables[key].data[:, kept], table.data[:, kept])


def test_a_unit_that_fails_is_told_and_leaves_no_rows(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def broken(*_: object) -> None:
        raise ValueError("broken")

    monkeypatch.setattr("benchmarks.papers.runner.run_series", broken)
    answers = UnitWork("E7", 50).answer([b"[0, 0, 0]"])
    assert "broken" in answers.faults[0]
    with pytest.raises(RuntimeError, match="failed"):
        _keep(tmp_path / "000.csv", answers.outcomes[0])
    assert not list(tmp_path.iterdir())
