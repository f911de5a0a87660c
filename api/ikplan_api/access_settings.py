"""Settings of who may ask, and how often."""

from __future__ import annotations

import ipaddress
import re
from typing import Annotated, Any, NamedTuple

import limits
from pydantic import BeforeValidator, Field, field_validator, model_validator
from pydantic_settings import BaseSettings, NoDecode, SettingsConfigDict

__all__ = ["AccessSettings", "ApiKey", "is_loopback"]

_KEY = re.compile(r"(?:(?P<name>[A-Za-z0-9_.-]{1,64}):)?(?P<hash>[0-9a-fA-F]{64})")
_ORIGIN = re.compile(r"https?://(?:[A-Za-z0-9.-]+|\[[0-9A-Fa-f:.]+\])(?::[0-9]{1,5})?")


class ApiKey(NamedTuple):
    """A key that is known here.

    Attributes:
        name: What logs and metrics call its owner.
        hash: SHA-256 of the key, hexadecimal.
    """

    name: str
    hash: str


def is_loopback(host: str) -> bool:
    """Whether only this machine reaches a server that listens on ``host``."""
    try:
        address = ipaddress.ip_address(host.strip("[]"))
    except ValueError:
        return host.lower() == "localhost"
    mapped = getattr(address, "ipv4_mapped", None)
    return (mapped or address).is_loopback


def _parts(value: Any) -> Any:
    """An environment variable's list: separated by commas."""
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
            # The part itself is not repeated: it may be a key, set here by mistake.
            raise ValueError(
                f"entry {i + 1} is not a SHA-256 of 64 hexadecimal digits, with or without a "
                "name before it (name:hash); `ikplan keys new` makes one"
            )
        keys.append(ApiKey(found["name"] or f"key-{i + 1}", found["hash"].lower()))
    if len({key.name for key in keys}) < len(keys):
        raise ValueError("two keys have the same name")
    return tuple(keys)


class AccessSettings(BaseSettings):
    """Who may ask, and how often."""

    model_config = SettingsConfigDict(frozen=True)

    host: str = Field("127.0.0.1", description="Address to listen on.")
    api_keys: Annotated[tuple[ApiKey, ...], NoDecode, BeforeValidator(_keys)] = Field(
        (),
        description="Hashes of the keys of those who may ask, separated by commas, each with or "
        "without a `name:` before it.",
    )
    rate_limit: str = Field(
        "1200/minute",
        description="Requests of each key; more are refused with 429. Empty: no limit.",
    )
    cors_origins: Annotated[tuple[str, ...], NoDecode, BeforeValidator(_parts)] = Field(
        (),
        description="Origins whose web pages may ask, such as `https://cell.example`, separated by "
        "commas; `*` is refused.",
    )

    @field_validator("rate_limit")
    @classmethod
    def _a_rate(cls, value: str) -> str:
        if value.strip():
            try:
                item = limits.parse(value)
            except ValueError as error:
                raise ValueError(f"{error}; a rate is such as 1200/minute or 20/second") from error
            if item.amount < 1:
                raise ValueError("at least 1 request has to be allowed; empty: no limit")
        return value.strip()

    @field_validator("cors_origins")
    @classmethod
    def _named_origins(cls, value: tuple[str, ...]) -> tuple[str, ...]:
        for origin in value:
            if not _ORIGIN.fullmatch(origin):
                raise ValueError(
                    f"{origin[:200]!r} is not one origin such as https://cell.example:8443; "
                    "'*' would let every page that anybody visits ask from their browser"
                )
        return value

    @model_validator(mode="after")
    def _keys_beyond_loopback(self) -> AccessSettings:
        if not self.api_keys and not is_loopback(self.host):
            raise ValueError(
                f"others can reach {self.host or 'every address'} (IKPLAN_HOST), so "
                "IKPLAN_API_KEYS must hold the hash of at least one key; `ikplan keys new` makes "
                "one. Or listen on 127.0.0.1"
            )
        return self
