"""Settings of the service, from the environment: ``IKPLAN_PORT=9000`` and so on."""

from __future__ import annotations

import os
from collections.abc import Mapping
from typing import Literal

from pydantic import Field, ValidationError
from pydantic_settings import SettingsConfigDict

from ikplan.errors import InvalidRequest, near_names
from ikplan.processors import processor_count
from ikplan.robots.safe_xml import MAX_BYTES
from ikplan_api.access_settings import AccessSettings

__all__ = ["Settings", "load_settings", "unknown_variables"]

_PREFIX = "IKPLAN_"
_OTHERS = ("CACHE_DIR", "KEY", "ROBOTS_PATH")
"""Variables of the library and the client."""


def _data_file() -> str:
    """The file of a user's services, in the user's data folder."""
    data = os.environ.get("XDG_DATA_HOME") or os.path.join(os.path.expanduser("~"), ".local/share")
    return os.path.join(data, "ikplan", "service.sqlite3")


class Settings(AccessSettings):
    """What an operator can set, each as an environment variable ``IKPLAN_<NAME>``."""

    model_config = SettingsConfigDict(env_prefix=_PREFIX, frozen=True)

    port: int = Field(8000, ge=0, le=65535, description="Port to listen on; 0: any free one.")
    workers: int = Field(
        0,
        ge=0,
        le=1024,
        description="Plans made at the same time; 0: one for each processor that the "
        "container or machine allows.",
    )
    max_queued: int = Field(
        64, ge=0, description="Requests that may wait for a worker; more are refused with 503."
    )
    worker_memory_bytes: int = Field(
        2 * 2**30,
        ge=0,
        description="Most memory of its own that a worker may take [bytes]; 0: no limit. A fresh "
        "one takes 0.4 GB.",
    )
    grace_s: float = Field(
        2.0, ge=0, le=60, description="Time that a plan gets beyond its budget to end itself [s]."
    )
    stop_s: float = Field(
        20.0,
        ge=0,
        le=3600,
        description="Time that plans under way get when the service is to stop [s].",
    )
    max_body_bytes: int = Field(
        8 * 2**20,
        ge=1024,
        description="Largest request body, counted as it streams in; then 413 [bytes].",
    )
    max_budget_s: float = Field(
        3600.0,
        gt=0,
        le=3600,
        description="Longest time for a request, whatever its `budget_s` [s].",
    )
    max_batch_bytes: int = Field(64 * 2**20, ge=1024, description="Largest batch [bytes].")
    max_batch_lines: int = Field(10_000, ge=1, description="Most requests of a batch.")
    store_path: str = Field(
        default_factory=_data_file,
        min_length=1,
        description="File that plans and jobs are kept in; `:memory:`: none, a restart forgets.",
    )
    store_plans: int = Field(10_000, ge=0, description="Finished plans kept.")
    store_bytes: int = Field(512 * 2**20, ge=0, description="Size of all plans kept [bytes].")
    store_days: float = Field(30.0, gt=0, description="Longest time that a plan is kept [days].")
    max_urdf_bytes: int = Field(
        2**20, ge=1024, le=MAX_BYTES, description="Largest URDF or SRDF uploaded [bytes]."
    )
    store_robots: int = Field(64, ge=1, description="Uploaded robots kept.")
    store_robot_bytes: int = Field(
        64 * 2**20, ge=8 * 2**20, description="Size of all uploaded robots kept [bytes]."
    )
    robot_memory_bytes: int = Field(
        2**30, ge=2**29, description="Memory for building an uploaded robot [bytes]."
    )
    robot_timeout_s: float = Field(
        20.0, gt=0, le=600, description="Time for building an uploaded robot [s]."
    )

    log_format: Literal["auto", "json", "text"] = Field(
        "auto",
        description="What the log looks like: `json`, `text`, or `auto`: text on a terminal, "
        "else JSON.",
    )
    log_level: Literal["debug", "info", "warning", "error"] = Field(
        "info", description="What is logged: `debug` (probes too), `info`, `warning` or `error`."
    )

    @property
    def worker_count(self) -> int:
        """Plans made at the same time."""
        return self.workers or processor_count()


def unknown_variables(environment: Mapping[str, str]) -> dict[str, list[str]]:
    """Return the variables that look like settings but are none, with those perhaps meant."""
    known = [*map(str.upper, Settings.model_fields), *_OTHERS]
    unknown = {
        name: name.upper().removeprefix(_PREFIX)
        for name in environment
        if name.upper().startswith(_PREFIX)
    }
    return {
        name: [_PREFIX + near for near in near_names(bare, known)]
        for name, bare in unknown.items()
        if bare not in known
    }


def load_settings() -> Settings:
    """Read the settings from the environment.

    Raises:
        InvalidRequest: A variable has a value that is not allowed; names the variable.
    """
    try:
        return Settings()
    except ValidationError as error:
        errors = [
            {
                "field": _PREFIX + "_".join(str(part) for part in e["loc"]).upper()
                if e["loc"]
                else "",
                "detail": str(e["msg"]).removeprefix("Value error, "),
            }
            for e in error.errors(include_url=False, include_input=False)
        ]
        first = errors[0]
        where = f"environment variable {first['field']}" if first["field"] else "settings"
        raise InvalidRequest(
            f"{where}: {first['detail']}", field=first["field"], errors=errors
        ) from error
