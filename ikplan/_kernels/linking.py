"""Large kernels are called where they are, instead of being compiled into each of their callers.

numba links the code of everything that a kernel calls into it and optimises the whole again. For
kernels of a few instructions that is what makes them fast; for the solver that fifteen others call
it is fifteen times the work for nothing. So a caller only declares a large kernel, and what it was
compiled to is loaded before the caller: numba runs what a library wants done before it is loaded
(``reload_init``), hands it on to whatever it is linked into, and keeps it in its caches. For that a
kernel has the same symbol in every process.
"""

from __future__ import annotations

import functools
import importlib
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from llvmlite import binding
from numba.core import bytecode
from numba.core.compiler import Compiler
from numba.core.errors import NumbaError
from numba.core.untyped_passes import ExtractByteCode

from ikplan._kernels.sources import PACKAGE, digest_of

__all__ = [
    "KernelCompiler",
    "StaleKernelError",
    "call_out_of_line",
    "is_stable",
    "reduced",
    "restored",
    "with_names",
]

_LARGE = 500
"""LLVM instructions from which on a call costs nothing beside the work."""
_EMPTY = ""


class StaleKernelError(RuntimeError):
    """What was compiled calls a kernel that has changed since."""


@dataclass(frozen=True)
class Loaded:
    """Has a kernel loaded, or compiled, before one that calls it.

    Attributes:
        module: Its module.
        name: Its name there.
        arguments: numba's types of its arguments.
        symbol: The name that its callers know it by.
    """

    module: str
    name: str
    arguments: tuple[Any, ...]
    symbol: str

    def __call__(self) -> None:
        """Load the kernel.

        Raises:
            StaleKernelError: There is none of this symbol, or it takes other arguments now.
        """
        stale = StaleKernelError(
            f"{self.module}.{self.name} is not what its caller was compiled with: remove the "
            "caller from its cache"
        )
        dispatcher = _found(self.module, self.name)
        if dispatcher is None:
            raise stale
        try:
            dispatcher.compile(self.arguments)
        except (TypeError, NumbaError) as error:  # of another number, and of other types
            raise stale from error
        found = dispatcher.overloads.get(self.arguments)
        if found is None or found.fndesc.llvm_func_name != self.symbol:
            raise stale


class KernelCompiler(Compiler):  # type: ignore[misc]
    """numba's compiler, with symbols that do not depend on what was compiled before."""

    def compile_extra(self, func: Any) -> Any:
        """Compile a function."""
        identity = bytecode.FunctionIdentity.from_function(func)
        if is_stable(func):
            digest = digest_of(Path(func.__code__.co_filename))
            identity.unique_id = f"{digest}_{identity.firstlineno}"
            identity.unique_name = f"{identity.func_qualname}${identity.unique_id}"
        self.state.func_id = identity
        ExtractByteCode().run_pass(self.state)
        self.state.lifted = ()
        self.state.lifted_from = None
        return self._compile_bytecode()


def is_stable(function: Callable[..., Any]) -> bool:
    """Whether there is one function of its name and place, not one each time that code runs."""
    file = Path(function.__code__.co_filename)
    return "<locals>" not in function.__qualname__ and file.is_relative_to(PACKAGE)


def _found(module: str, name: str) -> Any:
    """Return the kernel of a name; None: it cannot be found by name, as one within a function."""
    found: Any = importlib.import_module(module)
    for part in name.split("."):
        found = getattr(found, part, None)
    return found if hasattr(found, "overloads") else None


def call_out_of_line(dispatcher: Any, result: Any) -> None:
    """Have what calls a kernel from now on declare it only, if it is large.

    Args:
        dispatcher: The kernel.
        result: What it was compiled to.
    """
    function, symbol = dispatcher.py_func, result.fndesc.llvm_func_name
    module, name = function.__module__, function.__qualname__
    if not is_stable(function) or _found(module, name) is not dispatcher:
        return
    if not _large(result.library.get_function(symbol)):
        return
    _declare(result.library, Loaded(module, name, tuple(result.signature.args), symbol))


def _large(function: Any) -> bool:
    # Each instruction is a line of the text, further lines of one are set deeper: read at once,
    # since going from one to the next asks LLVM for each.
    text = str(function)
    return text.count("\n  ") - text.count("\n   ") >= _LARGE


def _declare(library: Any, loaded: Loaded) -> None:
    """Link nothing of a library into its callers, which have it loaded instead."""
    library.loaded = loaded
    library._reload_init = {loaded}
    library._get_module_for_linking = _nothing


@functools.cache
def _nothing() -> Any:
    return binding.parse_assembly(_EMPTY)


def reduced(result: Any) -> tuple[Any, ...]:
    """Return what is kept of a compiled kernel.

    Args:
        result: What it was compiled to.
    """
    loaded = getattr(result.library, "loaded", None)
    library, *rest = result._reduce()
    if loaded is not None:
        library = with_names(library, (result.fndesc.llvm_func_name,))
    return (library, *rest), loaded


def with_names(library: tuple[Any, ...], names: tuple[str, ...]) -> tuple[Any, ...]:
    """Return a serialised library that is not linked into others: its code, and what to find there.

    Args:
        library: The library as numba serialises it.
        names: Symbols that are looked up in it.
    """
    name, kind, (code, _) = library
    text = "".join(f'define void @"{each}"() {{ unreachable }}\n' for each in names)
    return name, kind, (code, binding.parse_assembly(text).as_bitcode())


def restored(rebuild: Callable[[Any], Any], kept: tuple[Any, ...]) -> Any:
    """Return a compiled kernel.

    Args:
        rebuild: Makes it of what numba keeps.
        kept: What :func:`reduced` returns.

    Returns:
        The kernel; None: it calls one that has changed.
    """
    payload, loaded = kept
    try:
        result = rebuild(payload)
    except StaleKernelError:
        return None
    if loaded is None:
        result.library._reload_init.update(result.reload_init)
    else:
        _declare(result.library, loaded)
    return result
