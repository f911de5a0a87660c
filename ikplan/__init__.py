"""ikplan: a tool path in, a certified joint trajectory out.

The public names are imported on first use, so that a client needs neither Pinocchio nor a compiler.
"""

from __future__ import annotations

import importlib
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from ikplan.client import AsyncClient, AsyncPlanJob, Client, PlanJob
    from ikplan.documents.status import PlanStatus
    from ikplan.documents.timing import TimingRequest
    from ikplan.errors import (
        AccessDenied,
        BudgetExceeded,
        CertificateViolated,
        Disconnected,
        IkplanError,
        InvalidRequest,
        InvalidRobot,
        MemoryExceeded,
        PlanNotFound,
        RateLimited,
        RobotNotFound,
        ServiceUnavailable,
        TimingFailed,
        Unreachable,
        WorkerLost,
    )
    from ikplan.ik import solve_ik
    from ikplan.pipeline import plan
    from ikplan.request import FkRequest, IkRequest, PlanRequest
    from ikplan.result import Certificate, FkResult, IkSolution, Plan
    from ikplan.retiming import time_path, time_request
    from ikplan.robots import Robot, load_robot, robot_names

_HOMES = {
    "AccessDenied": "errors",
    "AsyncClient": "client",
    "AsyncPlanJob": "client",
    "BudgetExceeded": "errors",
    "Certificate": "result",
    "CertificateViolated": "errors",
    "Client": "client",
    "Disconnected": "errors",
    "FkRequest": "request",
    "FkResult": "result",
    "IkRequest": "request",
    "IkSolution": "result",
    "IkplanError": "errors",
    "InvalidRequest": "errors",
    "InvalidRobot": "errors",
    "MemoryExceeded": "errors",
    "Plan": "result",
    "PlanJob": "client",
    "PlanNotFound": "errors",
    "PlanRequest": "request",
    "PlanStatus": "documents.status",
    "RateLimited": "errors",
    "Robot": "robots",
    "RobotNotFound": "errors",
    "ServiceUnavailable": "errors",
    "TimingFailed": "errors",
    "TimingRequest": "documents.timing",
    "Unreachable": "errors",
    "WorkerLost": "errors",
    "load_robot": "robots",
    "plan": "pipeline",
    "robot_names": "robots",
    "solve_ik": "ik",
    "time_path": "retiming",
    "time_request": "retiming",
}

__all__ = [
    "AccessDenied",
    "AsyncClient",
    "AsyncPlanJob",
    "BudgetExceeded",
    "Certificate",
    "CertificateViolated",
    "Client",
    "Disconnected",
    "FkRequest",
    "FkResult",
    "IkRequest",
    "IkSolution",
    "IkplanError",
    "InvalidRequest",
    "InvalidRobot",
    "MemoryExceeded",
    "Plan",
    "PlanJob",
    "PlanNotFound",
    "PlanRequest",
    "PlanStatus",
    "RateLimited",
    "Robot",
    "RobotNotFound",
    "ServiceUnavailable",
    "TimingFailed",
    "TimingRequest",
    "Unreachable",
    "WorkerLost",
    "__version__",
    "load_robot",
    "plan",
    "robot_names",
    "solve_ik",
    "time_path",
    "time_request",
]

__version__ = "0.1.0"


def __getattr__(name: str) -> Any:
    if name not in _HOMES:
        raise AttributeError(f"module 'ikplan' has no attribute {name!r}")
    value = getattr(importlib.import_module(f"ikplan.{_HOMES[name]}"), name)
    globals()[name] = value
    return value


def __dir__() -> list[str]:
    return __all__
