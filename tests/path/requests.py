"""Path requests, and the tool paths they make."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

import numpy as np
from hypothesis import strategies as st
from numpy.typing import ArrayLike, NDArray

from ikplan.documents import parse
from ikplan.documents.path import PathRequest
from ikplan.path import Pose, ToolLeg, ToolPath, legs_of
from ikplan.path.rotation.so3 import exp, quaternion_of

Array = NDArray[np.float64]

START_R = exp(np.array([0.1, 0.2, 0.3]))
START = Pose(START_R, np.array([0.4, 0.0, 0.5]))

coordinates = st.floats(-1.0, 1.0, allow_subnormal=False)
vectors = st.tuples(coordinates, coordinates, coordinates)
seeds = st.integers(0, 2**32 - 1)


def fk(q: Array) -> tuple[Array, Array]:
    """A made-up arm: three turns and three slides."""
    return exp(q[:3]), np.asarray(q[3:6])


def quaternion(rotvec: ArrayLike) -> list[float]:
    q: list[float] = quaternion_of(exp(np.array(rotvec, dtype=float))).tolist()
    return q


def pose(position: Iterable[float], rotvec: ArrayLike | None = None) -> dict[str, Any]:
    """A waypoint document."""
    document: dict[str, Any] = {"position": [float(x) for x in position]}
    if rotvec is not None:
        document["quaternion_xyzw"] = quaternion(rotvec)
    return document


def random_poses(
    seed: int, count: int, *, spread: float = 0.3, turn: float = 0.5, oriented: bool = True
) -> list[dict[str, Any]]:
    rng = np.random.default_rng(seed)
    return [
        pose(p, r if oriented else None)
        for p, r in zip(
            rng.normal(size=(count, 3)) * spread, rng.normal(size=(count, 3)) * turn, strict=True
        )
    ]


def legs(document: dict[str, Any], start: Pose | None = START) -> list[Any]:
    """The legs of a request; a test knows the class of each."""
    return [*legs_of(parse(PathRequest, document), start, fk)]


def tool_path(document: dict[str, Any], start: Pose | None = START) -> ToolPath:
    """The tool path of a request that is one."""
    (leg,) = legs(document, start)
    assert isinstance(leg, ToolLeg)
    return leg.path


def of_segments(*segments: dict[str, Any], start: Pose | None = START, **more: Any) -> ToolPath:
    """The tool path of segments; its corners are exact unless the test says otherwise."""
    return tool_path({"segments": list(segments), "corners": "exact", **more}, start)


def through(
    poses: list[dict[str, Any]], interpolation: str, start: Pose | None = START, **more: Any
) -> ToolPath:
    """The tool path of waypoints; its corners are exact unless the test says otherwise."""
    document: dict[str, Any] = {
        "waypoints": poses,
        "interpolation": interpolation,
        "corners": "exact",
        **more,
    }
    return tool_path(document, start)
