"""The documents of the path language."""

import copy
from typing import Any

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from ikplan import InvalidRequest
from ikplan.documents import parse
from ikplan.documents.path import PathRequest, ToleranceBox
from ikplan.documents.plan_request import PlanRequest

from .requests import pose, quaternion, vectors

Documents = st.SearchStrategy[dict[str, Any]]
Fields = dict[str, st.SearchStrategy[Any]]

WAYPOINTS = {"waypoints": [pose([0.1, 0.2, 0.3])]}

quaternions = vectors.map(quaternion)
positions = vectors.map(list)
waypoints = st.builds(
    lambda p, q: {"position": p, **({"quaternion_xyzw": q} if q else {})},
    positions,
    st.none() | quaternions,
)
positive = st.floats(1e-3, 10.0)
signed = st.floats(-10.0, 10.0).filter(lambda x: abs(x) > 1e-3)
rules = st.sampled_from(["constant", "follow"]) | st.builds(
    lambda q: {"quaternion_xyzw": q}, quaternions
)


def segments(kind: str, required: Fields, optional: Fields | None = None) -> Documents:
    return st.fixed_dictionaries(
        {"type": st.just(kind), **required},
        optional={"blend": st.none() | st.floats(0.0, 1.0), **(optional or {})},
    )


def curves(kind: str, required: Fields, rule: st.SearchStrategy[Any] = rules) -> Documents:
    return segments(
        kind,
        required,
        {"orientation": rule, "quaternion_xyzw": quaternions, "connect": st.booleans()},
    )


even = rules.filter(lambda rule: rule != "follow")
any_segment = st.one_of(
    segments("line", {"to": waypoints}, {"turn_axis": st.just([0.0, 1.0, 0.0])}),
    segments("arc", {"via": positions, "to": waypoints}),
    segments("arc", {"centre": positions, "angle": signed}, {"orientation": rules}),
    segments("spline", {"through": st.lists(waypoints, min_size=1, max_size=4)}),
    st.fixed_dictionaries({"type": st.just("joint"), "q": st.lists(signed, min_size=1)}),
    st.fixed_dictionaries({"type": st.just("joint"), "to": waypoints}),
    curves("circle", {"radius": positive, "angle": signed}),
    curves("helix", {"radius": positive, "rise": signed, "turns": signed}),
    curves("rose", {"radius": positive, "petals": st.integers(1, 9)}),
    curves(
        "sinusoid", {"length": positive, "amplitude": signed, "wavelength": st.floats(0.05, 10.0)}
    ),
    curves("sawtooth", {"length": positive, "height": signed, "teeth": st.integers(1, 9)}, even),
    curves("trapezoid", {"length": positive, "height": signed, "periods": st.integers(1, 9)}, even),
)
frees = st.sampled_from([None, "all", {"about": "tool_z"}, {"about": "tool_x", "cone": 0.3}])
boxes = st.fixed_dictionaries(
    {},
    optional={
        "position": st.just([0.0, 0.1, 0.2]),
        "orientation": st.just([3.1, 0.0, 0.0]),
        "frame": st.sampled_from(["tool", "path"]),
    },
)
paths = st.fixed_dictionaries(
    {"segments": st.lists(any_segment, min_size=1, max_size=5)},
    optional={
        "begin": waypoints,
        "approach": st.sampled_from(["path", "joint"]),
        "blend": st.floats(0.0, 1.0),
        "orientation_free": frees,
        "tolerance": st.fixed_dictionaries({}, optional={"box": boxes}),
    },
)


@settings(max_examples=150, deadline=None)
@given(paths)
def test_a_path_survives_being_written_and_read(document: dict[str, Any]) -> None:
    path = parse(PathRequest, copy.deepcopy(document))
    again = parse(PathRequest, path.model_dump(mode="json"))
    assert again == path
    assert again.model_dump_json() == path.model_dump_json()
    assert path.segments is not None
    for asked, read in zip(document["segments"], path.segments, strict=True):
        assert read.type == asked["type"]


def test_old_requests_mean_what_they_meant() -> None:
    path = parse(PathRequest, WAYPOINTS)
    assert (path.interpolation, path.approach, path.blend) == ("joint", "path", None)
    assert path.segments is None
    assert path.begin is None
    assert path.orientation_free is None
    assert path.tolerance.box is None
    assert (path.tolerance.position, path.tolerance.orientation) == (1e-4, 1e-3)


LINE = {"type": "line", "to": pose([0, 0, 0])}
CIRCLE = {"type": "circle", "radius": 0.1}


@pytest.mark.parametrize(
    ("path", "field", "words"),
    [
        ({}, "path", "neither"),
        ({**WAYPOINTS, "segments": [LINE]}, "path", "both"),
        ({"waypoints": []}, "path.waypoints", "at least 1"),
        ({"segments": []}, "path.segments", "at least 1"),
        ({"segments": [LINE], "interpolation": "line"}, "path", "interpolation"),
        ({**WAYPOINTS, "begin": pose([0, 0, 0])}, "path", "begin"),
        ({**WAYPOINTS, "blend": 0.1}, "path", "blend"),
        ({**WAYPOINTS, "blend": -0.1, "interpolation": "line"}, "path.blend", "greater"),
        ({**WAYPOINTS, "interpolation": "lines"}, "path.interpolation", "'line'"),
        ({**WAYPOINTS, "approach": "jump"}, "path.approach", "'joint'"),
        ({**WAYPOINTS, "orientation_free": "some"}, "path.orientation_free", "'all'"),
        ({**WAYPOINTS, "orientation_free": {"cone": 1.0}}, "path.orientation_free.about", "req"),
        (
            {**WAYPOINTS, "orientation_free": {"about": "z"}},
            "path.orientation_free.about",
            "'tool_z'",
        ),
        (
            {**WAYPOINTS, "orientation_free": {"about": "tool_z", "cone": 4.0}},
            "path.orientation_free.cone",
            "less",
        ),
        (
            {**WAYPOINTS, "tolerance": {"box": {"frame": "world"}}},
            "path.tolerance.box.frame",
            "'path'",
        ),
        (
            {**WAYPOINTS, "tolerance": {"box": {"position": [0.1, -0.1, 0.0]}}},
            "path.tolerance.box.position[1]",
            "greater",
        ),
        ({"segments": [LINE, {"type": "lnie"}]}, "path.segments[1].type", "'line'"),
        ({"segments": [{"to": pose([0, 0, 0])}]}, "path.segments[0].type", "required"),
        ({"segments": [{"type": "line"}]}, "path.segments[0].to", "required"),
        ({"segments": [{**LINE, "too": 1}]}, "path.segments[0].too", "'to'"),
        ({"segments": [{**LINE, "turn_axis": [0, 0, 0.0]}]}, "path.segments[0].turn_axis", "axis"),
        (
            {"segments": [LINE, {**LINE, "to": {"positon": [0, 0, 0]}}]},
            "path.segments[1].to.position",
            "required",
        ),
        ({"segments": [{"type": "arc"}]}, "path.segments[0]", "centre and angle"),
        ({"segments": [{"type": "arc", "via": [0, 0, 1.0]}]}, "path.segments[0]", "via and to"),
        (
            {"segments": [{"type": "arc", "centre": [0, 0, 1.0], "angle": 0.0}]},
            "path.segments[0]",
            "other than 0",
        ),
        (
            {"segments": [{"type": "arc", "via": [0, 0, 1], "to": pose([1, 0, 0]),
                           "orientation": "free"}]},
            "path.segments[0]",
            "orientation",
        ),
        ({"segments": [{"type": "joint"}]}, "path.segments[0]", "exactly one"),
        ({"segments": [{"type": "spline", "through": []}]}, "path.segments[0].through", "least"),
        ({"segments": [{**CIRCLE, "radius": 0}]}, "path.segments[0].radius", "greater"),
        ({"segments": [{**CIRCLE, "angle": 0.0}]}, "path.segments[0].angle", "differ from 0"),
        ({"segments": [{**CIRCLE, "angle": 5e-324}]}, "path.segments[0].angle", "differ from 0"),
        ({"segments": [{**CIRCLE, "radius": 5e-324}]}, "path.segments[0].radius", "greater than"),
        ({"segments": [{**CIRCLE, "orientation": "spin"}]}, "path.segments[0].orientation", "fol"),
        (
            {"segments": [{**CIRCLE, "orientation": {"quaternion_xyzw": [0, 0, 0, 2.0]}}]},
            "path.segments[0].orientation.quaternion_xyzw",
            "norm 2",
        ),
        (
            {"segments": [{**CIRCLE, "orientation": "free", "quaternion_xyzw": [0, 0, 0, 1.0]}]},
            "path.segments[0]",
            "no meaning",
        ),
        (
            {"segments": [{"type": "sawtooth", "length": 1.0, "height": 0.1, "teeth": 2,
                           "orientation": "follow"}]},
            "path.segments[0]",
            "corners",
        ),
        (
            {"segments": [{"type": "sinusoid", "length": 1.0, "amplitude": 0.1,
                           "wavelength": 1e-5}]},
            "path.segments[0]",
            "1000 periods",
        ),
    ],
)  # fmt: skip
def test_a_wrong_field_is_named_as_it_is_written(
    path: dict[str, Any], field: str, words: str
) -> None:
    with pytest.raises(InvalidRequest) as caught:
        parse(PlanRequest, {"robot": "iiwa14", "path": path})
    assert caught.value.field == field
    assert words in caught.value.detail


def test_every_field_of_the_language_is_described() -> None:
    definitions = PlanRequest.model_json_schema()["$defs"]
    names = {name for name in definitions if name.endswith("Segment")}
    assert len(names) == 11
    for name in (*names, "PathRequest", "PathTolerance", "ToleranceBox", "AxisFreedom"):
        assert definitions[name]["description"]
        for field, schema in definitions[name]["properties"].items():
            assert "description" in schema, f"{name}.{field}"
    assert ToleranceBox().frame == "tool"
