"""Settings of access control: address, API keys, rate limit, CORS."""

from __future__ import annotations

import ipaddress
import re
from typing import Annotated, Any, Literal, NamedTuple, get_args

import limits
from pydantic import BeforeValidator, Field, field_validator, model_validator
from pydantic_settings import BaseSettings, NoDecode, SettingsConfigDict

__all__ = ["AccessSettings", "ApiKey", "Role", "is_loopback"]

_KEY = re.compile(
    r"(?:(?P<name>[A-Za-z0-9_.-]{1,64}):)?(?P<hash>[0-9a-fA-F]{64})(?P<options>(;[a-z]+=[^;]*)*)"
)
Role = Literal["planner", "reader", "auditor", "monitor"]
_ROLES: tuple[Role, ...] = get_args(Role)
_HOST = re.compile(r"[A-Za-z0-9_]([A-Za-z0-9_.-]*[A-Za-z0-9_])?")
_ORIGIN = re.compile(r"https?://(?:[A-Za-z0-9.-]+|\[[0-9A-Fa-f:.]+\])(?::[0-9]{1,5})?")


class ApiKey(NamedTuple):
    """A configured API key.

    Attributes:
        name: Name of its owner in logs.
        hash: SHA-256 of the key, hexadecimal.
        role: What it may do: ``planner``: all with what is its own; ``reader``: read that;
            ``auditor``: read that, and who planned what; ``monitor``: the metrics only.
        rate: Its rate limit; None: that of all keys.
        jobs: Most accepted and unfinished jobs; None: no limit.
    """

    name: str
    hash: str
    role: Role = "planner"
    rate: str | None = None
    jobs: int | None = None


def _is_address(host: str) -> bool:
    try:
        ipaddress.ip_address(host)
    except ValueError:
        return False
    return True


def is_loopback(host: str) -> bool:
    """Whether only this machine reaches a server that listens on ``host``."""
    try:
        address = ipaddress.ip_address(host.strip("[]"))
    except ValueError:
        return host.lower() == "localhost"
    mapped = getattr(address, "ipv4_mapped", None)
    return (mapped or address).is_loopback


def _parts(value: Any) -> Any:
    """Split the comma-separated list of an environment variable."""
    if isinstance(value, str):
        return [part.strip() for part in value.split(",") if part.strip()]
    return value


def _keys(value: Any) -> Any:
    keys = []
    for i, part in enumerate(_parts(value)):
        if isinstance(part, ApiKey):
            keys.append(part)
            continue
        found = _KEY.fullmatch(str(part))
        if found is None:
            # The message does not repeat the entry: it may be a key instead of its hash.
            raise ValueError(
                f"entry {i + 1} is not a SHA-256 hash of 64 hexadecimal digits, with or without a "
                "name before it (name:hash); create one with `ikplan keys new`"
            )
        key = ApiKey(found["name"] or f"key-{i + 1}", found["hash"].lower())
        keys.append(key._replace(**_options(found["options"], f"entry {i + 1}")))
    if len({key.name for key in keys}) < len(keys):
        raise ValueError("two keys have the same name")
    return tuple(keys)


def _options(text: str, where: str) -> dict[str, Any]:
    """Read the options of a key, such as ``;role=reader;jobs=100``."""
    options: dict[str, Any] = {}
    for part in text.split(";")[1:]:
        name, _, value = part.partition("=")
        if name == "role" and value in _ROLES:
            options[name] = value
        elif name == "rate":
            options[name] = _rate(value)
        elif name == "jobs" and value.isdecimal() and len(value) < 10:
            options[name] = int(value)
        else:
            raise ValueError(
                f"{where}: {part[:100]!r} is no option of a key; allowed are "
                f"role={'|'.join(_ROLES)}, rate=1200/minute and jobs=100"
            )
    return options


def _rate(value: str) -> str:
    """Return a rate limit as it is given, stripped."""
    try:
        item = limits.parse(value)
    except ValueError as error:
        raise ValueError(f"{error}; give a rate such as 1200/minute or 20/second") from error
    if item.amount < 1:
        raise ValueError("the limit must be at least 1 request; empty: no limit")
    return value.strip()


class AccessSettings(BaseSettings):
    """Settings of access control."""

    model_config = SettingsConfigDict(frozen=True)

    host: str = Field("127.0.0.1", description="Address to listen on.")
    api_keys: Annotated[tuple[ApiKey, ...], NoDecode, BeforeValidator(_keys)] = Field(
        (),
        description="Hashes of the accepted API keys, separated by commas, each optionally with a "
        "`name:` before it and options after it: `;role=reader;rate=60/minute;jobs=100`.",
    )
    shared_store: bool = Field(
        False,
        description="1: all keys share plans, jobs, robots and scenes. 0: each key has its own, "
        "but in a file that was begun by a version without this setting.",
    )
    rate_limit: str = Field(
        "1200/minute",
        description="Rate limit of each key; further requests are refused with 429. Empty: no "
        "limit.",
    )
    cors_origins: Annotated[tuple[str, ...], NoDecode, BeforeValidator(_parts)] = Field(
        (),
        description="Origins whose web pages may use the service, such as `https://cell.example`, "
        "separated by commas; `*` is not allowed.",
    )

    hosts: Annotated[tuple[str, ...], NoDecode, BeforeValidator(_parts)] = Field(
        (),
        description="Names or addresses under which clients ask for the service, separated by "
        "commas; others are refused with 403. None: with API keys any, else loopback names only.",
    )

    def job_quota(self, owner: str) -> int | None:
        """Return the most accepted and unfinished jobs of an owner; None: no limit."""
        return next((key.jobs for key in self.api_keys if key.name == owner), None)

    @field_validator("hosts")
    @classmethod
    def _names_of_hosts(cls, value: tuple[str, ...]) -> tuple[str, ...]:
        for host in value:
            if not _HOST.fullmatch(host) and not _is_address(host.strip("[]")):
                raise ValueError(
                    f"{host[:200]!r} is not a host name or address such as cell.example; leave out "
                    "the scheme and the port, and name each host"
                )
        return tuple(host.lower().strip("[]") for host in value)

    @field_validator("rate_limit")
    @classmethod
    def _a_rate(cls, value: str) -> str:
        return _rate(value) if value.strip() else ""

    @field_validator("cors_origins")
    @classmethod
    def _named_origins(cls, value: tuple[str, ...]) -> tuple[str, ...]:
        for origin in value:
            if not _ORIGIN.fullmatch(origin):
                raise ValueError(
                    f"{origin[:200]!r} is not an origin such as https://cell.example:8443; '*' "
                    "would allow every web page to send requests from its visitors' browsers"
                )
        return value

    @model_validator(mode="after")
    def _keys_beyond_loopback(self) -> AccessSettings:
        if not self.api_keys and not is_loopback(self.host):
            raise ValueError(
                f"other machines can reach {self.host or 'every address'} (IKPLAN_HOST), so "
                "IKPLAN_API_KEYS must contain the hash of at least one key; create one with "
                "`ikplan keys new`, or listen on 127.0.0.1"
            )
        return self
