"""The kernels of the choice along the path, against SciPy, Pinocchio and brute force."""

from __future__ import annotations

import itertools

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray
from scipy.linalg import null_space, solveh_banded
from scipy.optimize import linprog

from ikplan.kinematics.arm import arm_of
from ikplan.kinematics.target import Target, no_freedom, pose_target
from ikplan.planning.ladder.banded_cholesky import solve_banded
from ikplan.planning.ladder.ik_candidates import IkCandidates, Targets, sample_ik_solutions
from ikplan.planning.ladder.joint_length import joint_path_length
from ikplan.planning.ladder.ladder_graph import diverse_shortest_paths
from ikplan.planning.ladder.motion_cost import plain_cost
from ikplan.planning.ladder.null_space import null_space_basis
from ikplan.planning.ladder.path_shortening import shorten_sequence
from ikplan.planning.waypoints.stack import stack_targets
from ikplan.robots import Robot, load_robot

Array = NDArray[np.float64]

seeds = st.integers(0, 2**32 - 1)


@settings(deadline=None)
@given(seed=seeds, dof=st.integers(2, 9), rank=st.integers(0, 6), fixed=st.integers(0, 3))
def test_the_tangent_basis_is_an_orthonormal_basis_of_the_null_space(
    seed: int, dof: int, rank: int, fixed: int
) -> None:
    rng = np.random.default_rng(seed)
    rank = min(rank, dof)
    J = rng.normal(size=(6, rank)) @ rng.normal(size=(rank, dof))
    held = np.zeros(dof, dtype=bool)
    held[rng.permutation(dof)[:fixed]] = True
    basis = np.zeros((dof, dof))
    count = null_space_basis(np.ascontiguousarray(J.T), held, basis)
    B = basis[:count]
    np.testing.assert_allclose(B @ B.T, np.eye(count), atol=1e-12)
    np.testing.assert_allclose(J @ B.T, 0.0, atol=1e-6 * max(1.0, np.abs(J).max()))
    assert np.abs(B[:, held]).max(initial=0.0) < 1e-12
    assert count == null_space(np.vstack([J, np.eye(dof)[held]]), rcond=1e-9).shape[1]


@settings(deadline=None)
@given(seed=seeds, size=st.integers(1, 30), width=st.integers(0, 6))
def test_a_band_matrix_is_solved_as_by_scipy(seed: int, size: int, width: int) -> None:
    rng = np.random.default_rng(seed)
    width = min(width, size - 1)
    full = np.zeros((size, size))
    for i, j in itertools.product(range(size), repeat=2):
        if 0 < i - j <= width:
            full[i, j] = full[j, i] = rng.normal()
    full += np.diag(np.abs(full).sum(axis=1) + rng.uniform(0.1, 1.0, size))
    A, upper = np.zeros((size, width + 1)), np.zeros((width + 1, size))
    for i in range(size):
        for j in range(max(0, i - width), i + 1):
            A[i, width - (i - j)] = full[i, j]
            upper[width - (i - j), i] = full[i, j]
    b = rng.normal(size=size)
    want = solveh_banded(upper, b)
    assert solve_banded(A, b, size, width)
    np.testing.assert_allclose(b, want, rtol=1e-9, atol=1e-12)


def test_a_matrix_that_is_not_positive_definite_is_told() -> None:
    assert not solve_banded(np.array([[0.0, 1.0], [2.0, 1.0]]), np.ones(2), 2, 1)


@settings(deadline=None)
@given(seed=seeds, free=st.booleans())
def test_the_ladder_finds_the_shortest_path_of_all(seed: int, free: bool) -> None:
    rng = np.random.default_rng(seed)
    counts = rng.integers(1, 5, size=4)
    q = rng.normal(size=(4, 4, 3))
    start = rng.normal(size=3)
    candidates = IkCandidates(q, counts, np.zeros(1, dtype=np.int64))
    chain = arm_of(load_robot("eod_arm")).chain
    limits = np.full(3, 3.0)  # no room for a full turn
    paths = diverse_shortest_paths(
        chain, candidates, start, free, -limits, limits, plain_cost(len(limits)), 5, 1e-9, 10.0
    )
    lengths = sorted(
        joint_path_length(np.array([q[k, i] for k, i in enumerate(rows)]), start, free)
        for rows in itertools.product(*map(range, counts))
    )
    found = [joint_path_length(path, start, free) for path in paths]
    assert found[0] == pytest.approx(lengths[0], rel=1e-12)
    assert (np.diff(found) >= -1e-12).all()
    for a, b in itertools.combinations(paths, 2):
        assert np.abs(a - b).max() >= 1e-9


def along(name: str, count: int, seed: int, step: float = 0.25) -> tuple[Robot, list[Target]]:
    """Targets that the robot passes, and where it starts."""
    robot = load_robot(name)
    rng = np.random.default_rng(seed)
    q, targets = np.array(robot.home), []
    for _ in range(count):
        q = robot.clip(q + step * rng.uniform(-1, 1, robot.dof))
        T = robot.fk(q)
        targets.append(pose_target(T.translation, T.rotation))
    return robot, targets


def grown(
    robot: Robot, targets: list[Target], first: int = 64
) -> tuple[IkCandidates, Targets, Array, Array, Array]:
    arm = arm_of(robot)
    lower, upper = arm.search_bounds(np.array(robot.home))
    no_seeds = np.empty((len(targets), 0, arm.dof))
    home = np.array(robot.home)
    stacked = stack_targets(targets)
    found = sample_ik_solutions(
        arm.chain, stacked, no_seeds, home, lower, upper, 40, first, 4, 0.5, 1e-9
    )
    return found, stacked, lower, upper, home


@pytest.mark.parametrize("name", ["iiwa14", "ur5", "tiago", "dobot_magician"])
def test_candidates_are_different_solutions_within_limits(name: str) -> None:
    robot, targets = along(name, 4, 7)
    found, _, lower, upper, _ = grown(robot, targets)
    for k, target in enumerate(targets):
        rows = found.q[k, : found.counts[k]]
        assert len(rows) >= 1
        for q in rows:
            T = robot.fk(q)
            np.testing.assert_allclose(T.translation, target.p, atol=1e-8)
            np.testing.assert_allclose(T.rotation, target.R, atol=1e-8)
            assert ((lower <= q) & (q <= upper)).all()
        for a, b in itertools.combinations(rows, 2):
            assert np.abs(a - b).max() >= 1e-4


def test_the_branches_of_the_ur5_are_all_found() -> None:
    robot, targets = along("ur5", 1, 11, step=0.6)
    found, *_ = grown(robot, targets, first=300)
    turns = np.round(np.mod(found.q[0, : found.counts[0]] + 1e-6, 2.0 * np.pi), 4)
    assert len({tuple(row) for row in turns}) == 8  # shoulder, elbow, wrist


@pytest.mark.parametrize("start_free", [False, True])
@pytest.mark.parametrize(
    ("name", "seed"), [("iiwa14", 1), ("panda", 2), ("xarm7", 3), ("tiago", 4)]
)
def test_the_polish_shortens_to_a_stationary_point(name: str, seed: int, start_free: bool) -> None:
    robot, targets = along(name, 6, seed)
    found, stacked, lower, upper, home = grown(robot, targets)
    q = diverse_shortest_paths(
        arm_of(robot).chain,
        found,
        home,
        start_free,
        lower,
        upper,
        plain_cost(robot.dof),
        1,
        0.6,
        0.1,
    )[0]
    before = joint_path_length(q, home, start_free)
    length, _ = shorten_sequence(
        arm_of(robot).chain,
        stacked,
        q,
        home,
        start_free,
        lower,
        upper,
        plain_cost(robot.dof),
        200,
        1e-12,
    )
    assert length <= before
    assert length == pytest.approx(joint_path_length(q, home, start_free), rel=1e-12)
    for k, target in enumerate(targets):
        T = robot.fk(q[k])
        np.testing.assert_allclose(T.translation, target.p, atol=1e-8)
        np.testing.assert_allclose(T.rotation, target.R, atol=1e-8)
        assert ((lower <= q[k]) & (q[k] <= upper)).all()
    # No way of sliding a waypoint within the limits shortens the motion to first order.
    path = np.vstack([q[:1] if start_free else home[None], q])
    for k in range(len(q)):
        gradient = np.zeros(robot.dof)
        for other in (path[k], path[k + 2] if k + 2 < len(path) else q[k]):
            apart = q[k] - other
            if np.linalg.norm(apart) > 1e-6:
                gradient += apart / np.linalg.norm(apart)
        # -1 <= v <= 1, v inwards at a limit: the least of gradient . v is the KKT defect.
        bounds = [
            (0.0 if at <= low + 1e-4 else -1.0, 0.0 if at >= high - 1e-4 else 1.0)
            for at, low, high in zip(q[k], lower, upper, strict=True)
        ]
        jacobian = robot.jacobian(q[k])
        best = linprog(gradient, A_eq=jacobian, b_eq=np.zeros(len(jacobian)), bounds=bounds)
        assert best.fun is not None
        assert best.fun > -2e-3


def test_the_polish_leaves_the_only_solution_alone() -> None:
    robot, targets = along("ur5", 3, 5)
    found, stacked, lower, upper, home = grown(robot, targets)
    q = diverse_shortest_paths(
        arm_of(robot).chain, found, home, False, lower, upper, plain_cost(robot.dof), 1, 0.6, 0.1
    )[0]
    before = q.copy()
    shorten_sequence(
        arm_of(robot).chain, stacked, q, home, False, lower, upper, plain_cost(robot.dof), 50, 1e-9
    )
    np.testing.assert_array_equal(q, before)
    assert stacked.freedom.axis == no_freedom().axis


def test_the_polish_lets_go_of_a_long_run_at_a_limit_at_once() -> None:
    """Dense waypoints on a ring: ways that begin at a limit of the last joint, and need not."""
    robot = load_robot("iiwa14")
    arm = arm_of(robot)
    R = np.diag([1.0, -1.0, -1.0])
    targets = []
    for a in np.linspace(0.0, 4.0 * np.pi, 800):
        p = [0.58 + 0.12 * np.cos(a), 0.12 * np.sin(a), 0.35 + 0.05 * np.sin(3.5 * a)]
        targets.append(pose_target(np.array(p), R))
    found, stacked, lower, upper, home = grown(robot, targets)
    ways = diverse_shortest_paths(
        arm.chain, found, home, False, lower, upper, plain_cost(robot.dof), 6, 0.6, 0.1
    )
    at_limit = ((ways <= lower + 1e-4) | (ways >= upper - 1e-4)).any(axis=2).sum(axis=1)
    q = ways[int(np.argmax(at_limit))]
    assert at_limit.max() > 50
    length, _ = shorten_sequence(
        arm.chain, stacked, q, home, False, lower, upper, plain_cost(robot.dof), 12, 1e-9
    )
    least, _ = shorten_sequence(
        arm.chain, stacked, q, home, False, lower, upper, plain_cost(robot.dof), 300, 1e-12
    )
    assert length <= 1.001 * least
