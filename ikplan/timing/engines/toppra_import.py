"""toppra without the drawing library that it imports for its figures.

Some modules of toppra import ``matplotlib.pyplot``, which takes longer than all of toppra and is
used by functions that draw. toppra's modules are executed here with an import function of their
own, which defers pyplot to its first use: toppra's figures work as ever, no file is changed, and
nothing is put in the place of matplotlib for anybody else.
"""

from __future__ import annotations

import builtins
import contextlib
import importlib
import sys
from collections.abc import Iterator, Sequence
from importlib.abc import Loader, MetaPathFinder
from importlib.machinery import ModuleSpec, PathFinder, SourceFileLoader
from types import ModuleType, SimpleNamespace
from typing import Any

__all__ = ["pyplot_on_first_use"]

_PACKAGE = "toppra"
_DEFERRED = "matplotlib.pyplot"


class _Deferred(ModuleType):
    """A module that is imported when something of it is asked for."""

    def __getattr__(self, name: str) -> Any:
        return getattr(importlib.import_module(self.__name__), name)


def _import(name: str, *details: Any) -> Any:
    if name == _DEFERRED and name not in sys.modules:
        return SimpleNamespace(pyplot=_Deferred(name))  # what ``import ... as`` takes it from
    return builtins.__import__(name, *details)


class _DeferringLoader(Loader):
    """Loads a module as its own loader does, with another import function."""

    def __init__(self, loader: Loader) -> None:
        self._loader = loader

    def create_module(self, spec: ModuleSpec) -> ModuleType | None:
        return self._loader.create_module(spec)

    def exec_module(self, module: ModuleType) -> None:
        module.__dict__["__builtins__"] = {**vars(builtins), "__import__": _import}
        self._loader.exec_module(module)

    def __getattr__(self, name: str) -> Any:
        return getattr(self._loader, name)  # source and resources, for whoever asks


class _Finder(MetaPathFinder):
    """Finds the modules of toppra, and leaves every other to the finders behind it."""

    def find_spec(
        self, fullname: str, path: Sequence[str] | None, target: ModuleType | None = None
    ) -> ModuleSpec | None:
        if fullname.partition(".")[0] != _PACKAGE:
            return None
        spec = PathFinder.find_spec(fullname, path, target)
        if spec is not None and isinstance(spec.loader, SourceFileLoader):
            spec.loader = _DeferringLoader(spec.loader)
        return spec


@contextlib.contextmanager
def pyplot_on_first_use() -> Iterator[None]:
    """Import toppra within; a toppra that is imported already stays as it is."""
    finder = _Finder()
    sys.meta_path.insert(0, finder)
    try:
        yield
    finally:
        sys.meta_path.remove(finder)
