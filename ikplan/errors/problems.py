"""Errors read from problem documents (RFC 9457)."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from ikplan.errors.base import IkplanError
from ikplan.errors.certificate import CertificateViolated
from ikplan.errors.invalid_input import (
    InvalidRequest,
    InvalidRobot,
    PlanNotFound,
    RobotNotFound,
)
from ikplan.errors.no_plan import (
    BudgetExceeded,
    Disconnected,
    InCollision,
    TimingFailed,
    Unreachable,
)
from ikplan.errors.service import (
    AccessDenied,
    MemoryExceeded,
    RateLimited,
    ServiceUnavailable,
    WorkerLost,
)

__all__ = ["error_from_problem"]

_BY_TYPE: dict[str, type[IkplanError]] = {
    cls.problem_type(): cls
    for cls in (
        InvalidRequest,
        RobotNotFound,
        PlanNotFound,
        InvalidRobot,
        Unreachable,
        Disconnected,
        InCollision,
        TimingFailed,
        BudgetExceeded,
        MemoryExceeded,
        WorkerLost,
        CertificateViolated,
        AccessDenied,
        RateLimited,
        ServiceUnavailable,
    )
}


def error_from_problem(problem: Mapping[str, Any], *, url: str = "") -> IkplanError:
    """Rebuild the error that a problem document describes.

    Args:
        problem: An RFC 9457 document, as made by :meth:`IkplanError.to_problem`.
        url: Address it came from, for documents of no class of ours.

    Returns:
        An error of the class that the document's ``type`` names, with its data, or
        ServiceUnavailable when the type is none of ours.
    """
    cls = _BY_TYPE.get(str(problem.get("type")))
    detail = str(problem.get("detail") or problem.get("title") or "unknown problem")
    needed = () if cls is None else set(cls.fields) - set(cls.added_fields)
    if cls is not None and all(name in problem for name in needed):
        try:
            return cls(detail, **{name: problem[name] for name in cls.fields if name in problem})
        except (TypeError, ValueError):
            # A document of that type with other data is none of ours either.
            detail = (
                f"{url or 'the service'} answered a problem with data of another kind: {detail}"
            )
    status = problem.get("status")
    return ServiceUnavailable(
        detail, url=url, status_code=status if isinstance(status, int) else None
    )
