"""The document that other people's tools read."""

import re
from collections.abc import Iterator
from typing import Any

import httpx
import pytest

from ikplan import Client, errors
from ikplan.documents.pose_results import FkResult, IkBatchSolution, IkSolution
from ikplan.plans.plan import Plan
from ikplan_api.http.schemas import PROBLEMS
from tests.measured import waypoint_errors

from .bad_requests import GOOD

OPERATIONS = {
    "create_plan": ("post", "/v1/plans"),
    "list_plans": ("get", "/v1/plans"),
    "get_plan": ("get", "/v1/plans/{plan_id}"),
    "delete_plan": ("delete", "/v1/plans/{plan_id}"),
    "watch_plan": ("get", "/v1/plans/{plan_id}/events"),
    "read_points": ("post", "/v1/points"),
    "create_batch": ("post", "/v1/batches"),
    "create_timing": ("post", "/v1/timings"),
    "compute_fk": ("post", "/v1/fk"),
    "solve_ik": ("post", "/v1/ik"),
    "solve_ik_batch": ("post", "/v1/ik/batch"),
    "list_robots": ("get", "/v1/robots"),
    "upload_robot": ("post", "/v1/robots"),
    "get_robot": ("get", "/v1/robots/{name}"),
    "delete_robot": ("delete", "/v1/robots/{name}"),
    "get_robot_visual": ("get", "/v1/robots/{name}/visual"),
    "list_formats": ("get", "/v1/robots/{name}/formats"),
    "measure_plan": ("post", "/v1/series"),
    "upload_scene": ("post", "/v1/scenes"),
    "get_scene": ("get", "/v1/scenes/{scene_id}"),
    "delete_scene": ("delete", "/v1/scenes/{scene_id}"),
    "list_solvers": ("get", "/v1/solvers"),
    "list_audit": ("get", "/v1/audit"),
    "livez": ("get", "/livez"),
    "readyz": ("get", "/readyz"),
    "get_version": ("get", "/version"),
    "get_metrics": ("get", "/metrics"),
}


@pytest.fixture(scope="module")
def document(http: httpx.Client) -> dict[str, Any]:
    read: dict[str, Any] = http.get("/openapi.json").json()
    return read


def nodes(value: Any) -> Iterator[Any]:
    yield value
    if isinstance(value, dict):
        for item in value.values():
            yield from nodes(item)
    elif isinstance(value, list):
        for item in value:
            yield from nodes(item)


def test_operation_ids_are_stable(document: dict[str, Any]) -> None:
    found = {
        operation["operationId"]: (method, path)
        for path, methods in document["paths"].items()
        for method, operation in methods.items()
    }
    assert found == OPERATIONS


def test_every_reference_leads_somewhere(document: dict[str, Any]) -> None:
    schemas = document["components"]["schemas"]
    refs = {n["$ref"] for n in nodes(document) if isinstance(n, dict) and "$ref" in n}
    assert {ref.rpartition("/")[2] for ref in refs} <= schemas.keys()
    assert all(ref.startswith("#/components/schemas/") for ref in refs)
    assert not any("HTTPValidationError" in name for name in schemas)


def test_every_error_class_has_its_problem_with_its_data() -> None:
    classes = {getattr(errors, name) for name in errors.__all__ if name[0].isupper()}
    assert PROBLEMS.keys() == {c for c in classes if not c.__subclasses__()}
    for cls, model in PROBLEMS.items():
        common = {"type", "title", "status", "detail", "instance"}
        assert set(model.model_fields) == common | set(cls.fields)
        schema = model.model_json_schema()["properties"]["type"]
        assert schema["const"] == cls.problem_type()


def test_every_operation_documents_its_failures(document: dict[str, Any]) -> None:
    for methods in document["paths"].values():
        for operation in methods.values():
            failures = {s: r for s, r in operation["responses"].items() if s >= "4"}
            assert "default" in failures
            for answer in failures.values():
                assert list(answer["content"]) == ["application/problem+json"]


def test_every_request_field_has_a_default_or_is_required_and_is_described(
    document: dict[str, Any],
) -> None:
    schemas = document["components"]["schemas"]
    for name in (
        "PlanRequest",
        "TimingRequest",
        "IkRequest",
        "FkRequest",
        "RobotUpload",
        "JointLimits",
        "PathRequest",
        "IkOptions",
        "LimitOptions",
    ):
        for field, schema in schemas[name]["properties"].items():
            where = f"{name}.{field}"
            assert (
                field in schemas[name].get("required", [])
                or "default" in schema
                or "$ref" in schema
            ), where
            assert "description" in schema or "$ref" in schema, where


def test_answers_fit_the_models_they_are_documented_with(
    document: dict[str, Any], http: httpx.Client, client: Client
) -> None:
    plan = client.plan(GOOD)
    for path, model, body in (
        ("/v1/plans", Plan, GOOD),
        ("/v1/timings", Plan, {"robot": "ur5", "waypoints": [[0.0] * 6, [0.1] * 6]}),
        ("/v1/ik", IkSolution, {"robot": "ur5", "position": [0.4, 0.1, 0.4]}),
        (
            "/v1/ik/batch",
            IkBatchSolution,
            {"robot": "ur5", "poses": [{"position": [0.4, 0.1, 0.4]}]},
        ),
        ("/v1/fk", FkResult, {"robot": "ur5", "q": [0.0] * 6}),
    ):
        ok = document["paths"][path]["post"]["responses"]["200"]["content"]["application/json"]
        assert ok["schema"]["$ref"].endswith(f"/{model.__name__}")
        answer = http.post(path, json=body).json()
        assert (
            answer.keys() == document["components"]["schemas"][model.__name__]["properties"].keys()
        )
    assert waypoint_errors(plan, GOOD["path"]).max() <= 1e-8


def test_problems_fit_the_models_they_are_documented_with(http: httpx.Client) -> None:
    for body in ({"robot": "x"}, {**GOOD, "robot": "x"}):
        problem = http.post("/v1/plans", json=body).json()
        cls = next(c for c in PROBLEMS if c.problem_type() == problem["type"])
        PROBLEMS[cls].model_validate(problem)
        assert re.fullmatch(r"urn:ikplan:request:[0-9a-f]{32}", problem["instance"])
