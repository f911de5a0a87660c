"""The exchanges that the service offers, each as one :class:`~ikplan.client.wire.Call`."""

from __future__ import annotations

import json
from collections.abc import Callable, Mapping
from datetime import datetime
from pathlib import Path
from typing import Any
from urllib.parse import quote, urlencode

from pydantic import BaseModel

from ikplan.client.wire import Call, encode
from ikplan.documents.plan_request import PlanRequest
from ikplan.documents.pose_results import FkResult, IkBatchSolution, IkSolution
from ikplan.documents.requests.fk import FkRequest
from ikplan.documents.requests.ik import IkBatchRequest, IkRequest
from ikplan.documents.status import Audit, PlanList, PlanStatus
from ikplan.documents.timing_request import TimingRequest
from ikplan.documents.trajectory import PlanSeries
from ikplan.errors import InvalidRobot, ServiceUnavailable
from ikplan.plans.plan import Plan
from ikplan.scene.mesh_files import without_mesh_files

__all__ = [
    "audit",
    "delete_plan",
    "delete_robot",
    "delete_scene",
    "fk",
    "formats",
    "get_plan",
    "ik",
    "ik_batch",
    "peek",
    "plan",
    "plan_path",
    "plans",
    "robot",
    "robots",
    "scene",
    "series",
    "solvers",
    "submit",
    "submit_time",
    "time",
    "upload_robot",
    "upload_scene",
    "version",
]


def plan(request: Mapping[str, Any] | PlanRequest) -> Call[Plan]:
    """Make a plan."""
    return Call("POST", "/v1/plans", Plan.load, encode(request))


def time(request: Mapping[str, Any] | TimingRequest) -> Call[Plan]:
    """Time a joint path."""
    return Call("POST", "/v1/timings", Plan.load, encode(request))


def plan_path(plan_id: str) -> str:
    """Where a plan is."""
    return f"/v1/plans/{quote(plan_id, safe='')}"


def get_plan(plan_id: str) -> Call[Plan]:
    """Fetch a finished plan."""
    return Call("GET", plan_path(plan_id), Plan.load, unfinished=_not_yet)


def plans(
    robot: str | None,
    outcome: str | None,
    since: datetime | str | None,
    until: datetime | str | None,
    after: str | None,
) -> Call[PlanList]:
    """List a page of plans and jobs."""
    asked = {"robot": robot, "outcome": outcome, "since": _moment(since), "until": _moment(until)}
    query = {name: value for name, value in {**asked, "after": after}.items() if value is not None}
    path = "/v1/plans" + (f"?{urlencode(query)}" if query else "")
    return Call("GET", path, PlanList.model_validate_json)


def audit(owner: str | None, before: int | None) -> Call[Audit]:
    """List a page of what was done."""
    asked = {"owner": owner, "before": before}
    query = {name: value for name, value in asked.items() if value is not None}
    path = "/v1/audit" + (f"?{urlencode(query)}" if query else "")
    return Call("GET", path, Audit.model_validate_json)


def _moment(value: datetime | str | None) -> str | None:
    return value.isoformat() if isinstance(value, datetime) else value


def submit(request: Mapping[str, Any] | PlanRequest) -> Call[Plan | PlanStatus]:
    """Ask for a plan without waiting for it."""
    return _later("/v1/plans", encode(request))


def submit_time(request: Mapping[str, Any] | TimingRequest) -> Call[Plan | PlanStatus]:
    """Ask for the timing of a joint path without waiting for it."""
    return _later("/v1/timings", encode(request))


def _later(path: str, content: bytes) -> Call[Plan | PlanStatus]:
    status = PlanStatus.model_validate_json
    return Call("POST", path, Plan.load, content, unfinished=status, prefer="respond-async")


def peek(plan_id: str) -> Call[Plan | PlanStatus]:
    """Fetch a plan, or how far it is."""
    status = PlanStatus.model_validate_json
    return Call("GET", plan_path(plan_id), Plan.load, unfinished=status)


def delete_plan(plan_id: str) -> Call[None]:
    """Cancel or forget a plan."""
    return Call("DELETE", plan_path(plan_id), lambda _: None)


def _not_yet(body: bytes) -> Plan:
    status = PlanStatus.model_validate_json(body)
    raise ServiceUnavailable(
        f"plan {status.id} is not finished: it is {status.state}",
        url=plan_path(status.id),
        status_code=202,
        retry_after_s=1.0,
    )


def ik(request: Mapping[str, Any] | IkRequest) -> Call[IkSolution]:
    """Solve one pose."""
    return Call("POST", "/v1/ik", IkSolution.model_validate_json, encode(request))


def ik_batch(request: Mapping[str, Any] | IkBatchRequest) -> Call[IkBatchSolution]:
    """Solve many poses."""
    return Call("POST", "/v1/ik/batch", IkBatchSolution.model_validate_json, encode(request))


def fk(request: Mapping[str, Any] | FkRequest) -> Call[FkResult]:
    """Place the tool."""
    return Call("POST", "/v1/fk", FkResult.model_validate_json, encode(request))


def robots() -> Call[list[dict[str, Any]]]:
    """List the robots."""
    return Call("GET", "/v1/robots", _list("robots"))


def robot(name: str) -> Call[dict[str, Any]]:
    """Describe a robot."""
    return Call("GET", f"/v1/robots/{quote(name, safe='')}", _object)


def formats(name: str) -> Call[list[dict[str, Any]]]:
    """List the formats of a robot's plans."""
    return Call("GET", f"/v1/robots/{quote(name, safe='')}/formats", _list("formats"))


def series(request: Mapping[str, Any] | PlanRequest) -> Call[PlanSeries]:
    """Measure a plan over time."""
    return Call("POST", "/v1/series", PlanSeries.model_validate_json, encode(request))


def upload_robot(urdf: str | bytes, options: Mapping[str, Any]) -> Call[dict[str, Any]]:
    """Upload a robot.

    Raises:
        InvalidRobot: The URDF is not text.
    """
    try:
        text = urdf.decode() if isinstance(urdf, bytes) else urdf
    except UnicodeDecodeError as error:
        raise InvalidRobot(f"the URDF is not UTF-8 text: {error.reason}") from error
    return Call("POST", "/v1/robots", _object, encode({"urdf": text, **options}))


def delete_robot(name: str) -> Call[None]:
    """Forget an uploaded robot."""
    return Call("DELETE", f"/v1/robots/{quote(name, safe='')}", lambda _: None)


def upload_scene(scene: Mapping[str, Any] | BaseModel, name: str | None) -> Call[dict[str, Any]]:
    """Upload a scene."""
    document = without_mesh_files({"scene": scene}, Path.cwd())["scene"]
    if isinstance(document, BaseModel):
        document = document.model_dump(mode="json", exclude_unset=True)
    if name is not None and isinstance(document, Mapping):
        document = {**document, "name": name}
    return Call("POST", "/v1/scenes", _object, encode(document))


def scene(scene_id: str) -> Call[dict[str, Any]]:
    """Fetch an uploaded scene."""
    return Call("GET", f"/v1/scenes/{quote(scene_id, safe='')}", _object)


def delete_scene(scene_id: str) -> Call[None]:
    """Forget an uploaded scene."""
    return Call("DELETE", f"/v1/scenes/{quote(scene_id, safe='')}", lambda _: None)


def solvers() -> Call[list[dict[str, Any]]]:
    """List the solvers."""
    return Call("GET", "/v1/solvers", _list("solvers"))


def version() -> Call[dict[str, Any]]:
    """Tell the service's version."""
    return Call("GET", "/version", _object)


def _object(body: bytes) -> dict[str, Any]:
    document = json.loads(body)
    if not isinstance(document, dict):
        raise TypeError("an object was expected")
    return document


def _list(key: str) -> Callable[[bytes], list[dict[str, Any]]]:
    def pick(body: bytes) -> list[dict[str, Any]]:
        items = _object(body)[key]
        if not isinstance(items, list):
            raise TypeError("a list was expected")
        return items

    return pick
