"""What goes over the wire and comes back, for both clients: no input or output of its own."""

from __future__ import annotations

import contextlib
import json
import os
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Generic, TypeVar

import httpx
import numpy as np
from pydantic import BaseModel, ValidationError

from ikplan._version import __version__
from ikplan.errors import IkplanError, InvalidRequest, ServiceUnavailable, error_from_problem
from ikplan.scene.mesh_files import without_mesh_files

__all__ = [
    "EVENTS",
    "KEY_VARIABLE",
    "PROBLEM",
    "Call",
    "client_headers",
    "encode",
    "read",
    "unreachable",
]

T = TypeVar("T")

PROBLEM = "application/problem+json"
EVENTS = {"accept": f"text/event-stream, {PROBLEM}", "cache-control": "no-store"}
"""Headers of a request for events."""
KEY_VARIABLE = "IKPLAN_KEY"


def client_headers(base_url: str, key: str | None) -> dict[str, str]:
    """Return what a client says with every request.

    Args:
        base_url: Address of the service.
        key: The key to show; None: the one in the environment, if there is one.

    Raises:
        InvalidRequest: The key cannot be sent in a header.
    """
    headers = {"user-agent": f"ikplan/{__version__}"}
    if httpx.URL(base_url).host in ("127.0.0.1", "::1", "localhost"):
        headers["accept-encoding"] = "identity"  # compressing takes longer than this wire
    key = os.environ.get(KEY_VARIABLE, "") if key is None else key
    if key:
        if not (key.isascii() and key.isprintable()) or " " in key:
            raise InvalidRequest("a key is printable ASCII without spaces", field="key")
        headers["authorization"] = f"Bearer {key}"
    return headers


@dataclass(frozen=True)
class Call(Generic[T]):
    """One exchange with the service.

    Attributes:
        method: HTTP method.
        path: Path below the service's address.
        read: From the body of the answer to what the caller gets.
        content: Body of the request, or None.
        unfinished: From the body of the answer 202 to what the caller gets; None: as ``read``.
        prefer: The header ``Prefer``, or None.
    """

    method: str
    path: str
    read: Callable[[bytes], T]
    content: bytes | None = None
    unfinished: Callable[[bytes], T] | None = None
    prefer: str | None = None

    @property
    def headers(self) -> dict[str, str]:
        """Headers of the request."""
        headers = {
            "accept": f"application/json, {PROBLEM}",
        }
        if self.content is not None:
            headers["content-type"] = "application/json"
        if self.prefer is not None:
            headers["prefer"] = self.prefer
        return headers


def encode(document: Mapping[str, Any] | BaseModel) -> bytes:
    """Write a request as JSON, arrays as lists, without judging it: that is the service's part.

    Meshes in files are read, relative to the working folder, and sent as their convex hulls.

    Raises:
        InvalidRequest: It holds NaN or an infinity, or something that JSON cannot hold; or a mesh
            cannot be read.
    """
    if isinstance(document, BaseModel):
        document = document.model_dump(mode="json", exclude_unset=True)
    if not isinstance(document, Mapping):
        raise InvalidRequest(
            f"a request is a JSON object, not {type(document).__name__}", allowed="an object"
        )
    _refuse_not_finite(document, "")
    document = without_mesh_files(document, Path.cwd())
    try:
        return json.dumps(dict(document), allow_nan=False, default=_plain).encode()
    except (TypeError, ValueError, RecursionError) as error:
        raise InvalidRequest(
            f"the request cannot be written as JSON: {error}", allowed="a JSON object"
        ) from error


def _plain(value: Any) -> Any:
    """What JSON holds in place of an array, a numpy scalar, a mapping or a model."""
    if isinstance(value, np.ndarray | np.generic):
        return value.tolist()
    if isinstance(value, BaseModel):
        # Only what was set: defaults are the service's to fill in.
        return value.model_dump(mode="json", exclude_unset=True)
    if isinstance(value, Mapping):
        return dict(value)
    raise TypeError(f"{type(value).__name__} is not JSON")


def _refuse_not_finite(value: Any, field: str, depth: int = 0) -> None:
    """Name the field of a NaN, which JSON has no way to send for the service to refuse."""
    if isinstance(value, float | np.floating):
        if not np.isfinite(value):
            raise InvalidRequest(
                f"{field}: NaN and infinities are not numbers a robot can follow",
                field=field,
                allowed="a finite number",
            )
    elif isinstance(value, np.ndarray):
        if value.dtype.kind == "f" and not np.isfinite(value).all():
            place = "".join(f"[{i}]" for i in np.argwhere(~np.isfinite(value))[0])
            _refuse_not_finite(float("nan"), field + place)
    elif depth > 50:  # deeper than any request; json finds what is circular
        return
    elif isinstance(value, Mapping):
        for key, item in value.items():
            _refuse_not_finite(item, f"{field}.{key}" if field else str(key), depth + 1)
    elif isinstance(value, list | tuple):
        for i, item in enumerate(value):
            _refuse_not_finite(item, f"{field}[{i}]", depth + 1)


def read(call: Call[T], response: httpx.Response) -> T:
    """Return what the answer says.

    Raises:
        IkplanError: The service's own verdict, as the class that a local call would raise.
        ServiceUnavailable: The answer is no document of ours.
    """
    url, status = str(response.request.url), response.status_code
    if not response.is_success:
        raise _verdict(response, url)
    try:
        unfinished = call.unfinished if status == 202 else None
        return (unfinished or call.read)(response.content)
    except (ValidationError, ValueError, TypeError, KeyError) as error:
        raise ServiceUnavailable(
            f"{url} answered something else than expected: is it an ikplan service?",
            url=url,
            status_code=status,
        ) from error


def _verdict(response: httpx.Response, url: str) -> IkplanError:
    status = response.status_code
    error: IkplanError | None = None
    media_type = response.headers.get("content-type", "").partition(";")[0].strip().lower()
    if media_type == PROBLEM:
        with contextlib.suppress(ValueError, TypeError, AttributeError):
            problem = response.json()
            error = error_from_problem(problem, url=url)
            ours = isinstance(problem.get("type"), str) and problem["type"].startswith(
                "urn:ikplan:"
            )
            if isinstance(error, ServiceUnavailable) and ours:
                # A type of ours whose data made no sense comes back as this class as well.
                error = error if problem["type"] == error.problem_type() else None
        if isinstance(error, ServiceUnavailable):
            error.url = url  # the service cannot know by which address it is reached
            error.status_code = error.status_code or status
        if error is not None:
            return error
    return ServiceUnavailable(
        f"{url} answered {status} {response.reason_phrase}".rstrip() + " without a reason of ours",
        url=url,
        status_code=status,
    )


def unreachable(error: Exception, url: str) -> ServiceUnavailable:
    """Return the error of an exchange that did not happen."""
    if isinstance(error, httpx.TimeoutException):
        reason = "no answer in time"
    elif isinstance(error, httpx.InvalidURL | httpx.UnsupportedProtocol):
        reason = f"not an address: {error}"
    else:
        reason = str(error) or type(error).__name__
    return ServiceUnavailable(f"cannot reach {url}: {reason}", url=url)
