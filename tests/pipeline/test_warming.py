"""The small requests that load the kernels: each once a process, before any clock begins."""

from __future__ import annotations

import threading
from collections.abc import Iterator, Mapping
from typing import Any

import pytest

from ikplan import InCollision, InvalidRequest, Unreachable
from ikplan.pipeline import warm_up as warming
from ikplan.pipeline.forward_kinematics import fk_request
from ikplan.pipeline.plan import plan
from ikplan.pipeline.poses import solve_ik_request
from ikplan.pipeline.retime import time_request
from ikplan.pipeline.warm_up import RequestKind, small_requests, warm_up

RUN = {"fk": fk_request, "ik": solve_ik_request, "plan": plan, "time": time_request}


@pytest.fixture
def cold(monkeypatch: pytest.MonkeyPatch) -> Iterator[None]:
    """As in a process in which nothing was asked for yet."""
    monkeypatch.setattr(warming, "_ready", set())
    yield
    assert not warming._under_way


@pytest.mark.usefixtures("cold")
def test_a_warm_up_within_a_warm_up_asks_for_nothing_twice() -> None:
    asked: list[Mapping[str, Any]] = []

    def run(request: Mapping[str, Any]) -> None:
        asked.append(request)
        warm_up(run, "plan", "lm", jerk=False)

    for _ in range(2):
        warm_up(run, "plan", "lm", jerk=True)
    assert asked == small_requests("plan", "lm") + small_requests("plan", "lm", jerk=True)


@pytest.mark.usefixtures("cold")
def test_a_warm_up_that_fails_says_so_and_is_tried_again() -> None:
    def fails(_: Mapping[str, Any]) -> None:
        raise MemoryError

    for _ in range(2):
        with pytest.raises(MemoryError):
            warm_up(fails, "fk")
    asked: list[object] = []
    warm_up(asked.append, "fk")
    assert asked == small_requests("fk")


@pytest.mark.usefixtures("cold")
def test_a_second_thread_waits_for_the_first() -> None:
    begun, go_on = threading.Event(), threading.Event()
    done: list[str] = []

    def slow(_: Mapping[str, Any]) -> None:
        begun.set()
        assert go_on.wait(10.0)
        done.append("first")

    def second() -> None:
        warm_up(lambda _: done.append("asked again"), "fk")
        done.append("second")

    threads = [threading.Thread(target=warm_up, args=(slow, "fk"))]
    threads[0].start()
    assert begun.wait(10.0)
    threads.append(threading.Thread(target=second))
    threads[1].start()
    threads[1].join(0.05)
    assert done == []
    go_on.set()
    for thread in threads:
        thread.join(10.0)
    assert done == ["first", "second"]


@pytest.mark.parametrize("kind", ["ik", "plan"])
def test_a_solver_that_does_not_exist_is_refused_by_the_warm_up_too(kind: RequestKind) -> None:
    with pytest.raises(InvalidRequest, match="ik-ba") as caught:
        warm_up(RUN[kind], kind, "no such")  # type: ignore[arg-type]
    assert caught.value.field == "ik.method"


@pytest.mark.parametrize("jerk", [False, True])
@pytest.mark.parametrize("kind", RUN)
def test_small_requests_are_answered_all_but_those_out_of_reach_or_in_contact(
    kind: RequestKind, jerk: bool
) -> None:
    away, touching = [], []
    for request in small_requests(kind, "ik-ba", jerk=jerk):
        try:
            RUN[kind](request)  # type: ignore[operator]
        except Unreachable as error:
            away.append(error.position_error)
        except InCollision as error:
            touching.append(error.pair)
    # One of an arm without and one of an arm with a closed form.
    assert len(away) == 2 * (kind == "ik" or (kind == "plan" and not jerk))
    assert all(distance > 1.0 for distance in away)
    # A line of the plans ends at a ball: every way around it is looked for.
    expected = {"ik": 1, "plan": 2 * (not jerk), "time": not jerk}
    assert len(touching) == expected.get(kind, 0)
    assert all("ball" in pair for pair in touching)
