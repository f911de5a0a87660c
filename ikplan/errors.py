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

import difflib
from collections.abc import Callable, Iterable, Mapping, Sequence
from typing import Any, ClassVar

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

_URN = "urn:ikplan:"


def near_names(name: str, valid: Iterable[str]) -> list[str]:
    """Return up to three of ``valid`` that look like ``name``, best first."""
    by_folded = {v.lower(): v for v in sorted(valid)}
    matches = difflib.get_close_matches(name.lower(), by_folded, n=3, cutoff=0.5)
    return [by_folded[m] for m in matches]


class IkplanError(Exception):
    """Root of the tree.

    Attributes:
        slug: Last part of the problem type ``urn:ikplan:<slug>``.
        title: A short name for people, the same for every occurrence.
        status: HTTP status of the problem document.
        fields: Names of the attributes that make up the error's own data, JSON-ready.
        added_fields: Those of them that documents of older services lack.
        detail: What happened this time, and what the user can do.
    """

    slug: ClassVar[str] = "error"
    title: ClassVar[str] = "Planning error"
    status: ClassVar[int] = 500
    fields: ClassVar[tuple[str, ...]] = ()
    added_fields: ClassVar[tuple[str, ...]] = ()

    def __init__(self, detail: str) -> None:
        super().__init__(detail)
        self.detail = detail

    @property
    def data(self) -> dict[str, Any]:
        """The error's own data, by field name, ready for JSON."""
        return {name: getattr(self, name) for name in self.fields}

    @classmethod
    def problem_type(cls) -> str:
        """The problem type URI of this class."""
        return _URN + cls.slug

    def to_problem(self) -> dict[str, Any]:
        """Return the RFC 9457 problem document of this error."""
        return {
            "type": self.problem_type(),
            "title": self.title,
            "status": self.status,
            "detail": self.detail,
            **self.data,
        }

    def __reduce__(self) -> tuple[Callable[..., IkplanError], tuple[Any, ...]]:
        # Keyword-only data does not survive the default pickling of exceptions.
        return _rebuild, (type(self), self.detail, self.data)


def _shortened(text: str, length: int = 4000) -> str:
    return text if len(text) <= length else f"{text[:length]}..."


def _rebuild(cls: type[IkplanError], detail: str, data: Mapping[str, Any]) -> IkplanError:
    return cls(detail, **data)


class NoPlan(IkplanError):
    """The request makes sense, and there is no plan for it: a group, to be caught."""


class InvalidInput(IkplanError):
    """What the caller gave is wrong, or names what does not exist: a group, to be caught."""


class ServiceError(IkplanError):
    """A service refuses the request, or fails at it: a group, to be caught."""


class InvalidRequest(InvalidInput):
    """A field is wrong, unknown, not finite or of the wrong length.

    Attributes:
        field: Path of the first wrong field, such as ``path.waypoints[3].position``.
        allowed: What is allowed there: a list of choices, a range in words, or None.
        errors: Every wrong field as ``{"field": ..., "detail": ...}``, the first one included.
    """

    slug = "invalid-request"
    title = "Invalid request"
    status = 422
    fields = ("field", "allowed", "errors")

    def __init__(
        self,
        detail: str,
        *,
        field: str = "",
        allowed: Any = None,
        errors: Sequence[Mapping[str, str]] | None = None,
    ) -> None:
        super().__init__(detail)
        self.field = field
        self.allowed = allowed
        self.errors = list(errors) if errors else [{"field": field, "detail": detail}]


class RobotNotFound(InvalidInput):
    """No robot of that name.

    Attributes:
        name: The name asked for.
        near: Valid names that look like it.
        valid: Every valid name.
    """

    slug = "robot-not-found"
    title = "Robot not found"
    status = 404
    fields = ("name", "near", "valid")

    def __init__(
        self,
        detail: str = "",
        *,
        name: str,
        valid: Sequence[str] = (),
        near: Sequence[str] | None = None,
    ) -> None:
        self.name = name
        self.valid = list(valid)
        self.near = near_names(name, valid) if near is None else list(near)
        if not detail:
            hint = f"; did you mean {' or '.join(self.near)}?" if self.near else "."
            detail = f"no robot named {name!r}{hint} Valid names: {', '.join(self.valid)}"
        super().__init__(detail)


class PlanNotFound(InvalidInput):
    """No plan of that id.

    Attributes:
        id: The id asked for.
    """

    slug = "plan-not-found"
    title = "Plan not found"
    status = 404
    fields = ("id",)

    def __init__(self, detail: str = "", *, id: str) -> None:
        super().__init__(detail or f"no plan with id {id!r} is kept here")
        self.id = id


class InvalidRobot(InvalidInput):
    """A robot description that makes no sense.

    Attributes:
        robot: Name or file of the description.
        joint: The joint at fault, or None.
        value: The value at fault, or None.
        valid: The choices there are instead (link names, fields), empty where there are none.
    """

    slug = "invalid-robot"
    title = "Invalid robot description"
    status = 422
    fields = ("robot", "joint", "value", "valid")

    def __init__(
        self,
        detail: str,
        *,
        robot: str = "",
        joint: str | None = None,
        value: Any = None,
        valid: Sequence[str] = (),
    ) -> None:
        # A description may put a megabyte where a number belongs; who reads this needs its start.
        super().__init__(_shortened(detail))
        self.robot = robot
        self.joint = joint
        self.value = _shortened(value) if isinstance(value, str) else value
        self.valid = list(valid)


class Unreachable(NoPlan):
    """A waypoint has no solution within limits and tolerance.

    Attributes:
        waypoint: Index of the waypoint, from 0.
        position_error: Smallest position error found [m].
        orientation_error: Orientation error of that configuration [rad]; None: position target.
        q: Joint values of the best configuration found, shape (dof,) [rad or m].
        reason: Why, as far as it is known: out of reach by so much, or which joint limit binds.
        limits: Names of the joints that stand at a position limit in ``q``.
        target: Where the tool was to be, in the robot's base, as ``{"position",
            "quaternion_xyzw"}`` (None: any orientation) [m], or None.
        waypoints: Every waypoint found unreachable, as ``{"waypoint", "position_error",
            "orientation_error", "reason", "target"}``.
        repairs: Changes of the request that were tried and make it feasible, least first, as
            ``{"change", "detail"}``: the fields to change, and what that means in words.
    """

    slug = "unreachable"
    title = "Waypoint unreachable"
    status = 422
    fields = (
        "waypoint",
        "position_error",
        "orientation_error",
        "q",
        "reason",
        "limits",
        "target",
        "waypoints",
        "repairs",
    )

    def __init__(
        self,
        detail: str,
        *,
        waypoint: int,
        position_error: float,
        orientation_error: float | None,
        q: Sequence[float],
        reason: str,
        limits: Sequence[str] = (),
        target: Mapping[str, Any] | None = None,
        waypoints: Sequence[Mapping[str, Any]] = (),
        repairs: Sequence[Mapping[str, Any]] = (),
    ) -> None:
        super().__init__(detail)
        self.waypoint = waypoint
        self.position_error = position_error
        self.orientation_error = orientation_error
        self.q = [float(v) for v in q]
        self.reason = reason
        self.limits = list(limits)
        self.target = None if target is None else dict(target)
        self.waypoints = [dict(w) for w in waypoints]
        self.repairs = [dict(r) for r in repairs]


class Disconnected(NoPlan):
    """Each waypoint has solutions, but no continuous motion joins two neighbours.

    Attributes:
        waypoints: Indices of the two waypoints, from 0; -1 stands for the start configuration.
        jump: Largest single-joint difference a motion between them would need [rad or m].
        reason: Why the motion is not possible.
        q: Joint values at which the motion gets no further, shape (dof,) [rad or m].
        repairs: Changes of the request that were tried and make it feasible, as
            ``{"change", "detail"}``.
    """

    slug = "disconnected"
    title = "Path disconnected"
    status = 422
    fields = ("waypoints", "jump", "reason", "q", "repairs")

    def __init__(
        self,
        detail: str,
        *,
        waypoints: Sequence[int],
        jump: float,
        reason: str = "",
        q: Sequence[float] = (),
        repairs: Sequence[Mapping[str, Any]] = (),
    ) -> None:
        super().__init__(detail)
        self.waypoints = [int(i) for i in waypoints]
        self.jump = jump
        self.reason = reason
        self.q = [float(v) for v in q]
        self.repairs = [dict(r) for r in repairs]


class InCollision(NoPlan):
    """The arm, its tool or what it holds comes closer to a body than the clearance asked for.

    Attributes:
        waypoint: Index of the waypoint, from 0; -1 stands for the start configuration; None: it
            happens between waypoints.
        time: When in the finished motion [s]; None: there is no timed motion yet.
        pair: Names of the two bodies.
        depth: How far the gap falls short of the clearance asked for; of bodies in each other, how
            deep they are and the clearance [m].
        q: Joint values at which it happens, shape (dof,) [rad or m].
        proven: Whether contact is proven there; false: no way around was found.
        reason: Why no way around was found: how many candidates failed for which pair.
        repairs: Changes of the request that were tried and make it feasible, as
            ``{"change", "detail"}``.
    """

    slug = "in-collision"
    title = "In collision"
    status = 422
    fields = ("waypoint", "time", "pair", "depth", "q", "proven", "reason", "repairs")

    def __init__(
        self,
        detail: str,
        *,
        waypoint: int | None = None,
        time: float | None = None,
        pair: Sequence[str] = (),
        depth: float = 0.0,
        q: Sequence[float] = (),
        proven: bool = False,
        reason: str = "",
        repairs: Sequence[Mapping[str, Any]] = (),
    ) -> None:
        super().__init__(detail)
        self.waypoint = waypoint
        self.time = time
        self.pair = [str(name) for name in pair]
        self.depth = depth
        self.q = [float(v) for v in q]
        self.proven = proven
        self.reason = reason
        self.repairs = [dict(r) for r in repairs]


class TimingFailed(NoPlan):
    """No timing exists, or none was found, under the limits.

    Attributes:
        position: Where on the path, as a fraction 0..1 of its joint arc length, or None.
        joint: Name of the joint, or None.
        limit: The limit that cannot be kept ("velocity", "acceleration", "position", "torque"), or
            None.
        repairs: Changes of the request that were tried and make it feasible, as
            ``{"change", "detail"}``.
        nearest: Fields of the request with the nearest values found that are feasible: of a motion
            that begins or ends moving, of a duration or of times asked for; else empty.
    """

    slug = "timing-failed"
    title = "Timing failed"
    status = 422
    fields = ("position", "joint", "limit", "repairs", "nearest")
    added_fields = ("nearest",)

    def __init__(
        self,
        detail: str,
        *,
        position: float | None = None,
        joint: str | None = None,
        limit: str | None = None,
        repairs: Sequence[Mapping[str, Any]] = (),
        nearest: Mapping[str, Any] | None = None,
    ) -> None:
        super().__init__(detail)
        self.position = position
        self.joint = joint
        self.limit = limit
        self.repairs = [dict(r) for r in repairs]
        self.nearest = dict(nearest or {})


class BudgetExceeded(NoPlan):
    """The time budget of the request ran out: its processor time, or a multiple in wall time.

    Attributes:
        stage: The stage that was running.
        budget_s: The budget [s].
        best: Best result so far (joint values of the waypoints solved), or None.
    """

    slug = "budget-exceeded"
    title = "Time budget exceeded"
    status = 422
    fields = ("stage", "budget_s", "best")

    def __init__(
        self, detail: str, *, stage: str, budget_s: float, best: Mapping[str, Any] | None = None
    ) -> None:
        super().__init__(detail)
        self.stage = stage
        self.budget_s = budget_s
        self.best = dict(best) if best is not None else None


class MemoryExceeded(ServiceError):
    """The request needed more memory than the service gives one.

    Attributes:
        stage: The stage that was running, as far as it is known.
        limit_bytes: The memory that a request may take [bytes].
    """

    slug = "memory-exceeded"
    title = "Memory exceeded"
    status = 422
    fields = ("stage", "limit_bytes")

    def __init__(self, detail: str, *, stage: str, limit_bytes: int) -> None:
        super().__init__(detail)
        self.stage = stage
        self.limit_bytes = limit_bytes


class WorkerLost(ServiceError):
    """The process that did the work ended in the middle of it.

    Attributes:
        exit_code: Its exit code, or minus the number of the signal that ended it.
    """

    slug = "worker-lost"
    title = "Worker lost"
    status = 500
    fields = ("exit_code",)

    def __init__(self, detail: str, *, exit_code: int) -> None:
        super().__init__(detail)
        self.exit_code = exit_code


class CertificateViolated(IkplanError):
    """A finished plan broke one of its promises: a bug of ours, never returned as a plan.

    Attributes:
        certificate: The certificate as a JSON-ready mapping.
        violations: The promises broken, in words.
    """

    slug = "certificate-violated"
    title = "Certificate violated"
    status = 500
    fields = ("certificate", "violations")

    def __init__(
        self, detail: str, *, certificate: Mapping[str, Any], violations: Sequence[str] = ()
    ) -> None:
        super().__init__(detail)
        self.certificate = dict(certificate)
        self.violations = list(violations)


class AccessDenied(ServiceError):
    """An API key is required, or the key is unknown."""

    slug = "access-denied"
    title = "Access denied"
    status = 401


class RateLimited(ServiceError):
    """The key asks more often than it may.

    Attributes:
        limit: How often it may, in words.
        retry_after_s: When to ask again [s].
    """

    slug = "rate-limited"
    title = "Too many requests"
    status = 429
    fields = ("limit", "retry_after_s")

    def __init__(self, detail: str = "", *, limit: str, retry_after_s: float) -> None:
        super().__init__(
            detail or f"this key may ask {limit}; ask again in {retry_after_s:.0f} s or later"
        )
        self.limit = limit
        self.retry_after_s = retry_after_s


class ServiceUnavailable(ServiceError):
    """The client cannot reach the service, or got an answer that is no document of ours.

    Attributes:
        url: The address asked.
        status_code: HTTP status of the answer, None if there was none.
        retry_after_s: When to ask again [s], as far as the service says so, or None.
    """

    slug = "service-unavailable"
    title = "Service unavailable"
    status = 503
    fields = ("url", "status_code", "retry_after_s")

    def __init__(
        self,
        detail: str,
        *,
        url: str = "",
        status_code: int | None = None,
        retry_after_s: float | None = None,
    ) -> None:
        super().__init__(detail)
        self.url = url
        self.status_code = status_code
        self.retry_after_s = retry_after_s


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
