"""Settings of the service, from environment variables such as ``IKPLAN_PORT=9000``."""

from __future__ import annotations

import os
from collections.abc import Mapping
from typing import Literal

from pydantic import Field, ValidationError, field_validator
from pydantic_settings import SettingsConfigDict

from ikplan.errors import InvalidRequest, near_names
from ikplan.robots.urdf.safe_xml import MAX_BYTES
from ikplan.workers.processors import processor_count
from ikplan_api.settings.access import AccessSettings

__all__ = ["Settings", "load_settings", "unknown_variables"]

_PREFIX = "IKPLAN_"
_LEAST_WORKER_BYTES = 768 * 2**20
_OTHERS = ("CACHE_DIR", "COMPILE_AHEAD", "KERNELS", "KEY", "ROBOTS_PATH", "SERVER")
"""Variables of the library and of the client."""


def _data_file() -> str:
    """Return the default store file, in the user's data folder."""
    data = os.environ.get("XDG_DATA_HOME") or os.path.join(os.path.expanduser("~"), ".local/share")
    return os.path.join(data, "ikplan", "service.sqlite3")


class Settings(AccessSettings):
    """Settings of the service, each an environment variable ``IKPLAN_<NAME>``."""

    model_config = SettingsConfigDict(env_prefix=_PREFIX, frozen=True)

    port: int = Field(8000, ge=0, le=65535, description="Port to listen on; 0: any free one.")
    workers: int = Field(
        0,
        ge=0,
        le=1024,
        description="Number of worker processes; 0: one for each processor that the container or "
        "machine allows.",
    )
    max_queued: int = Field(
        64,
        ge=0,
        description="Requests that may wait for a worker; further ones are refused with 503.",
    )
    max_wait_s: float = Field(
        60.0,
        gt=0,
        le=3600,
        description="Longest time that a request waits for a worker [s]; then it is refused with "
        "503. Jobs and batches wait on.",
    )
    worker_memory_bytes: int = Field(
        2 * 2**30,
        ge=0,
        description="Private memory that a worker may allocate [bytes]; 0: no limit, else at least "
        "768 MiB. A new worker uses 0.4 GB.",
    )
    grace_s: float = Field(
        2.0,
        ge=0,
        le=60,
        description="Time beyond its budget in which a plan may end by itself [s].",
    )
    stop_s: float = Field(
        20.0,
        ge=0,
        le=3600,
        description="Time for plans in progress to finish during a shutdown [s].",
    )
    header_s: float = Field(
        10.0, gt=0, le=600, description="Time for a client to send the header of a request [s]."
    )
    body_s: float = Field(
        30.0,
        gt=0,
        le=3600,
        description="Time for a client to send a body [s]; longer at 16 KiB/s or more.",
    )
    max_connections: int = Field(
        1000,
        ge=8,
        description="Largest number of connections; fewer if the process may not open as many "
        "files.",
    )
    max_connections_per_address: int = Field(
        500, ge=4, description="Largest number of connections of one address."
    )
    max_body_bytes: int = Field(
        8 * 2**20,
        ge=1024,
        description="Largest request body [bytes]; larger ones are refused with 413.",
    )
    max_budget_s: float = Field(
        3600.0,
        gt=0,
        le=3600,
        description="Upper limit of every request's `budget_s` [s].",
    )
    max_batch_bytes: int = Field(64 * 2**20, ge=1024, description="Largest batch [bytes].")
    max_batch_lines: int = Field(10_000, ge=1, description="Largest number of requests in a batch.")
    store_url: str = Field(
        "",
        repr=False,
        description="Database of several replicas, `postgresql://user@host/database`; empty: the "
        "file IKPLAN_STORE_PATH, for one service.",
    )
    object_store_url: str = Field(
        "",
        repr=False,
        description="Where long plans of the database are, an address that fsspec knows such as "
        "`s3://bucket/plans`; empty: in the database.",
    )
    object_bytes: int = Field(
        2**20,
        ge=0,
        description="Size of a compressed plan above which it is in the object store [bytes].",
    )
    lease_s: float = Field(
        10.0,
        ge=1,
        le=600,
        description="Time after which another replica takes over a job of one that is gone [s].",
    )
    max_jobs: int = Field(
        10_000, ge=1, description="Jobs that may wait in the database; further ones get 503."
    )
    store_path: str = Field(
        default_factory=_data_file,
        min_length=1,
        description="File that stores plans, jobs, robots and scenes; `:memory:`: no file, a "
        "restart loses them.",
    )
    store_damaged: Literal["refuse", "set-aside"] = Field(
        "refuse",
        description="What to do if the file of the store is damaged: `refuse` to start, or "
        "`set-aside`: rename it and start a new one.",
    )
    store_plans: int = Field(10_000, ge=0, description="Largest number of stored plans.")
    store_bytes: int = Field(
        512 * 2**20, ge=0, description="Largest total size of the stored plans [bytes]."
    )
    store_days: float = Field(30.0, gt=0, description="Longest time that a plan is stored [days].")
    max_urdf_bytes: int = Field(
        2**20, ge=1024, le=MAX_BYTES, description="Largest uploaded URDF or SRDF [bytes]."
    )
    store_robots: int = Field(64, ge=1, description="Largest number of stored uploaded robots.")
    store_robot_bytes: int = Field(
        64 * 2**20,
        ge=8 * 2**20,
        description="Largest total size of the stored uploaded robots [bytes].",
    )
    store_scenes: int = Field(256, ge=1, description="Largest number of stored uploaded scenes.")
    store_scene_bytes: int = Field(
        128 * 2**20,
        ge=16 * 2**20,
        description="Largest total size of the stored uploaded scenes [bytes].",
    )
    robot_memory_bytes: int = Field(
        2**30, ge=2**29, description="Memory limit for the build of an uploaded robot [bytes]."
    )
    robot_timeout_s: float = Field(
        20.0, gt=0, le=600, description="Time limit for the build of an uploaded robot [s]."
    )

    log_format: Literal["auto", "json", "text"] = Field(
        "auto",
        description="Log format: `json`, `text` or `auto` (text on a terminal, else JSON).",
    )
    log_level: Literal["debug", "info", "warning", "error"] = Field(
        "info",
        description="Log level: `debug` (includes probes), `info`, `warning` or `error`.",
    )

    @field_validator("store_url")
    @classmethod
    def _a_database(cls, value: str) -> str:
        if value and not value.startswith(("postgresql://", "postgres://")):
            raise ValueError(
                "not a database: give postgresql://user@host:port/database, or leave it empty and "
                "name a file in IKPLAN_STORE_PATH"
            )
        return value

    @field_validator("worker_memory_bytes")
    @classmethod
    def _enough_for_a_worker(cls, value: int) -> int:
        if 0 < value < _LEAST_WORKER_BYTES:
            raise ValueError(
                f"a worker needs {_LEAST_WORKER_BYTES} bytes for its kernels and robots before it "
                "takes a request; give more, or 0 for no limit"
            )
        return value

    @property
    def worker_count(self) -> int:
        """Number of worker processes."""
        return self.workers or processor_count()


def unknown_variables(environment: Mapping[str, str]) -> dict[str, list[str]]:
    """Return the unknown ``IKPLAN_`` variables, each with similar names of settings."""
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
        InvalidRequest: A variable has an invalid value; names the variable.
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
