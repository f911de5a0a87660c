"""What loading a compiled kernel needs of numba, which is less than compiling one needs.

numba brings its context up to date before it looks into a cache, and imports the modules that the
parts of a kernel come from: two hundred modules, which say how things are compiled, and a third of
SciPy with them. Code that is compiled already needs the symbols that it calls, and the constants
that come with it. numba's compiler brings the context up to date by itself.
"""

from __future__ import annotations

import functools
import importlib
import io
import pickle
import sys
from typing import Any

from numba.core import environment
from numba.core.runtime import rtsys

__all__ = ["ready_to_load", "unpickled"]

_SYMBOLS = "numba.cpython.hashing"
"""Module of numba that gives compiled code symbols when it is imported, beside its core."""


@functools.cache
def ready_to_load(context: Any) -> None:
    """Give compiled kernels what they call.

    Args:
        context: numba's target context.
    """
    importlib.import_module(_SYMBOLS)
    rtsys.initialize(context)


def unpickled(data: bytes) -> Any:
    """Return what numba keeps of a kernel, without importing the modules its parts come from."""
    return _Unpickler(io.BytesIO(data)).load()


def _environment(module: str, constants: list[Any], name: str) -> Any:
    """Return the environment of a function: its constants, and the names of its module.

    Only code in numba's object mode, which no kernel is, looks up names.
    """
    if module in sys.modules or not module.startswith("numba."):
        return environment._rebuild_env(module, constants, name)
    found = environment.lookup_environment(name)
    if found is None:
        found = environment.Environment({"__name__": module})
        found.consts[:] = constants
        found.env_name = name
        environment.Environment._memo[name] = found
    return found


class _Unpickler(pickle.Unpickler):
    def find_class(self, module: str, name: str, /) -> Any:
        if (module, name) == (environment.__name__, environment._rebuild_env.__name__):
            return _environment
        return super().find_class(module, name)
