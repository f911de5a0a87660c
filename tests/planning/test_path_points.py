"""Points along a path: every place that matters has one, whatever the gaps between them."""

from __future__ import annotations

import itertools
from dataclasses import dataclass, field, replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray

from ikplan.path.tool_path import SegmentRange
from ikplan.planning.tracking.reference_path import (
    initial_points,
    nearest_points,
    points_around,
    positions_missing,
    rest_points,
)

Array = NDArray[np.float64]

gaps = st.sampled_from([0.0, 1e-16, 5e-13, 3e-10, 1e-9, 1e-6, 0.01, 1.0, 40.0])


@dataclass(frozen=True)
class Straight:
    """A straight path with corners and waypoints at given places."""

    length: float
    corners: Array
    waypoint_s: Array
    segments: tuple[SegmentRange, ...] = ()
    taken: float = 0.0
    orientation_changes: Array = field(default_factory=lambda: np.empty(0))

    def poses(self, s: Array) -> tuple[Array, Array]:
        return np.tile(np.eye(3), (len(s), 1, 1)), np.outer(s, [1.0, 0.0, 0.0])

    def positions(self, s: Array) -> Array:
        return self.poses(s)[1]

    def orientation_mask(self, s: Array) -> NDArray[np.bool_]:
        return np.ones(len(s), dtype=np.bool_)


@settings(max_examples=200, deadline=None)
@given(steps=st.lists(gaps, min_size=1, max_size=8), every=st.integers(1, 3))
def test_every_corner_and_waypoint_has_a_point(steps: list[float], every: int) -> None:
    places = np.cumsum([0.0, *steps])
    path = Straight(float(places[-1]), places[1:-1:every], places)
    slack = 1.01e-12 * max(path.length, 1.0)
    s = initial_points(path, 0.04)
    assert s[0] == 0.0
    assert s[-1] == path.length
    assert (np.diff(s) > 0.0).all()
    assert len(s) % 2 == 1
    points = nearest_points(s, places)
    assert np.abs(s[points] - places).max() <= slack
    assert (np.diff(points) >= 0).all()
    assert points[-1] == len(s) - 1 or path.length <= slack
    assert rest_points(path, s) == nearest_points(s, path.corners).tolist()
    for begin, end in itertools.pairwise(places.tolist()):
        first, last = (
            int(k[0]) for k in points_around(path, s, np.array([begin]), np.array([end]))
        )
        assert 0 <= first <= last < len(s)
        assert s[first] <= begin + slack
        assert s[last] >= end - slack
        # No farther out than the points next to it, and nowhere where there is nothing between.
        assert first + 1 == len(s) or s[first + 1] > begin - slack
        assert last == 0 or s[last - 1] < end + slack
        if begin == end:
            assert first == last


@settings(max_examples=100, deadline=None)
@given(
    seed=st.integers(0, 2**32 - 1),
    count=st.integers(1, 30),
)
def test_a_segment_between_points_is_within_those_around_it(seed: int, count: int) -> None:
    rng = np.random.default_rng(seed)
    path = Straight(1.0, np.zeros(0), np.zeros(0))
    s = np.unique([0.0, *rng.uniform(0.0, 1.0, count), 1.0])
    begin, end = np.sort(rng.uniform(0.0, 1.0, (2, 1)), axis=0)
    first, last = points_around(path, s, begin, end)
    assert s[first] <= begin < s[first + 1]
    assert s[last - 1] < end <= s[last]


@pytest.mark.parametrize("place", [0.05, 0.3337, 0.98])
def test_where_the_orientation_becomes_free_there_is_a_point(place: float) -> None:
    path = Straight(1.0, np.empty(0), np.array([0.0, 1.0]))
    change = replace(path, orientation_changes=np.array([place]))
    assert place not in initial_points(path, 0.04)
    assert place in initial_points(change, 0.04)


@settings(max_examples=100, deadline=None)
@given(
    steps=st.lists(gaps, min_size=1, max_size=8),
    times=st.integers(1, 40),
    apart=st.sampled_from([0.005, 0.02, 0.3]),
)
def test_points_left_out_of_close_ones_are_told(
    steps: list[float], times: int, apart: float
) -> None:
    places = np.cumsum([0.0, *(times * steps)])
    path = Straight(float(places[-1]), places[1:-1:2], places)
    s = initial_points(path, apart, apart=apart)
    assert len(s) % 2 == 1
    missing = positions_missing(path, s)
    assert set(missing) <= set(places)
    whole = np.sort(np.concatenate([s, missing]))
    slack = 1.01e-12 * max(path.length, 1.0)
    assert np.abs(whole[nearest_points(whole, places)] - places).max() <= slack
    assert len(positions_missing(path, whole)) == 0


def test_close_waypoints_do_not_add_to_the_points_of_a_whole_path() -> None:
    counts = set()
    for waypoints in (2, 200, 2000):
        places = np.linspace(0.0, 1.0, waypoints)
        path = Straight(1.0, places[1:-1], places)
        counts.add(len(initial_points(path, 0.05, apart=0.05)))
    assert max(counts) <= 4 * min(counts)
