"""YAML text, read by libyaml where it is there: the same content, ten times as fast."""

from __future__ import annotations

from typing import Any

import yaml

__all__ = ["load_yaml"]

_LOADER = getattr(yaml, "CSafeLoader", yaml.SafeLoader)


def load_yaml(text: str | bytes) -> Any:
    """Return the content of a YAML document: plain data, no objects.

    Args:
        text: The document.

    Raises:
        YAMLError: Not YAML; names line and column.
        RecursionError: Nested too deep.
    """
    return yaml.load(text, Loader=_LOADER)
