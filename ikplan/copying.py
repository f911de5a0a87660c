"""Copies of arrays into others of the same shape, in kernels.

For ``out[:] = values`` numba compiles the words of an error about shapes into the kernel, strings
and all, in every process that compiles: seconds of the first use.
"""

from __future__ import annotations

from ikplan._jit import leaf_kernel
from ikplan.arrays import Array, Indices

__all__ = ["copy_into", "copy_rows_into"]


@leaf_kernel
def copy_into(out: Array | Indices, values: Array | Indices) -> None:
    """Write values, shape (n,), to an array of that shape."""
    for k in range(out.shape[0]):
        out[k] = values[k]


@leaf_kernel
def copy_rows_into(out: Array, rows: Array) -> None:
    """Write rows, shape (m, n), to an array of that shape."""
    for i in range(out.shape[0]):
        for k in range(out.shape[1]):
            out[i, k] = rows[i, k]
