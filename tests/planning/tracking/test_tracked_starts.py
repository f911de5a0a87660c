"""Sequences free of contact, shortest first, found by as few looks for contact as it takes."""

from __future__ import annotations

from functools import reduce

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from ikplan.arrays import Array
from ikplan.collision.check import Contact
from ikplan.planning.tracking.tracked_path import (
    JointSequence,
    TrackedStarts,
    TrackingFailed,
    farthest_failure,
    in_contact,
    shortest_first,
)

S = np.linspace(0.0, 1.0, 6)

ends = st.lists(
    st.one_of(
        st.floats(0.0, 1.0).map(lambda s: TrackingFailed(s, np.zeros(2))),
        st.tuples(st.integers(1, 4), st.sampled_from([-1, -1, 0, 3, 4])).map(
            lambda row: (float(row[0]), S, np.full((len(S), 2), float(row[1])))
        ),
    ),
    max_size=9,
)


class Looks:
    """Meets a body where the configurations say, and counts how often it was asked."""

    def __init__(self) -> None:
        self.count = 0

    def __call__(self, _: Array, q: Array) -> Contact | None:
        self.count += 1
        step = int(q[0, 0])
        return None if step < 0 else Contact(step, 0.0, q[step], ("a", "b"))


def tracked(of: list[JointSequence | TrackingFailed]) -> list[JointSequence]:
    return [end for end in of if not isinstance(end, TrackingFailed)]


@given(ends, st.one_of(st.none(), st.integers(1, 4)))
def test_the_shortest_that_are_free_come_first(
    of: list[JointSequence | TrackingFailed], most: int | None
) -> None:
    looks = Looks()
    found = TrackedStarts(of, looks).clear(most)
    free = [row for row in shortest_first(tracked(of)) if row[2][0, 0] < 0]
    assert [id(row) for row in found] == [id(row) for row in free[:most]]
    assert looks.count <= len(tracked(of))


@given(ends)
def test_the_farthest_failure_is_that_of_all_starts_in_order(
    of: list[JointSequence | TrackingFailed],
) -> None:
    looks = Looks()
    starts = TrackedStarts(of, looks)
    starts.clear(2)
    failures: list[TrackingFailed | None] = [None]
    for end in of:
        if isinstance(end, TrackingFailed):
            failures.append(end)
        elif (met := Looks()(end[1], end[2])) is not None:
            failures.append(in_contact(met, end[1]))
    expected = reduce(farthest_failure, failures)
    found = starts.farthest()
    assert (found is None) == (expected is None)
    if found is not None and expected is not None:
        assert (found.s, found.contact is None) == (expected.s, expected.contact is None)
    assert looks.count == len(tracked(of))


@pytest.mark.parametrize("most", [1, 3])
def test_no_more_is_looked_at_than_is_asked_for(most: int) -> None:
    looks = Looks()
    free: list[JointSequence | TrackingFailed] = [
        (float(k), S, np.full((len(S), 2), -1.0)) for k in range(20)
    ]
    assert len(TrackedStarts(free, looks).clear(most)) == most
    assert looks.count == most
