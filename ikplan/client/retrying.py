"""Whether to ask again, and when: for both clients."""

from __future__ import annotations

import httpx
from httpx_retries import Retry

__all__ = ["Patience"]

_STATUSES = (429, 503)
_FAILURES = (httpx.NetworkError, httpx.ConnectTimeout, httpx.RemoteProtocolError)
"""The connection failed. Whatever was asked, it can be asked again: the same request has the same
answer."""
_BACKOFF_S = 0.2
_LONGEST_S = 60.0


class Patience:
    """How often a request is tried again.

    Args:
        retries: Most times to ask again.
    """

    def __init__(self, retries: int) -> None:
        self._retry = Retry(
            total=retries,
            status_forcelist=_STATUSES,
            retry_on_exceptions=_FAILURES,
            backoff_factor=_BACKOFF_S,
        )

    def wait_s(self, outcome: httpx.Response | Exception) -> float | None:
        """Tell how long to wait before asking again.

        Args:
            outcome: The answer, or what happened instead of one.

        Returns:
            The time [s], not shorter than the service asks for; None: do not ask again.
        """
        retry = self._retry
        if retry.is_exhausted():
            return None
        self._retry = retry.increment()
        if isinstance(outcome, Exception):
            retries = retry.is_retryable_exception(outcome)
            return self._retry.backoff_strategy() if retries else None
        if not retry.is_retryable_status_code(outcome.status_code):
            return None
        return self._asked_for(outcome)

    def _asked_for(self, response: httpx.Response) -> float | None:
        """The time that the service asks for; None: longer than anybody waits."""
        try:
            asked_s = self._retry.parse_retry_after(response.headers["retry-after"])
        except (KeyError, ValueError):
            return self._retry.backoff_strategy()
        return asked_s if asked_s <= _LONGEST_S else None
