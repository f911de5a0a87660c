"""Importing this keeps numeric libraries from starting threads of their own.

One worker a processor is the parallelism of the service: threads within each would only get into
each other's way, and a process that has threads cannot be forked safely. It has to come before
the first import of numpy.
"""

from __future__ import annotations

import os

for _name in (
    "OMP_NUM_THREADS",
    "OPENBLAS_NUM_THREADS",
    "MKL_NUM_THREADS",
    "VECLIB_MAXIMUM_THREADS",
    "NUMBA_NUM_THREADS",
):
    os.environ[_name] = "1"
