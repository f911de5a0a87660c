"""toppra without the libraries that it imports for what is not asked of it here.

Some modules of toppra import ``matplotlib.pyplot``, which takes longer than all of toppra and is
used by functions that draw, and SciPy, used by its own kinds of path. toppra's modules are executed
here with an import function of their own, which defers both to their first use: all of toppra works
as ever, no file is changed, and nothing is put in the place of the libraries for anybody else.
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

__all__ = ["libraries_on_first_use"]

_PACKAGE = "toppra"
_PLOTTING = "matplotlib.pyplot"
_SPLINES = "scipy.interpolate"
_SPARSE = "scipy.sparse"


class _DeferredModule(ModuleType):
    """A module that is imported when something of it is asked for."""

    def __getattr__(self, name: str) -> Any:
        return getattr(importlib.import_module(self.__name__), name)


class _DeferredClass:
    """A class whose module is imported when the class is used."""

    def __init__(self, module: str, name: str) -> None:
        self._place = module, name

    def _class(self) -> Any:
        module, name = self._place
        return getattr(importlib.import_module(module), name)

    def __call__(self, *arguments: Any, **named: Any) -> Any:
        return self._class()(*arguments, **named)

    def __getattr__(self, name: str) -> Any:
        return getattr(self._class(), name)

    def __instancecheck__(self, instance: Any) -> bool:
        return isinstance(instance, self._class())


def _import(
    name: str, own: Any = None, local: Any = None, names: Sequence[str] = (), level: int = 0
) -> Any:
    if name == _PLOTTING and name not in sys.modules:
        return SimpleNamespace(pyplot=_DeferredModule(name))  # what ``import ... as`` takes it from
    if name == _SPLINES and name not in sys.modules and names:
        return SimpleNamespace(**{each: _DeferredClass(name, each) for each in names})
    if name == _SPARSE:
        name = name.partition(".")[0]  # SciPy itself imports its packages on first use
    return builtins.__import__(name, own, local, names, level)


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
def libraries_on_first_use() -> Iterator[None]:
    """Import toppra within; a toppra that is imported already stays as it is."""
    finder = _Finder()
    sys.meta_path.insert(0, finder)
    try:
        yield
    finally:
        sys.meta_path.remove(finder)
