"""The example that follows a jumping target."""

from __future__ import annotations

import importlib.util
import itertools
from pathlib import Path

import numpy as np

import ikplan

FILE = Path(__file__).parents[2] / "examples" / "retarget.py"


def test_every_piece_is_certified_and_goes_on_where_the_one_before_is_left() -> None:
    spec = importlib.util.spec_from_file_location("retarget", FILE)
    assert spec is not None
    assert spec.loader is not None
    example = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(example)
    robot = ikplan.load_robot("ur5")
    home = np.array([0.0, -1.2, 1.5, -1.8, -1.5, 0.2])
    targets = home + np.random.default_rng(1).uniform(-0.8, 0.8, (8, 6))
    plans = example.pieces(robot, home, targets)
    for before, after in itertools.pairwise(plans):
        q, dq, _ = before.at(example.CYCLE)
        assert np.abs(after.q[0] - q).max() == 0.0
        assert np.abs(after.dq[0] - dq).max() <= 1e-9
        assert after.certificate.valid
