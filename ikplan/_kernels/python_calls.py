"""What Python calls a kernel by, compiled when Python does.

Two thirds of the kernels are called by other kernels only. What unpacks arguments from Python and
packs results for it is therefore a piece of its own, made at the first such call and kept beside
the kernel.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, NamedTuple, Protocol

from numba.core.compiler import Flags, _make_subtarget
from numba.core.compiler_lock import global_compiler_lock

from ikplan._kernels.linking import with_names

__all__ = ["KeptWrappers", "Wrapper", "wrap_when_called"]


class Wrapper(NamedTuple):
    """What Python calls a kernel by, as it is kept.

    Attributes:
        symbol: The kernel's.
        library: The code, as numba serialises it.
        constants: Python objects that kernel and piece use, those of the kernel first.
    """

    symbol: str
    library: Any
    constants: tuple[Any, ...]


class KeptWrappers(Protocol):
    """Where the pieces are kept."""

    def load_wrapper(self, sig: Any, codegen: Any) -> Wrapper | None:
        """Return the piece for a signature, if it is kept."""

    def save_wrapper(self, sig: Any, codegen: Any, wrapper: Wrapper) -> None:
        """Keep the piece for a signature."""


def wrap_when_called(dispatcher: Any, kept: KeptWrappers) -> None:
    """Have numba make a kernel callable from Python when Python calls it.

    Args:
        dispatcher: The kernel, compiled without what Python calls it by.
        kept: Where the pieces are kept.
    """
    for_arguments = dispatcher._compile_for_args
    held: dict[tuple[Any, ...], Any] = {}  # what numba calls belongs to whoever gives it to numba

    def add_overload(result: Any) -> None:
        dispatcher.overloads[tuple(result.signature.args)] = result

    def compile_for_args(*arguments: Any, **named: Any) -> Any:
        entry = for_arguments(*arguments, **named)
        with global_compiler_lock:
            result = next(
                (r for r in dispatcher.overloads.values() if r.entry_point is entry), None
            )
            if result is None:  # a further call for literal arguments made it already
                return entry
            signature = tuple(result.signature.args)
            if signature not in held:
                held[signature] = _wrapped(dispatcher, result, kept)
                codes = [each._code for each in signature]
                dispatcher._insert(codes, held[signature], result.objectmode)
        return held[signature]

    dispatcher.add_overload = add_overload
    dispatcher._compile_for_args = compile_for_args


def _wrapped(dispatcher: Any, result: Any, kept: KeptWrappers) -> Callable[..., Any]:
    """Return what Python calls a compiled kernel by."""
    signature, symbol = tuple(result.signature.args), result.fndesc.llvm_func_name
    codegen = dispatcher.targetctx.codegen()
    found = kept.load_wrapper(signature, codegen)
    constants = result.environment.consts
    if found is not None and found.symbol == symbol:
        library = codegen.unserialize_library(found.library)
        constants.extend(found.constants[len(constants) :])
        return _callable(dispatcher.targetctx, library, result)
    dispatcher.targetctx.refresh()  # compiling needs more of numba than loading did
    flags = Flags()
    dispatcher.targetdescr.options.parse_as_flags(flags, dispatcher.targetoptions)
    context = _make_subtarget(dispatcher.targetctx, flags)
    library = codegen.create_library(f"{result.fndesc.qualname} for Python")
    library.enable_object_caching()
    with context.push_code_library(library):
        context.create_cpython_wrapper(
            *(library, result.fndesc, result.environment, result.call_helper), release_gil=True
        )
    made = _callable(context, library, result)
    data = library.serialize_using_object_code()
    name = result.fndesc.llvm_cpython_wrapper_name
    made_of = Wrapper(symbol, with_names(data, (name,)), tuple(constants))
    kept.save_wrapper(signature, codegen, made_of)
    return made


def _callable(context: Any, library: Any, result: Any) -> Callable[..., Any]:
    made: Callable[..., Any] = context.get_executable(library, result.fndesc, result.environment)
    return made
