"""Capsules about pieces enclose them, and segments are as far apart as a dense look finds."""

from __future__ import annotations

import numpy as np
import pytest

from ikplan.collision.capsules import enclosing_capsule, segment_distance


@pytest.mark.parametrize("count", [1, 2, 3, 8, 60])
def test_every_point_is_inside_its_capsule(count: int) -> None:
    rng = np.random.default_rng(count)
    for _ in range(50):
        points = rng.normal(size=(count, 3)) * rng.uniform(0.001, 0.3, 3) + rng.normal(size=3)
        begin, end, radius = enclosing_capsule(points)
        axis = end - begin
        square = float(axis @ axis)
        share = np.zeros(count) if square == 0.0 else (points - begin) @ axis / square
        nearest = begin + np.clip(share, 0.0, 1.0)[:, None] * axis
        assert (np.linalg.norm(points - nearest, axis=1) <= radius).all()


def test_a_long_thin_body_gets_a_long_thin_capsule() -> None:
    box = np.array([[x, y, z] for x in (-0.5, 0.5) for y in (-0.02, 0.02) for z in (-0.02, 0.02)])
    begin, end, radius = enclosing_capsule(box)
    assert radius == pytest.approx(0.02 * np.sqrt(2.0), rel=1e-6)
    assert np.linalg.norm(end - begin) == pytest.approx(1.0, abs=0.02)


def test_segments_are_as_far_apart_as_a_dense_look_finds() -> None:
    rng = np.random.default_rng(2)
    share = np.linspace(0.0, 1.0, 201)
    for kind in range(60):
        ends = rng.normal(size=(2, 6))
        if kind % 4 == 1:
            ends[0, 3:] = ends[0, :3]  # a point
        if kind % 4 == 2:
            ends[1, 3:] = ends[1, :3] + 2.0 * (ends[0, 3:] - ends[0, :3])  # parallel
        a = ends[0, :3] + share[:, None] * (ends[0, 3:] - ends[0, :3])
        b = ends[1, :3] + share[:, None] * (ends[1, 3:] - ends[1, :3])
        dense = np.linalg.norm(a[:, None] - b[None], axis=2).min()
        found = segment_distance(ends, 0, 1)
        assert found <= dense + 1e-12
        assert found == pytest.approx(dense, abs=0.02)
        assert segment_distance(ends, 1, 0) == pytest.approx(found, abs=1e-9)
