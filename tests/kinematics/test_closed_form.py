"""The closed form finds every branch of a pose, and says where it may not."""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np
import pytest

from ikplan.arrays import Array
from ikplan.kinematics import forward
from ikplan.kinematics.arm import arm_of
from ikplan.kinematics.chain import Chain, aligning_rotation
from ikplan.kinematics.closed_form.branches import MOST_BRANCHES, branches_into
from ikplan.kinematics.closed_form.form import (
    FIRST_MEET,
    FIRST_PARALLEL,
    NO_FORM,
    SECOND_MEET,
    SECOND_PARALLEL,
    THREE_PARALLEL,
    ClosedForm,
    find_closed_form,
)
from ikplan.robots import Robot, load_robot, robot_names

Axes = tuple[Array, Array]
"""Directions and points of six axes, each of shape (6, 3)."""


def chain_through(h: Array, o: Array, rng: np.random.Generator) -> Chain:
    """A chain whose axes are these at joint values of zero, with a random tool."""
    frames = [(aligning_rotation(h[i]), o[i]) for i in range(6)]
    tool = aligning_rotation(unit(rng)), o[5] + 0.2 * rng.normal(size=3)
    placements, (R_before, p_before) = [], (np.eye(3), np.zeros(3))
    for R, p in [*frames, tool]:
        placements.append(np.hstack([(R_before.T @ R).ravel(), R_before.T @ (p - p_before)]))
        R_before, p_before = R, p
    prismatic = np.zeros(6, dtype=np.bool_)
    return Chain(np.array(placements), prismatic, False, np.eye(6), np.zeros(6))


def unit(rng: np.random.Generator) -> Array:
    v = rng.normal(size=3)
    return np.asarray(v / np.linalg.norm(v))


def random_axes(rng: np.random.Generator) -> Axes:
    return np.array([unit(rng) for _ in range(6)]), 0.4 * rng.normal(size=(6, 3))


def meet(h: Array, o: Array, *axes: int, rng: np.random.Generator) -> None:
    """Move axes so that they meet; each keeps a point of its own that is not where they do."""
    point = 0.4 * rng.normal(size=3)
    for k in axes:
        o[k] = point + rng.normal() * h[k]


def parallel(h: Array, *axes: int, rng: np.random.Generator) -> None:
    for k in axes[1:]:
        h[k] = h[axes[0]] * rng.choice([-1.0, 1.0])


def three_parallel(h: Array, o: Array, rng: np.random.Generator) -> None:
    parallel(h, 1, 2, 3, rng=rng)
    meet(h, o, 4, 5, rng=rng)


def second_parallel(h: Array, o: Array, rng: np.random.Generator) -> None:
    parallel(h, 1, 2, rng=rng)
    meet(h, o, 3, 4, 5, rng=rng)


def first_meet(h: Array, o: Array, rng: np.random.Generator) -> None:
    meet(h, o, 0, 1, rng=rng)
    meet(h, o, 3, 4, 5, rng=rng)


def second_meet(h: Array, o: Array, rng: np.random.Generator) -> None:
    meet(h, o, 1, 2, rng=rng)
    meet(h, o, 3, 4, 5, rng=rng)


def first_parallel(h: Array, o: Array, rng: np.random.Generator) -> None:
    parallel(h, 0, 1, rng=rng)
    meet(h, o, 3, 4, 5, rng=rng)


KINDS: dict[int, Callable[[Array, Array, np.random.Generator], None]] = {
    THREE_PARALLEL: three_parallel,
    SECOND_PARALLEL: second_parallel,
    FIRST_MEET: first_meet,
    SECOND_MEET: second_meet,
    FIRST_PARALLEL: first_parallel,
}


def branches_of(form: ClosedForm, R: Array, p: Array) -> tuple[Array, bool]:
    out = np.empty((MOST_BRANCHES, 6))
    count, unsure = branches_into(form, np.ascontiguousarray(R), np.ascontiguousarray(p), out)
    return out[:count], unsure


def turned_apart(a: Array, b: Array) -> Array:
    """Largest difference of a joint, full turns apart."""
    return np.asarray(np.abs((a - b + math.pi) % (2.0 * math.pi) - math.pi).max(axis=-1))


@pytest.mark.parametrize("kind", KINDS)
def test_random_chains_of_a_kind_are_known_and_all_their_branches_reach_the_pose(kind: int) -> None:
    rng = np.random.default_rng(kind)
    counts, doubtful = set(), 0
    for _ in range(30):
        h, o = random_axes(rng)
        KINDS[kind](h, o, rng)
        chain = chain_through(h, o, rng)
        form = find_closed_form(chain)
        assert form.kind == kind
        for _ in range(10):
            q = rng.uniform(-math.pi, math.pi, size=6)
            R, p = forward(chain, q)
            found, unsure = branches_of(form, R, p)
            if unsure:
                doubtful += 1
                continue
            for row in found:
                R_row, p_row = forward(chain, row)
                np.testing.assert_allclose(R_row, R, rtol=0, atol=2e-8)
                np.testing.assert_allclose(p_row, p, rtol=0, atol=2e-8)
            assert turned_apart(found, q).min() < 1e-5
            for i in range(len(found)):
                assert (turned_apart(found[i + 1 :], found[i]) > 1e-6).all()
            counts.add(len(found))
    assert max(counts) == MOST_BRANCHES
    assert doubtful <= 6


def test_axes_that_are_nearly_of_a_kind_are_not_taken_for_it() -> None:
    rng = np.random.default_rng(9)
    for kind, make in KINDS.items():
        h, o = random_axes(rng)
        make(h, o, rng)
        o[5] += 1e-6 * np.cross(h[4], h[5])
        assert find_closed_form(chain_through(h, o, rng)).kind == NO_FORM, kind


def test_forms_of_the_catalogue_are_found_from_its_chains() -> None:
    kinds = {
        "ur5": THREE_PARALLEL,
        "ur10e": THREE_PARALLEL,
        "tm5_900": THREE_PARALLEL,
        "abb_irb2400_12_155": SECOND_PARALLEL,
        "fanuc_lrmate200id": SECOND_PARALLEL,
        "staubli_rx160": SECOND_PARALLEL,
        "kinova_j2s6s200": SECOND_PARALLEL,
        "iiwa14": NO_FORM,
        "xarm6": NO_FORM,
        "doosan_m1013": NO_FORM,
        "dobot_magician": NO_FORM,
    }
    assert kinds.keys() <= set(robot_names())
    for name, kind in kinds.items():
        assert arm_of(load_robot(name)).closed_form.kind == kind, name


def many_starts(robot: Robot, R: Array, p: Array) -> Array:
    """Solutions by Levenberg-Marquardt from 1,500 seeds, full turns apart, shape (k, 6)."""
    from ikplan.ik.levenberg_marquardt import Effort, new_workspace, refine
    from ikplan.kinematics.target import pose_target

    arm, rng = arm_of(robot), np.random.default_rng(5)
    lower, upper = np.full(6, -2.0 * math.pi), np.full(6, 2.0 * math.pi)
    target, w = pose_target(p, R), new_workspace(arm.chain)
    rows: list[Array] = []
    for _ in range(1500):
        q = rng.uniform(-math.pi, math.pi, size=6)
        distance, angle, _ = refine(arm.chain, target, q, lower, upper, Effort(60, 10), w)
        solved = max(distance, angle) < 1e-10
        if solved and (not rows or turned_apart(np.array(rows), q).min() > 1e-4):
            rows.append(q.copy())
    return np.array(rows)


@pytest.mark.parametrize("name", ["ur5", "abb_irb2400_12_155", "staubli_rx160"])
def test_branches_are_those_that_many_starts_find(name: str) -> None:
    robot = load_robot(name)
    rng, form = np.random.default_rng(3), arm_of(robot).closed_form
    for _ in range(3):
        pose = robot.fk(robot.random_configuration(rng))
        found, unsure = branches_of(form, pose.rotation, pose.translation)
        searched = many_starts(robot, np.ascontiguousarray(pose.rotation), pose.translation.copy())
        assert not unsure
        assert len(searched) == len(found)
        for row in searched:
            assert turned_apart(found, row).min() < 1e-6


@pytest.mark.parametrize(
    ("name", "q"),
    [
        ("ur5", [0.3, -1.0, 1.2, 0.4, 0.0, 0.7]),  # axes 4 and 6 in line
        ("ur5", [0.3, -1.0, 0.0, 0.4, 0.9, 0.7]),  # the elbow stretched
        ("abb_irb2400_12_155", [0.3, 0.2, 0.1, 0.5, 0.0, 0.7]),
        ("staubli_rx160", [0.3, 0.2, 1.1, 0.5, 0.0, 0.7]),
    ],
)
def test_singular_poses_are_said_to_be_unsure(name: str, q: list[float]) -> None:
    robot = load_robot(name)
    pose = robot.fk(q)
    _, unsure = branches_of(arm_of(robot).closed_form, pose.rotation, pose.translation)
    assert unsure


def test_poses_out_of_reach_have_no_branches() -> None:
    robot = load_robot("ur5")
    pose = robot.fk([0.3, -1.0, 1.2, 0.4, 0.8, 0.7])
    found, unsure = branches_of(arm_of(robot).closed_form, pose.rotation, 3.0 * pose.translation)
    assert len(found) == 0
    assert not unsure


def test_the_tool_and_the_base_of_a_robot_are_part_of_its_form() -> None:
    robot = load_robot("ur5").with_tool([0.1, -0.05, 0.2], [0.5, 0.5, 0.5, 0.5])
    q = np.array([0.3, -1.0, 1.2, 0.4, 0.8, 0.7])
    pose = robot.fk(q)
    found, _ = branches_of(arm_of(robot).closed_form, pose.rotation, pose.translation)
    assert turned_apart(found, q).min() < 1e-9
