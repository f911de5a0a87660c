"""The request documents: what they take, what they refuse, and how they tell it."""

from __future__ import annotations

import copy
import json
import math
from typing import Any

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from ikplan import FkRequest, IkRequest, InvalidRequest, PlanRequest
from ikplan.documents import load_json, parse, parse_json

from .requests_like import leaves, look, mappings, plan_requests, written

GOOD: dict[str, Any] = {
    "robot": "iiwa14",
    "start": [0.0] * 7,
    "tool": {"position": [0.0, 0.0, 0.1], "quaternion_xyzw": [0.0, 0.0, 0.0, 1.0]},
    "path": {
        "frame": {"position": [0.0, 0.0, 0.0]},
        "waypoints": [
            {"position": [0.5, 0.0, 0.5], "quaternion_xyzw": [0.0, 1.0, 0.0, 0.0]},
            {"position": [0.5, 0.2, 0.5]},
        ],
        "tolerance": {"position": 1e-4, "orientation": 1e-3},
    },
    "ik": {"method": "ik-ba", "seed": 0, "population": 20, "params": {"alpha": 0.9}},
    "limits": {"velocity_scale": 0.5},
    "sampling": {"rate_hz": 100.0},
    "budget_s": 5.0,
}
NAN, INF = math.nan, math.inf


def good_but(at: str, value: Any) -> dict[str, Any]:
    """The good request with one field replaced: ``path.waypoints.0.position``."""
    document = copy.deepcopy(GOOD)
    *parents, last = at.split(".")
    inner: Any = document
    for name in parents:
        inner = inner[int(name)] if name.isdigit() else inner[name]
    inner[int(last) if last.isdigit() else last] = value
    return document


BAD: list[tuple[str, Any, str]] = [
    ("robot", "", "robot"),
    ("robot", 3, "robot"),
    ("robot", None, "robot"),
    ("robot", "x" * 201, "robot"),
    ("start", "here", "start"),
    ("start", 3.0, "start"),
    ("start", {"A1": 0.0}, "start"),
    ("start.3", NAN, "start[3]"),
    ("start.3", "0", "start[3]"),
    ("start.6", 1e7, "start[6]"),
    ("start.0", True, "start[0]"),
    ("tool.position", [0.0, 0.0], "tool.position"),
    ("tool.position", [0.0] * 4, "tool.position"),
    ("tool.quaternion_xyzw", [0.0, 0.0, 0.0, 1.1], "tool.quaternion_xyzw"),
    ("tool.quaternion_xyzw", [0.0] * 4, "tool.quaternion_xyzw"),
    ("tool.quaternion_xyzw", [1e308] * 4, "tool.quaternion_xyzw"),
    ("tool.quaternion_xyzw", None, "tool.quaternion_xyzw"),
    ("path", None, "path"),
    ("path", [], "path"),
    ("path.waypoints", [], "path.waypoints"),
    ("path.waypoints", {}, "path.waypoints"),
    ("path.waypoints", [None], "path.waypoints[0]"),
    ("path.waypoints.1", {}, "path.waypoints[1].position"),
    ("path.waypoints.1.position", None, "path.waypoints[1].position"),
    ("path.waypoints.1.position", [0.0, INF, 0.0], "path.waypoints[1].position[1]"),
    ("path.waypoints.0.position", [0.0, 0.0, -1e160], "path.waypoints[0].position[2]"),
    (
        "path.waypoints.0.quaternion_xyzw",
        [0.0, 0.0, 0.0, 0.998],
        "path.waypoints[0].quaternion_xyzw",
    ),
    ("path.waypoints.0.quaternion_xyzw", [0.0, 0.0, 1.0], "path.waypoints[0].quaternion_xyzw"),
    (
        "path.waypoints.0.quaternion_xyzw",
        [0.0, NAN, 0.0, 1.0],
        "path.waypoints[0].quaternion_xyzw[1]",
    ),
    ("path.tolerance.position", 0.0, "path.tolerance.position"),
    ("path.tolerance.orientation", 4.0, "path.tolerance.orientation"),
    ("path.tolerance.position", NAN, "path.tolerance.position"),
    ("ik.method", 3, "ik.method"),
    ("ik.seed", -1, "ik.seed"),
    ("ik.seed", 1.5, "ik.seed"),
    ("ik.seed", 2**63, "ik.seed"),
    ("ik.population", 0, "ik.population"),
    ("ik.population", 100_001, "ik.population"),
    ("ik.population", "thesis", "ik.population"),
    ("ik", {"population": 5_000, "iterations": 5_000}, "ik"),
    ("ik", {"population": 100_000, "iterations": "paper"}, "ik"),
    ("ik", {"method": "gsa", "population": 10_000, "iterations": 2}, "ik"),
    ("ik", {"method": "gsa", "population": 1000, "iterations": 197}, "ik"),
    ("ik", {"population": "paper", "iterations": 100_000 + 1}, "ik.iterations"),
    ("ik.population", 2.5, "ik.population"),
    ("ik.params", [], "ik.params"),
    ("ik.params.alpha", NAN, "ik.params.alpha"),
    ("ik.params.alpha", None, "ik.params.alpha"),
    ("ik.params.alpha", [1], "ik.params.alpha"),
    ("ik.params.alpha", 2**64, "ik.params.alpha"),
    ("limits.velocity_scale", 0.0, "limits.velocity_scale"),
    ("limits.velocity_scale", 1.01, "limits.velocity_scale"),
    ("limits.velocity_scale", "fast", "limits.velocity_scale"),
    ("sampling.rate_hz", 0, "sampling.rate_hz"),
    ("sampling.rate_hz", 1e6, "sampling.rate_hz"),
    ("sampling.rate_hz", -INF, "sampling.rate_hz"),
    ("budget_s", 0.0, "budget_s"),
    ("budget_s", INF, "budget_s"),
    ("budget_s", "10", "budget_s"),
]


@pytest.mark.parametrize(("at", "value", "field"), BAD)
def test_a_wrong_value_is_named_by_its_field(at: str, value: Any, field: str) -> None:
    with pytest.raises(InvalidRequest) as caught:
        parse(PlanRequest, good_but(at, value))
    error = caught.value
    assert error.field == field
    assert error.detail.startswith(f"{field}: ")
    assert error.errors[0]["field"] == field
    json.dumps(error.to_problem(), allow_nan=False)


def test_a_search_in_which_all_look_at_each_other_may_be_as_long_as_others_in_time() -> None:
    for change in (
        {"method": "gsa", "population": 1000, "iterations": 196},
        {"method": "gsa", "population": "paper", "iterations": "paper"},
        {"method": "pso", "population": 10_000, "iterations": 1000},
    ):
        parse(PlanRequest, good_but("ik", change))
    change = {"method": "gsa", "population": 1000, "iterations": 500}
    with pytest.raises(InvalidRequest, match="at most 196 iterations are allowed, not 500"):
        parse(PlanRequest, good_but("ik", change))


def test_the_good_request_is_good() -> None:
    assert parse(PlanRequest, GOOD).model_dump(exclude_unset=True) == GOOD


UNKNOWN = [
    ("robott", "robott", "robot"),
    ("tool.positon", "tool.positon", "position"),
    ("path.way_points", "path.way_points", "waypoints"),
    ("path.waypoints.1.quaternion", "path.waypoints[1].quaternion", "quaternion_xyzw"),
    ("ik.metod", "ik.metod", "method"),
    ("sampling.rate", "sampling.rate", "rate_hz"),
]


@pytest.mark.parametrize(("at", "field", "near"), UNKNOWN)
def test_an_unknown_field_is_named_with_the_one_meant(at: str, field: str, near: str) -> None:
    with pytest.raises(InvalidRequest, match=f"did you mean '{near}'") as caught:
        parse(PlanRequest, good_but(at, 1.0))
    assert caught.value.field == field
    assert near in caught.value.allowed


def test_an_unknown_field_like_no_other_is_answered_with_all_there_are() -> None:
    with pytest.raises(InvalidRequest, match=r"known fields: .*method.*seed") as caught:
        parse(PlanRequest, good_but("ik.zzzzz", 1.0))
    assert "population" in caught.value.allowed


@pytest.mark.parametrize("missing", ["robot", "path"])
def test_a_required_field_is_asked_for(missing: str) -> None:
    document = copy.deepcopy(GOOD)
    del document[missing]
    with pytest.raises(InvalidRequest, match=f"{missing}: this field is required"):
        parse(PlanRequest, document)


def test_many_faults_are_all_listed_and_the_first_is_told() -> None:
    document = good_but("budget_s", -1.0)
    document["ik"]["seed"] = -1
    document["colour"] = "red"
    with pytest.raises(InvalidRequest, match=r"\(and 2 more\)") as caught:
        parse(PlanRequest, document)
    fields = {e["field"] for e in caught.value.errors}
    assert fields == {"ik.seed", "budget_s", "colour"}


@pytest.mark.parametrize("count", [10_001, 20_000])
def test_a_recording_of_ten_seconds_at_1_khz_and_twice_as_much_is_a_path(count: int) -> None:
    """sdu_controllers' circle of the panda has 10,001 rows."""
    poses = [{"position": [0.5, 0.0, 0.3 + 1e-5 * k]} for k in range(count)]
    lines = [{"type": "line", "to": pose} for pose in poses]
    for path in (
        {"waypoints": poses},
        {"segments": [{"type": "spline", "through": poses}]},
        {"segments": lines},
    ):
        request = parse(PlanRequest, {"robot": "iiwa14", "path": path})
        assert request.path.waypoints is None or len(request.path.waypoints) == count


def test_a_hundred_thousand_waypoints_and_one_are_too_many() -> None:
    waypoints = [{"position": [0.5, 0.0, 0.5]}] * 100_001
    with pytest.raises(InvalidRequest, match="at most 20000") as caught:
        parse(PlanRequest, {"robot": "iiwa14", "path": {"waypoints": waypoints}})
    assert caught.value.field == "path.waypoints"


@pytest.mark.parametrize("document", [None, 3, "iiwa14", [GOOD], True])
def test_what_is_no_object_is_refused(document: Any) -> None:
    with pytest.raises(InvalidRequest, match="a request is a JSON object"):
        parse(PlanRequest, document)


def test_a_key_that_is_no_text_is_refused() -> None:
    with pytest.raises(InvalidRequest):
        parse(PlanRequest, {**GOOD, 3: 4})


@pytest.mark.parametrize("norm", [0.9991, 1.0, 1.0009])
def test_a_quaternion_within_a_thousandth_is_normalised(norm: float) -> None:
    q = np.array([0.1, 0.2, 0.3, (1 - 0.14) ** 0.5]) * norm
    request = parse(PlanRequest, good_but("tool.quaternion_xyzw", q.tolist()))
    assert np.linalg.norm(request.tool.quaternion_xyzw) == pytest.approx(1.0, abs=1e-15)
    again = parse(PlanRequest, request.model_dump())
    assert again.tool.quaternion_xyzw == request.tool.quaternion_xyzw


@pytest.mark.parametrize("norm", [0.9989, 1.0011])
def test_a_quaternion_beyond_a_thousandth_is_refused_with_its_norm(norm: float) -> None:
    with pytest.raises(InvalidRequest, match=f"norm {norm}"):
        parse(PlanRequest, good_but("tool.quaternion_xyzw", [0.0, 0.0, 0.0, norm]))


@given(plan_requests)
@settings(deadline=None)
def test_a_request_survives_writing_and_reading(document: dict[str, Any]) -> None:
    request = parse(PlanRequest, document)
    for again in (
        parse(PlanRequest, request.model_dump()),
        parse(PlanRequest, request.model_dump(exclude_unset=True)),
        parse_json(PlanRequest, request.model_dump_json()),
        parse_json(PlanRequest, json.dumps(document)),
        parse(PlanRequest, request),
    ):
        assert again == request
        assert again.content_hash("robot", "version") == request.content_hash("robot", "version")
    assert request.content_hash("robot") != request.content_hash("other robot")


@given(plan_requests, st.data())
@settings(deadline=None)
def test_an_unknown_field_anywhere_is_named_where_it_is(document: Any, data: Any) -> None:
    places = [at for at in mappings(document) if at[-1:] != ("params",)]
    at = data.draw(st.sampled_from(places))
    look(document, at)["misplaced"] = 1
    with pytest.raises(InvalidRequest) as caught:
        parse(PlanRequest, document)
    assert caught.value.field == written((*at, "misplaced"))


@given(plan_requests, st.data())
@settings(deadline=None)
def test_a_value_that_no_field_takes_is_named_where_it_is(document: Any, data: Any) -> None:
    at = data.draw(st.sampled_from(leaves(document)))
    wrong = data.draw(st.sampled_from([NAN, INF, -INF, {"a": 1}, [[]], b"bytes", 1j]))
    assume(look(document, at) != [])
    look(document, at[:-1])[at[-1]] = wrong
    with pytest.raises(InvalidRequest) as caught:
        parse(PlanRequest, document)
    assert caught.value.field.startswith(written(at))
    json.dumps(caught.value.to_problem(), allow_nan=False)


anything = st.recursive(
    st.none() | st.booleans() | st.integers() | st.floats() | st.text("abé_ ", max_size=5),
    lambda inner: (
        st.lists(inner, max_size=4)
        | st.dictionaries(
            st.sampled_from(["robot", "path", "waypoints", "position", "ik", "q", "start"]), inner
        )
    ),
    max_leaves=20,
)


@given(st.sampled_from([PlanRequest, IkRequest, FkRequest]), anything)
@settings(deadline=None)
def test_anything_at_all_is_read_or_refused(model: Any, document: Any) -> None:
    try:
        request = parse(model, document)
    except InvalidRequest as error:
        text = json.dumps(error.to_problem(), allow_nan=False)
    else:
        text = request.model_dump_json()
    assert text


MALFORMED: list[tuple[str | bytes, str]] = [
    ("", "line 1, column 1"),
    ('{"robot": }', "line 1, column 11"),
    ('{\n"robot": "a",\n}', "line 3, column 1"),
    ('{"robot": "a"} tail', "line 1, column 16"),
    ('{"start": [NaN]}', "NaN is not JSON"),
    ('{"start": [Infinity]}', "Infinity is not JSON"),
    ('{"start": [-Infinity]}', "-Infinity is not JSON"),
    (b"\xff\xfe\x00", "UTF-8"),
    (b'{"robot": "\xff"}', "not UTF-8 text"),
    ("[" * 200_000, "nested too deeply"),
    ('{"a": ' + "9" * 5000 + "}", "too many digits"),
]


@pytest.mark.parametrize(("text", "says"), MALFORMED, ids=range(len(MALFORMED)))
def test_text_that_is_no_json_is_refused_with_the_place(text: str | bytes, says: str) -> None:
    with pytest.raises(InvalidRequest, match=says):
        load_json(text)


def test_numbers_beyond_floats_are_refused_where_they_are() -> None:
    with pytest.raises(InvalidRequest) as caught:
        parse_json(PlanRequest, json.dumps(GOOD).replace("[0.5, 0.2, 0.5]", "[0.5, 1e999, 0.5]"))
    assert caught.value.field == "path.waypoints[1].position[1]"


def test_a_request_cannot_be_changed() -> None:
    request = parse(PlanRequest, GOOD)
    with pytest.raises(ValueError, match="frozen"):
        request.robot = "ur5"  # type: ignore[misc]


@given(st.text('{}[]":,019e-.tfn ', max_size=20))
def test_any_short_text_is_refused(text: str) -> None:
    # No text so short is a whole request.
    with pytest.raises(InvalidRequest):
        parse_json(PlanRequest, text)


def test_the_schema_gives_every_field_a_description_and_every_number_a_default_or_bounds() -> None:
    for model in (PlanRequest, IkRequest, FkRequest):
        schema = model.model_json_schema()
        for name, definition in [(model.__name__, schema), *schema.get("$defs", {}).items()]:
            assert definition["additionalProperties"] is False, name
            for field, entry in definition["properties"].items():
                documented = "description" in entry or "$ref" in entry
                assert documented or field in ("path", "type"), f"{name}.{field}"
