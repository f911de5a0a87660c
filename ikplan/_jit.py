"""The one place where kernels are compiled and cached.

numba's own cache looks only at the file of the function, so that a kernel that calls another
file's kernel can be stale after an edit; it also refuses to work where the cache folder is
read-only, as in a container. The cache here is stamped with the content of the file and of every
file it imports (so kernels are imported by ``from ikplan.... import ...``), reads from a read-only
folder, and says on stderr, once, when it has to compile. Kernels that are shipped, compiled, are
looked for first (``make kernels``).

Environment: ``IKPLAN_CACHE_DIR`` moves the cache (default: ``ikplan`` in the user's cache
folder); ``IKPLAN_KERNELS`` names a file of shipped kernels (empty: none);
``NUMBA_CPU_NAME=generic`` compiles for any processor of the family.
"""

from __future__ import annotations

import os
from collections.abc import Callable
from typing import ParamSpec, TypeVar, cast

import numba

from ikplan._kernels.cache import cache_folder, keep, when_compiling
from ikplan._kernels.linking import KernelCompiler, is_stable

__all__ = ["cache_folder", "kernel", "leaf_kernel", "when_compiling"]

P = ParamSpec("P")
R = TypeVar("R")


def kernel(function: Callable[P, R]) -> Callable[P, R]:
    """Compile ``function`` with numba: no GIL, cached on disk, no fast-math.

    Args:
        function: A function on plain arrays, scalars and named tuples of them.

    Returns:
        The compiled function.
    """
    return _compiled(function, counting=True)


def leaf_kernel(function: Callable[P, R]) -> Callable[P, R]:
    """Compile ``function`` like :func:`kernel`, without counting references to arrays.

    In a kernel of a microsecond that takes arrays out of named tuples, the counting costs as much
    as the work. numba refuses to compile such a function if it makes an array, also for the
    copy of an array into another (``a[:] = b``).

    Args:
        function: A function that makes no array and returns scalars.

    Returns:
        The compiled function.
    """
    return _compiled(function, counting=False)


def _compiled(function: Callable[P, R], *, counting: bool) -> Callable[P, R]:
    # Said explicitly, since a kernel compiled on behalf of a leaf would inherit its option.
    # Nothing calls kernels from C, so that no wrapper is compiled for that; the one for Python is
    # compiled where Python calls, if it can be kept apart.
    apart = is_stable(function) and not _disabled()
    dispatcher = numba.njit(
        nogil=True,
        error_model="numpy",
        no_cfunc_wrapper=True,
        no_cpython_wrapper=apart,
        pipeline_class=KernelCompiler,
        _nrt=counting,
    )(function)
    if not _disabled():
        keep(dispatcher, function, wrappers_apart=apart)
    return cast("Callable[P, R]", dispatcher)


def _disabled() -> bool:
    return os.environ.get("NUMBA_DISABLE_JIT", "0") not in ("", "0")
