"""A part of a path that the tool leaves out is found, although the tool is never far from the path.

The tool of a gantry goes up one strand of a hairpin and down the other, which is nearer to the
first than the tolerance: it may go over anywhere, and its samples are near the path.
"""

from __future__ import annotations

import math
from dataclasses import replace
from itertools import pairwise
from typing import Any

import numpy as np
import pytest

import ikplan
from ikplan import CertificateViolated
from ikplan.certificate import Claim, certify
from ikplan.certificate.coverage import left_out
from ikplan.certificate.deviation import MatchedLeg, TimedLeg, Tool, match_legs, timed_legs
from ikplan.certificate.offsets import Allowance
from ikplan.certificate.requested import RequestedPath, read_motion
from ikplan.certificate.requested.pieces import line
from ikplan.documents.path import PathRequest

from .slides import RATE, A, claim, gantry

WIDTH, HEIGHT, TOLERANCE = 2e-4, 0.05, 1e-3
UNSEEN = 2.0 * A / RATE**2 / 8.0
"""How far the tool may be between samples from where they have it: both slides at full A [m]."""
Point = tuple[float, float]


def hairpins(count: int = 1, **more: Any) -> PathRequest:
    """Square teeth of one strand up, one down; there are waypoints at the two ends only."""
    teeth = {"type": "trapezoid", "length": 2.0 * WIDTH * count, "height": HEIGHT, "ramp": 0.0}
    tolerance = {"position": TOLERANCE, **more}
    document = {"segments": [{**teeth, "periods": count}], "tolerance": tolerance}
    return PathRequest.model_validate(document)


def corners(*cuts: float, height: float = HEIGHT) -> list[Point]:
    """Where the teeth turn if each is short by so much."""
    found: list[Point] = [(0.0, 0.0)]
    for k, cut in enumerate(cuts):
        x, top = 2.0 * k * WIDTH, height - cut
        found += [(x, top), (x + WIDTH, top), (x + WIDTH, 0.0), (x + 2.0 * WIDTH, 0.0)]
    return found


def cut(*cuts: float, **more: Any) -> Claim:
    """The tool goes along the teeth, and turns so much before the top of each [m]."""
    made = claim(gantry, *corners(*cuts), path=hairpins(len(cuts), **more))
    return replace(made, waypoint_q=made.q[[0, -1]], waypoint_time=made.time[[0, -1]])


def matched(made: Claim) -> tuple[Claim, MatchedLeg, Tool, Allowance]:
    assert made.path is not None
    motion, tool = read_motion(made.robot, made.path, made.q_start), Tool.of(made, samples=True)
    (part,) = match_legs(made, timed_legs(made, motion), tool)
    assert part.distance.max() <= 1.001 * WIDTH
    return made, part, tool, Allowance(made.path)


def over(made: Claim, path: RequestedPath, s: Any) -> tuple[float, float]:
    """What is left out of a path by a motion whose samples are said to be at path lengths s."""
    count = len(s)
    assert made.path is not None
    leg = TimedLeg(path, np.array([0.0, path.length]), made.time[[0, -1]], np.array([-1, 0]))
    none = np.zeros(count)
    part = MatchedLeg(leg, np.arange(count), np.array(s), none > 0.0, none, none)
    return left_out(made, part, Tool.of(made, samples=True), Allowance(made.path))


def lengths_at(made: Claim, stops: list[Point], lengths: Any) -> Any:
    """Path lengths at samples, given those at the stops, by the share of the way between two."""
    s = np.empty(len(made.time))
    times = np.concatenate([[0.0], made.waypoint_time])
    for (begin, end), (low, high), stop in zip(
        pairwise(times), pairwise(lengths), stops[1:], strict=True
    ):
        here = (made.time >= begin) & (made.time <= end)
        away = np.linalg.norm(made.q[here] - stop, axis=1)
        s[here] = high - (high - low) * away / away[0]
    return s


def quiet(made: Claim) -> Claim:
    """The claim with limits on accelerations so low that nothing is unseen between samples."""
    least = np.full(2, 1e-12)
    limits = replace(made.limits, acceleration=least, acceleration_lower=-least)
    return replace(made, limits=limits)


def through(*points: Point) -> RequestedPath:
    pieces = tuple(line(np.array([*a, 0.0]), np.array([*b, 0.0])) for a, b in pairwise(points))
    return RequestedPath(pieces, ((sum(p.length for p in pieces), 0),), ())


def test_every_sample_from_the_first_to_the_last_is_on_the_path() -> None:
    made, part, *_ = matched(cut(0.0))
    np.testing.assert_array_equal(part.sample, np.arange(len(made.time)))
    np.testing.assert_array_equal(part.leg.time, made.time[[0, 0, -1]])


def test_a_tool_that_goes_round_twice_is_where_its_way_says() -> None:
    """To a square, twice about it and on: each place of the square has two path lengths."""
    square: list[Point] = [(0.1, 0.0), (0.1, 0.1), (0.0, 0.1), (0.0, 0.0)]
    stops: list[Point] = [(-0.5, 0.0), (0.0, 0.0), *square, *square, (0.2, 0.0)]
    path = through(*stops)
    made = claim(gantry, *stops, path=hairpins())
    s, passed = lengths_at(made, stops, path.begins), made.waypoint_time[[8, 9]]
    marked = replace(made, waypoint_q=made.waypoint_q[[8, 9]], waypoint_time=passed)
    marks = np.array([0.0, path.begins[-2], path.length])
    leg = TimedLeg(path, marks, np.array([0.0, *passed]), np.array([-1, 0, 1]))
    (part,) = match_legs(marked, [leg], Tool.of(marked, samples=True))
    np.testing.assert_allclose(part.s, s, atol=1e-9)
    assert part.distance.max() <= 1e-12


def test_a_tool_that_goes_all_the_way_is_certified() -> None:
    certificate = certify(cut(0.0, 0.0))
    assert certificate.max_path_deviation is not None
    assert certificate.max_path_deviation <= 1e-9
    assert left_out(*matched(cut(0.0, 0.0))) == (0.0, 0.0)


@pytest.mark.parametrize("share", [0.8, 0.99, 1.01, 1.1, 2.0, 40.0])
def test_a_crest_is_left_out_from_the_tolerance_on(share: float) -> None:
    made = cut(share * TOLERANCE + UNSEEN)
    if share <= 1.0:
        deviation = certify(made).max_path_deviation
        assert deviation is not None
        assert deviation <= 1.001 * WIDTH
        return
    with pytest.raises(CertificateViolated, match="a part of the path") as caught:
        certify(made)
    (violation,) = caught.value.violations
    assert violation.endswith(f"is left out by {share * TOLERANCE:.3g} m")
    # Near the path all the while.
    assert caught.value.certificate["max_path_deviation"] <= 1.001 * WIDTH
    found, time = left_out(*matched(made))
    assert found == pytest.approx(share * TOLERANCE, rel=1e-9)
    # Told of the time at which the tool is over there.
    assert np.linalg.norm(made.q[made.time == time] - corners(0.0)[1]) <= 2.0 * found


@pytest.mark.parametrize("box", [0.5 * TOLERANCE, 4.0 * TOLERANCE])
def test_a_crest_may_be_left_out_by_the_size_of_a_box(box: float) -> None:
    """Half widths of 3 : 4, so that a corner of the box is 5 away."""
    half = [0.6 * box, 0.8 * box, 0.0]
    for beyond in (0.5 * TOLERANCE, 1.01 * TOLERANCE, 3.0 * TOLERANCE):
        found, _ = left_out(*matched(cut(box + beyond + UNSEEN, box={"position": half})))
        assert found == pytest.approx(beyond, rel=1e-9)


def test_what_gains_most_is_looked_at_before_what_gains_little() -> None:
    """Of forty teeth cut by a little more than the tolerance, the worst is found, as any is."""
    cuts = np.full(40, 1.2 * TOLERANCE)
    cuts[[7, 33]] = 1.5 * TOLERANCE, 3.0 * TOLERANCE
    made = cut(*cuts)
    found, time = left_out(*matched(made))
    assert found == pytest.approx(3.0 * TOLERANCE - UNSEEN, rel=1e-9)
    assert made.q[made.time == time][0, 0] == pytest.approx(66.5 * WIDTH, abs=WIDTH)


def test_turns_on_the_spot_are_no_part_of_the_way() -> None:
    """They have lengths of their own, on which the tool does not move."""
    made = cut(2.0 * TOLERANCE)
    up = through(*corners(0.0))
    spot = line(np.zeros(3), np.zeros(3), np.eye(3), np.array([0.0, 0.0, 3.0]))
    path = RequestedPath((spot, *up.pieces), ((spot.length + up.length, 0),), ())
    _, part, *_ = matched(made)
    still = 60
    made = replace(
        made,
        time=np.concatenate([np.arange(still) / RATE, made.time + still / RATE]),
        q=np.vstack([np.zeros((still, 2)), made.q]),
        dq=np.vstack([np.zeros((still, 2)), made.dq]),
    )
    s = np.concatenate([np.linspace(0.0, spot.length, still), spot.length + part.s])
    assert over(made, path, s)[0] == pytest.approx(2.0 * TOLERANCE - UNSEEN, rel=1e-9)


def test_a_single_sample_leaves_nothing_out_and_two_can() -> None:
    made = quiet(claim(gantry, (0.0, 0.0), (WIDTH, 0.0), path=hairpins()))
    ends = [0, -1]
    made = replace(made, time=made.time[ends], q=made.q[ends], dq=made.dq[ends])
    path = through(*corners(0.0)[:4])
    assert over(made, path, [0.0]) == (0.0, 0.0)
    assert over(made, path, [0.0, path.length])[0] == pytest.approx(HEIGHT, rel=1e-9)
    # Where the samples do not get farther on the path there is nothing to leave out.
    assert over(made, path, [0.3 * path.length, 0.3 * path.length]) == (0.0, 0.0)


@pytest.mark.parametrize("early", [0.2, 0.5, 0.8])
def test_a_sample_may_be_matched_to_either_strand(early: float) -> None:
    """The tool goes all the way; from some height on its samples are taken for the other strand."""
    made = cut(0.0)
    path = through(*corners(0.0))
    x, y = made.q.T
    up = np.linspace(0.0, 1.0, len(x)) < 0.5
    own = np.where(up & (x == 0.0), y, HEIGHT + x)
    own = np.where(x == WIDTH, HEIGHT + WIDTH + HEIGHT - y, own)
    own = np.where(x > WIDTH, 2.0 * HEIGHT + x, own)
    other = np.where(up & (x == 0.0) & (y > early * HEIGHT), 2.0 * HEIGHT + WIDTH - y, own)
    assert np.diff(other).min() < 0.0
    assert over(made, path, own) == (0.0, 0.0)
    assert over(made, path, other) == (0.0, 0.0)
    # The same on the way down: taken for the strand up until it is low.
    late = np.where((x == WIDTH) & (y > early * HEIGHT), y, own)
    assert np.diff(late).min() < 0.0
    assert over(made, path, late) == (0.0, 0.0)


def test_having_been_there_before_does_not_make_up_for_it() -> None:
    """A path goes up and down in one place twice, half a metre in between: once is not twice."""
    round_trip: list[Point] = [(0.0, 0.0), (0.25, 0.0), (0.0, 0.0)]
    once, short = corners(0.0)[:4], corners(5.0 * TOLERANCE)[:4]
    back: list[Point] = [(0.0, 0.0)]
    path = through(*once, *back, *round_trip[1:], *once[1:])
    stops = [*once, *back, *round_trip[1:], *short[1:]]
    made = quiet(claim(gantry, *stops, path=hairpins()))
    on_path = [*once, *back, *round_trip[1:], *once[1:]]
    lengths = np.concatenate([[0.0], np.cumsum([math.dist(a, b) for a, b in pairwise(on_path)])])
    # The tool goes on at once from the strand up to that down.
    turn = len(on_path) - 3
    lengths[turn] -= 5.0 * TOLERANCE
    lengths[turn + 1] += 5.0 * TOLERANCE
    times = np.concatenate([[0.0], made.waypoint_time])
    s = lengths_at(made, stops, lengths)
    middle = s == lengths[turn]
    assert middle.any()
    s[np.flatnonzero(made.time > times[turn])[0] :] = np.maximum(
        s[np.flatnonzero(made.time > times[turn])[0] :], lengths[turn + 1]
    )
    assert over(made, path, s)[0] == pytest.approx(5.0 * TOLERANCE, rel=1e-9)


@pytest.mark.parametrize("speed", [(0.4, 0.3), (-0.4, 0.5), (0.2, -0.3)])
def test_between_samples_the_tool_goes_by_cubics(speed: Point) -> None:
    """Three samples, seconds apart: left out is what is far from their Hermite cubics."""
    time = np.array([0.0, 2.0, 3.0])
    ends = np.array([[0.0, 0.0], [0.3, 0.02], [0.5, 0.1]])
    rates = np.array([[speed[0], speed[1]], [speed[1], -speed[0]], [0.1, 0.2]])
    made = claim(gantry, (0.0, 0.0), (0.3, 0.02), path=hairpins())
    made = quiet(replace(made, time=time, q=ends, dq=rates))
    path = through((0.0, 0.0), (0.1, 0.6), (0.3, 0.02), (0.4, 0.2), (0.5, 0.1))
    x, tool = np.linspace(0.0, 1.0, 2001)[:, None], []
    for k, h in enumerate(np.diff(time)):
        # The Bezier curve with the same ends and velocities.
        b = [ends[k], ends[k] + h * rates[k] / 3.0, ends[k + 1] - h * rates[k + 1] / 3.0]
        cubic = (1 - x) ** 3 * b[0] + 3 * x * (1 - x) ** 2 * b[1] + 3 * x**2 * (1 - x) * b[2]
        tool.append(cubic + x**3 * ends[k + 1])
    first = path.begins[2]
    places = np.linspace(0.0, first, 800)
    piece = path.piece_at(places)
    p = path.derivatives(piece, places - path.begins[piece]).p[:, :2]
    motion = np.vstack(tool)
    far = max(float(np.linalg.norm(motion - point, axis=1).min()) for point in p)
    found, when = over(made, path, [0.0, first, path.length])
    assert found == pytest.approx(far, abs=1.5e-3)
    assert when == 0.0


def test_a_tool_may_stand_still_on_its_way() -> None:
    made = cut(2.0 * TOLERANCE)
    turn = int(np.flatnonzero((made.q == corners(2.0 * TOLERANCE)[1]).all(axis=1))[0])
    rows = np.sort(np.concatenate([np.arange(len(made.time)), np.full(30, turn)]))
    time = np.arange(len(rows)) / RATE
    made = replace(made, time=time, q=made.q[rows], dq=made.dq[rows], waypoint_time=time[[0, -1]])
    assert left_out(*matched(made))[0] == pytest.approx(2.0 * TOLERANCE - UNSEEN, rel=1e-9)


@pytest.mark.parametrize("longest", [1, 2, 3])
@pytest.mark.parametrize("lower", [1.0, 3.0])
def test_what_happens_unseen_goes_with_the_square_of_the_longest_step(
    longest: int, lower: float
) -> None:
    made = cut(10.0 * TOLERANCE)
    limits = made.limits
    limits = replace(limits, acceleration_lower=-lower * limits.acceleration)
    # Some samples are left out where the tool runs at a constant speed.
    gone = np.arange(35, 34 + longest)
    kept = {name: np.delete(getattr(made, name), gone, axis=0) for name in ("time", "q", "dq")}
    made = replace(made, **kept, limits=limits)
    found, _ = left_out(*matched(made))
    unseen = longest**2 * lower * UNSEEN
    assert found == pytest.approx(10.0 * TOLERANCE - unseen, rel=1e-9)


def test_few_samples_a_second_allow_what_cannot_be_seen_between_them() -> None:
    """With a tenth of the samples, a crest cut by 3.5 mm may have been gone up to."""
    made = cut(3.5 * TOLERANCE)
    few = slice(None, None, 10)
    coarse = replace(made, time=made.time[few], q=made.q[few], dq=made.dq[few])
    assert left_out(*matched(made))[0] > 3.0 * TOLERANCE
    assert left_out(*matched(coarse))[0] <= TOLERANCE


def test_on_a_wave_much_finer_than_the_tolerance_any_strand_may_be_taken() -> None:
    """28 periods of 4.3 um: a sample is taken for one strands away, and nothing is left out."""
    wave = {"type": "sinusoid", "length": 1.212e-4, "wavelength": 4.3286e-6, "phase": -2.409}
    path = {
        "frame": {
            "position": [-0.3497, -0.0315, 0.8309],
            "quaternion_xyzw": [0.28, -0.15, -0.64, 0.7],
        },
        "begin": {"position": [0.0, 0.0, 0.0]},
        "segments": [{**wave, "amplitude": -1.078e-4}],
        "orientation_free": "all",
    }
    sampling = {"rate_hz": 1000.0}
    plan = ikplan.plan({"robot": "eod_arm", "start": "free", "path": path, "sampling": sampling})
    assert plan.certificate.max_path_deviation is not None
    assert plan.certificate.max_path_deviation <= 1e-4
