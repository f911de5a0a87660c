"""Sockets that outlive the services of tests."""

from __future__ import annotations

import gc
import warnings

__all__ = ["free_local_sockets"]


def free_local_sockets() -> None:
    """Free the ends of local sockets that outlive a service.

    They are two, of a worker's socket pairs; no file of tests leaves them by itself. Anything else
    that is left open ends the run as an error.
    """
    with warnings.catch_warnings():
        warnings.filterwarnings("ignore", r"unclosed <socket\.socket fd=\d+, family=1,")
        gc.collect()
