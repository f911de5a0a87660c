"""Segments, attached bodies, and the document."""

from __future__ import annotations

import json

import numpy as np
import pytest

from ikplan.certificate.clearance import JointCurve, prove_clearance
from ikplan.certificate.clearance.windows import windows_of
from ikplan.documents.base import write_json
from ikplan.documents.certificate import Certificate
from ikplan.documents.clearance import Clearance
from ikplan.errors import InvalidRequest
from ikplan.robots import load_robot
from ikplan.scene.body import Body, CollisionModel
from ikplan.scene.model import collision_model
from tests.certificate.clearance.test_proof import BALL, SLIDE, model, sphere, straight

POST = Body("post", 0, (sphere((0.9, 0.4, 0.0), 0.1),), kind="obstacle")
THIRDS = [(0.0, 1 / 3), (1 / 3, 2 / 3), (2 / 3, 1.0)]
MOTION = straight([0.0], [1.0])


def carrying(first: int | None, last: int | None) -> CollisionModel:
    """A ball that carries a large part, which hits the post near the end of the motion."""
    part = Body(
        "part",
        1,
        (sphere((0.0, 0.0, 0.0), 0.35),),
        "attached",
        first_segment=first,
        last_segment=last,
    )
    return model(BALL, POST, part, pairs=[(0, 1), (1, 2)])


def test_each_segment_has_its_own_nearest_place() -> None:
    c = prove_clearance(SLIDE, model(BALL, POST), MOTION, segment_times=THIRDS).clearance
    expected = [np.hypot(0.9 - end, 0.4) - 0.2 for end in (1 / 3, 2 / 3, 0.9)]
    for segment, distance, (begin, end) in zip(c.segments, expected, THIRDS, strict=True):
        assert (segment.begin, segment.end) == (begin, end)
        assert segment.least is not None
        assert segment.found is not None
        assert segment.least <= distance + 1e-9
        assert distance <= segment.found + 1e-9
        assert segment.found - segment.least <= 1e-3
        assert begin - 1e-9 <= (segment.time or 0.0) <= end + 1e-9
    assert c.found == min(s.found for s in c.segments if s.found is not None)
    assert c.least == min(s.least for s in c.segments if s.least is not None)


def test_segments_change_nothing_of_the_whole_beyond_the_tolerance() -> None:
    parts = prove_clearance(SLIDE, model(BALL, POST), MOTION, segment_times=THIRDS).clearance
    whole = prove_clearance(SLIDE, model(BALL, POST), MOTION).clearance
    assert parts.least == pytest.approx(whole.least, abs=1e-3)
    assert whole.segments == []


@pytest.mark.parametrize(
    ("first", "last", "proven"),
    [
        (0, 1, True),
        (0, 0, True),
        (None, 1, True),
        (2, 2, False),
        (1, None, False),
        (None, None, False),
    ],
)
def test_an_attached_part_is_there_between_its_segments_only(
    first: int | None, last: int | None, proven: bool
) -> None:
    result = prove_clearance(SLIDE, carrying(first, last), MOTION, segment_times=THIRDS)
    assert result.proven == proven
    assert result.clearance.pairs_checked == 2
    if not proven:
        assert result.violation is not None
        assert set(result.violation.pair) == {"part", "post"}


def test_between_segments_bodies_of_both_are_there() -> None:
    gap = [(0.0, 0.3), (0.3, 0.5), (0.95, 1.0)]
    assert [(w.begin, w.end, w.segments, w.own) for w in windows_of(1.0, gap)] == [
        (0.0, 0.3, (0,), 0),
        (0.3, 0.5, (1,), 1),
        (0.5, 0.95, (1, 2), None),
        (0.95, 1.0, (2,), 2),
    ]
    assert not prove_clearance(SLIDE, carrying(0, 1), MOTION, segment_times=gap).proven


def test_windows_hold_the_whole_motion() -> None:
    for times in ([(0.1, 0.2)], [(0.0, 0.6), (0.5, 0.9)], [(0.2, 0.2), (0.4, 0.7)], None):
        reached = 0.0
        for window in windows_of(1.0, times):
            assert window.begin <= reached + 1e-9
            reached = max(reached, window.end)
        assert reached == 1.0


@pytest.mark.parametrize("times", [[(0.5, 0.2)], [(0.5, 0.6), (0.1, 0.2)], [(0.0, float("nan"))]])
def test_segments_out_of_order_are_refused(times: list[tuple[float, float]]) -> None:
    with pytest.raises(InvalidRequest, match="segment_times"):
        prove_clearance(SLIDE, model(BALL, POST), MOTION, segment_times=times)


def test_the_document_has_the_fields_of_the_contract_inside_a_certificate() -> None:
    bodies = CollisionModel(
        (Body("ball", 1, BALL.pieces, source="drawn", excess=0.01), POST),
        np.array([[0, 1]]),
        0.05,
        allowed=(("a", "b", "adjacent"),),
        unchecked=("camera",),
    )
    c = prove_clearance(SLIDE, bodies, MOTION, segment_times=THIRDS).clearance
    fields = {name: 0.0 for name, f in Certificate.model_fields.items() if f.is_required()}
    place = {"joint": "j", "time": 0.0}
    ats = {k: place for k in fields if k.endswith("_at")}
    certificate = Certificate.model_validate({**fields, **ats, "valid": True, "clearance": c})
    written = json.loads(write_json(certificate))["clearance"]
    assert written == json.loads(certificate.model_dump_json())["clearance"]
    wanted = {"proven", "least", "found", "time", "pair", "points", "tolerance", "pairs_checked"}
    assert wanted | {"self", "scene", "unchecked", "segments", "allowed"} <= set(written)
    assert wanted <= set(written["self"])
    assert wanted <= set(written["scene"])
    assert written["unchecked"] == ["camera"]
    assert written["allowed"] == [{"pair": ["a", "b"], "reason": "adjacent"}]
    assert written["sources"] == [{"body": "ball", "source": "drawn", "excess": 0.01}]
    assert Clearance.model_validate(written) == c


def test_a_model_without_pairs_is_proven_and_says_that_nothing_was_checked() -> None:
    c = prove_clearance(SLIDE, model(BALL, pairs=[]), MOTION).clearance
    assert (c.proven, c.least, c.found, c.pair, c.pairs_checked) == (True, None, None, None, 0)


def test_a_segment_of_no_duration_at_the_end_is_proven_at_once() -> None:
    robot = load_robot("ur5")
    q = np.vstack([robot.home, robot.home + 0.01])
    curve = JointCurve.of_samples(np.array([0.0, 1.0]), q, np.zeros_like(q))
    model = collision_model(robot)
    proof = prove_clearance(robot, model, curve, segment_times=[(0.0, 1.0), (1.0, 1.0)])
    assert proof.proven
    assert proof.configurations < 1000
