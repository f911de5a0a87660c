"""The compiled evaluation of paths: held to the evaluation in NumPy that it replaced, recorded.

``recorded_evaluation.json`` has for each request the path lengths asked for, and rotations,
positions and derivatives there.
"""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal

from ikplan.path.pieces.curved import CurvedPiece
from ikplan.path.pieces.piece_stack import stack_pieces

from .requests import random_poses, through, tool_path

RECORDED: dict[str, Any] = json.loads(
    Path(__file__).with_name("recorded_evaluation.json").read_text(encoding="utf-8")
)


@pytest.mark.parametrize("name", sorted(RECORDED))
def test_every_kind_of_piece_moves_as_it_was_recorded(name: str) -> None:
    recorded = RECORDED[name]
    path = tool_path(recorded["path"])
    # The last digits differ from processor to processor (measured: 7e-15 and 4e-12 of the largest).
    assert path.length == pytest.approx(recorded["length"], rel=1e-13)
    found = path.derivatives(np.array(recorded["s"]))
    for field in ("R", "p", "v", "w", "bend"):
        values = getattr(found, field).reshape(len(recorded["s"]), -1)
        largest = max(1.0, np.abs(recorded[field]).max())
        assert_allclose(values, recorded[field], rtol=1e-11, atol=1e-11 * largest, err_msg=field)


@pytest.mark.parametrize("name", sorted(RECORDED))
def test_the_motion_at_one_place_does_not_depend_on_the_others_asked_for(name: str) -> None:
    path = tool_path(RECORDED[name]["path"])
    s = np.linspace(0.0, path.length, 23)
    together = path.derivatives(s)
    for k in (0, 7, 22):
        alone = path.derivatives(s[k : k + 1])
        for field in ("R", "p", "v", "w", "bend"):
            assert_array_equal(getattr(alone, field)[0], getattr(together, field)[k])
    assert_array_equal(path.positions(s), together.p)


def test_a_piece_moves_alone_as_in_its_path() -> None:
    path = through(random_poses(9, 6), "line", blend=0.02)
    assert any(isinstance(piece, CurvedPiece) for piece in path.pieces)
    for k, piece in enumerate(path.pieces):
        s = np.linspace(0.0, piece.length, 9)
        alone, within = piece.evaluate(s), path.derivatives_on(np.full(9, k), s)
        for field in ("R", "p", "v", "w", "bend"):
            assert_array_equal(getattr(alone, field), getattr(within, field))


def test_parts_of_one_curve_share_its_coefficients() -> None:
    recorded = tool_path(RECORDED["recorded points"]["path"])
    stack = stack_pieces(recorded.pieces)
    assert len(recorded.pieces) > 50
    assert len(stack.curves.kind) == len(stack.laws.kind) == 1
