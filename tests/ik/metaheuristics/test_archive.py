"""The archive of MO-PSO: what it keeps, how crowded, who leads."""

from __future__ import annotations

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from ikplan.ik.metaheuristics.archive import archive_into, crowding, draw_leader, knee
from tests.ik.metaheuristics.runs import problem, run

pairs = st.lists(st.tuples(st.integers(0, 9), st.integers(0, 9)), min_size=1, max_size=25)


def undominated(G: np.ndarray) -> list[tuple[float, ...]]:
    def beaten(a: np.ndarray) -> bool:
        return any((b <= a).all() and (b < a).any() for b in G)

    return sorted(tuple(a) for a in G if not beaten(a))


@settings(max_examples=80, deadline=None)
@given(first=pairs, second=pairs)
def test_archive_is_the_undominated_part_of_all_it_was_shown(
    first: list[tuple[int, int]], second: list[tuple[int, int]]
) -> None:
    A, B = np.array(first, dtype=np.float64), np.array(second, dtype=np.float64)
    room = np.empty((100, 4))
    size = archive_into(room, 0, A.copy(), A, 60)
    size = archive_into(room, size, B.copy(), B, 60)
    assert sorted(tuple(g) for g in room[:size, 2:]) == undominated(np.vstack([A, B]))
    np.testing.assert_array_equal(room[:size, :2], room[:size, 2:])


def test_the_most_crowded_candidates_leave_a_full_archive() -> None:
    f1 = np.array([0.0, 1.0, 1.1, 2.0, 3.0])
    G = np.column_stack([f1, 3.0 - f1])
    room = np.empty((20, 3))
    size = archive_into(room, 0, f1[:, None].copy(), G, 4)
    # 1.1 lies between 1.0 and 2.0, 1.0 between 0.0 and 1.1: the distances are 2/3 and 11/15.
    assert size == 4
    assert sorted(room[:4, 0]) == [0.0, 1.0, 2.0, 3.0]


def test_crowding_distance_by_hand() -> None:
    G = np.array([[0.0, 4.0], [1.0, 1.0], [4.0, 0.0]])
    np.testing.assert_allclose(crowding(G), [np.inf, 2.0, np.inf])


def test_leader_of_a_lonely_cell_is_as_likely_as_a_crowded_cell() -> None:
    G = np.array([[0.0, 1.0], [1.0, 0.0], [0.999, 0.001], [0.998, 0.002], [0.997, 0.003]])
    rng = np.random.default_rng(0)
    drawn = np.bincount([draw_leader(G, 20, rng) for _ in range(8000)], minlength=5) / 8000
    # Weight 10 for the cell of one, 10 / 4 for the cell of four.
    assert abs(drawn[0] - 0.8) < 0.02
    np.testing.assert_allclose(drawn[1:], 0.05, atol=0.012)


def test_knee_is_nearest_to_the_scaled_ideal_point() -> None:
    G = np.array([[0.0, 100.0], [0.3, 20.0], [1.0, 0.0]])
    assert knee(G) == 1


def test_mo_pso_returns_its_archive_and_reports_by_the_choice_rule() -> None:
    task = problem(4, 30, 60, q_s=[2.0, 2.0, 2.0, 2.0])
    best = run("mo-pso", task, 3)
    front = best.archive
    assert front.shape[1] == 6
    assert len(front) > 5
    assert len(undominated(front[:, 4:])) == len(front)
    assert best.f[0] == front[:, 4].min()
    np.testing.assert_allclose(np.sum(front[:, :4] ** 2, axis=1), front[:, 4], rtol=1e-12)
    np.testing.assert_allclose(np.linalg.norm(front[:, :4] - 2.0, axis=1), front[:, 5], rtol=1e-12)
    middle = run("mo-pso", task, 3, choice="knee")
    assert front[:, 4].min() < middle.f[0] < front[:, 4].max()
    assert (middle.x == front[knee(np.ascontiguousarray(front[:, 4:])), :4]).all()


def test_archive_never_exceeds_its_capacity() -> None:
    out = run("mo-pso", problem(4, 30, 60), 1, archive=12)
    assert len(out.archive) <= 12
