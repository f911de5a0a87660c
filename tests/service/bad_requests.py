"""Wrong requests, each with the error it gets: the same in Python, in the shell and over HTTP."""

from __future__ import annotations

import copy
import math
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any

from ikplan import InvalidRequest, RobotNotFound, Unreachable
from ikplan.errors import IkplanError

GOOD: dict[str, Any] = {
    "robot": "iiwa14",
    "start": [0.0, 0.52, 0.0, -1.57, 0.0, 1.05, 0.0],
    "path": {
        "waypoints": [
            {"position": [0.6, 0.0, 0.4], "quaternion_xyzw": [0.0, 1.0, 0.0, 0.0]},
            {"position": [0.6, 0.1, 0.4]},
        ]
    },
    "sampling": {"rate_hz": 100},
}


def changed(*path: str | int, to: Any) -> dict[str, Any]:
    """The good request with one value replaced or added."""
    document = copy.deepcopy(GOOD)
    place: Any = document
    for key in path[:-1]:
        place = place.setdefault(key, {}) if isinstance(place, dict) else place[key]
    place[path[-1]] = to
    return document


@dataclass(frozen=True)
class Bad:
    """A wrong request.

    Attributes:
        name: What is wrong.
        document: The request.
        error: The class of the error.
        words: Words that its detail must have.
        data: Data that the error must carry.
        check: A further check of the error.
    """

    name: str
    document: Any
    error: type[IkplanError]
    words: tuple[str, ...] = ()
    data: dict[str, Any] = field(default_factory=dict)
    check: Callable[[Any], bool] = lambda _: True


def helix(radius: float, rise: float, x: float, z: float) -> list[dict[str, Any]]:
    """The 20 points of a helix about a vertical axis, the tool's z along +y of the base."""
    s = math.sqrt(0.5)
    points = []
    for k in range(20):
        a = 4 * math.pi * k / 19
        point = [x + radius * math.cos(a), radius * math.sin(a), z + rise * k / 19]
        points.append({"position": point, "quaternion_xyzw": [0.0, s, s, 0.0]})
    return points


BAD = [
    Bad(
        "unknown robot", changed("robot", to="iiwa41"), RobotNotFound, ("iiwa41", "iiwa14"),
        check=lambda e: "iiwa14" in e.near and "panda" in e.valid,
    ),
    Bad(
        "a robot that is a path", changed("robot", to="../../etc/passwd"), RobotNotFound,
    ),
    Bad(
        "unknown field", changed("tolerence", to=1), InvalidRequest, ("tolerence", "unknown"),
        {"field": "tolerence"},
    ),
    Bad(
        "unknown field, deep", changed("path", "waypoints", 1, "positon", to=[0, 0, 0]),
        InvalidRequest, ("did you mean 'position'",), {"field": "path.waypoints[1].positon"},
    ),
    Bad(
        "no path", {"robot": "iiwa14"}, InvalidRequest, ("required",), {"field": "path"},
    ),
    Bad(
        "wrong number of joints", changed("start", to=[0.0] * 6), InvalidRequest, ("7", "6"),
        {"field": "start"},
    ),
    Bad(
        "a quaternion that is not unit",
        changed("path", "waypoints", 0, "quaternion_xyzw", to=[0.0, 1.0, 0.0, 0.1]),
        InvalidRequest, ("unit", "1.00499"), {"field": "path.waypoints[0].quaternion_xyzw"},
    ),
    Bad(
        "start outside limits", changed("start", to=[0.0, 2.2, 0.0, -1.57, 0.0, 1.05, 0.0]),
        InvalidRequest, ("A2",), check=lambda e: e.field.startswith("start"),
    ),
    Bad(
        "empty path", changed("path", "waypoints", to=[]), InvalidRequest, ("at least 1",),
        {"field": "path.waypoints"},
    ),
    Bad(
        "a waypoint out of reach", changed("path", "waypoints", 1, "position", to=[2.0, 0.0, 0.4]),
        Unreachable, ("1", "mm"), {"waypoint": 1},
        check=lambda e: 0.5 < e.position_error < 1.5 and len(e.q) == 7 and e.reason,
    ),
    Bad(
        "the published helix", changed("path", "waypoints", to=helix(0.20, 0.50, 0.60, 0.10)),
        Unreachable, ("mm",),
        check=lambda e: {w["waypoint"] for w in e.waypoints} == {0, 18, 19} and e.reason,
    ),
    Bad(
        "100,001 waypoints",
        changed("path", "waypoints", to=[{"position": [0.6, 0.0, 0.4]}] * 100_001),
        InvalidRequest, ("at most 20000",), {"field": "path.waypoints"},
    ),
    Bad(
        "rate of 0", changed("sampling", "rate_hz", to=0), InvalidRequest, (),
        {"field": "sampling.rate_hz"},
    ),
    Bad(
        "rate of 1 MHz", changed("sampling", "rate_hz", to=1e6), InvalidRequest, (),
        {"field": "sampling.rate_hz"},
    ),
    Bad(
        "unknown solver", changed("ik", "method", to="ik-bat"), InvalidRequest, ("ik-ba",),
        {"field": "ik.method"},
    ),
    Bad(
        "unknown parameter", changed("ik", "params", to={"alhpa": 1.0}), InvalidRequest,
        ("alpha",), {"field": "ik.params.alhpa"},
    ),
    Bad(
        "a number too large to be one", changed("budget_s", to=10**400), InvalidRequest,
    ),
    Bad("a list", [GOOD], InvalidRequest, ("object",)),
]  # fmt: skip

NOT_FINITE = [
    Bad(
        f"{name} at {'.'.join(map(str, path))}", changed(*path, to=value), InvalidRequest,
    )
    for name, value in (("NaN", math.nan), ("Infinity", math.inf), ("-Infinity", -math.inf))
    for path in (("start", 3), ("path", "waypoints", 0, "position", 1), ("budget_s",))
]  # fmt: skip

NOT_JSON = [
    ("a key given twice", b'{"robot": "ur5", "robot": "iiwa14"}'),
    ("empty", b""),
    ("cut", b'{"robot": "iiwa14", "path": {'),
    ("single quotes", b"{'robot': 'iiwa14'}"),
    ("not UTF-8", b'{"robot": "\xff"}'),
    ("nested too deeply", b"[" * 100_000),
    ("a number with too many digits", b'{"robot": "iiwa14", "budget_s": ' + b"9" * 5000 + b"}"),
    ("NaN", b'{"robot": "iiwa14", "budget_s": NaN}'),
    ("overflowing", b'{"robot": "iiwa14", "budget_s": 1e999}'),
]
