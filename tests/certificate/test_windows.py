"""Limits of a segment are checked from its begin to its end, and nowhere else."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from ikplan import CertificateViolated
from ikplan.certificate import Claim, RequestedSegment, certify
from ikplan.documents.limits import SegmentLimits

from .slides import A, V, claim, slide


def timed(*stops: float) -> Claim:
    """A motion whose waypoints are all its stops, the start too."""
    made = claim(slide, *stops)
    return replace(
        made,
        waypoint_q=np.array(stops)[:, None],
        waypoint_time=np.concatenate([[0.0], made.waypoint_time]),
    )


def segment(k: int, **limits: float) -> RequestedSegment:
    """The way from stop k to the next, with limits of its own."""
    return RequestedSegment(f"segments[{k}]", k, k + 1, SegmentLimits.model_validate(limits))


def refused(made: Claim) -> tuple[str, list[dict[str, Any]]]:
    """The one promise that is broken, and the certificate's segments."""
    with pytest.raises(CertificateViolated) as caught:
        certify(made)
    (violation,) = caught.value.violations
    return violation, caught.value.certificate["segments"]


@pytest.mark.parametrize("kind", ["velocity", "acceleration"])
@pytest.mark.parametrize("strict", [0, 1, 2])
def test_a_limit_that_one_segment_breaks_is_broken_there(strict: int, kind: str) -> None:
    """Three like ways, from rest to rest: what one of them uses, each does."""
    made = timed(0.0, 0.2, 0.4, 0.6)
    rates = {"velocity": (V, made.dq), "acceleration": (A, made.ddq)}
    limit, used = rates[kind][0], float(np.abs(rates[kind][1]).max())
    asked = [segment(k, **{kind: 0.9 * used if k == strict else limit}) for k in range(3)]
    violation, told = refused(replace(made, segments=tuple(asked)))
    assert violation.startswith(f"segments[{strict}]: the {kind} limit of")
    for k, found in enumerate(told):
        begin, end = made.waypoint_time[k : k + 2]
        assert (found["begin"], found["end"]) == (begin, end)
        share = 1.0 / 0.9 if k == strict else used / limit
        assert found[f"{kind}_limit_ratio"] == pytest.approx(share, rel=1e-9)
        assert begin <= found[f"{kind}_limit_at"]["time"] <= end


def test_a_slow_segment_and_a_fast_one_are_each_held_to_their_own_limits() -> None:
    """A short way, which is slow, and a long one."""
    made = timed(0.0, 0.02, 0.6)
    times = made.waypoint_time
    slow, fast = (
        float(np.abs(made.dq[(made.time > times[k]) & (made.time < times[k + 1])]).max())
        for k in range(2)
    )
    assert slow < 0.5 * fast
    own = (segment(0, velocity=1.01 * slow), segment(1, velocity=1.01 * fast))
    for found in certify(replace(made, segments=own)).segments:
        assert found.velocity_limit_ratio == pytest.approx(1.0 / 1.01, rel=1e-9)
    violation, _ = refused(replace(made, segments=(segment(1, velocity=1.01 * slow),)))
    assert violation.startswith("segments[1]: the velocity limit of")


@pytest.mark.parametrize("row", [0, -1])
def test_the_sample_at_rest_at_an_end_belongs_to_the_segment_there(row: int) -> None:
    made = timed(0.0, 0.2)
    usual = float(np.abs(made.ddq).max())
    ddq = made.ddq.copy()
    ddq[row] *= 1.5
    assert np.abs(ddq).max() < A
    whole = (segment(0, acceleration=1.2 * usual),)
    (kept,) = certify(replace(made, segments=whole)).segments
    assert kept.acceleration_limit_ratio == pytest.approx(1.0 / 1.2, rel=1e-9)
    violation, (told,) = refused(replace(made, ddq=ddq, segments=whole))
    assert violation.startswith("segments[0]: the acceleration limit of")
    assert told["acceleration_limit_at"]["time"] == made.time[row]


def test_a_segment_that_no_sample_falls_in_has_no_figures() -> None:
    made = timed(0.0, 0.4)
    between = replace(
        made,
        waypoint_q=np.vstack([made.q[5:7], made.waypoint_q[1:]]),
        waypoint_time=np.concatenate([made.time[5:7], made.waypoint_time[1:]]),
        segments=(segment(0, velocity=1e-3),),
    )
    (found,) = certify(between).segments
    assert (found.begin, found.end) == (made.time[5], made.time[6])
    assert found.velocity_limit_ratio is None
    assert found.acceleration_limit_at is None


def test_a_segment_of_no_length_has_no_sample_not_even_the_first() -> None:
    made = timed(0.0, 0.2)
    nowhere = RequestedSegment("segments[0]", 0, 0, SegmentLimits(acceleration=1e-3))
    (found,) = certify(replace(made, segments=(nowhere,))).segments
    assert (found.begin, found.end) == (0.0, 0.0)
    assert found.acceleration_limit_ratio is None
