"""A service refuses the request, or fails at it."""

from __future__ import annotations

from ikplan.errors.base import IkplanError

__all__ = [
    "AccessDenied",
    "MemoryExceeded",
    "RateLimited",
    "ServiceError",
    "ServiceUnavailable",
    "WorkerLost",
]


class ServiceError(IkplanError):
    """A service refuses the request, or fails at it: a group, to be caught."""


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
