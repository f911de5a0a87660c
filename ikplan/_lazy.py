"""Names of a package that are imported on first use."""

from __future__ import annotations

import importlib
import sys
from collections.abc import Callable, Mapping
from typing import Any

__all__ = ["on_first_use"]


def on_first_use(package: str, homes: Mapping[str, str]) -> Callable[[str], Any]:
    """Return the ``__getattr__`` of a package (PEP 562) that imports a name when it is asked for.

    Args:
        package: Name of the package.
        homes: Names, and the module below the package that each comes from.
    """

    def get(name: str) -> Any:
        if name not in homes:
            raise AttributeError(f"module {package!r} has no attribute {name!r}")
        try:
            value = getattr(importlib.import_module(f"{package}.{homes[name]}"), name)
        except ModuleNotFoundError as error:
            if error.name is None or error.name.partition(".")[0] == package.partition(".")[0]:
                raise
            raise ModuleNotFoundError(
                f"{package}.{name} needs {error.name}, which is not installed; the client alone "
                "(ikplan-client) plans by a service only: pip install ikplan",
                name=error.name,
            ) from error
        setattr(sys.modules[package], name, value)
        return value

    return get
