"""Run what is missing of an experiment, one file a (case, series, run)."""

from __future__ import annotations

import ast
import base64
import contextlib
import functools
import hashlib
import importlib
import json
import sys
import tempfile
import time
import traceback
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

import ikplan
from benchmarks.papers.experiment import Experiment, Results, Study
from benchmarks.papers.rows import read_rows, write_rows
from benchmarks.papers.series import OPTIMUM, PLANNER, Series
from benchmarks.papers.solving import run_series, warm_up
from ikplan.batch.choice import executor_for
from ikplan.batch.chunks import Line, Pace, chunks_of
from ikplan.batch.executor import Answers
from ikplan.batch.outcome import OK, Outcome, failed
from ikplan.errors import IkplanError

__all__ = ["find_experiment", "rows_of", "run_experiment", "studies_of"]

Unit = tuple[int, int, int]
"""Study, series, run."""


@functools.cache
def find_experiment(name: str) -> Experiment:
    """Return an experiment by name, such as "E1"."""
    module = importlib.import_module(f"benchmarks.papers.{name.lower()}")
    experiment: Experiment = module.EXPERIMENT
    return experiment


@functools.cache
def studies_of(name: str, thin: int) -> list[Study]:
    """Return the studies of an experiment."""
    return find_experiment(name).studies(thin)


@functools.cache
def _warmed(name: str, thin: int, study: int, series: int) -> None:
    chosen = studies_of(name, thin)[study]
    warm_up(chosen.case, chosen.series[series])


SEARCHES = ("ik/metaheuristics", "ik/baselines")
PLANNING = ("ik", "kinematics", "planning", "robots")
"""Folders of the library that the rows of searches, and those of the planner, are made by."""


def _without_words(source: str) -> str:
    """Return the syntax tree of a module without its docstrings: what rows depend on."""
    tree = ast.parse(source)
    for node in ast.walk(tree):
        body = getattr(node, "body", None)
        first = body[0] if isinstance(body, list) and body else None
        if isinstance(first, ast.Expr) and isinstance(first.value, ast.Constant):
            first.value.value = ""
    return ast.dump(tree)


@functools.cache
def _code(folders: tuple[str, ...]) -> str:
    """Return a digest of the sources: rows of other code are not taken for those of this."""
    digest = hashlib.sha256()
    library = Path(ikplan.__file__).parent
    for folder in folders:
        for source in sorted((library / folder).rglob("*.py")):
            # Descriptions and defaults: a series' own digest has its parameters.
            if "catalogue" not in source.parts:
                digest.update(_without_words(source.read_text()).encode())
    return digest.hexdigest()[:8]


def _folder(out: Path, study: Study, series: Series) -> Path:
    label = "".join(c if c.isalnum() else "-" for c in series.name)
    code = _code(PLANNING if series.method in (PLANNER, OPTIMUM) else SEARCHES)
    return out / study.case.name / f"{label}-{study.case.digest()}{series.digest()}{code}"


def _runs(series: Series, runs: int) -> int:
    return 1 if series.method == OPTIMUM else min(runs, series.max_runs)


def _do(name: str, thin: int, unit: Unit, path: Path, seed: int) -> None:
    """Run one unit and write its file; in a worker."""
    study, series, run = unit
    _warmed(name, thin, study, series)
    chosen = studies_of(name, thin)[study]
    rows, curve = run_series(chosen.case, chosen.series[series], run, seed)
    path.parent.mkdir(parents=True, exist_ok=True)
    if curve.size:
        np.save(path.with_suffix(".npy"), curve.astype(np.float32))
    write_rows(path, rows, chosen.case.arm.dof)


@dataclass(frozen=True)
class UnitWork:
    """Runs units of an experiment, in workers of an executor, wherever they are.

    Attributes:
        name: E1 ... E9.
        thin: Every how many-th target is used.
        seed: Seed of the random numbers.
    """

    name: str
    thin: int
    seed: int = 0

    @property
    def preload(self) -> str:
        """The module that workers import first."""
        return "benchmarks.papers.runner"

    def answer(self, lines: Sequence[bytes]) -> Answers:
        """Run the units of some lines; the answer to each is its files."""
        begun = time.perf_counter()
        outcomes, faults = [], []
        for line in lines:
            study, series, run = json.loads(line)
            try:
                with tempfile.TemporaryDirectory() as folder:
                    path = Path(folder) / "rows.csv"
                    _do(self.name, self.thin, (study, series, run), path, self.seed)
                    made = {
                        file.suffix: base64.b64encode(file.read_bytes()).decode()
                        for file in sorted(Path(folder).iterdir())
                    }
                outcomes.append(Outcome(OK, json.dumps(made).encode()))
            except Exception:
                faults.append(traceback.format_exc())
                outcomes.append(failed(IkplanError(f"unit {study, series, run} failed")))
        return Answers(outcomes, time.perf_counter() - begun, tuple(faults))


def _keep(path: Path, outcome: Outcome) -> None:
    """Write the files of a unit, the rows last: a unit whose rows are there is done.

    Raises:
        RuntimeError: The unit failed, or ended its worker.
    """
    if outcome.slug:
        raise RuntimeError(outcome.document.decode())
    path.parent.mkdir(parents=True, exist_ok=True)
    for suffix, content in sorted(json.loads(outcome.document).items(), reverse=True):
        target = path.with_suffix(suffix)
        part = target.with_name(f"{target.name}.part")
        part.write_bytes(base64.b64decode(content))
        part.replace(target)


def _units(studies: list[Study], runs: int, out: Path) -> Iterator[tuple[Unit, Path]]:
    """Every unit; all series of a run before the next run."""
    for run in range(runs):
        for i, study in enumerate(studies):
            for j, series in enumerate(study.series):
                if run < _runs(series, runs):
                    yield (i, j, run), _folder(out, study, series) / f"{run:03d}.csv"


def rows_of(name: str, out: Path) -> Iterator[tuple[str, list[Path]]]:
    """Yield every series of an experiment as "case/series" with the files of its runs, in order."""
    for study in studies_of(name, 1):
        for series in study.series:
            folder = _folder(out, study, series)
            yield f"{study.case.name}/{series.name}", sorted(folder.glob("*.csv"))


class _Progress:
    """One line on stderr; on something else than a terminal, one line a tenth."""

    def __init__(self, name: str, total: int) -> None:
        self.name, self.total, self.done = name, total, 0
        self.begin = time.perf_counter()

    def step(self) -> None:
        self.done += 1
        seconds = time.perf_counter() - self.begin
        left = seconds / self.done * (self.total - self.done)
        bar = "#" * (30 * self.done // self.total)
        line = (
            f"{self.name} [{bar:30}] {self.done}/{self.total}, {seconds:.0f} s, {left:.0f} s left"
        )
        if sys.stderr.isatty():
            end = "\n" if self.done == self.total else ""
            print(f"\r{line:90}", end=end, file=sys.stderr, flush=True)
        elif self.done % max(self.total // 10, 1) == 0 or self.done == self.total:
            print(line, file=sys.stderr, flush=True)


def run_experiment(
    name: str,
    runs: int,
    jobs: int,
    thin: int,
    out: Path,
    on: str | None = None,
    seed: int = 0,
) -> Results:
    """Make every run that is missing, and return all results.

    Args:
        name: E1 ... E9.
        runs: Runs of every series.
        jobs: Workers.
        thin: Every how many-th target is used, where an experiment has many.
        out: Folder of the rows, by case, which experiments share; what is there already is not
            made again.
        on: Where they are made: "local", "ray" or "ray=ADDRESS", as for batches; None: here if
            there is one worker, else "local". Rows are the same, but for the seconds they took.
        seed: Seed of the random numbers; rows of other seeds than 0 have a folder of their own.
    """
    if seed:
        out = out / f"seed-{seed}"
    studies = studies_of(name, thin)
    missing = [(u, p) for u, p in _units(studies, runs, out) if not p.exists()]
    progress = _Progress(name, max(len(missing), 1))
    if on is None and jobs == 1:
        for unit, path in missing:
            _do(name, thin, unit, path, seed)
            progress.step()
    elif missing:
        lines = (Line(k, json.dumps(unit).encode(), 0) for k, (unit, _) in enumerate(missing))
        executor = executor_for(on or "local", UnitWork(name, thin, seed), jobs)
        with contextlib.closing(executor):
            for done in executor.run(chunks_of(lines, Pace(1))):
                for line, outcome in zip(done.chunk.lines, done.outcomes, strict=True):
                    _keep(missing[line.index][1], outcome)
                    progress.step()
    tables, curves = {}, {}
    for study in studies:
        for series in study.series:
            count = _runs(series, runs)
            paths = [_folder(out, study, series) / f"{run:03d}.csv" for run in range(count)]
            key = (study.case.name, series.name)
            tables[key] = read_rows(paths)
            arrays = [p.with_suffix(".npy") for p in paths]
            if arrays[0].exists():
                curves[key] = np.array([np.load(a) for a in arrays], dtype=np.float64)
    return Results(tables, curves, runs)
