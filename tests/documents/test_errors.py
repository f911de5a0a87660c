"""The tree of errors: each carries its data through JSON, pickles and the client."""

from __future__ import annotations

import json
import pickle
from typing import Any

import httpx
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import ikplan
from ikplan import errors
from ikplan.errors import IkplanError, ServiceUnavailable, error_from_problem, near_names

EXAMPLES: list[IkplanError] = [
    errors.InvalidRequest("a: wrong", field="a", allowed=[1.0, 2.0]),
    errors.InvalidRequest("two", field="b", errors=[{"field": "b", "detail": "x"}] * 2),
    errors.RobotNotFound(name="iiwa", valid=["iiwa14", "ur5"]),
    errors.PlanNotFound(id="abc"),
    errors.InvalidRobot("no", robot="r", joint="j", value=[1, None], valid=["a"]),
    errors.Unreachable(
        "far",
        waypoint=3,
        position_error=0.1,
        orientation_error=None,
        q=[0.0, 1.0],
        reason="too far",
        limits=["A1"],
        target={"position": [9.0, 0.0, 0.0], "quaternion_xyzw": None},
        waypoints=[{"waypoint": 3, "position_error": 0.1}],
    ),
    errors.Disconnected("apart", waypoints=[-1, 0], jump=2.5, reason="limits", q=[0.5, 1.0]),
    errors.InCollision(
        "touches", waypoint=2, pair=["table", "link_3"], depth=0.01, q=[0.5, 1.0], proven=True
    ),
    errors.TimingFailed("slow", position=0.5, joint="A1", limit="velocity"),
    errors.TimingFailed("heavy", limit="torque", repairs=[{"change": {}, "detail": "less"}]),
    errors.BudgetExceeded("late", stage="ik", budget_s=1.0, best={"q": [[0.0]]}),
    errors.BudgetExceeded("late", stage="ik", budget_s=1.0),
    errors.MemoryExceeded("large", stage="timing", limit_bytes=2**30),
    errors.WorkerLost("ended", exit_code=-9),
    errors.CertificateViolated("broken", certificate={"valid": False}, violations=["x"]),
    errors.AccessDenied("no key"),
    errors.RateLimited(limit="5 per 1 minute", retry_after_s=7.5),
    errors.ServiceUnavailable("gone", url="http://x", status_code=503, retry_after_s=1.0),
]
CLASSES = [c for c in vars(errors).values() if isinstance(c, type) and issubclass(c, IkplanError)]


@pytest.mark.parametrize("error", EXAMPLES, ids=lambda e: type(e).__name__)
def test_an_error_comes_back_from_its_problem_document(error: IkplanError) -> None:
    problem = json.loads(json.dumps(error.to_problem(), allow_nan=False))
    again = error_from_problem(problem)
    assert type(again) is type(error)
    assert again.data == error.data
    assert again.detail == error.detail == str(error) == str(again)
    assert problem["status"] == error.status
    assert problem["title"] == error.title
    assert problem["type"] == f"urn:ikplan:{error.slug}"


@pytest.mark.parametrize("error", EXAMPLES, ids=lambda e: type(e).__name__)
def test_an_error_comes_back_from_a_pickle(error: IkplanError) -> None:
    again = pickle.loads(pickle.dumps(error))
    assert type(again) is type(error)
    assert again.data == error.data
    assert again.detail == error.detail


def test_every_class_has_an_example_a_slug_of_its_own_and_a_place_in_the_drawing() -> None:
    leaves = [c for c in CLASSES if not c.__subclasses__()]
    assert {type(e) for e in EXAMPLES} == set(leaves)
    assert len({c.slug for c in leaves}) == len(leaves)
    assert not {c.slug for c in leaves} & {c.slug for c in CLASSES if c.__subclasses__()}
    for c in CLASSES:
        assert issubclass(c, IkplanError)
        assert c.__name__ in (errors.__doc__ or "")
        assert getattr(ikplan, c.__name__) is c
        assert c.__name__ in ikplan.__all__
        assert 400 <= c.status < 600


TREE: dict[str, dict[str, tuple[str, int]]] = {
    "NoPlan": {
        "Unreachable": ("unreachable", 422),
        "Disconnected": ("disconnected", 422),
        "InCollision": ("in-collision", 422),
        "TimingFailed": ("timing-failed", 422),
        "BudgetExceeded": ("budget-exceeded", 422),
    },
    "InvalidInput": {
        "InvalidRequest": ("invalid-request", 422),
        "RobotNotFound": ("robot-not-found", 404),
        "InvalidRobot": ("invalid-robot", 422),
        "PlanNotFound": ("plan-not-found", 404),
    },
    "ServiceError": {
        "AccessDenied": ("access-denied", 401),
        "RateLimited": ("rate-limited", 429),
        "ServiceUnavailable": ("service-unavailable", 503),
        "MemoryExceeded": ("memory-exceeded", 422),
        "WorkerLost": ("worker-lost", 500),
    },
    "IkplanError": {"CertificateViolated": ("certificate-violated", 500)},
}
"""Group, class, problem type and status: relied on by callers in other languages too."""


def test_every_class_is_directly_below_its_group_with_its_problem_type() -> None:
    groups = {c for c in CLASSES if c.__subclasses__()}
    assert {c.__name__ for c in groups} == TREE.keys()
    for name, members in TREE.items():
        group = getattr(ikplan, name)
        below = {c.__name__: (c.slug, c.status) for c in group.__subclasses__() if c not in groups}
        assert below == members
    assert {c.__base__ for c in groups - {IkplanError}} == {IkplanError}


@pytest.mark.parametrize("error", EXAMPLES, ids=lambda e: type(e).__name__)
def test_a_client_raises_the_class_that_its_group_catches(error: IkplanError) -> None:
    (group,) = (name for name, members in TREE.items() if type(error).__name__ in members)

    def answer(_: httpx.Request) -> httpx.Response:
        headers = {"content-type": "application/problem+json"}
        return httpx.Response(error.status, json=error.to_problem(), headers=headers)

    transport = httpx.MockTransport(answer)
    with (
        ikplan.Client("http://service", transport=transport, retries=0) as client,
        pytest.raises(getattr(ikplan, group)) as caught,
    ):
        client.plan({"robot": "r", "path": {"waypoints": [{"position": [0.5, 0.0, 0.5]}]}})
    assert type(caught.value) is type(error)
    # Which address was asked, the client knows best.
    asked = {"url": "http://service/v1/plans"} if "url" in error.fields else {}
    assert caught.value.data == error.data | asked


def test_a_problem_of_another_kind_is_an_unavailable_service() -> None:
    error = error_from_problem(
        {"type": "about:blank", "title": "Teapot", "status": 418}, url="http://x/v1"
    )
    assert isinstance(error, ServiceUnavailable)
    assert error.data == {"url": "http://x/v1", "status_code": 418, "retry_after_s": None}
    assert error.detail == "Teapot"


scalars = st.none() | st.booleans() | st.integers() | st.floats() | st.text("aé\n", max_size=3)
anything = (
    scalars | st.lists(scalars, max_size=3) | st.dictionaries(st.text("aé\n", max_size=3), scalars)
)


@given(st.sampled_from(EXAMPLES), st.data())
@settings(deadline=None)
def test_a_mangled_problem_is_still_an_error_of_the_tree(error: IkplanError, data: Any) -> None:
    problem = error.to_problem()
    for name in data.draw(st.sets(st.sampled_from(sorted(problem)), max_size=3)):
        if data.draw(st.booleans()):
            problem[name] = data.draw(anything)
        else:
            del problem[name]
    assert isinstance(error_from_problem(problem), IkplanError)


def test_near_names_are_the_ones_that_look_alike() -> None:
    names = ["iiwa14", "ur3", "ur5", "ur10", "panda", "baxter_left", "baxter_right"]
    assert near_names("iiwa", names) == ["iiwa14"]
    assert near_names("UR5", names)[0] == "ur5"
    assert near_names("baxter", names) == ["baxter_left", "baxter_right"]
    assert near_names("qqqqqqq", names) == []
    assert len(near_names("ur", names)) <= 3


def test_a_robot_that_is_not_there_is_answered_with_the_ones_that_are() -> None:
    error = errors.RobotNotFound(name="iiwa", valid=["iiwa14", "ur5"])
    assert error.near == ["iiwa14"]
    assert "did you mean iiwa14?" in error.detail
    assert "iiwa14, ur5" in error.detail


def test_problem_of_an_older_service_keeps_its_class() -> None:
    problem = errors.TimingFailed("no timing", joint="elbow", limit="velocity").to_problem()
    del problem["nearest"]
    again = error_from_problem(problem)
    assert isinstance(again, errors.TimingFailed)
    assert (again.joint, again.nearest) == ("elbow", {})
    del problem["joint"]
    assert isinstance(error_from_problem(problem), ServiceUnavailable)
