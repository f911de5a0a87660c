"""A small interpreter of RAPID: as much of the language as a module of timed joint moves needs.

It plays as the manual describes: moves linear in the joints in the time that is given, corners
parabolas in zones, a zone no larger than half of the way to the nearest point. Numbers are held in
single precision, as RAPID holds them. What the manual leaves open is taken as the certificate
names it: zones in time, and half of the way of the first and of the last move for its ramp.
"""

from __future__ import annotations

import re
from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from benchmarks.programs.blending import Motion, played
from benchmarks.programs.urscript import ScriptError

__all__ = ["play"]

Array = NDArray[np.float64]

_MODULE = re.compile(r"MODULE ([A-Za-z]\w{0,31})")
_PROC = re.compile(r"(?:LOCAL )?PROC ([A-Za-z]\w{0,31})\(\)")
_ZONE = re.compile(r"LOCAL CONST zonedata ([A-Za-z]\w{0,31}):=\[FALSE,([^\]]*)\];")
_CALL = re.compile(r"([A-Za-z]\w{0,31});")
_MOVE = re.compile(
    r"MoveAbsJ \[\[([^\]]*)\],\[9E9,9E9,9E9,9E9,9E9,9E9\]\]\\NoEOffs,v\d+(?:\\T:=([0-9.]+))?,"
    r"(fine|[A-Za-z]\w*),tool0;"
)
_NUMBER = re.compile(r"-?\d+(?:\.\d+)?")
_LONGEST_LINE = 512


def play(program: str, cycle: float, way: Callable[[Array, Array], float]) -> Motion:
    """Run a module's first routine.

    Args:
        program: The text.
        cycle: The controller's cycle [s].
        way: How far the tool moves between two points [mm].

    Raises:
        ScriptError: It does not parse, or does what this interpreter knows no answer to.
    """
    routines, zones = _parsed(program)
    moves = [found for line in _run(next(iter(routines)), routines) for found in [_move(line)]]
    points = np.array([move[0] for move in moves])
    if moves[0][1] is not None or moves[0][2] != "fine" or moves[-1][2] != "fine":
        raise ScriptError("the motion does not begin and end at rest")
    steps = np.array([move[1] if move[1] is not None else np.nan for move in moves[1:]])
    if np.isnan(steps).any() or (steps <= 0.0).any():
        raise ScriptError("a move without a time")
    for k, (_, _, zone) in enumerate(moves[1:-1], start=1):
        if zone == "fine":
            raise ScriptError("a stop on the way")
        nearest = min(way(points[k - 1], points[k]), way(points[k], points[k + 1]))
        if zones[zone][0] < nearest / 2.0:
            raise ScriptError("the zone is smaller than half of the way to the nearest point")
    return played(points, steps, cycle)


def _parsed(program: str) -> tuple[dict[str, list[str]], dict[str, list[float]]]:
    routines: dict[str, list[str]] = {}
    zones: dict[str, list[float]] = {}
    body: list[str] | None = None
    lines = [raw.partition("!")[0].strip() for raw in program.split("\n")]
    lines = [line for line in lines if line]
    if not lines or not _MODULE.fullmatch(lines[0]) or lines[-1] != "ENDMODULE":
        raise ScriptError("not a module")
    for line in lines[1:-1]:
        if len(line) > _LONGEST_LINE:
            raise ScriptError("a line is too long")
        if found := _PROC.fullmatch(line):
            body = routines[found[1]] = []
        elif line == "ENDPROC":
            body = None
        elif found := _ZONE.fullmatch(line):
            zones[found[1]] = [_number(text) for text in found[2].split(",")]
        elif body is None:
            raise ScriptError(f"outside of a routine: {line}")
        else:
            body.append(line)
    if body is not None or not routines:
        raise ScriptError("a routine without an end, or none at all")
    return routines, zones


def _run(name: str, routines: dict[str, list[str]]) -> list[str]:
    found: list[str] = []
    for line in routines[name]:
        call = _CALL.fullmatch(line)
        found += _run(call[1], routines) if call is not None else [line]
    return found


def _move(line: str) -> tuple[list[float], float | None, str]:
    found = _MOVE.fullmatch(line)
    if found is None:
        raise ScriptError(f"no such instruction: {line}")
    values = [_number(text) for text in found[1].split(",")]
    if len(values) != 6:
        raise ScriptError("a point has six joint values")
    return values, None if found[2] is None else _number(found[2]), found[3]


def _number(text: str) -> float:
    if not _NUMBER.fullmatch(text):
        raise ScriptError(f"not a number: {text}")
    return float(np.float32(text))
