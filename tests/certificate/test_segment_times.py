"""Limits that hold between two times are measured on the samples between them, and no others."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from ikplan import load_robot
from ikplan.certificate.claim import Claim, RequestedSegment
from ikplan.certificate.deviation import MatchedLeg, TimedLeg
from ikplan.certificate.requested import RequestedMotion, RequestedPath, ToolLeg
from ikplan.certificate.requested.motion import JointSegmentRange
from ikplan.certificate.requested.path import SegmentRange
from ikplan.certificate.requested.pieces import line
from ikplan.certificate.segments import TimedSegment, segment_checks, timed_segments
from ikplan.documents.certificate import SegmentCertificate
from ikplan.documents.limits import LimitOptions, SegmentLimits
from ikplan.documents.path import PathRequest
from ikplan.limits.motion_limits import MotionLimits

ROBOT = load_robot("panda")
LIMITS = MotionLimits.of(ROBOT, LimitOptions())
COUNT = 9
TIME = np.array([0.0, 0.4, 0.8, 0.8 + 2e-9, 0.8 + 4e-8, 2.0, 3.0, 3.5, 4.0])
"""The fourth sample is nearer to the third than 1e-9 of the duration, the fifth is not."""


def window(begin: float, end: float, limits: MotionLimits = LIMITS) -> TimedSegment:
    return TimedSegment("path.segments[1]", begin, end, limits)


def claim(time: np.ndarray, dq: np.ndarray, ddq: np.ndarray) -> Claim:
    q = np.tile(ROBOT.home, (len(time), 1))
    return Claim(ROBOT, None, None, q[-1:], time[-1:], time, q, dq, ddq, LIMITS)


def checked(
    parts: list[TimedSegment], dq: np.ndarray, ddq: np.ndarray | None = None
) -> tuple[list[SegmentCertificate], list[str]]:
    return segment_checks(claim(TIME, dq, np.zeros_like(dq) if ddq is None else ddq), parts)


def inside(begin: float, end: float, time: np.ndarray = TIME) -> set[int]:
    """Which samples a window has: those where a velocity beyond its limit is found."""
    found = set()
    still = np.zeros((len(time), 7))
    for row in range(len(time)):
        dq = still.copy()
        dq[row] = 2.0 * ROBOT.velocity_limit
        if segment_checks(claim(time, dq, still), [window(begin, end)])[1]:
            found.add(row)
    return found


@pytest.mark.parametrize(
    ("begin", "end", "samples"),
    [
        (0.8, 3.0, {4, 5}),
        (0.4, 0.8, set()),
        (0.4, 2.0, {2, 3, 4}),
        (0.8 + 2e-9, 2.0, {4}),
        (0.8 + 2e-8, 2.0, {4}),
        (0.4, 0.8 + 2e-9, set()),
        (0.4, 0.8 + 2e-8, {2, 3}),
        (0.0, 2.0, {0, 1, 2, 3, 4}),
        (0.5, 4.0, {2, 3, 4, 5, 6, 7, 8}),
        (0.5, 4.0 - 2e-9, {2, 3, 4, 5, 6, 7, 8}),
        (0.5, 4.0 - 2e-8, {2, 3, 4, 5, 6, 7}),
        (0.0, 4.0, set(range(COUNT))),
        (1e-3, 0.5, {1}),
        (2.5, 3.2, {6}),
        (2.0, 2.0, set()),
        (0.0, 0.0, set()),
        (4.0, 4.0, set()),
    ],
)
def test_a_window_has_the_samples_between_its_ends(
    begin: float, end: float, samples: set[int]
) -> None:
    assert inside(begin, end) == samples


def test_a_sample_is_near_by_a_share_of_the_whole_duration() -> None:
    time = np.array([0.0, 1.0, 1.0 + 5e-9, 2.0, 10.0])
    assert inside(1.0, 9.0, time) == {3}


def test_a_sample_just_as_near_as_that_is_of_the_next_segment() -> None:
    begin, end, last = 0.7, 3.3, 4.0
    near = 1e-9 * last
    time = np.array([0.0, begin + near, 2.0, end - near, 3.5, last])
    assert inside(begin, end, time) == {2}
    assert inside(begin, last - near, time) == {2, 3, 4, 5}


def test_a_window_without_samples_measures_nothing() -> None:
    (part,), exceeded = checked([window(2.1, 2.2)], np.ones((COUNT, 7)))
    assert exceeded == []
    assert (part.field, part.begin, part.end) == ("path.segments[1]", 2.1, 2.2)
    assert part.velocity_limit_ratio is None
    assert part.acceleration_limit_ratio is None


DIFFERENT = replace(
    LIMITS,
    velocity=np.linspace(1.0, 2.0, 7),
    velocity_lower=-np.linspace(0.25, 0.5, 7),
    acceleration=np.linspace(4.0, 8.0, 7),
    acceleration_lower=-np.linspace(2.0, 3.0, 7),
)


@pytest.mark.parametrize("kind", ["velocity", "acceleration"])
@pytest.mark.parametrize("way", ["", "_lower"])
@pytest.mark.parametrize(("over", "broken"), [(-0.01, False), (5e-10, False), (5e-9, True)])
def test_a_limit_holds_in_its_own_direction_up_to_rounding(
    kind: str, way: str, over: float, broken: bool
) -> None:
    rates = {"velocity": np.zeros((COUNT, 7)), "acceleration": np.zeros((COUNT, 7))}
    rates[kind][5, 2] = (1.0 + over) * getattr(DIFFERENT, f"{kind}{way}")[2]
    rates[kind][6, 4] = 0.5 * getattr(DIFFERENT, f"{kind}{way}")[4]
    rates[kind][0] = 9.0  # outside of the window
    (part,), exceeded = checked(
        [window(1.0, 3.2, DIFFERENT)], rates["velocity"], rates["acceleration"]
    )
    assert getattr(part, f"{kind}_limit_ratio") == pytest.approx(1.0 + over, rel=1e-12)
    place = getattr(part, f"{kind}_limit_at")
    assert (place.joint, place.time) == (ROBOT.joint_names[2], 2.0)
    other = {"velocity": "acceleration", "acceleration": "velocity"}[kind]
    assert getattr(part, f"{other}_limit_ratio") == 0.0
    words = f"path.segments[1]: the {kind} limit of {ROBOT.joint_names[2]} is exceeded at 2.0000 s"
    assert exceeded == ([words] if broken else [])


def test_each_window_has_its_own_limits_and_its_own_part() -> None:
    slow = replace(LIMITS, velocity=np.full(7, 0.1), tool_speed=(1e-3, np.inf))
    dq = np.full((COUNT, 7), 0.2)
    windows = [window(0.0, 1.0), TimedSegment("path.segments[2]", 1.0, 3.2, slow)]
    parts, exceeded = checked(windows, dq)
    assert [part.field for part in parts] == ["path.segments[1]", "path.segments[2]"]
    assert parts[0].tool_speed_ratio is None
    assert parts[1].tool_speed_ratio is not None
    assert parts[1].tool_speed_ratio > 1.0
    assert parts[1].velocity_limit_ratio == pytest.approx(2.0)
    assert len(exceeded) == 2
    assert all(words.startswith("path.segments[2]: the ") for words in exceeded)


def test_what_is_not_a_number_breaks_a_limit() -> None:
    dq = np.zeros((COUNT, 7))
    dq[5, 0] = np.nan
    assert len(checked([window(1.0, 3.2)], dq)[1]) == 1


WAYPOINT_TIMES = np.array([1.0, 3.0, 5.0, 6.0, 6.0])
SAMPLE_TIMES = np.arange(0.0, 6.0 + 1e-9, 0.125)
LINE_TO = {"type": "line", "to": {"position": [0.5, 0.0, 0.5]}}


def path_of(limits: dict[int, float], **more: Any) -> PathRequest:
    """Five segments, some with a share of the velocity limits of their own."""
    segments: list[dict[str, Any]] = [dict(LINE_TO) for _ in range(5)]
    for k, scale in limits.items():
        segments[k]["limits"] = {"velocity_scale": scale}
    return PathRequest.model_validate({"segments": segments, **more})


def timed(path: PathRequest | None, *segments: RequestedSegment) -> Claim:
    q = np.zeros((len(SAMPLE_TIMES), 7))
    return Claim(ROBOT, path, None, q[:5], WAYPOINT_TIMES, SAMPLE_TIMES, q, q, q, LIMITS, segments)


ASKED = RequestedPath(
    (line(np.zeros(3), np.array([1.0, 0.0, 0.0])),),
    ((0.5, 1), (1.0, 2)),
    (
        SegmentRange("path.segments[1]", 0.0, 0.625, False, True),
        SegmentRange("path.segments[2]", 0.375, 1.0, True, False),
    ),
)
MOTION = RequestedMotion(
    (),
    (ToolLeg(ASKED, 0),),
    (JointSegmentRange("path.segments[0]", None, 0), JointSegmentRange("path.segments[3]", 2, 3)),
    {f"path.segments[{k}]": k for k in range(5)},
)


def matched() -> list[MatchedLeg]:
    """The tool goes along the path evenly, from 1 s to 5 s, and falls back once by a little."""
    sample = np.flatnonzero((SAMPLE_TIMES >= 1.0) & (SAMPLE_TIMES <= 5.0))
    s = (SAMPLE_TIMES[sample] - 1.0) / 4.0
    s[21] = 0.59
    leg = TimedLeg(ASKED, np.array([0.0, 0.5, 1.0]), WAYPOINT_TIMES[:3], np.array([0, 1, 2]))
    still = np.zeros(len(sample))
    return [MatchedLeg(leg, sample, s, still > 0.0, still, still)]


def times_of(path: PathRequest, *segments: RequestedSegment) -> dict[str, tuple[float, float]]:
    parts = timed_segments(timed(path, *segments), MOTION, matched())
    return {part.field: (part.begin, part.end) for part in parts}


def test_a_part_of_a_joint_path_is_passed_between_its_waypoints() -> None:
    part = RequestedSegment("segments[0]", 1, 3, SegmentLimits(velocity_scale=0.25))
    for path, motion in ((None, None), (path_of({1: 0.5}), None), (path_of({}), MOTION)):
        (found,) = timed_segments(timed(path, part), motion, matched())
        assert (found.field, found.begin, found.end) == ("segments[0]", 3.0, 6.0)
        np.testing.assert_array_equal(found.limits.velocity, 0.25 * ROBOT.velocity_limit)


def test_a_segment_is_passed_between_its_ends_and_has_its_own_limits() -> None:
    path = path_of({0: 0.1, 3: 0.2, 4: 0.3}, tolerance={"position": 0.015625})
    assert times_of(path) == {
        "path.segments[0]": (0.0, 1.0),
        "path.segments[3]": (5.0, 6.0),
        "path.segments[4]": (6.0, 6.0),  # of no length
    }
    parts = timed_segments(timed(path), MOTION, matched())
    for part, scale in zip(parts, (0.1, 0.2, 0.3), strict=True):
        np.testing.assert_array_equal(part.limits.velocity, scale * ROBOT.velocity_limit)


def test_a_rounded_corner_belongs_to_both_its_neighbours_but_for_what_the_tool_may_be_off() -> None:
    path = path_of({1: 0.5, 2: 0.5}, tolerance={"position": 0.015625})
    # 0.625 m less 0.03125 m, and 0.375 m and 0.03125 m, at 0.25 m/s from 1 s on.
    assert times_of(path) == {"path.segments[1]": (1.0, 3.375), "path.segments[2]": (2.625, 5.0)}
    box = {"position": [0.0, 0.046875, 0.0625], "orientation": [0.0, 0.0, 0.0]}
    boxed = path_of({1: 0.5, 2: 0.5}, tolerance={"position": 0.015625, "box": box})
    assert times_of(boxed) == {"path.segments[1]": (1.0, 2.75), "path.segments[2]": (3.25, 5.0)}


def test_a_corner_that_the_tool_is_never_surely_past_leaves_one_instant() -> None:
    path = path_of({1: 0.5, 2: 0.5}, tolerance={"position": 0.1})
    leg = matched()[0]
    slow = replace(leg, s=np.linspace(0.5, 0.55, len(leg.s)))
    parts = timed_segments(timed(path), MOTION, [slow])
    assert [(part.begin, part.end) for part in parts] == [(1.0, 1.0), (5.0, 5.0)]


def test_both_kinds_of_parts_stand_side_by_side() -> None:
    part = RequestedSegment("segments[0]", 0, 4, SegmentLimits())
    assert times_of(path_of({3: 0.5}), part) == {
        "segments[0]": (1.0, 6.0),
        "path.segments[3]": (5.0, 6.0),
    }
