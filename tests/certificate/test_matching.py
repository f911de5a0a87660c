"""Each sample is measured at one place of the path between the waypoints passed around it."""

from __future__ import annotations

from itertools import pairwise
from typing import Any

import numpy as np
import pinocchio as pin
import pytest
from numpy.typing import NDArray

from ikplan.certificate import matching
from ikplan.certificate.matching import Match, Samples, match_samples
from ikplan.certificate.offsets import Allowance
from ikplan.certificate.requested import RequestedPath
from ikplan.certificate.requested.pieces import line
from ikplan.certificate.requested.rotations import exp
from ikplan.documents.path import PathRequest

Vector = NDArray[np.float64]
ALONG = np.array([0.0, 1.0, 0.0])
UNTURNED = np.eye(3)


def allowance(**options: Any) -> Allowance:
    waypoints = [{"position": [0.0, 0.0, 0.0]}]
    return Allowance(PathRequest.model_validate({"waypoints": waypoints, **options}))


def matched(
    path: RequestedPath, allowed: Allowance, p: Any, R: Any, hint: float, low: float, high: float
) -> Match:
    one = [np.array([value]) for value in (hint, low, high)]
    return match_samples(path, allowed, Samples(np.array([p]), np.array([R]), *one))


@pytest.mark.parametrize(("after", "angle"), [(-1e-5, 0.02), (1e-5, 0.0), (0.0, 0.02)])
def test_a_sample_beside_a_waypoint_is_measured_on_the_side_it_belongs_to(
    after: float, angle: float
) -> None:
    tilted = exp(np.array([[0.02, 0.0, 0.0]]))[0]
    pieces = (line(-0.1 * ALONG, 0.0 * ALONG, tilted), line(0.0 * ALONG, 0.1 * ALONG))
    path = RequestedPath(pieces, ((0.1, 0), (0.2, 1)), ())
    low, high = (0.0, 0.1) if after <= 0.0 else (0.1, 0.2)
    found = matched(path, allowance(), after * ALONG, UNTURNED, 0.1 + after, low, high)
    assert found.angle[0] == pytest.approx(angle, abs=1e-12)
    assert found.distance[0] == pytest.approx(0.0, abs=1e-12)
    assert found.oriented[0] == (angle > 0.0)


@pytest.mark.parametrize("freedom", [{"about": "tool_z"}, {"about": "tool_x", "cone": 1e-4}, None])
@pytest.mark.parametrize(("off", "kept"), [(5e-6, True), (9e-5, True), (3e-4, False)])
def test_a_tool_that_turns_faster_than_it_moves_is_measured_in_both_at_one_place(
    freedom: Any, off: float, kept: bool
) -> None:
    turn = np.array([1.4, 1.4, 0.0])
    # The middle of the path is turned as the tool is, and is ``off`` along it.
    begin, end = (off - 5e-4) * ALONG, (off + 5e-4) * ALONG
    path = RequestedPath((line(begin, end, exp(-0.5 * turn[None])[0], turn),), ((1e-3, 0),), ())
    allowed = allowance(orientation_free=freedom)
    found = matched(path, allowed, np.zeros(3), UNTURNED, 5e-4, 0.0, 1e-3)
    assert (found.ratio[0] <= 1.0) == kept
    assert found.distance[0] <= off + 1e-9


@pytest.mark.parametrize("aside", [0.0, 3e-5, 2e-3])
@pytest.mark.parametrize("hint", [0.02, 0.5, 0.98])
def test_the_distance_is_that_of_the_nearest_point_wherever_the_hint_is(
    aside: float, hint: float
) -> None:
    path = RequestedPath((line(np.zeros(3), ALONG),), ((1.0, 0),), ())
    at = np.array([aside, 0.3, 0.0])
    found = matched(path, allowance(), at, UNTURNED, hint, 0.0, 1.0)
    assert found.distance[0] == pytest.approx(aside, abs=1e-12)
    assert found.s[0] == pytest.approx(0.3, abs=1e-9)


def test_a_place_beyond_the_next_waypoint_does_not_count() -> None:
    path = RequestedPath((line(np.zeros(3), ALONG),), ((0.5, 0), (1.0, 1)), ())
    found = matched(path, allowance(), 0.7 * ALONG, UNTURNED, 0.5, 0.0, 0.5)
    assert found.distance[0] == pytest.approx(0.2, abs=1e-12)


@pytest.mark.parametrize("beyond", [-0.01, 0.01])
def test_a_node_beyond_a_mark_does_not_count(beyond: float) -> None:
    """Two lines meet a little beyond the mark, and the tool is there."""
    corner = (0.5 + beyond) * ALONG
    path = RequestedPath((line(np.zeros(3), corner), line(corner, ALONG)), ((1.0, 0),), ())
    low, high = (0.0, 0.5) if beyond > 0.0 else (0.5, 1.0)
    found = matched(path, allowance(), corner, UNTURNED, 0.5, low, high)
    assert found.distance[0] == pytest.approx(0.01, abs=1e-12)


@pytest.mark.parametrize("pairs", [1, 40, 200_000])
def test_places_between_matched_samples_are_looked_through(
    pairs: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    """On a path of many narrow teeth, a hint that is several teeth off still leads home.

    However many are looked at together.
    """
    monkeypatch.setattr(matching, "_PAIRS", pairs)
    # Without the nodes of the path, which are the corners of the teeth.
    monkeypatch.setattr(matching._Search, "_from_nodes", lambda *_: None)
    height, width, count = 2e-2, 1e-3, 40
    corners = [np.array([k * width, height * (k % 2), 0.0]) for k in range(count + 1)]
    pieces = tuple(line(a, b) for a, b in pairwise(corners))
    path = RequestedPath(pieces, ((float(sum(p.length for p in pieces)), 0),), ())
    s = np.linspace(0.0, path.length, 300)
    piece = path.piece_at(s)
    p = path.derivatives(piece, s - path.begins[piece]).p
    R = np.tile(UNTURNED, (len(s), 1, 1))
    hint = np.clip(s + 3e-2 * np.sin(7.0 * s / path.length), 0.0, path.length)
    whole = np.full(len(s), path.length)
    samples = Samples(p, R, hint, np.zeros(len(s)), whole)
    assert (match_samples(path, allowance(), samples).distance <= 1e-4).all()


@pytest.mark.parametrize("half", [[0.01, 0.0, 0.004], [0.0, 0.02, 0.0]])
def test_a_box_covers_its_half_widths_along_its_axes_and_no_more(half: list[float]) -> None:
    turned = exp(np.array([[0.3, -0.4, 0.5]]))[0]
    for frame, axes in (("tool", turned), ("path", UNTURNED)):
        box = {"position": half, "orientation": [0.0, 0.0, 0.0], "frame": frame}
        allowed = allowance(tolerance={"position": 1e-4, "orientation": 1e-3, "box": box})
        rng = np.random.default_rng(3)
        apart = rng.uniform(-0.03, 0.03, (200, 3))
        p, R = apart @ axes.T, np.tile(turned, (200, 1, 1))
        flags = np.ones(200, dtype=bool)
        found = allowed.offsets(p, R, np.zeros((200, 3)), R, flags)
        beyond = np.maximum(np.abs(apart) - np.array(half), 0.0)
        np.testing.assert_allclose(found.distance, np.linalg.norm(beyond, axis=1), atol=1e-15)
        assert (found.angle == 0.0).all()


def test_a_box_has_the_axes_of_the_base_where_no_orientation_counts() -> None:
    turned = exp(np.array([[0.3, -0.4, 0.5]]))[0]
    box = {"position": [0.01, 0.0, 0.0]}
    tolerance = {"position": 1e-4, "orientation": 1e-3, "box": box}
    along = np.array([[0.009, 0.0, 0.0]])
    for options, oriented in (({}, False), ({"orientation_free": "all"}, True)):
        allowed = allowance(tolerance=tolerance, **options)
        flag = np.array([oriented])
        found = allowed.offsets(along, turned[None], np.zeros((1, 3)), turned[None], flag)
        assert found.distance[0] == 0.0
        assert found.angle[0] == 0.0


def test_an_orientation_counts_where_one_is_asked_for_and_nowhere_else() -> None:
    turned = exp(np.array([[0.3, -0.4, 0.5]]))[0]
    R, places, flags = np.stack([turned] * 3), np.zeros((3, 3)), np.array([True, False, True])
    found = allowance().offsets(places, R, places, np.stack([UNTURNED] * 3), flags)
    np.testing.assert_allclose(found.angle, np.sqrt(0.5) * flags, atol=1e-12)


@pytest.mark.parametrize("seed", range(5))
def test_what_is_off_is_the_rotation_vector_from_the_target(seed: int) -> None:
    rng = np.random.default_rng(seed)
    turns = rng.uniform(-1.0, 1.0, (40, 3)) * rng.choice([1e-9, 1e-3, 1.7], (40, 1))
    R_target = exp(rng.uniform(-2.0, 2.0, (40, 3)))
    R = exp(turns) @ R_target
    found = allowance().offsets(np.ones((40, 3)), R, np.zeros((40, 3)), R_target, np.ones(40, bool))
    want = np.array([pin.log3(a @ b.T) for a, b in zip(R, R_target, strict=True)])
    np.testing.assert_allclose(found.turned, want, atol=1e-14)
    np.testing.assert_allclose(found.apart, 1.0)


@pytest.mark.parametrize("freedom", [None, {"about": "tool_y"}, {"about": "tool_x", "cone": 4e-4}])
@pytest.mark.parametrize("frame", [None, "tool", "path"])
def test_the_step_along_the_path_is_that_of_the_slope(freedom: Any, frame: str | None) -> None:
    rng = np.random.default_rng(7)
    box = {"position": [0.02, 0.0, 0.1], "orientation": [0.0, 2e-4, 5e-4], "frame": frame}
    tolerance = {"position": 1e-2, "orientation": 1e-4} | ({} if frame is None else {"box": box})
    allowed = allowance(tolerance=tolerance, orientation_free=freedom)
    m, h = 60, 1e-7
    # Turned by little, so that rotation vectors change as the angular rate says.
    p, R = rng.uniform(-0.2, 0.2, (m, 3)), exp(rng.uniform(-1e-3, 1e-3, (m, 3)))
    v, w = rng.uniform(-1.0, 1.0, (m, 3)), rng.uniform(-1.0, 1.0, (m, 3))
    counts = np.ones(m, dtype=bool)

    def square(s: float) -> Vector:
        return np.asarray(allowed.offsets(p, R, s * v, exp(s * w), counts).steps[:, 0])

    here = allowed.offsets(p, R, 0.0 * v, exp(0.0 * w), counts, (v, w)).steps
    np.testing.assert_allclose(here[:, 0], square(0.0), rtol=1e-12)
    slope = (square(h) - square(-h)) / (2.0 * h)
    scale = np.abs(slope).max()
    np.testing.assert_allclose(
        -2.0 * here[:, 1] * here[:, 2] ** 2 / scale, slope / scale, atol=3e-3
    )
