"""Plant faults and see whether the tests find them: ``python -m benchmarks.mutants``.

The exit code is 1 if a mutant survives that ``equivalent.toml`` does not list, and 2 if the tests
do not pass as the code is.
"""

from __future__ import annotations

import argparse
import os
import signal
import sys
import time
from dataclasses import replace

from benchmarks.mutants.catalogue import Module, equivalents, modules, named_mutants
from benchmarks.mutants.drawing import draw, possible
from benchmarks.mutants.mutant import Mutant, StaleMutantError
from benchmarks.mutants.report import find_equivalent, line_of, print_survivors, print_table
from benchmarks.mutants.rooms import ROOT
from benchmarks.mutants.runner import BaselineError, Verdict, run_mutants

_PACKAGE = ROOT / "ikplan"


def _options() -> argparse.Namespace:
    parser = argparse.ArgumentParser(prog="python -m benchmarks.mutants", description=__doc__)
    parser.add_argument("--only", default="", metavar="TEXT", help="names or files that contain it")
    parser.add_argument("--drawn", type=int, default=150, metavar="N", help="how many are drawn")
    parser.add_argument("--seed", type=int, default=11, help="of the draw (default: 11)")
    parser.add_argument(
        "--every", action="store_true", help="every mutant of the modules, instead of a draw"
    )
    parser.add_argument("--unnamed", action="store_true", help="leave out those that have names")
    parser.add_argument("--list", action="store_true", help="list the mutants and run nothing")
    parser.add_argument(
        "--without", action="append", default=[], metavar="TEST", help="leave a test file out"
    )
    parser.add_argument("--processes", type=int, default=2, metavar="N", help="how many at a time")
    return parser.parse_args()


def _chosen(options: argparse.Namespace) -> list[Mutant]:
    files = [module.file for module in modules().values() if module.drawn]
    if options.every:
        drawn = [m for file in files for m in possible(_PACKAGE, file)]
    else:
        drawn = draw(_PACKAGE, files, options.drawn, options.seed)
    mutants = drawn if options.unnamed else [*named_mutants(), *drawn]
    for mutant in mutants:  # a stale one ends it here
        mutant.apply((_PACKAGE / mutant.file).read_text())
    return [m for m in mutants if options.only in m.name or options.only in m.file]


def _planned(without: list[str]) -> dict[str, Module]:
    """The modules, some tests left out."""
    return {
        file: replace(module, tests=tuple(t for t in module.tests if t not in without))
        for file, module in modules().items()
    }


def main() -> int:
    """Run what the command line asks for."""
    options = _options()
    try:
        mutants = _chosen(options)
    except StaleMutantError as error:
        print(f"stale mutant: {error}", file=sys.stderr)
        return 2
    if options.list:
        for mutant in mutants:
            line = "" if mutant.line is None else f":{mutant.line}"
            old, new = (" ".join(text.split()) for text in (mutant.old, mutant.new))
            print(f"{mutant.file}{line}  {mutant.name}  {old}  ->  {new}")
        print(f"{len(mutants)} mutants")
        return 0
    if not mutants:
        print(f"no mutant contains {options.only!r}", file=sys.stderr)
        return 2
    begin = time.monotonic()

    def tell(verdict: Verdict) -> None:
        print(line_of(verdict), flush=True)

    os.environ.pop("NUMBA_DISABLE_JIT", None)
    # The rooms are removed then too.
    signal.signal(signal.SIGTERM, lambda *_: sys.exit(143))
    try:
        verdicts, before = run_mutants(mutants, _planned(options.without), options.processes, tell)
    except BaselineError as error:
        print(f"the tests cannot tell anything: {error}", file=sys.stderr)
        return 2
    known = equivalents()
    survivors = [(v, find_equivalent(_PACKAGE, v, known)) for v in verdicts if v.survived]
    print_survivors(_PACKAGE, survivors)
    print_table(verdicts, [v for v, entry in survivors if entry is not None], modules())
    took = time.monotonic() - begin
    print(f"\n{len(verdicts)} mutants in {took:.0f} s, {before:.0f} s of it without any")
    return 1 if any(entry is None for _, entry in survivors) else 0


if __name__ == "__main__":
    sys.exit(main())
