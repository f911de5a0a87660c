"""What a run prints."""

from __future__ import annotations

import collections
from collections.abc import Sequence
from pathlib import Path

from benchmarks.mutants.catalogue import Equivalent, Module
from benchmarks.mutants.runner import Verdict

__all__ = ["find_equivalent", "line_of", "print_survivors", "print_table"]


def find_equivalent(
    package: Path, verdict: Verdict, known: Sequence[Equivalent]
) -> Equivalent | None:
    """Return the entry that says why no test can find a mutant, or None if there is none."""
    mutant = verdict.mutant
    old, new = mutant.changed_lines((package / mutant.file).read_text())
    for entry in known:
        if (entry.file, entry.old, entry.new) == (mutant.file, old, new):
            return entry
    return None


def line_of(verdict: Verdict) -> str:
    """One line about a mutant."""
    mutant = verdict.mutant
    where = mutant.file if mutant.line is None else f"{mutant.file}:{mutant.line}"
    what = "survived" if verdict.survived else verdict.result
    return f"{what:8s} {verdict.seconds:5.1f} s  {where}  {mutant.name}  {verdict.by}".rstrip()


def print_survivors(package: Path, survivors: Sequence[tuple[Verdict, Equivalent | None]]) -> None:
    """Print what each survivor changes, and why it may."""
    for verdict, equivalent in survivors:
        mutant = verdict.mutant
        what = "SURVIVOR" if equivalent is None else "equivalent"
        print(f"\n{what}: {mutant.name} ({mutant.why})")
        if equivalent is not None:
            print(f"  {equivalent.reason}")
        print(mutant.diff((package / mutant.file).read_text()))


def print_table(
    verdicts: Sequence[Verdict],
    equivalent: Sequence[Verdict],
    modules: dict[str, Module],
) -> None:
    """Print figures for each module and each room."""
    rows: dict[str, collections.Counter[str]] = {}
    for verdict in verdicts:
        module = modules[verdict.mutant.file]
        result = "equivalent" if verdict in equivalent else verdict.result
        for key in (f"{module.room}/", f"{module.room}/ {module.file}", "~"):
            row = rows.setdefault(key, collections.Counter())
            row["all"] += 1
            row[result if result in ("passed", "timeout", "equivalent") else "killed"] += 1
    print(f"\n{'':42s} mutants  killed  timeout  equivalent  survived")
    for key, row in sorted(rows.items()):
        head = key.endswith("/") or key == "~"
        name = "all" if key == "~" else key if head else f"  {key.split()[1]}"
        counted = row["all"] - row["equivalent"]
        share = f"  {100.0 * row['passed'] / counted:.1f} %" if head and counted else ""
        print(
            f"{name:42s} {row['all']:7d} {row['killed']:7d} {row['timeout']:8d} "
            f"{row['equivalent']:11d} {row['passed']:9d}{share}"
        )
