"""YAML text, read by libyaml where it is there: the same content, ten times as fast."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import yaml

__all__ = ["glance_at_yaml", "load_yaml"]

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


def glance_at_yaml(text: str | bytes) -> dict[str, str | int]:
    """Return texts and lengths of lists of the outermost mapping of a document.

    The whole document is parsed, but nothing else of it is made, in a third of the time. A value
    that is neither a text nor a list is left out, as is a text that is written with a tag.

    Args:
        text: The document.

    Returns:
        By key, a text itself or the number of items of a list.

    Raises:
        YAMLError: Not YAML; names line and column.
    """
    loader = _LOADER(text)
    try:
        return _glance(iter(loader.get_event, None))
    finally:
        loader.dispose()


def _glance(events: Iterator[Any]) -> dict[str, str | int]:
    """Return texts and lengths of lists of the outermost mapping, from the events of a stream."""
    found: dict[str, str | int] = {}
    next(events)  # the stream starts
    if isinstance(next(events), yaml.StreamEndEvent):
        return found
    if not isinstance(next(events), yaml.MappingStartEvent):
        return found
    while not isinstance(key := next(events), yaml.MappingEndEvent):
        if isinstance(key, yaml.CollectionStartEvent):
            _count(events)
        value = next(events)
        items = _count(events) if isinstance(value, yaml.CollectionStartEvent) else 0
        if not isinstance(key, yaml.ScalarEvent):
            continue
        if isinstance(value, yaml.SequenceStartEvent):
            found[key.value] = items
        elif isinstance(value, yaml.ScalarEvent) and _is_text(value):
            found[key.value] = value.value
    next(events)  # the document ends
    # A second document is for the full reader.
    return found if isinstance(next(events), yaml.StreamEndEvent) else {}


def _count(events: Iterator[Any]) -> int:
    """Pass over the rest of a list or a mapping; return how many nodes are directly in it."""
    count, depth = 0, 1
    for event in events:
        if isinstance(event, yaml.CollectionEndEvent):
            depth -= 1
            if depth == 0:
                return count
            continue
        count += depth == 1
        depth += isinstance(event, yaml.CollectionStartEvent)
    return count


def _is_text(scalar: Any) -> bool:
    """Whether a scalar is a text: quoted, or plain and neither a number nor another word."""
    if scalar.tag is not None:
        return False
    if not scalar.implicit[0]:
        return True
    known = yaml.SafeLoader.yaml_implicit_resolvers.get(scalar.value[:1], ())
    return not any(pattern.match(scalar.value) for _, pattern in known)
