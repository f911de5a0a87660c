"""Which mutants change what is compiled."""

from __future__ import annotations

import ast

from benchmarks.mutants.mutant import Mutant

__all__ = ["changes_kernels"]

_DECORATORS = ("kernel", "leaf_kernel")


def changes_kernels(source: str, mutant: Mutant) -> bool:
    """Return whether the kernels of a module have to run without compilation.

    They have to where the fault is in a kernel, or in a constant that a kernel may use, or moves
    a kernel to another line: the cache of kernels knows them by their lines.

    Args:
        source: The module as it is.
        mutant: The fault.
    """
    if "from ikplan._jit import" not in source:
        return False
    mutated = mutant.apply(source)
    if mutated.count("\n") != source.count("\n"):
        return True
    lines = zip(source.splitlines(), mutated.splitlines(), strict=True)
    changed = [k for k, (before, after) in enumerate(lines, 1) if before != after]
    functions = [n for n in ast.parse(source).body if isinstance(n, ast.FunctionDef)]
    plain = [f for f in functions if not any(_compiles(d) for d in f.decorator_list)]
    spans = [(f.lineno, f.end_lineno or f.lineno) for f in plain]
    return not all(any(first <= k <= last for first, last in spans) for k in changed)


def _compiles(decorator: ast.expr) -> bool:
    return isinstance(decorator, ast.Name) and decorator.id in _DECORATORS
