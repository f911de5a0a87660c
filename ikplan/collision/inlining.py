"""Kernels that their callers take a copy of instead of calling them.

A call hands over every field of the named tuples of bodies and work space, which costs as much as
the work of a kernel of some tens of nanoseconds.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import ParamSpec, TypeVar, cast

import numba

__all__ = ["inlined_kernel"]

P = ParamSpec("P")
R = TypeVar("R")


def inlined_kernel(function: Callable[P, R]) -> Callable[P, R]:
    """Compile ``function`` like a leaf kernel, into each kernel that calls it.

    Args:
        function: A function that makes no array and returns scalars.

    Returns:
        The function; called from Python it is compiled by itself and not kept.
    """
    return cast(
        "Callable[P, R]",
        numba.njit(inline="always", nogil=True, error_model="numpy", _nrt=False)(function),
    )
