"""Whatever is thrown at the service, it answers a document or a problem, never a 500."""

import copy
import json
from typing import Any
from urllib.parse import quote

import httpx
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from pydantic import BaseModel

from ikplan.documents.pose_results import FkResult, IkSolution
from ikplan.plans.plan import Plan
from ikplan_api.http.schemas import PROBLEMS

CALM = settings(
    deadline=None,
    derandomize=True,
    max_examples=150,
    # The fixtures are the service itself, shared on purpose.
    suppress_health_check=[HealthCheck.function_scoped_fixture, HealthCheck.too_slow],
)
MODELS: dict[str, type[BaseModel]] = {"/v1/plans": Plan, "/v1/ik": IkSolution, "/v1/fk": FkResult}
BY_TYPE = {cls.problem_type(): model for cls, model in PROBLEMS.items()}

numbers = st.one_of(
    st.floats(-2.0, 2.0),
    st.floats(),
    st.integers(),
    st.sampled_from([0, -0.0, 1e-300, 1e300, 10**30, -1, 5e-324]),
)
junk = st.recursive(
    st.none() | st.booleans() | numbers | st.text(max_size=8),
    lambda inner: st.lists(inner, max_size=4) | st.dictionaries(st.text(max_size=8), inner),
    max_leaves=6,
)
small = st.floats(-0.7, 0.7)
unit_quaternions = st.sampled_from(
    [[0.0, 1.0, 0.0, 0.0], [0.0, 0.0, 0.0, 1.0], [0.5, -0.5, 0.5, 0.5], [0.0, 1.0004, 0.0, 0.0]]
)
positions = st.lists(small, min_size=3, max_size=3)
robots = st.sampled_from(["iiwa14", "ur5", "dobot_magician", "tiago", "kinova_j2s6s200"])
waypoints = st.fixed_dictionaries(
    {"position": positions}, optional={"quaternion_xyzw": unit_quaternions}
)
frames = st.fixed_dictionaries(
    {}, optional={"position": positions, "quaternion_xyzw": unit_quaternions}
)
ik = st.fixed_dictionaries(
    {},
    optional={
        "method": st.sampled_from(["ik-ba", "lm", "none"]),
        "seed": st.integers(-1, 2**63),
        "population": st.integers(0, 60),
        "iterations": st.integers(0, 60),
        "params": st.dictionaries(
            st.sampled_from(["alpha", "fmax", "variant", "objective", "decouple", "x"]),
            numbers | st.text(max_size=4) | st.booleans(),
            max_size=2,
        ),
        "refine": st.booleans(),
    },
)
starts = st.one_of(
    st.none(), st.just("free"), st.lists(small, min_size=4, max_size=8), st.text(max_size=4)
)
plan_requests = st.fixed_dictionaries(
    {
        "robot": robots,
        "path": st.fixed_dictionaries(
            {"waypoints": st.lists(waypoints, max_size=3)},
            optional={
                "frame": frames,
                "tolerance": st.fixed_dictionaries(
                    {}, optional={"position": numbers, "orientation": numbers}
                ),
            },
        ),
    },
    optional={
        "start": starts,
        "tool": frames,
        "ik": ik,
        "limits": st.fixed_dictionaries(
            {},
            optional={
                "velocity_scale": st.floats(0, 1.1) | st.sampled_from([1e-300, 5e-324, 1e-9]),
                "acceleration_scale": st.floats(0, 1.1) | st.sampled_from([1e-300, 5e-324, 1e-9]),
            },
        ),
        "sampling": st.fixed_dictionaries({"rate_hz": st.floats(0, 11_000) | st.integers(0, 9)}),
        "budget_s": st.sampled_from([1e-9, 0.05, 1.0, 0, -1, 1e9]),
    },
)
ik_requests = st.fixed_dictionaries(
    {"robot": robots, "position": positions},
    optional={
        "quaternion_xyzw": unit_quaternions,
        "start": starts,
        "tool": frames,
        "ik": ik,
        "tolerance": st.fixed_dictionaries({}, optional={"position": numbers}),
    },
)
fk_requests = st.fixed_dictionaries(
    {"robot": robots, "q": st.lists(numbers, min_size=3, max_size=8)}, optional={"tool": frames}
)


@st.composite
def mutated(draw: st.DrawFn, documents: st.SearchStrategy[dict[str, Any]]) -> dict[str, Any]:
    """A document with, often, one place replaced, removed or added to."""
    document = copy.deepcopy(draw(documents))  # sampled values are shared
    if draw(st.booleans()):
        return document
    place: Any = document
    while True:
        keys = list(place) if isinstance(place, dict) else list(range(len(place)))
        if not keys:
            break
        key = draw(st.sampled_from(keys))
        if isinstance(place[key], dict | list) and draw(st.booleans()):
            place = place[key]
            continue
        if draw(st.booleans()):
            place[key] = draw(junk)
        else:
            del place[key]
        return document
    if isinstance(place, dict):
        place[draw(st.text(max_size=8))] = draw(junk)
    return document


def check(answer: httpx.Response, path: str) -> None:
    """The answer is the path's document, or a problem that fits its class."""
    assert answer.status_code < 500 or answer.status_code == 503, answer.text
    if answer.status_code == 200:
        MODELS[path].model_validate_json(answer.content)
        assert b"NaN" not in answer.content
        return
    problem = json.loads(answer.content, parse_constant=lambda _: 1 / 0)
    assert answer.headers["content-type"] == "application/problem+json"
    BY_TYPE[problem["type"]].model_validate(problem)
    assert problem["detail"]


def post(http: httpx.Client, path: str, document: object) -> httpx.Response:
    body = json.dumps(document).encode()
    return http.post(path, content=body, headers={"content-type": "application/json"})


@CALM
@given(document=mutated(plan_requests))
def test_no_plan_request_is_a_500(document: dict[str, Any], http: httpx.Client) -> None:
    check(post(http, "/v1/plans", document), "/v1/plans")


@CALM
@given(document=mutated(ik_requests))
def test_no_ik_request_is_a_500(document: dict[str, Any], http: httpx.Client) -> None:
    check(post(http, "/v1/ik", document), "/v1/ik")


@CALM
@given(document=mutated(fk_requests))
def test_no_fk_request_is_a_500(document: dict[str, Any], http: httpx.Client) -> None:
    check(post(http, "/v1/fk", document), "/v1/fk")


@CALM
@given(
    body=st.binary(max_size=200)
    | st.text().map(lambda text: text.encode("utf-8", "surrogatepass"))
    | junk.map(lambda value: json.dumps(value).encode()),
    path=st.sampled_from(sorted(MODELS)),
)
def test_no_bytes_are_a_500(body: bytes, path: str, http: httpx.Client) -> None:
    check(http.post(path, content=body, headers={"content-type": "application/json"}), path)


@CALM
@given(name=st.text(min_size=1, max_size=20), room=st.sampled_from(["robots", "plans"]))
def test_no_name_is_a_500(name: str, room: str, http: httpx.Client) -> None:
    text = name.encode("utf-8", "surrogatepass")
    answer = http.get(f"/v1/{room}/{quote(text, safe='')}")
    assert answer.status_code in (200, 404, 405)
    assert answer.status_code == 200 or answer.json()["type"]
