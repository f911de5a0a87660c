"""The mutants kept as data fit the code as it is, and have tests that exist."""

from __future__ import annotations

import random

import pytest

from benchmarks.mutants.catalogue import equivalents, modules, named_mutants
from benchmarks.mutants.drawing import draw, possible
from benchmarks.mutants.mutant import Mutant
from benchmarks.mutants.rooms import ROOT

PACKAGE = ROOT / "ikplan"
NAMED = named_mutants()
FILES = list(modules())


def source(file: str) -> str:
    return (PACKAGE / file).read_text()


@pytest.mark.parametrize("mutant", NAMED, ids=lambda m: m.name)
def test_a_named_mutant_applies_to_its_module_and_compiles(mutant: Mutant) -> None:
    text = source(mutant.file)
    mutated = mutant.apply(text)
    assert mutated != text
    assert mutant.why
    removed, added = mutant.changed_lines(text)
    assert removed != added


def test_there_are_mutants_of_every_room() -> None:
    rooms = {module.room for module in modules().values()}
    assert {modules()[m.file].room for m in NAMED} == rooms
    assert len(NAMED) >= 40


def test_every_test_planned_exists() -> None:
    planned = {test for module in modules().values() for test in module.tests}
    planned |= {test for mutant in NAMED for test in mutant.tests}
    for test in planned:
        assert (ROOT / test.partition("::")[0]).exists(), test


@pytest.mark.parametrize("file", FILES)
def test_possible_mutants_apply_and_no_two_have_the_same_name(file: str) -> None:
    text, mutants = source(file), possible(PACKAGE, file)
    assert len({m.name for m in mutants}) == len(mutants)
    # To apply one is to compile its module: a sample, drawn by the module's name.
    for mutant in random.Random(file).sample(mutants, min(30, len(mutants))):
        assert mutant.apply(text) != text


def test_an_equivalent_mutant_is_one_of_those_possible() -> None:
    changes: dict[str, set[tuple[str, str]]] = {}
    for entry in equivalents():
        if entry.file not in changes:
            text = source(entry.file)
            changes[entry.file] = {m.changed_lines(text) for m in possible(PACKAGE, entry.file)}
        assert (entry.old, entry.new) in changes[entry.file], entry
        assert entry.reason


def test_a_draw_is_that_of_its_seed() -> None:
    drawn = draw(PACKAGE, FILES, 30, 1)
    assert drawn == draw(PACKAGE, FILES, 30, 1)
    assert drawn != draw(PACKAGE, FILES, 30, 2)
    assert len(set(drawn)) == 30
    assert set(drawn) < set(draw(PACKAGE, FILES, 60, 1))
