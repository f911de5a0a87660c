"""Requests of every shape, as a user writes them."""

from __future__ import annotations

import math
from typing import Any

from hypothesis import strategies as st

number = st.floats(-1e6, 1e6, allow_nan=False)
vec3 = st.lists(number, min_size=3, max_size=3)


@st.composite
def quaternion(draw: st.DrawFn) -> list[float]:
    """A unit quaternion, to within the thousandth that is forgiven."""
    v = draw(st.lists(st.floats(-1, 1), min_size=4, max_size=4))
    norm = math.sqrt(sum(c * c for c in v))
    if norm < 0.1:
        v, norm = [0.0, 0.0, 0.0, 1.0], 1.0
    stretch = draw(st.floats(0.9991, 1.0009))
    return [c / norm * stretch for c in v]


def some(required: dict[str, Any], **optional: Any) -> st.SearchStrategy[dict[str, Any]]:
    return st.fixed_dictionaries(required, optional=optional)


frame = some({}, position=vec3, quaternion_xyzw=quaternion())
waypoint = some({"position": vec3}, quaternion_xyzw=quaternion() | st.none())
tolerance = some({}, position=st.floats(1e-5, 1.0), orientation=st.floats(1e-5, 3.2))
budget = st.integers(1, 3_000) | st.just("paper") | st.none()
scalar = st.booleans() | st.integers(-(2**40), 2**40) | number | st.text("abé_ ", max_size=5)
path = some(
    {"waypoints": st.lists(waypoint, min_size=1, max_size=4)}, frame=frame, tolerance=tolerance
)
ik = some(
    {},
    method=st.sampled_from(["ik-ba", "lm"]),
    seed=st.integers(0, 2**63 - 1),
    population=budget,
    iterations=budget,
    params=st.dictionaries(st.text("abé_ ", max_size=5), scalar, max_size=3),
    refine=st.booleans(),
    elongation=st.sampled_from(["global", "greedy"]),
)
plan_requests = some(
    {"robot": st.text("ab14é_ ", min_size=1, max_size=20), "path": path},
    start=st.lists(number, max_size=8) | st.just("free") | st.none(),
    tool=frame,
    ik=ik,
    limits=some({}, velocity_scale=st.floats(1e-3, 1.0), acceleration_scale=st.floats(1e-3, 1.0)),
    sampling=some({}, rate_hz=st.floats(1.0, 10_000.0)),
    budget_s=st.floats(1e-3, 3600.0),
)


def leaves(document: Any, at: tuple[str | int, ...] = ()) -> list[tuple[str | int, ...]]:
    """Places of every value that is neither a mapping nor a list."""
    if isinstance(document, dict):
        return [p for k, v in document.items() for p in leaves(v, (*at, k))]
    if isinstance(document, list):
        return [p for i, v in enumerate(document) for p in leaves(v, (*at, i))]
    return [at]


def mappings(document: Any, at: tuple[str | int, ...] = ()) -> list[tuple[str | int, ...]]:
    """Places of every mapping."""
    if isinstance(document, dict):
        return [at, *(p for k, v in document.items() for p in mappings(v, (*at, k)))]
    if isinstance(document, list):
        return [p for i, v in enumerate(document) for p in mappings(v, (*at, i))]
    return []


def look(document: Any, at: tuple[str | int, ...]) -> Any:
    """What is at a place."""
    for part in at:
        document = document[part]
    return document


def written(at: tuple[str | int, ...]) -> str:
    """A place as a user writes it: ``path.waypoints[3].position``."""
    text = ""
    for part in at:
        text += f"[{part}]" if isinstance(part, int) else f".{part}" if text else part
    return text
