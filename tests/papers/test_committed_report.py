"""The committed report is made of the archived rows and of the committed texts."""

from __future__ import annotations

import json
import re
from dataclasses import replace

import numpy as np
import pytest

from benchmarks.papers import archive
from benchmarks.papers.claims import UNDECIDED, VERDICTS, short
from benchmarks.papers.document import number
from benchmarks.papers.report import ORDER, TEXT
from benchmarks.papers.runner import studies_of
from benchmarks.papers.summary import OWN, summary
from benchmarks.papers.sweeps import RIVALS

REPORT = (archive.HERE.parent / "REPORT.md").read_text()
MANIFEST = json.loads((archive.HERE / "manifest.json").read_text())
MEDIANS = np.load(archive.HERE / "medians.npz")


def tables_of(case: str) -> dict[str, dict[str, str]]:
    """Return the first table below the heading of a case, by series and column."""
    (body,) = re.findall(rf"^### {case}[:,][^\n]*\n(.*?)(?=^##)", REPORT, re.M | re.S)
    lines = [line for line in body.splitlines() if line.startswith("|")]
    head = [cell.strip() for cell in lines[0].strip("|").split("|")]
    rows: dict[str, dict[str, str]] = {}
    for line in lines[2:]:
        cells = [cell.strip() for cell in line.strip("|").split("|")]
        if len(cells) != len(head):
            break
        rows.setdefault(cells[0], dict(zip(head, cells, strict=True)))
    return rows


def same(printed: str, value: float) -> bool:
    """Whether a figure is printed as one that single precision cannot tell from ``value``."""
    return printed in {number(value * (1.0 + shift)) for shift in (0.0, -1e-6, 1e-6)}


def series_of(experiment: str) -> list[tuple[str, str]]:
    """Return every case and series of an experiment."""
    return [(s.case.name, x.name) for s in studies_of(experiment, 1) for x in s.series]


@pytest.mark.parametrize("experiment", ORDER)
def test_every_experiment_has_its_section_and_its_series_are_archived(experiment: str) -> None:
    assert f"\n## {experiment}: " in REPORT
    for study in studies_of(experiment, 1):
        for series in study.series:
            label = f"{study.case.name}/{series.name}"
            runs = MANIFEST["series"][label]["runs"]
            assert MEDIANS[f"{label}/runs"].shape == (2, runs)
            assert MEDIANS[f"{label}/eps_p"].shape == (study.case.count,)
            assert runs <= series.max_runs


@pytest.mark.parametrize("case", ["E1a", "E1b", "E1c", "E1b-bent"])
def test_means_and_maxima_of_the_helix_are_those_archived(case: str) -> None:
    table = tables_of(case)
    for name in (n for c, n in series_of("E1") if c == case):
        mean, largest = 100.0 * MEDIANS[f"{case}/{name}/runs"].astype(float)
        assert same(table[name]["error mean cm"], mean.mean()), name
        assert same(table[name]["max"], largest.max()), name


@pytest.mark.parametrize(
    ("experiment", "case"), [("E7", "E7a"), ("E7", "E7c"), ("E7", "E7f"), ("E8", "E8a")]
)
def test_maxima_of_runs_over_poses_are_those_archived(experiment: str, case: str) -> None:
    table = tables_of(case)
    for name in (n for c, n in series_of(experiment) if c == case):
        largest = 1e3 * MEDIANS[f"{case}/{name}/runs"][1].astype(float)
        printed = table[name]["ours, mean of the runs' max"].split(" / ")[0]
        assert same(printed, largest.mean()), name


@pytest.mark.parametrize("case", [s.case.name for e in ("S1", "S2") for s in studies_of(e, 1)])
@pytest.mark.parametrize(
    ("column", "factor", "what"), [("elongation_deg", 1.0, "joint motion"), ("eps_p", 1e3, "error")]
)
def test_medians_of_the_sweeps_are_those_archived(
    case: str, column: str, factor: float, what: str
) -> None:
    sweep, _, value = case.partition("-")
    (line,) = re.findall(
        rf"^\| {sweep}, [^|]*\b{value}: IK-BA has the smallest {what} [^\n]*$", REPORT, re.M
    )
    for name in ["IK-BA", *(s.name for s in RIVALS)]:
        median = factor * float(np.median(MEDIANS[f"{case}/{name}/{column}"].astype(float)))
        assert f"{name} {short(median)}" in line


@pytest.mark.parametrize("name", ["found", "contradictions", "defaults"])
def test_the_words_of_the_report_are_those_of_the_texts(name: str) -> None:
    assert (TEXT / f"{name}.md").read_text().strip() in REPORT


def test_the_summary_is_that_of_the_archived_claims() -> None:
    assert f"\n{summary(archive.read_archived_claims(), ORDER)}\n## " in REPORT


def test_a_verdict_that_another_seed_turns_is_printed_as_undecided_and_kept() -> None:
    own = archive.read_archived_claims()[OWN]["E9"]
    turned = next(c for c in own if c.verdict != UNDECIDED)
    other = next(v for v in VERDICTS if v not in (turned.verdict, UNDECIDED))
    made = {"seed-7": {"E9": [replace(c, verdict=other) if c is turned else c for c in own]}}
    text, seeds = archive.hold(REPORT, made)
    (line,) = [row for row in text.splitlines() if row.startswith(f"| {turned.subject} |")]
    assert line.endswith(f"| undecided: {turned.verdict}; another seed: {other} |")
    assert list(seeds["seed-7"]["E9"]) == made["seed-7"]["E9"]
    assert archive.hold(text, made)[0] == text
    assert text.partition("\n## What was found")[2] == REPORT.partition("\n## What was found")[2]


def test_figures_of_the_reports_own_seed_are_not_replaced() -> None:
    assert archive.hold(REPORT, {OWN: {"E9": []}})[0] == REPORT


def test_claims_of_another_version_are_refused() -> None:
    with pytest.raises(ValueError, match="says nothing of"):
        archive.hold(REPORT, {"seed-7": {"E9": []}})
