"""Failures as RFC 9457 problem documents."""

from __future__ import annotations

import http
import itertools
import json
import math
from collections.abc import Mapping, Sequence
from typing import Any

from fastapi import APIRouter, FastAPI, Request, Response
from fastapi.exceptions import RequestValidationError
from fastapi.routing import APIRoute
from starlette.exceptions import HTTPException
from starlette.routing import Match

from ikplan.documents.json_text import json_ready, shortened
from ikplan.errors import (
    AccessDenied,
    IkplanError,
    InvalidRequest,
    RateLimited,
    ServiceUnavailable,
)
from ikplan_api.http.disconnect import ClientGone

__all__ = [
    "PROBLEM",
    "Refusal",
    "error_response",
    "http_problem",
    "install",
    "problem_response",
    "request_id_of",
]

PROBLEM = "application/problem+json"
_LONGEST_TEXT = 4000
"""Longest text in a problem document."""


class Refusal(Exception):
    """An error with a more specific HTTP status than that of its class.

    Args:
        error: The error.
        status: The HTTP status.
        headers: Headers of the response.
    """

    def __init__(
        self, error: IkplanError, status: int, headers: Mapping[str, str] | None = None
    ) -> None:
        super().__init__(error.detail)
        self.error = error
        self.status = status
        self.headers = dict(headers or {})


def problem_response(
    document: Mapping[str, Any], request_id: str, headers: Mapping[str, str] | None = None
) -> Response:
    """Return a response with a problem document; its ``instance`` is the request's id."""
    body = {**document, "instance": f"urn:ikplan:request:{request_id}"}
    return Response(
        json.dumps(_brief(json_ready(body)), allow_nan=False),
        status_code=int(document["status"]),
        media_type=PROBLEM,
        headers=dict(headers or {}),
    )


def _brief(value: Any) -> Any:
    """Shorten every text: what a client sent does not come back as a whole."""
    if isinstance(value, dict):
        return {shortened(key): _brief(item) for key, item in value.items()}
    if isinstance(value, list):
        return [_brief(item) for item in value]
    return shortened(value, _LONGEST_TEXT) if isinstance(value, str) else value


def error_response(
    request: Request,
    error: IkplanError,
    status: int | None = None,
    more_headers: Mapping[str, str] | None = None,
) -> Response:
    """Return the response for an error."""
    request.scope.setdefault("state", {})["problem"] = error.slug  # for the log
    document = error.to_problem()
    headers = dict(more_headers or {})
    # Words on the type of the problem, for people; the type itself is a name and leads nowhere.
    prefix = request.scope.get("root_path", "")
    headers["link"] = f'<{prefix}/problems/{error.slug}>; rel="help"'
    if notes := request.scope["state"].get("notes"):
        headers["ikplan-notes"] = str(notes)  # how its file was read
    if status is not None:
        document["status"] = status
    if isinstance(error, ServiceUnavailable) and not error.url:
        document["url"] = request.url.path
    if isinstance(error, ServiceUnavailable | RateLimited) and error.retry_after_s is not None:
        headers["retry-after"] = str(math.ceil(error.retry_after_s))
    if isinstance(error, AccessDenied) and document["status"] == AccessDenied.status:
        headers["www-authenticate"] = 'Bearer realm="ikplan"'
    return problem_response(document, request_id_of(request), headers)


def http_problem(status: int, detail: str) -> dict[str, Any]:
    """Return the problem document of a plain HTTP status."""
    title = http.HTTPStatus(status).phrase
    return {"type": "about:blank", "title": title, "status": status, "detail": detail}


def request_id_of(request: Request) -> str:
    """Return the id that the middleware gave the request."""
    return str(request.scope.get("state", {}).get("request_id", ""))


async def _on_ikplan_error(request: Request, error: Exception) -> Response:
    assert isinstance(error, IkplanError)
    return error_response(request, error)


async def _on_refusal(request: Request, error: Exception) -> Response:
    assert isinstance(error, Refusal)
    return error_response(request, error.error, error.status, error.headers)


async def _on_client_gone(request: Request, error: Exception) -> Response:
    assert isinstance(error, ClientGone)
    # For the log only: the client is gone, or the server gave it up with a status of its own.
    return Response(status_code=request.scope.get("state", {}).get("given_up", 499))


async def _on_validation_error(request: Request, error: Exception) -> Response:
    assert isinstance(error, RequestValidationError)
    first = error.errors()[0]
    field = ".".join(str(part) for part in first["loc"])
    return error_response(request, InvalidRequest(f"{field}: {first['msg']}", field=field))


async def _on_http_exception(request: Request, error: Exception) -> Response:
    assert isinstance(error, HTTPException)
    path = request.url.path
    details = {
        404: f"nothing found at {path}; see /docs for the available endpoints",
        405: f"{path} does not support {request.method}; see /docs",
    }
    document = http_problem(error.status_code, details.get(error.status_code, str(error.detail)))
    headers = dict(error.headers or {})
    if error.status_code == 405:
        # Starlette lists the methods of the first matching route only.
        headers["Allow"] = ", ".join(sorted(_methods_at(request)))
    return problem_response(document, request_id_of(request), headers)


def _methods_at(request: Request) -> set[str]:
    """Return the methods of all routes that match the path of a request."""
    routers: Sequence[APIRouter] = request.app.state.routers
    found: set[str] = set()
    for route in itertools.chain.from_iterable(router.routes for router in routers):
        if isinstance(route, APIRoute) and route.matches(request.scope)[0] is not Match.NONE:
            found |= route.methods or set()
    return found


def install(app: FastAPI, routers: Sequence[APIRouter]) -> None:
    """Make an app with these routers answer every failure with a problem document."""
    app.state.routers = tuple(routers)
    app.add_exception_handler(IkplanError, _on_ikplan_error)
    app.add_exception_handler(Refusal, _on_refusal)
    app.add_exception_handler(ClientGone, _on_client_gone)
    app.add_exception_handler(RequestValidationError, _on_validation_error)
    app.add_exception_handler(HTTPException, _on_http_exception)
