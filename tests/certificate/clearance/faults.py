"""Faults planted into the proof, to see that its tests find them."""

from __future__ import annotations

from types import FunctionType
from typing import Any

import pytest

from ikplan.certificate.clearance import prove
from ikplan.certificate.clearance.search import search

__all__ = ["halve_motion_bounds", "ignore_radii", "look_at_middles_only"]


def _with_bounds_times(share: float) -> Any:
    """The search in Python, its motion bounds multiplied."""
    function: Any = search.py_func  # type: ignore[attr-defined]
    names = dict(function.__globals__)
    real = names["motion_bounds"]

    def scaled(*arguments: Any) -> None:
        real(*arguments)
        arguments[-1][:] *= share

    names["motion_bounds"] = scaled
    return FunctionType(function.__code__, names)


def halve_motion_bounds(patch: pytest.MonkeyPatch) -> None:
    """Bodies move twice as far as the search believes."""
    patch.setattr(prove, "search", _with_bounds_times(0.5))


def look_at_middles_only(patch: pytest.MonkeyPatch) -> None:
    """Nothing moves between the middles of intervals: a check of samples."""
    patch.setattr(prove, "search", _with_bounds_times(0.0))


def ignore_radii(patch: pytest.MonkeyPatch) -> None:
    """The hulls alone are kept apart."""

    def bare(chain: Any, shapes: Any, *rest: Any) -> None:
        search(chain, shapes._replace(radius=0.0 * shapes.radius), *rest)

    patch.setattr(prove, "search", bare)
