"""The time budget ends a plan in the stage it runs out in, and tells the best so far.

Time is made up: nothing here waits or is measured.
"""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import ikplan
from ikplan import BudgetExceeded, Disconnected, Plan, load_robot
from ikplan.documents.poses import Tolerance
from ikplan.documents.requests.ik_options import IkOptions
from ikplan.kinematics.target import pose_target
from ikplan.planning import TimeBudget, select_configurations
from ikplan.planning.tracking.densify import densify
from ikplan.planning.tracking.tracked_path import TrackingFailed
from ikplan.planning.waypoints.waypoint_problem import WaypointProblem
from ikplan.planning.within.tolerant_tracker import TolerantTracker

from .conftest import Time
from .planar import Elongation, Polyline, joints, line, problem_of, solver_of, tracker_of, two_links

STAGES = ["ik", "planning", "timing", "certificate"]
END = {"ik": 0, "planning": 0, "timing": 1, "certificate": 2}
"""Which part of a plan each stage is in: candidates are searched for in the midst of planning."""


REQUEST: dict[str, Any] = {
    "robot": "ur5",
    "start": [0.4, -1.2, 1.5, -0.8, -1.2, 0.3],
    "path": {
        "waypoints": [
            {"position": [0.49, 0.33, 0.25]},
            {"position": [0.49, 0.41, 0.25]},
            {"position": [0.42, 0.41, 0.3]},
        ],
    },
    "budget_s": 1000.0,
}


def lines() -> dict[str, Any]:
    path = {**REQUEST["path"], "interpolation": "line"}
    return {**REQUEST, "path": path}


REQUESTS = {
    "global": REQUEST,
    "greedy": {**REQUEST, "ik": {"elongation": "greedy"}},
    "lines": lines(),
    "jerk": {**REQUEST, "limits": {"jerk": 300.0}},
}


@pytest.mark.parametrize("kind", REQUESTS)
@pytest.mark.parametrize("stage", STAGES)
def test_a_budget_that_is_gone_in_a_stage_ends_it_or_keeps_the_next_from_beginning(
    stage: str, kind: str, passing: Time
) -> None:
    begun: list[str] = []

    def pass_by(name: str, _: int, of: int) -> None:
        if not of:
            begun.append(name)
        if name == stage:
            passing.now = 1001.0

    if stage == STAGES[-1]:
        plan = ikplan.plan(REQUESTS[kind], progress=pass_by)
        assert begun == STAGES
        assert plan.stats.seconds.keys() == set(STAGES)
        return
    with pytest.raises(BudgetExceeded) as caught:
        ikplan.plan(REQUESTS[kind], progress=pass_by)
    # The solver is set up in one go: what it runs over, the next stage is refused for.
    assert caught.value.stage == ("planning" if stage == "ik" else stage)
    assert begun == STAGES[: STAGES.index(stage) + 1]


@pytest.mark.parametrize("kind", ["global", "greedy", "jerk"])
def test_a_budget_that_is_gone_in_the_search_for_configurations_ends_it_there(
    kind: str, passing: Time
) -> None:
    def pass_by(name: str, _: int, of: int) -> None:
        if name == "ik" and of:
            passing.now = 1001.0

    with pytest.raises(BudgetExceeded) as caught:
        ikplan.plan(REQUESTS[kind], progress=pass_by)
    assert caught.value.stage == "ik"


def test_a_curve_too_long_to_track_in_its_budget_ends_in_the_planning(passing: Time) -> None:
    def pass_by(_: str, __: int, of: int) -> None:
        if of:  # from the start on, the lines are tracked
            passing.now = 1001.0

    with pytest.raises(BudgetExceeded) as caught:
        ikplan.plan(lines(), progress=pass_by)
    assert caught.value.stage == "planning"


@pytest.mark.parametrize("kind", REQUESTS)
def test_whenever_the_budget_ends_the_plan_ends_at_the_next_look(kind: str, passing: Time) -> None:
    """Each look at the clock takes a millisecond. However many there are, none is in vain."""
    passing.a_look = 1e-3
    whole = ikplan.plan({**REQUESTS[kind], "budget_s": 3600.0})
    looks, ends = passing.looks, []
    assert looks < 3_000_000
    for budget in sorted({*range(0, min(looks, 24), 2), *range(24, looks, max(1, looks // 16))}):
        passing.now, passing.looks = 0.0, 0
        end, plan = outcome({**REQUESTS[kind], "budget_s": (budget + 0.5) * 1e-3})
        ends.append(end)
        if plan is None:
            # Besides, the time of each stage that is left is taken once more.
            assert passing.looks <= budget + 7
        else:
            assert lasting(plan) == lasting(whole)
    assert ends == sorted(ends)
    assert ends[0] == END["ik"]
    assert END["timing"] in ends


def outcome(request: dict[str, Any]) -> tuple[int, Plan | None]:
    """In which part the budget ran out, as a number, and the plan if there is one."""
    try:
        return len(END), ikplan.plan(request)
    except BudgetExceeded as error:
        return END[error.stage], None


def lasting(plan: Plan) -> str:
    """A plan without what the budget says: its id, and how long its stages took."""
    return plan.model_dump_json(exclude={"stats", "id"})


def test_greedy_waypoints_solved_so_far_are_the_best_so_far(passing: Time) -> None:
    robot = two_links()
    points = [[0.5, 0.2, 0.0], [0.6, 0.1, 0.0], [0.4, -0.3, 0.0], [0.5, -0.5, 0.0]]

    def gone(_: str, done: int, __: int) -> None:
        if done == 2:
            passing.now = 11.0

    start = joints([0.5, 0.0, 0.0], 1.0)
    targets = [pose_target(np.array(p)) for p in points]
    problem = WaypointProblem(
        robot, solver_of(robot), targets, start, False, Tolerance(), TimeBudget(10.0, gone)
    )
    with pytest.raises(BudgetExceeded) as caught:
        select_configurations(problem, IkOptions(method="lm", elongation="greedy"))
    best = caught.value.best
    assert best is not None
    assert best["waypoints_solved"] == len(best["q"]) == 3
    np.testing.assert_allclose(best["q"], joints(points[:3], 1.0), atol=1e-8)


@pytest.mark.parametrize("elongation", ["global", "greedy"])
def test_the_verdict_on_many_waypoints_ends_with_the_budget_too(
    elongation: Elongation, passing: Time
) -> None:
    def gone(_: str, done: int, __: int) -> None:
        if done == 3:
            passing.now = 11.0

    problem = problem_of(two_links(), clock=TimeBudget(10.0, gone))
    with pytest.raises(BudgetExceeded) as caught:
        select_configurations(problem, IkOptions(method="lm", elongation=elongation))
    assert caught.value.best == {"waypoints_solved": 1}


def test_following_a_path_ends_with_the_budget(passing: Time) -> None:
    guide = line((0.5, -0.4), (0.45, 0.35))
    tracker = tracker_of(two_links(), budget_s=10.0)
    start = joints(guide.points[0], 1.0)
    assert len(tracker.track(guide, start[None], np.zeros(1)).s) > 2
    passing.now = 11.0
    with pytest.raises(BudgetExceeded):
        tracker.track(guide, start[None], np.zeros(1))
    with pytest.raises(BudgetExceeded):
        densify(tracker, guide, np.array([0.0, guide.length]), joints(guide.points, 1.0))


def test_no_further_start_is_led_once_the_budget_is_gone(passing: Time) -> None:
    class Slow(Polyline):
        """Each look at the path takes a second."""

        def positions(self, s: np.ndarray) -> np.ndarray:
            return self.poses(s)[1]

        def poses(self, s: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
            passing.now += 1.0
            return super().poses(s)

    guide = Slow(line((0.5, -0.4), (0.45, 0.35)).points)
    starts = np.array([joints(guide.points[0], elbow) for elbow in (1.0, -1.0)])
    looks = []
    for count in (1, 2):
        passing.now = 0.0
        tracker = tracker_of(two_links(), budget_s=1.5)
        with pytest.raises(BudgetExceeded):
            tracker.track(guide, starts[:count], np.zeros(count))
        looks.append(passing.now)
    assert looks[0] == looks[1] > 1.5


@pytest.mark.parametrize("search", ["track_global", "track_within"])
def test_a_budget_that_is_gone_after_a_verdict_tells_it(
    search: str, passing: Time, monkeypatch: pytest.MonkeyPatch
) -> None:
    """tesseract's puzzle_bent.csv with its axis fixed: lost at once, then searched on."""
    home = load_robot("iiwa14").home
    turns = {"type": "arc", "centre": [0.5, 0.0, 0.5], "angle": 14.0, "orientation": "follow"}
    request: dict[str, Any] = {
        "robot": "iiwa14",
        "start": home.tolist(),
        "path": {
            "begin": {"position": [0.55, 0.0, 0.5], "quaternion_xyzw": [0.0, 1.0, 0.0, 0.0]},
            "approach": "joint",
            "segments": [turns],
        },
        "budget_s": 100.0,
        "repairs": 0,
        "scene": {"self_collision": False},
    }
    with pytest.raises(Disconnected) as refused:
        ikplan.plan(request)

    def slow(tracker: TolerantTracker, *_: Any) -> Any:
        passing.now += 1000.0
        tracker.clock.check()

    def failing(*_: Any) -> Any:
        raise TrackingFailed(0.0, home)

    monkeypatch.setattr(TolerantTracker, "track_global", failing)
    monkeypatch.setattr(TolerantTracker, search, slow)
    with pytest.raises(BudgetExceeded) as caught:
        ikplan.plan(request)
    assert caught.value.stage == "planning"
    assert caught.value.detail.startswith("the budget of 100 s")
    assert caught.value.detail.endswith(f". Until then: {refused.value.detail}")
