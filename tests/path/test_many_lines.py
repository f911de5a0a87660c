"""Lines through many poses are those appended one by one, to the last digit."""

from __future__ import annotations

import itertools

import numpy as np
import pinocchio as pin

from ikplan.documents.path import PathRequest
from ikplan.path import Pose
from ikplan.path.build.builder import PathBuilder
from ikplan.path.build.path_frame import PathFrame


def _poses(rng: np.random.Generator) -> list[Pose]:
    """Poses of which some lack an orientation, and some coincide with the one before."""
    poses = []
    for _ in range(12):
        R = pin.exp3(rng.normal(size=3)) if rng.random() < 0.8 else None
        poses.append(Pose(R, rng.normal(size=3)))
        while rng.random() < 0.3:
            noise = pin.exp3(rng.normal(0.0, 1e-11, 3))
            poses.append(Pose(None if R is None else R @ noise, poses[-1].p + 1e-12))
    return poses


def test_lines_at_once_are_those_one_by_one() -> None:
    waypoints = [{"position": [0.0, 0.0, 0.0]}]
    frame = PathFrame(PathRequest.model_validate({"waypoints": waypoints}))
    for seed in range(20):
        rng = np.random.default_rng(seed)
        poses = _poses(rng)
        R = poses[0].R
        begin = Pose(None if R is None else R @ pin.exp3(np.full(3, 1e-11)), poses[0].p)
        names = [f"pose {k}" for k in range(len(poses))]
        both = []
        for at_once in (True, False):
            builder = PathBuilder(frame, begin, "begin", itertools.count().__next__)
            if at_once:
                builder.add_lines(poses, names)
            else:
                for pose, name in zip(poses, names, strict=True):
                    builder.add_line(pose, name)
            both.append(builder.finish())
        s = np.linspace(0.0, both[0].length, 200)
        for a, b in zip(*(path.derivatives(s) for path in both), strict=True):
            assert np.array_equal(a, b)
        assert [(w.row, w.name, w.s) for w in both[0].waypoints] == [
            (w.row, w.name, w.s) for w in both[1].waypoints
        ]
