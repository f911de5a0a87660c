"""The OpenAPI document, completed where FastAPI cannot infer it."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from fastapi import FastAPI
from fastapi.openapi.utils import get_openapi
from fastapi.routing import APIRoute
from pydantic import BaseModel
from pydantic.json_schema import models_json_schema

from ikplan import errors
from ikplan.documents.plan_request import PlanRequest
from ikplan.documents.requests.fk import FkRequest
from ikplan.documents.requests.ik import IkBatchRequest, IkRequest
from ikplan.documents.scene import SceneUpload
from ikplan.documents.timing_request import TimingRequest
from ikplan.robots import RobotUpload
from ikplan_api.http.problems import PROBLEM
from ikplan_api.http.representations import plan_contents
from ikplan_api.http.schemas import PROBLEMS, BatchLine, Problem

__all__ = [
    "WORKER_ERRORS",
    "install",
    "operation_id",
    "plan_answers",
    "problems",
    "request_body",
    "upload_body",
]

_REF = "#/components/schemas/{model}"
_REQUESTS: tuple[type[BaseModel], ...] = (
    PlanRequest,
    TimingRequest,
    IkRequest,
    IkBatchRequest,
    FkRequest,
    RobotUpload,
    SceneUpload,
)


def operation_id(route: APIRoute) -> str:
    """Name an operation after its function: the same in every version."""
    return route.name


def _ref(model: type[BaseModel]) -> dict[str, str]:
    return {"$ref": _REF.format(model=model.__name__)}


def request_body(model: type[BaseModel], example: dict[str, Any]) -> dict[str, Any]:
    """Describe a JSON body that the route parses itself."""
    content = {"application/json": {"schema": _ref(model), "example": example}}
    return {"requestBody": {"required": True, "content": content}}


def upload_body(
    model: type[BaseModel], example: dict[str, Any], xml: Sequence[str], query: Sequence[str]
) -> dict[str, Any]:
    """Describe a body in JSON, or in XML with some of the JSON fields in the query."""
    made = request_body(model, example)
    text = {"schema": {"type": "string"}, "example": example["urdf"]}
    made["requestBody"]["content"] |= dict.fromkeys(xml, text)
    made["parameters"] = [
        {
            "name": name,
            "in": "query",
            "description": f"With an XML body: {model.model_fields[name].description}",
            "schema": {"type": "string", "minLength": 1, "maxLength": 200},
        }
        for name in query
    ]
    return made


WORKER_ERRORS = (
    errors.BudgetExceeded,
    errors.MemoryExceeded,
    errors.WorkerLost,
    errors.ServiceUnavailable,
)
"""Errors of whatever a worker does."""


def problems(
    *classes: type[errors.IkplanError], body: bool = True
) -> dict[int | str, dict[str, Any]]:
    """Describe the problems of a route by status; ``body``: the route reads a request body."""
    by_status: dict[int | str, list[type[errors.IkplanError]]] = {}
    for cls in classes:
        by_status.setdefault(cls.status, []).append(cls)
    if body and errors.InvalidRequest in classes:
        by_status[413] = by_status[415] = [errors.InvalidRequest]
    answers: dict[int | str, dict[str, Any]] = {
        status: _answer(" or ".join(c.title for c in kinds), [PROBLEMS[c] for c in kinds])
        for status, kinds in sorted(by_status.items(), key=lambda item: str(item[0]))
    }
    if 503 in answers:
        header = {"description": "Retry after this time [s].", "schema": {"type": "integer"}}
        answers[503]["headers"] = {"Retry-After": header}
    answers["default"] = _answer("Any other failure", [Problem])
    return answers


def plan_answers(
    *classes: type[errors.IkplanError], body: bool = True
) -> dict[int | str, dict[str, Any]]:
    """Describe a plan in every format, and the problems of the route."""
    refused = [PROBLEMS[errors.InvalidRequest]]
    return {
        200: {"content": plan_contents()},
        406: _answer("No acceptable plan format", refused),
        **problems(*classes, body=body),
    }


def _answer(description: str, models: Sequence[type[Problem]]) -> dict[str, Any]:
    refs = [_ref(m) for m in models]
    schema: dict[str, Any] = refs[0]
    if len(refs) > 1:
        kinds = {m.model_fields["type"].annotation.__args__[0]: m for m in models}  # type: ignore[union-attr]
        mapping = {kind: _ref(m)["$ref"] for kind, m in kinds.items()}
        schema = {
            "oneOf": refs,
            "discriminator": {"propertyName": "type", "mapping": mapping},
        }
    return {"description": description, "content": {PROBLEM: {"schema": schema}}}


def _describe_access(document: dict[str, Any]) -> None:
    """Describe API keys, which every path under ``/v1/`` requires if keys are configured."""
    document["components"]["securitySchemes"] = {
        "key": {
            "type": "http",
            "scheme": "bearer",
            "description": "Required if the service has API keys; a service on loopback may have "
            "none.",
        }
    }
    refusals = {
        "401": _answer(errors.AccessDenied.title, [PROBLEMS[errors.AccessDenied]]),
        "429": _answer(errors.RateLimited.title, [PROBLEMS[errors.RateLimited]]),
    }
    for path, methods in document["paths"].items():
        for operation in methods.values() if path.startswith("/v1/") else ():
            operation["security"] = [{}, {"key": []}]
            operation["responses"] = dict(sorted({**refusals, **operation["responses"]}.items()))


def install(app: FastAPI) -> None:
    """Add the schemas that the routes refer to to the app's OpenAPI document."""

    def document() -> dict[str, Any]:
        if app.openapi_schema is None:
            made = get_openapi(
                title=app.title,
                version=app.version,
                summary=app.summary,
                description=app.description,
                routes=app.routes,
                tags=app.openapi_tags,
            )
            models: list[type[BaseModel]] = [*_REQUESTS, BatchLine, Problem, *PROBLEMS.values()]
            _, extra = models_json_schema(
                [(model, "validation") for model in models], ref_template=_REF
            )
            schemas = made.setdefault("components", {}).setdefault("schemas", {})
            for cls, model in PROBLEMS.items():
                extra["$defs"][model.__name__]["externalDocs"] = {
                    "description": "What it means, and what to do",
                    "url": f"problems/{cls.slug}",
                }
            made["components"]["schemas"] = dict(sorted((schemas | extra["$defs"]).items()))
            _describe_access(made)
            app.openapi_schema = made
        return app.openapi_schema

    app.openapi = document  # type: ignore[method-assign]
