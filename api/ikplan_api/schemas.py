"""The documents that only the service speaks: listings, states and problems."""

from __future__ import annotations

from typing import Any, Literal

from pydantic import BaseModel, ConfigDict, Field, create_model

from ikplan import errors
from ikplan.ik.registry import Solver
from ikplan.result import Plan
from ikplan.robots import RobotInfo

__all__ = [
    "PROBLEMS",
    "BatchLine",
    "Problem",
    "RobotList",
    "SolverList",
    "State",
    "Version",
]


class RobotList(BaseModel):
    """Every robot of the catalogue."""

    robots: list[RobotInfo]


class SolverList(BaseModel):
    """Every solver of joint values."""

    solvers: list[Solver]


class Version(BaseModel):
    """What answers here."""

    version: str = Field(description="Version of ikplan.")


class State(BaseModel):
    """State of the service."""

    status: Literal["alive", "ready"]


class Problem(BaseModel):
    """A failure (RFC 9457)."""

    model_config = ConfigDict(extra="allow")

    type: str = Field(description="What kind of failure, one of a fixed set of URIs.")
    title: str = Field(description="The same in words.")
    status: int = Field(description="The HTTP status.")
    detail: str = Field(description="What happened this time, and what can be done.")
    instance: str = Field(description="The id of the request, as in the header X-Request-ID.")


class BatchLine(BaseModel):
    """What became of one request of a batch: a plan or a problem."""

    index: int = Field(description="Place of the request in the batch, from 0.")
    status: int = Field(description="The HTTP status that the request alone would have had.")
    plan: Plan | None = Field(None, description="The plan.")
    problem: Problem | None = Field(None, description="Why there is none.")


_Names = list[str]
_REPAIRS = (
    list[dict[str, Any]],
    Field(description="Changes of the request that were planned and make it feasible."),
)
_DATA: dict[type[errors.IkplanError], dict[str, Any]] = {
    errors.InvalidRequest: {
        "field": (str, Field(description="Path of the first wrong field.")),
        "allowed": (Any, Field(description="What is allowed there: choices, words or null.")),
        "errors": (list[dict[str, Any]], Field(description="Every wrong field.")),
    },
    errors.RobotNotFound: {
        "name": (str, Field(description="The name asked for.")),
        "near": (_Names, Field(description="Valid names that look like it.")),
        "valid": (_Names, Field(description="Every valid name.")),
    },
    errors.PlanNotFound: {"id": (str, Field(description="The id asked for."))},
    errors.InvalidRobot: {
        "robot": (str, Field(description="Name or file of the description.")),
        "joint": (str | None, Field(description="The joint at fault.")),
        "value": (Any, Field(description="The value at fault.")),
        "valid": (_Names, Field(description="The choices there are instead.")),
    },
    errors.Unreachable: {
        "waypoint": (int, Field(description="Index of the waypoint, from 0.")),
        "position_error": (float | None, Field(description="Smallest position error found [m].")),
        "orientation_error": (float | None, Field(description="Orientation error there [rad].")),
        "q": (list[float | None], Field(description="Best joint values found [rad or m].")),
        "reason": (str, Field(description="Why, as far as it is known.")),
        "limits": (_Names, Field(description="Joints at a position limit in q.")),
        "target": (
            dict[str, Any] | None,
            Field(description="Where the tool was to be, in the base: position, quaternion_xyzw."),
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
            Field(description="Joint values at which it gets no further [rad or m]."),
        ),
        "repairs": _REPAIRS,
    },
    errors.TimingFailed: {
        "position": (float | None, Field(description="Where on the path, 0..1.")),
        "joint": (str | None, Field(description="The joint.")),
        "limit": (str | None, Field(description="The limit that cannot be kept.")),
    },
    errors.BudgetExceeded: {
        "stage": (str, Field(description="The stage that was running.")),
        "budget_s": (float, Field(description="The budget [s].")),
        "best": (dict[str, Any] | None, Field(description="Best result so far.")),
    },
    errors.MemoryExceeded: {
        "stage": (str, Field(description="The stage that was running.")),
        "limit_bytes": (int, Field(description="The memory that a request may take [bytes].")),
    },
    errors.WorkerLost: {
        "exit_code": (int, Field(description="Exit code of the process; minus a signal.")),
    },
    errors.CertificateViolated: {
        "certificate": (dict[str, Any], Field(description="The certificate.")),
        "violations": (_Names, Field(description="The promises broken.")),
    },
    errors.AccessDenied: {},
    errors.RateLimited: {
        "limit": (str, Field(description="How often the key may ask.")),
        "retry_after_s": (float, Field(description="When to ask again [s].")),
    },
    errors.ServiceUnavailable: {
        "url": (str, Field(description="The path asked.")),
        "status_code": (int | None, Field(description="The HTTP status.")),
        "retry_after_s": (float | None, Field(description="When to ask again [s].")),
    },
}


def _problem(cls: type[errors.IkplanError], data: dict[str, Any]) -> type[Problem]:
    kind: Any = Literal[cls.problem_type()]
    model: type[Problem] = create_model(
        f"{cls.__name__}Problem",
        __base__=Problem,
        __doc__=(cls.__doc__ or cls.title).partition("\n")[0],
        type=(kind, Field(description="What kind of failure.")),
        **data,
    )
    return model


PROBLEMS: dict[type[errors.IkplanError], type[Problem]] = {
    cls: _problem(cls, data) for cls, data in _DATA.items()
}
"""The problem document of each error class."""
