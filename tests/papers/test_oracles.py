"""What the experiments rest on: closed forms, reachability, statistics, published figures."""

from __future__ import annotations

import math

import numpy as np
import pinocchio as pin
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy import stats

from benchmarks.papers import published
from benchmarks.papers.closed_forms import dobot_solutions, eod_solutions
from benchmarks.papers.helix import helix_cases
from benchmarks.papers.li_paths import EQ_47, PRINTED, path_case
from benchmarks.papers.li_poses import configurations
from benchmarks.papers.series import Series, context_of
from benchmarks.papers.statistics import (
    adjusted,
    anova,
    average_ranks,
    estimate,
    holm,
    over_runs,
    over_targets,
    paired,
    paired_effect,
    share,
    summary,
    welch,
)
from ikplan import solve_ik
from ikplan.errors import Unreachable
from ikplan.robots import load_robot


@pytest.mark.parametrize("name", ["eod_arm", "dobot_magician"])
def test_closed_forms_contain_the_configuration_and_meet_the_pose(name: str) -> None:
    robot = load_robot(name)
    rng = np.random.default_rng(0)
    for _ in range(60):
        q = robot.random_configuration(rng)
        if name == "dobot_magician":
            q[3] = q[0]
        pose = robot.fk(q)
        solve = eod_solutions if name == "eod_arm" else dobot_solutions
        solutions = solve(np.array(pose.rotation), np.array(pose.translation))
        assert min(np.abs(s - q).max() for s in solutions) < 1e-9
        for s in solutions:
            np.testing.assert_allclose(robot.fk(s).homogeneous, pose.homogeneous, atol=1e-9)


def test_closed_form_of_the_dobot_is_table_8() -> None:
    phi = np.radians(18.0 * np.arange(20))
    for k, (c, s) in enumerate(zip(np.cos(phi), np.sin(phi), strict=True)):
        p = np.array([0.16 + 0.07 * c, 0.16 + 0.07 * s, 0.0])
        angles = [np.degrees(q[:3]).round(1) for q in dobot_solutions(np.eye(3), p)]
        assert any(np.allclose(a, published.DOBOT_TABLE_8[k]) for a in angles)


@pytest.mark.parametrize(("name", "count"), [("1", 95), ("2", 116), ("3", 129), ("4", 120)])
def test_reachable_poses_of_the_li_trajectories(name: str, count: int) -> None:
    assert path_case(name).reachable.sum() == count


def test_the_printed_trajectory_3_and_the_printed_matrix_are_impossible() -> None:
    assert not path_case("3+").reachable.any()
    assert np.linalg.det(PRINTED) == pytest.approx(0.134, abs=5e-4)
    np.testing.assert_allclose(EQ_47 @ EQ_47.T, np.eye(3), atol=1e-12)
    assert np.linalg.det(EQ_47) == pytest.approx(1.0)
    np.testing.assert_allclose(np.abs(EQ_47), np.abs(PRINTED), atol=1e-3)
    U, _, Vt = np.linalg.svd(PRINTED)
    floor = 0.0384167 * np.linalg.norm(PRINTED - U @ Vt)
    assert floor == pytest.approx(0.0431, abs=5e-5)


@pytest.mark.parametrize("name", ["E1b", "E1c", "E1d"])
def test_helix_points_are_reachable_as_stated(name: str) -> None:
    case = helix_cases()[name]
    for k in range(case.count):
        pose = pin.SE3(case.R[k], case.p[k])
        if case.reachable[k]:
            assert solve_ik(case.robot, pose, method="lm").position_error < 1e-6
        else:
            with pytest.raises(Unreachable):
                solve_ik(case.robot, pose, method="lm", params={"restarts": 30})


def test_stored_poses_are_inside_the_limits() -> None:
    for name in ("eod_arm", "baxter_table7"):
        q, robot = configurations(name), load_robot(name)
        assert q.shape == (100, robot.dof)
        assert ((q >= robot.lower) & (q <= robot.upper)).all()


def test_no_two_solves_share_their_random_numbers() -> None:
    contexts = {
        context_of(case, Series(name, "ik-ba"), run, k)
        for case in ("E1a", "E1b")
        for name in ("IK-BA", "BA")
        for run in range(3)
        for k in range(4)
    }
    assert len(contexts) == 48


def test_published_means_of_the_dobot_and_of_table_5_are_what_the_report_says() -> None:
    errors = np.array(published.DOBOT_ERRORS)
    assert errors.mean() == pytest.approx(2.553, abs=1e-3)
    assert np.where(errors == 9.61, 0.961, errors).mean() == pytest.approx(2.1196, abs=2e-3)
    points = np.array(published.KANAGARAJ_TABLE_4["linear"]["WOA"])
    assert len(points) == 17
    assert stats.gmean(points) == pytest.approx(2.63, abs=0.02)
    assert points.mean() == pytest.approx(3.30, abs=0.02)


def test_published_anova_follows_from_the_published_table() -> None:
    # Twenty values a group: SS between from the means, SS within from the deviations, ddof 1.
    table = published.SLIM_TABLE_3["elongation_deg"].values()
    means = np.array([row[0] for row in table])
    between = 20.0 * ((means - means.mean()) ** 2).sum()
    within = 19.0 * sum(row[2] ** 2 for row in table)
    assert between == pytest.approx(published.SLIM_ANOVA["elongation_deg"][0], rel=1e-4)
    assert within == pytest.approx(published.SLIM_ANOVA["elongation_deg"][1], rel=1e-4)


def test_anova_by_hand() -> None:
    groups = [np.array([1.0, 2.0, 3.0]), np.array([2.0, 3.0, 4.0]), np.array([5.0, 6.0, 7.0])]
    a = anova(groups)
    assert a.ss_between == pytest.approx(26.0)
    assert a.ss_within == pytest.approx(6.0)
    assert a.df == (2, 6)
    assert pytest.approx(13.0) == a.F
    assert a.p == pytest.approx(stats.f.sf(13.0, 2, 6))
    with pytest.raises(ValueError, match="three runs"):
        anova([np.array([1.0, 2.0]), np.array([1.0, 2.0])])


def test_holm_by_hand() -> None:
    assert holm([0.01, 0.04, 0.03, 0.005]) == pytest.approx([0.03, 0.06, 0.06, 0.02])
    assert holm([0.9, 0.8]) == [1.0, 1.0]


@settings(max_examples=50, deadline=None)
@given(
    a=st.lists(st.floats(0, 1), min_size=8, max_size=8),
    b=st.lists(st.floats(0, 1), min_size=8, max_size=8),
)
def test_effects_change_their_sign_with_the_order(a: list[float], b: list[float]) -> None:
    p, effect = paired(np.array(a), np.array(b))
    q, opposite = paired(np.array(b), np.array(a))
    assert p == pytest.approx(q)
    assert effect == pytest.approx(-opposite)
    assert -1.0 <= effect <= 1.0


def test_effect_is_minus_one_where_the_first_is_always_smaller() -> None:
    small = np.arange(6.0)
    p, effect = paired(small, small + np.arange(1.0, 7.0))
    assert effect == -1.0
    assert p == pytest.approx(2.0 / 2**6)
    assert paired(small, small) == (1.0, 0.0)


def test_average_ranks_share_ties() -> None:
    ranks = average_ranks({"a": np.array([1.0, 2.0]), "b": np.array([1.0, 1.0])})
    assert ranks == {"a": 1.75, "b": 1.25}


def test_summary_names_its_deviation() -> None:
    values = np.array([1.0, 2.0, 4.0])
    assert summary(values) == pytest.approx([7 / 3, 2.0, math.sqrt(7 / 3), 4.0, 1.0])
    assert summary(values, ddof=0)[2] == pytest.approx(math.sqrt(14 / 9))


def test_a12_is_the_share_of_pairs_in_which_the_first_is_smaller() -> None:
    a, b = np.array([1.0, 2.0, 3.0]), np.array([2.0, 4.0])
    test = over_runs(a, b)
    by_hand = np.mean([[1.0 if x < y else 0.5 if x == y else 0.0 for y in b] for x in a])
    assert test.effect == pytest.approx(by_hand)
    assert test.p == pytest.approx(stats.mannwhitneyu(a, b).pvalue)
    assert over_runs(a, a).effect == 0.5
    assert over_runs(np.ones(5), np.ones(5)).p == 1.0


@settings(max_examples=30, deadline=None)
@given(seed=st.integers(0, 10_000))
def test_a_comparison_does_not_depend_on_the_order_of_the_runs(seed: int) -> None:
    """Runs of two series share nothing, so that no pairing of them may matter."""
    rng = np.random.default_rng(seed)
    a, b = rng.random(20), rng.random(20) + 0.2
    first, again = over_runs(a, b), over_runs(rng.permutation(a), b)
    assert first.p == pytest.approx(again.p)
    assert first.effect == pytest.approx(again.effect)


def test_an_effect_is_one_where_the_first_is_smaller_throughout() -> None:
    small = np.arange(1.0, 21.0)
    for compare in (over_runs, over_targets):
        test = compare(small, small + 30.0)
        assert (test.effect, test.low, test.high) == (1.0, 1.0, 1.0)
        assert test.first_is_smaller
        assert compare(small + 30.0, small).second_is_smaller


def test_the_interval_of_a_mean_covers_it_as_often_as_it_says() -> None:
    rng = np.random.default_rng(1)
    hits = 0
    for _ in range(100):
        e = estimate(rng.normal(3.0, 1.0, (20, 20)))
        hits += e.low <= 3.0 <= e.high
    assert hits >= 90
    assert e.n == "20 runs x 20 targets"


def test_series_of_a_run_and_a_target_are_drawn_together() -> None:
    few = np.random.default_rng(2).random((5, 8)) + 1.0
    e = estimate(np.stack([few, 3.0 * few], axis=2), lambda v: v[..., 1].mean() / v[..., 0].mean())
    assert (e.value, e.low, e.high) == pytest.approx((3.0, 3.0, 3.0))
    assert e.n == "5 runs x 8 targets"


def test_intervals_of_effects_are_those_of_each_resample() -> None:
    rng = np.random.default_rng(3)
    a, b = rng.integers(0, 5, 30).astype(float), rng.integers(0, 5, 30).astype(float)
    drawn = np.random.Generator(np.random.PCG64(5)).integers(0, 30, (1000, 30))
    effects = [0.5 * (1.0 - paired(a[i], b[i])[1]) for i in drawn]
    test = over_targets(a, b)
    assert (test.low, test.high) == pytest.approx(tuple(np.quantile(effects, [0.025, 0.975])))


def test_the_rank_biserial_correlation_leaves_out_zeros() -> None:
    # Of |d| = 1, 2, 2: ranks 1, 2.5, 2.5; the zeros have none.
    assert paired_effect(np.array([0.0, 1.0, -2.0, 0.0, 2.0])) == pytest.approx(1.0 / 6.0)
    assert paired_effect(np.zeros(3)) == 0.0


def test_a_share_has_wilsons_interval() -> None:
    below = share(np.array([1.0, 2.0, 3.0, 4.0]), 1.5)
    assert below.value == 0.25
    # (p + z^2/2n -+ z sqrt(p q/n + z^2/4n^2)) / (1 + z^2/n), by hand for n = 4, p = 1/4.
    z = 1.959963984540054
    middle, half = 0.25 + z**2 / 8.0, z * math.sqrt(0.1875 / 4.0 + z**2 / 64.0)
    assert below.low == pytest.approx((middle - half) / (1.0 + z**2 / 4.0))
    assert below.high == pytest.approx((middle + half) / (1.0 + z**2 / 4.0))


def test_one_claim_is_one_family() -> None:
    small = np.arange(1.0, 21.0)
    raw = [over_runs(small, small + shift) for shift in (1.0, 4.0, 9.0)]
    assert [c.p for c in adjusted(raw)] == holm([c.p for c in raw])
    assert [c.effect for c in adjusted(raw)] == [c.effect for c in raw]


def test_welch_against_a_printed_mean() -> None:
    values = np.array([1.0, 2.0, 3.0, 4.0])
    other = np.array([2.0, 2.5, 3.5, 6.0, 7.0])
    printed = welch(values, float(other.mean()), float(other.std(ddof=1)), len(other))
    assert printed == pytest.approx(stats.ttest_ind(values, other, equal_var=False).pvalue)
