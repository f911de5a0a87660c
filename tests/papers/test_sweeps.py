"""The cases of the sweeps and of the readings, and the archive of rows."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from benchmarks.papers import archive
from benchmarks.papers.deviations import GROUPS
from benchmarks.papers.figures_kept import figures_of
from benchmarks.papers.rows import COLUMNS, write_rows
from benchmarks.papers.solving import run_series
from benchmarks.papers.sweep_cases import (
    DIMENSIONS,
    DISTANCES,
    dimension_case,
    distance_case,
    trunk,
)
from benchmarks.papers.sweeps import SEARCHES


@pytest.mark.parametrize("degrees", DISTANCES)
def test_starts_are_within_their_distance_of_a_solution(degrees: int) -> None:
    near, far = distance_case(DISTANCES[0]), distance_case(degrees)
    np.testing.assert_array_equal(near.p, far.p)
    assert near.starts is not None
    assert far.starts is not None
    shift = np.degrees(np.abs(far.starts - near.starts)).max()
    assert shift <= degrees + DISTANCES[0]
    assert ((far.starts >= far.arm.lower) & (far.starts <= far.arm.upper)).all()


@pytest.mark.parametrize("dof", DIMENSIONS)
def test_a_trunk_is_an_arm_of_one_metre(dof: int) -> None:
    robot = trunk(dof)
    assert robot.dof == dof
    np.testing.assert_allclose(robot.fk(np.zeros(dof)).translation, [0.0, 0.0, 1.0], atol=1e-12)
    case = dimension_case(dof)
    assert (np.linalg.norm(case.p, axis=1) <= 1.0 + 1e-12).all()


def test_every_target_of_a_sweep_has_its_own_start() -> None:
    case = distance_case(5)
    assert case.starts is not None
    rows, _ = run_series(case, SEARCHES[0], 0)
    moved = np.array(rows)[:, COLUMNS.index("elongation_deg")]
    q = np.array(rows)[:, len(COLUMNS) :]
    np.testing.assert_allclose(moved, np.degrees(np.linalg.norm(q - case.starts, axis=1)))
    # A search that begins at the start stays near it; 327 deg is what no memory gives.
    assert np.median(moved) < 30.0


def test_readings_of_a_group_are_different_searches() -> None:
    for groups in GROUPS.values():
        for group in groups:
            digests = {series.digest() for _, series in group}
            assert len(digests) == len(group)


def test_another_seed_gives_other_rows() -> None:
    case = distance_case(5)
    first, again, other = (run_series(case, SEARCHES[0], 0, seed)[0] for seed in (0, 0, 1))
    timeless = [i for i, c in enumerate(COLUMNS) if not c.endswith("seconds")]
    np.testing.assert_array_equal(np.array(first)[:, timeless], np.array(again)[:, timeless])
    assert not np.array_equal(np.array(first)[:, timeless], np.array(other)[:, timeless])


def test_digests_leave_out_times_and_nothing_else(tmp_path: Path) -> None:
    row = np.arange(float(len(COLUMNS) + 2))
    for column in range(len(row)):
        changed = row.copy()
        changed[column] += 0.5
        write_rows(tmp_path / "a.csv", [row.tolist()], 2)
        write_rows(tmp_path / "b.csv", [changed.tolist()], 2)
        a, b = (archive.digest_of([tmp_path / f"{n}.csv"]) for n in "ab")
        is_time = column < len(COLUMNS) and COLUMNS[column].endswith("seconds")
        assert (a == b) == is_time


def test_rows_that_differ_from_the_manifest_are_named(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    row = 0.1 + np.arange(float(len(COLUMNS) + 2))
    files = [tmp_path / f"{run:03d}.csv" for run in range(2)]

    def made(last: np.ndarray) -> None:
        for run, file in enumerate(files):
            values = last if run == 1 else row
            write_rows(file, [[float(run), 0.0, *values[2:].tolist()]], 2)

    made(row)
    monkeypatch.setattr(archive, "ORDER", ("X",))
    monkeypatch.setattr(archive, "rows_of", lambda _name, _out: [("X/a", files)])
    manifest, kept = archive.manifest_of(tmp_path), figures_of("X/a", files)
    assert archive.verify(tmp_path, manifest, kept) == ([], [])
    made(row * (1.0 + 1e-12))
    assert archive.verify(tmp_path, manifest, kept) == (["X/a"], [])
    assert archive.verify(tmp_path, manifest, {}) == ([], ["X/a: other rows"])
    for column in ("eps_p", "theta_deg", "elongation_deg"):
        changed = row.copy()
        changed[COLUMNS.index(column)] *= 1.0 + 1e-4
        made(changed)
        assert archive.verify(tmp_path, manifest, kept) == ([], ["X/a: other rows"])
    files.pop()
    assert archive.verify(tmp_path, manifest, kept) == ([], ["X/a: 1 of 2 runs"])
