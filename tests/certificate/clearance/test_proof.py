"""Proofs whose answers are known in closed form."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from benchmarks.collision.drawing import box
from benchmarks.collision.oracle import Oracle
from ikplan.certificate.clearance import ClearanceResult, JointCurve, prove_clearance
from ikplan.errors import InvalidRequest
from ikplan.robots import Robot, load_robot
from ikplan.scene.body import Body, CollisionModel, ConvexPiece
from tests.kinematics.synthetic import Joint, robot_of

Array = NDArray[np.float64]

SLIDE = robot_of([Joint("prismatic", axis=(1.0, 0.0, 0.0))])
"""Carrier 1 is at (q, 0, 0)."""
WHEEL = robot_of([Joint("revolute")], tip=Joint("fixed", xyz=(0.4, 0.0, 0.0)))
"""Carrier 1 turns about z."""
GANTRY = robot_of(
    [Joint("prismatic", axis=(1.0, 0.0, 0.0)), Joint("prismatic", axis=(0.0, 1.0, 0.0))]
)


def sphere(at: tuple[float, float, float], radius: float) -> ConvexPiece:
    return ConvexPiece(np.array([at]), radius)


def model(
    *bodies: Body, clearance: float = 0.0, pairs: list[tuple[int, int]] | None = None
) -> CollisionModel:
    """Bodies, every two of different carriers a pair."""
    every = [
        (i, j)
        for i in range(len(bodies))
        for j in range(i + 1, len(bodies))
        if bodies[i].carrier != bodies[j].carrier
    ]
    rows = np.array(every if pairs is None else pairs, dtype=np.int64)
    return CollisionModel(bodies, rows, clearance)


def straight(
    begin: list[float], end: list[float], seconds: float = 1.0, samples: int = 2
) -> JointCurve:
    """A motion at constant speed."""
    time = np.linspace(0.0, seconds, samples)
    a, b = np.array(begin), np.array(end)
    q = a + np.outer(time / seconds, b - a)
    return JointCurve.of_samples(time, q, np.tile((b - a) / seconds, (samples, 1)))


def proved(
    robot: Robot, bodies: CollisionModel, motion: JointCurve, **options: Any
) -> ClearanceResult:
    return prove_clearance(robot, bodies, motion, **options)


BALL = Body("ball", 1, (sphere((0.0, 0.0, 0.0), 0.1),))


def test_a_ball_that_slides_past_another_is_nearest_beside_it() -> None:
    post = Body("post", 0, (sphere((0.3, 0.4, 0.0), 0.1),), kind="obstacle")
    result = proved(SLIDE, model(BALL, post), straight([0.0], [1.0]), tolerance=1e-4)
    c = result.clearance
    assert result.proven
    assert result.violation is None
    assert c.least is not None
    assert c.found is not None
    assert c.points is not None
    assert c.found == pytest.approx(0.2, abs=1e-4)
    assert 0.2 - 1e-4 <= c.least <= 0.2
    assert c.time == pytest.approx(0.3, abs=0.01)
    assert sorted(c.pair or []) == ["ball", "post"]
    assert (c.scene.found, c.scene.pairs_checked) == (c.found, 1)
    assert (c.self_.found, c.self_.least, c.self_.pairs_checked) == (None, None, 0)
    assert np.linalg.norm(np.subtract(c.points[0], c.points[1])) == pytest.approx(c.found, abs=1e-9)
    np.testing.assert_allclose(c.points[(c.pair or []).index("post")], [0.3, 0.3, 0.0], atol=0.01)


@pytest.mark.parametrize("tolerance", [1e-2, 1e-3, 1e-4])
def test_the_bound_is_within_the_tolerance(tolerance: float) -> None:
    post = Body("post", 0, (box(np.array([0.35, 0.35, 0.0]), np.full(3, 0.1)),), kind="obstacle")
    tip = Body("tip", 1, (sphere((0.4, 0.0, 0.0), 0.01),))
    result = proved(WHEEL, model(tip, post), straight([-1.0], [2.0]), tolerance=tolerance)
    exact = np.hypot(0.3, 0.3) - 0.41
    c = result.clearance
    assert c.least is not None
    assert c.found is not None
    assert c.least <= exact + 1e-9
    assert exact <= c.found + 1e-9
    assert c.found - c.least <= tolerance
    assert c.time == pytest.approx((1.0 + np.pi / 4) / 3.0, abs=0.05)


def test_a_thin_plate_between_two_samples_is_hit() -> None:
    plate = Body(
        "plate",
        0,
        (box(np.array([0.512, 0.0, 0.0]), np.array([0.001, 1.0, 1.0])),),
        kind="obstacle",
    )
    bullet = Body("bullet", 1, (sphere((0.0, 0.0, 0.0), 0.002),))
    motion = straight([0.0], [1.0], samples=21)
    bodies = model(bullet, plate)
    oracle = Oracle(SLIDE, bodies)
    assert min(oracle.distances(np.array([q])).min() for q in np.linspace(0, 1, 21)) > 5e-3
    result = proved(SLIDE, bodies, motion)
    assert not result.proven
    assert result.violation is not None
    assert set(result.violation.pair) == {"bullet", "plate"}
    assert oracle.distances(result.violation.q).min() == 0.0
    assert result.violation.time == pytest.approx(result.violation.q[0], abs=1e-9)
    assert result.clearance.least == result.clearance.found == 0.0
    assert 0.0 < result.violation.depth <= 0.005
    assert not result.violation.undecided


@pytest.mark.parametrize(
    ("clearance", "proven"), [(0.0, True), (0.19, True), (0.199999, False), (0.21, False)]
)
def test_the_clearance_asked_for_decides(clearance: float, proven: bool) -> None:
    post = Body("post", 0, (sphere((0.3, 0.4, 0.0), 0.1),), kind="obstacle")
    result = proved(SLIDE, model(BALL, post, clearance=clearance), straight([0.0], [1.0]))
    assert result.proven == proven
    assert result.clearance.clearance == clearance
    if proven:
        assert result.violation is None
        assert result.clearance.least is not None
        assert result.clearance.least >= clearance
        return
    assert result.violation is not None
    assert result.violation.depth == 0.0
    assert result.violation.gap >= 0.2 - 1e-9
    # A gap within the resolution of the clearance asked for is not told from contact, and says so.
    assert result.violation.undecided == (clearance < 0.2)
    assert result.clearance.undecided == (clearance < 0.2)


def test_a_gap_smaller_than_the_tolerance_is_still_proven() -> None:
    post = Body("post", 0, (sphere((0.3, 0.2001, 0.0), 0.1),), kind="obstacle")
    result = proved(SLIDE, model(BALL, post), straight([0.0], [1.0]))
    assert result.proven
    assert 0.0 < (result.clearance.least or 0.0) <= 1e-4


def test_bodies_that_always_touch_are_not_proven_and_the_search_ends() -> None:
    floor = Body(
        "floor", 0, (box(np.array([0.5, 0.0, -0.6]), np.array([4.0, 4.0, 1.0])),), kind="obstacle"
    )
    result = proved(SLIDE, model(BALL, floor), straight([0.0], [1.0]))
    assert not result.proven
    assert result.configurations < 1000


def test_padding_lowers_every_distance_by_itself() -> None:
    plain = Body("post", 0, (box(np.array([0.3, 0.4, 0.0]), np.full(3, 0.1)),), kind="obstacle")
    padded = Body("post", 0, (plain.pieces[0]._replace(radius=0.05),), kind="obstacle")
    motion = straight([0.0], [1.0])
    found = [
        proved(SLIDE, model(BALL, post), motion, tolerance=1e-5).clearance
        for post in (plain, padded)
    ]
    assert (found[0].found or 0.0) - (found[1].found or 0.0) == pytest.approx(0.05, abs=1e-5)


def test_two_bodies_moved_by_joints_meet_only_through_the_joints_between_them() -> None:
    """The first slide carries both, so that its motion changes no distance."""
    first = Body("first", 1, (sphere((0.0, 0.0, 0.0), 0.1),))
    second = Body("second", 2, (sphere((0.0, 0.0, 0.0), 0.1),))
    result = proved(GANTRY, model(first, second), straight([0.0, 0.5], [2.0, 0.5]))
    assert result.proven
    assert result.clearance.self_.found == pytest.approx(0.3)
    assert result.clearance.self_.least == pytest.approx(0.3, abs=1e-8)
    assert result.clearance.scene.found is None
    assert result.queries <= 40
    assert not proved(GANTRY, model(first, second), straight([0.0, 0.5], [2.0, 0.1])).proven


def test_a_part_of_the_robot_fixed_to_its_base_is_one_of_the_robot() -> None:
    column = Body("column", 0, (box(np.array([0.5, 0.5, 0.0]), np.full(3, 0.2)),))
    c = proved(SLIDE, model(column, BALL), straight([0.0], [1.0])).clearance
    assert c.self_.pairs_checked == 1
    assert c.self_.found == pytest.approx(0.3)


def test_joints_coupled_to_others_move_what_they_carry() -> None:
    """Dobot: the second user joint turns the serial joint of the third back."""
    robot = load_robot("dobot_magician")
    assert not np.array_equal(robot.coupling, np.eye(*robot.coupling.shape))
    hand = Body("hand", robot.model.njoints - 1, (sphere((0.0, 0.0, 0.0), 0.02),))
    q0, q1 = robot.home, robot.home + np.array([0.3, 0.2, 0.2, 0.0])
    motion = straight(q0.tolist(), q1.tolist())
    post = Body("post", 0, (sphere((0.35, 0.1, 0.1), 0.03),), kind="obstacle")
    bodies = model(hand, post)
    c = proved(robot, bodies, motion, tolerance=1e-4).clearance
    dense = Oracle(robot, bodies).least(motion, 1e-3)[1]
    assert c.least is not None
    assert c.least <= dense <= c.least + 2e-4


def test_a_plan_is_proven_in_polynomials_and_in_samples_alike() -> None:
    import ikplan

    robot = load_robot("ur5")
    request = {"robot": "ur5", "waypoints": [robot.home.tolist(), (robot.home + 0.4).tolist()]}
    found = []
    bodies = model(
        Body("tool", 6, (box(np.array([0.0, 0.05, 0.0]), np.full(3, 0.05)),), kind="tool"),
        Body("post", 0, (box(np.array([0.6, 0.3, 0.3]), np.full(3, 0.1)),), kind="obstacle"),
    )
    for form in ("polynomial", "samples"):
        plan = ikplan.time_request({**request, "sampling": {"form": form}})
        curve = (
            JointCurve.of_motion(plan.motion)
            if plan.motion
            else JointCurve.of_samples(plan.time, plan.q, plan.dq)
        )
        c = proved(robot, bodies, curve, tolerance=1e-4).clearance
        assert c.interpolation == {"polynomial": "polynomials", "samples": "cubic"}[form]
        found.append([c.found or 0.0, c.time or 0.0])
    np.testing.assert_allclose(found[0], found[1], atol=2e-4, rtol=2e-2)


def test_the_same_proof_twice_is_the_same() -> None:
    post = Body("post", 0, (sphere((0.3, 0.4, 0.0), 0.1),), kind="obstacle")
    twice = [proved(SLIDE, model(BALL, post), straight([0.0], [1.0])) for _ in range(2)]
    assert twice[0].clearance == twice[1].clearance


@pytest.mark.parametrize(
    ("bodies", "field"),
    [
        (model(Body("far", 9, (sphere((0.0, 0.0, 0.0), 0.1),)), BALL), "bodies[0]"),
        (model(Body("none", 0, ()), BALL), "bodies[0]"),
        (
            model(Body("bad", 0, (ConvexPiece(np.full((1, 3), np.nan), 0.1),)), BALL),
            "bodies[0].pieces",
        ),
        (model(BALL, pairs=[(0, 3)]), "pairs[0]"),
        (model(BALL, Body("twin", 1, BALL.pieces), pairs=[(0, 1)]), "pairs[0]"),
    ],
)
def test_bodies_that_fit_no_robot_are_refused(bodies: CollisionModel, field: str) -> None:
    with pytest.raises(InvalidRequest) as caught:
        proved(SLIDE, bodies, straight([0.0], [1.0]))
    assert caught.value.field == field
