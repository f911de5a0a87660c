"""Documents of the service itself: listings, states and problems."""

from __future__ import annotations

from typing import Any, Literal

from pydantic import BaseModel, ConfigDict, Field, create_model

from ikplan import errors
from ikplan.documents.plan_request import PlanRequest
from ikplan.documents.scene import SceneUpload
from ikplan.ik.solver import Solver
from ikplan.plans.plan import Plan
from ikplan.robots import RobotInfo

__all__ = [
    "PROBLEMS",
    "BatchLine",
    "FormatInfo",
    "FormatList",
    "PointsRead",
    "Problem",
    "RobotList",
    "SolverList",
    "State",
    "StoredScene",
    "Version",
]


class RobotList(BaseModel):
    """Every robot: the catalogue and uploads."""

    robots: list[RobotInfo]


class FormatInfo(BaseModel):
    """A format that plans are available in."""

    name: str = Field(description="Short name.")
    title: str = Field(description="What it is, in one line.")
    suffix: str = Field(description="Ending of a file's name, with the dot.")
    media_type: str = Field(description="For the header `Accept` of a request for a plan.")


class FormatList(BaseModel):
    """The formats that the plans of one robot are available in."""

    formats: list[FormatInfo]


class SolverList(BaseModel):
    """Every inverse-kinematics solver."""

    solvers: list[Solver]


class StoredScene(SceneUpload):
    """A scene that the service holds."""

    id: str = Field(description="Its id, for the field `scene` of any request.")


class ReadingNote(BaseModel):
    """One note on how a file was read."""

    text: str = Field(description="The note in words.")
    guessed: bool = Field(description="Whether it was inferred from the values alone.")


class PointsRead(BaseModel):
    """The request read from a file of points."""

    request: PlanRequest = Field(description="The request for a plan through the points.")
    notes: list[ReadingNote] = Field(description="How the file was read.")


class Version(BaseModel):
    """Version of the service."""

    version: str = Field(description="Version of ikplan.")


class State(BaseModel):
    """State of the service."""

    status: Literal["alive", "ready"]


class Problem(BaseModel):
    """A failure (RFC 9457)."""

    model_config = ConfigDict(extra="allow")

    type: str = Field(description="Type of the failure, one of a fixed set of URIs.")
    title: str = Field(description="The type in words.")
    status: int = Field(description="The HTTP status.")
    detail: str = Field(description="What happened, and how to fix it.")
    instance: str = Field(description="The id of the request, as in the header X-Request-ID.")


class BatchLine(BaseModel):
    """The result of one request of a batch: a plan or a problem."""

    index: int = Field(description="Index of the request in the batch, from 0.")
    status: int = Field(description="The HTTP status of the same request outside of a batch.")
    plan: Plan | None = Field(None, description="The plan, if planning succeeded.")
    problem: Problem | None = Field(None, description="The problem, if planning failed.")


_Names = list[str]
_REPAIRS = (
    list[dict[str, Any]],
    Field(description="Changes of the request for which a plan was found."),
)
_DATA: dict[type[errors.IkplanError], dict[str, Any]] = {
    errors.InvalidRequest: {
        "field": (str, Field(description="Path of the first invalid field.")),
        "allowed": (Any, Field(description="Allowed values: choices, a description or null.")),
        "errors": (list[dict[str, Any]], Field(description="Every invalid field.")),
    },
    errors.RobotNotFound: {
        "name": (str, Field(description="The requested name.")),
        "near": (_Names, Field(description="Similar valid names.")),
        "valid": (_Names, Field(description="Every valid name.")),
    },
    errors.PlanNotFound: {"id": (str, Field(description="The requested id."))},
    errors.InvalidRobot: {
        "robot": (str, Field(description="Name or file of the description.")),
        "joint": (str | None, Field(description="The invalid joint.")),
        "value": (Any, Field(description="The invalid value.")),
        "valid": (_Names, Field(description="The valid choices.")),
    },
    errors.Unreachable: {
        "waypoint": (int, Field(description="Index of the waypoint, from 0.")),
        "position_error": (float | None, Field(description="Smallest position error found [m].")),
        "orientation_error": (float | None, Field(description="Orientation error there [rad].")),
        "q": (list[float | None], Field(description="Best joint values found [rad or m].")),
        "reason": (str, Field(description="The cause, if known.")),
        "limits": (_Names, Field(description="Joints at a position limit in q.")),
        "target": (
            dict[str, Any] | None,
            Field(description="Target pose of the tool in the base: position, quaternion_xyzw."),
        ),
        "waypoints": (list[dict[str, Any]], Field(description="Every unreachable waypoint.")),
        "repairs": _REPAIRS,
    },
    errors.Disconnected: {
        "waypoints": (list[int], Field(description="The two waypoints; -1 is the start.")),
        "jump": (float | None, Field(description="Joint difference needed [rad or m].")),
        "reason": (str, Field(description="Why the motion is not possible.")),
        "q": (
            list[float | None],
            Field(description="Joint values where tracking stopped [rad or m]."),
        ),
        "repairs": _REPAIRS,
    },
    errors.InCollision: {
        "waypoint": (
            int | None,
            Field(description="Index of the waypoint, from 0; -1: the start; null: between them."),
        ),
        "time": (float | None, Field(description="When in the finished motion [s].")),
        "pair": (_Names, Field(description="Names of the two bodies.")),
        "depth": (
            float | None,
            Field(
                description="How far the gap falls short of the clearance asked for; of bodies in "
                "each other, how deep they are and the clearance [m]."
            ),
        ),
        "q": (list[float | None], Field(description="Joint values there [rad or m].")),
        "proven": (bool, Field(description="Contact is proven; false: no way around was found.")),
        "reason": (str, Field(description="How many candidates failed for which pair.")),
        "repairs": _REPAIRS,
    },
    errors.TimingFailed: {
        "position": (float | None, Field(description="Position along the path, 0..1.")),
        "joint": (str | None, Field(description="The joint.")),
        "limit": (str | None, Field(description="The limit that cannot be satisfied.")),
        "repairs": _REPAIRS,
        "nearest": (
            dict[str, Any],
            Field(description="Fields of the request with the nearest feasible values, if any."),
        ),
    },
    errors.BudgetExceeded: {
        "stage": (str, Field(description="The stage that was running.")),
        "budget_s": (float, Field(description="The budget [s].")),
        "best": (dict[str, Any] | None, Field(description="Best result so far.")),
    },
    errors.MemoryExceeded: {
        "stage": (str, Field(description="The stage that was running.")),
        "limit_bytes": (int, Field(description="The memory limit of a request [bytes].")),
    },
    errors.WorkerLost: {
        "exit_code": (int, Field(description="Exit code of the process; minus a signal.")),
    },
    errors.CertificateViolated: {
        "certificate": (dict[str, Any], Field(description="The certificate.")),
        "violations": (_Names, Field(description="The violated checks.")),
    },
    errors.AccessDenied: {},
    errors.RateLimited: {
        "limit": (str, Field(description="The rate limit of the key.")),
        "retry_after_s": (float, Field(description="Retry after this time [s].")),
    },
    errors.ServiceUnavailable: {
        "url": (str, Field(description="The requested path.")),
        "status_code": (int | None, Field(description="The HTTP status.")),
        "retry_after_s": (float | None, Field(description="Retry after this time [s].")),
    },
}


def _problem(cls: type[errors.IkplanError], data: dict[str, Any]) -> type[Problem]:
    kind: Any = Literal[cls.problem_type()]
    model: type[Problem] = create_model(
        f"{cls.__name__}Problem",
        __base__=Problem,
        __doc__=(cls.__doc__ or cls.title).partition("\n")[0],
        type=(kind, Field(description="Type of the failure.")),
        **data,
    )
    return model


PROBLEMS: dict[type[errors.IkplanError], type[Problem]] = {
    cls: _problem(cls, data) for cls, data in _DATA.items()
}
"""The problem document of each error class."""
