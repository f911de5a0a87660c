"""Variants of a path round each corner once, and have the curves that they have alone."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from ikplan.documents import parse
from ikplan.documents.path import PathRequest
from ikplan.path import FoundCorners, Rounding, ToolLeg, ToolPath, legs_of
from ikplan.path.build import assembly, tolerance_corners
from ikplan.path.pieces.blend import blend_corner

from .requests import START, fk, pose, random_poses


def arcs_and_lines(count: int) -> dict[str, Any]:
    """Lines and half circles in turns, with corners of 90 degrees and of less between them."""
    segments: list[dict[str, Any]] = []
    for k in range(count):
        x, y = 0.4 + 0.02 * k, 0.01 * k
        segments.append({"type": "line", "to": pose([x, y, 0.5], [0.0, 0.0, 0.0])})
        centre = [x, y + 0.005, 0.5]
        segments.append({"type": "arc", "centre": centre, "angle": 3.0 if k % 2 else -2.5})
        segments.append({"type": "line", "to": pose([x + 0.01, y + 0.004, 0.5], [0.0, 0.02, 0.0])})
    return {"segments": segments}


def a_spline_between_lines() -> dict[str, Any]:
    poses = random_poses(4, 6)
    return {
        "segments": [
            {"type": "line", "to": poses[0]},
            {"type": "spline", "through": poses[1:5]},
            {"type": "line", "to": poses[5]},
        ]
    }


def laid(
    document: dict[str, Any],
    rounding: Rounding = "all",
    stops: tuple[int, ...] = (),
    found: FoundCorners | None = None,
) -> ToolPath:
    path = parse(PathRequest, document)
    (leg,) = legs_of(path, START, fk, rounding, None, stops, found)
    assert isinstance(leg, ToolLeg)
    return leg.path


@pytest.fixture
def rounds(monkeypatch: pytest.MonkeyPatch) -> list[float]:
    """The radius of each corner that is rounded from now on."""
    radii: list[float] = []

    def noted(before: Any, after: Any, radius: float) -> Any:
        radii.append(radius)
        return blend_corner(before, after, radius)

    monkeypatch.setattr(assembly, "blend_corner", noted)
    monkeypatch.setattr(tolerance_corners, "blend_corner", noted)
    return radii


def assert_same(path: ToolPath, other: ToolPath) -> None:
    assert path.corner_list == other.corner_list
    assert path.length == other.length
    s = np.linspace(0.0, path.length, 997)
    for a, b in zip(path.derivatives(s), other.derivatives(s), strict=True):
        assert a.tobytes() == b.tobytes()


@pytest.mark.parametrize("document", [arcs_and_lines(6), a_spline_between_lines()])
def test_a_path_laid_again_rounds_nothing_anew(
    document: dict[str, Any], rounds: list[float]
) -> None:
    found = FoundCorners()
    once = laid(document, found=found)
    count = len(rounds)
    assert count > 0
    assert_same(laid(document, found=found), once)
    assert len(rounds) == count
    laid(document)
    assert len(rounds) == 2 * count


@pytest.mark.parametrize(("rounding", "stops"), [("slight", ()), ("none", ()), ("all", (4, 7))])
def test_a_variant_is_the_same_path_after_others(
    rounding: Rounding, stops: tuple[int, ...]
) -> None:
    document, found = arcs_and_lines(6), FoundCorners()
    laid(document, found=found)
    assert_same(laid(document, rounding, stops, found), laid(document, rounding, stops))


def test_a_stop_rounds_anew_only_what_it_gives_more_room(rounds: list[float]) -> None:
    document, found = arcs_and_lines(6), FoundCorners()
    laid(document, found=found)
    count = len(rounds)
    laid(document, stops=(7,), found=found)
    assert len(rounds) <= count + 2 * 12  # two neighbours, of 12 tries each
    assert len(rounds) - count < count // 3


def test_another_tolerance_rounds_anew() -> None:
    found = FoundCorners()
    wide = {**arcs_and_lines(3), "tolerance": {"position": 1e-3, "orientation": 1e-2}}
    laid(arcs_and_lines(3), found=found)
    assert_same(laid(wide, found=found), laid(wide))


def test_blends_are_made_once(rounds: list[float]) -> None:
    document, found = {**arcs_and_lines(6), "blend": 1e-4}, FoundCorners()
    once = laid(document, found=found)
    count = len(rounds)
    assert_same(laid(document, stops=(4, 7), found=found), laid(document, stops=(4, 7)))
    assert len(rounds) == 2 * count - 2
    assert_same(laid(document, found=found), once)
    assert len(rounds) == 2 * count - 2
    other = {**document, "blend": 2e-4}
    assert_same(laid(other, found=found), laid(other))
