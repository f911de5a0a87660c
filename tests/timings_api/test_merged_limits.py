"""Limits of robot, request and segment are merged by the strictest, each direction by itself."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import ikplan
from ikplan import load_robot
from ikplan.documents.limits import LimitOptions, SegmentLimits
from ikplan.limits.motion_limits import MotionLimits

Layer = dict[str, Any]

KINDS = ("velocity", "acceleration")
ROBOT = load_robot("ur5")

shares = st.lists(st.floats(0.01, 3.0), min_size=ROBOT.dof, max_size=ROBOT.dof)
scales = st.floats(0.01, 1.0)
asked = st.fixed_dictionaries({}, optional={"upper": shares, "lower": shares, "scale": scales})


def options(kind: str, asked: Layer) -> dict[str, Any]:
    """A document of limits, given as shares of the robot's own."""
    own = getattr(ROBOT, f"{kind}_limit")
    document = {}
    if "upper" in asked:
        document[kind] = (own * asked["upper"]).tolist()
    if "lower" in asked:
        document[f"{kind}_lower"] = (-own * asked["lower"]).tolist()
    if "scale" in asked:
        document[f"{kind}_scale"] = asked["scale"]
    return document


def expected(kind: str, *layers: Layer) -> tuple[np.ndarray, np.ndarray]:
    """The strictest shares of the robot's own limits up and down, shape (dof,) each."""
    up, down = np.full(ROBOT.dof, np.inf), np.full(ROBOT.dof, np.inf)
    for layer in layers:
        here = share(kind, layer, "upper")
        # Without one of its own, the other direction has the same limit.
        there = share(kind, layer, "lower") if "lower" in layer else here
        up, down = np.minimum(up, here), np.minimum(down, there)
    return up, down


def share(kind: str, layer: Layer, side: str) -> np.ndarray:
    """What one layer allows; the arm's accelerations are defaults, which higher ones replace."""
    asked, scale = np.asarray(layer.get(side, np.full(ROBOT.dof, np.inf))), layer.get("scale", 1.0)
    own = np.ones(ROBOT.dof)
    if kind == "acceleration" and side in layer:
        own = np.maximum(own, asked)
    least: np.ndarray = np.minimum(scale * own, asked)
    return least


@pytest.mark.parametrize("kind", KINDS)
@given(whole=asked, segment=asked, part=asked)
def test_the_strictest_holds_in_each_direction_whichever_comes_first(
    kind: str, whole: Layer, segment: Layer, part: Layer
) -> None:
    own = getattr(ROBOT, f"{kind}_limit")
    up, down = expected(kind, whole, segment, part)
    for first, second in ((segment, part), (part, segment)):
        merged = MotionLimits.of(ROBOT, LimitOptions.model_validate(options(kind, whole)))
        for layer in (first, second):
            limits_of_segment = SegmentLimits.model_validate(options(kind, layer))
            merged = merged.within(ROBOT, limits_of_segment, "path.segments[0].limits")
        np.testing.assert_allclose(getattr(merged, kind), own * up, rtol=1e-12)
        np.testing.assert_allclose(getattr(merged, f"{kind}_lower"), -own * down, rtol=1e-12)


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("direction", [1.0, -1.0])
def test_a_motion_keeps_the_limit_of_the_direction_it_goes_in(kind: str, direction: float) -> None:
    """The last joint of the arm one way and back, slower one way: by request, then by segment."""
    field = kind if direction > 0 else f"{kind}_lower"
    own = getattr(ROBOT, f"{kind}_limit")
    other = f"{kind}_lower" if direction > 0 else kind
    limits = {field: (0.3 * direction * own).tolist(), other: (-direction * own).tolist()}
    there = ROBOT.home + np.array([0.0, 0.0, 0.0, 0.0, 0.0, 1.5])
    waypoints = [ROBOT.home, there, ROBOT.home]
    for where in ("request", "segment"):
        document: dict[str, Any] = {"robot": "ur5", "waypoints": waypoints, "rest_at": [1]}
        if where == "request":
            document["limits"] = limits
        else:
            document["segments"] = [{"first": 0, "last": 2, "limits": limits}]
        plan = ikplan.time_request(document)
        rates = plan.dq if kind == "velocity" else plan.ddq
        share = (direction * rates / own).max()
        assert 0.29 < share <= 0.3 * (1.0 + 1e-9)
        assert (-direction * rates / own).max() > 0.9
