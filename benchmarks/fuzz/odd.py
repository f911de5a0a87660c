"""Values that parsers trip over."""

from __future__ import annotations

from typing import Any

__all__ = ["ODD_NUMBERS", "ODD_TEXTS", "ODD_VALUES"]

ODD_NUMBERS: tuple[str, ...] = (
    "0", "-0", "-0.0", "1", "-1", "1e308", "-1e308", "1e309", "1e-320", "4.9e-324", "nan", "inf",
    "-inf", "NaN", "Infinity", "1_0", "0x10", "+1", " 1 ", "1,5", "1.", ".5", "1e", "\u0663", "--1",
    "9" * 25, "9" * 5000, "0." + "0" * 5000 + "1", str(2**63), str(-(2**63) - 1), str(2**31),
)  # fmt: skip
"""Texts that are numbers to some readers and none to others."""

ODD_TEXTS: tuple[str, ...] = (
    "", " ", "\0", "\n", "\u2028", "\ufeff", "\u202e", "e\u0301", "\U0001f916", "\x7f", "x" * 300,
    "x" * 100_000, "../../etc/passwd", "file:///etc/passwd", "package://x/../../y", "%2e%2e/",
    "${jndi:x}", "{0}{1}", "%s%n", "'; DROP TABLE plans; --", "<a/>", "&amp;", "]]>", "true",
    "null", "scene-0", "urdf-" + "0" * 32, "\ud800",
)  # fmt: skip
"""Texts that are no good names."""


def _nested(depth: int) -> Any:
    value: Any = 0
    for level in range(depth):
        value = [value] if level % 2 else {"a": value}
    return value


ODD_VALUES: tuple[Any, ...] = (
    None, True, False, 0, -1, 1, 3, 0.5, -0.0, 1e308, -1e308, 5e-324, float("nan"), float("inf"),
    2**53 + 1, 2**63, 10**30, -(10**400), [], {}, [[]], [None], [0.0] * 3, [0.0] * 7, [1e200] * 6,
    [0.0] * 10_000, {"type": "box"}, {"": 0}, _nested(20), _nested(300), *ODD_TEXTS,
)  # fmt: skip
"""Values of every kind of JSON."""
