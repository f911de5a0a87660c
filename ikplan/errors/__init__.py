"""The errors of ikplan: one tree, each class with its own data.

::

    IkplanError
    ├── NoPlan                    the request makes sense, and there is no plan for it
    │   ├── Unreachable           a waypoint has no solution within limits and tolerance
    │   ├── Disconnected          waypoints have solutions, but no continuous motion joins them
    │   ├── InCollision           the arm would touch itself, its tool or an obstacle
    │   ├── TimingFailed          no timing under the limits
    │   └── BudgetExceeded        the time budget ran out
    ├── InvalidInput              what the caller gave is wrong, or names what does not exist
    │   ├── InvalidRequest        a field is wrong, unknown, not finite, of the wrong length
    │   ├── RobotNotFound         no robot of that name
    │   ├── InvalidRobot          a description that makes no sense
    │   └── PlanNotFound          no plan of that id
    ├── ServiceError              a service refuses the request, or fails at it
    │   ├── AccessDenied          an API key is required, or the key is unknown
    │   ├── RateLimited           the key asks more often than it may
    │   ├── ServiceUnavailable    the service cannot be reached, or its answer is none of ours
    │   ├── MemoryExceeded        the request needed more memory than the service gives one
    │   └── WorkerLost            the process that did the work ended in the middle of it
    └── CertificateViolated       a finished plan broke a promise: a bug of ours

``NoPlan``, ``InvalidInput`` and ``ServiceError`` are groups, to be caught: what is raised is a
class below them. Each of those has one problem ``type`` (RFC 9457), so that an error raised by the
service is raised again, as the same class with the same data, by the client.
"""

from __future__ import annotations

from ikplan.errors.base import IkplanError
from ikplan.errors.certificate import CertificateViolated
from ikplan.errors.invalid_input import (
    InvalidInput,
    InvalidRequest,
    InvalidRobot,
    PlanNotFound,
    RobotNotFound,
    near_names,
)
from ikplan.errors.no_plan import (
    BudgetExceeded,
    Disconnected,
    InCollision,
    NoPlan,
    TimingFailed,
    Unreachable,
)
from ikplan.errors.problems import error_from_problem
from ikplan.errors.service import (
    AccessDenied,
    MemoryExceeded,
    RateLimited,
    ServiceError,
    ServiceUnavailable,
    WorkerLost,
)

__all__ = [
    "AccessDenied",
    "BudgetExceeded",
    "CertificateViolated",
    "Disconnected",
    "IkplanError",
    "InCollision",
    "InvalidInput",
    "InvalidRequest",
    "InvalidRobot",
    "MemoryExceeded",
    "NoPlan",
    "PlanNotFound",
    "RateLimited",
    "RobotNotFound",
    "ServiceError",
    "ServiceUnavailable",
    "TimingFailed",
    "Unreachable",
    "WorkerLost",
    "error_from_problem",
    "near_names",
]
