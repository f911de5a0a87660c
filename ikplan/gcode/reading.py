"""From a G-code file to a path of lines and arcs, and to a request."""

from __future__ import annotations

import logging
import os
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from ikplan.arrays import Array
from ikplan.documents.path import MAX_SEGMENTS
from ikplan.errors import InvalidRequest
from ikplan.gcode.arcs import Arc
from ikplan.gcode.blocks import fault, read_blocks
from ikplan.gcode.machine import Machine, Move

__all__ = ["Toolpath", "gcode_request", "path_of", "read_gcode", "read_toolpath"]

_UNITS = {"mm": 0.001, "in": 0.0254, "m": 1.0, "cm": 0.01, "um": 1e-6}
# The tool points down in the frame of the program, as a spindle does.
_DOWN = [1.0, 0.0, 0.0, 0.0]
_SHORT = 1e-9
# A helix goes to a spline through points of it; its chords bulge by this much at most [m].
_BULGE = 1e-6
_STEP = 0.17
_log = logging.getLogger("ikplan.gcode")


@dataclass(frozen=True)
class Toolpath:
    """What a G-code file says of the tool's path.

    Attributes:
        begin: Where the tool is before its first move, shape (3,) [m].
        moves: Its moves, those of no length left out.
        notes: What was passed over, in words.
    """

    begin: Array
    moves: list[Move]
    notes: list[str]


def read_toolpath(data: bytes, units: str | None = None) -> Toolpath:
    """Read the moves of a G-code file.

    Args:
        data: The file.
        units: mm, in, m, cm or um, for a file that does not say G20 or G21.

    Raises:
        InvalidRequest: The file is no G-code, or asks for what is not read; names the line.
    """
    if units is not None and units not in _UNITS:
        raise InvalidRequest(
            f"units: {', '.join(_UNITS)} are allowed, not {units!r}",
            field="units",
            allowed=list(_UNITS),
        )
    machine = Machine()
    text = data.decode("utf-8-sig", errors="replace")
    machine.run(read_blocks(text), None if units is None else _UNITS[units])
    if not machine.moves:
        raise InvalidRequest("the file moves nothing", allowed="G0, G1, G2 and G3")
    ends = np.array([move.end for move in machine.moves])
    notes = []
    for k, axis in enumerate("XYZ"):
        known = np.nonzero(~np.isnan(ends[:, k]))[0]
        if not len(known):
            notes.append(f"{axis} has no value: it is 0")
        # An axis is where it is first sent to, until then.
        ends[: known[0] if len(known) else None, k] = ends[known[0], k] if len(known) else 0.0
    begin, moves = ends[0], []
    at = begin
    for move, end in zip(machine.moves[1:], ends[1:], strict=True):
        if move.arc is not None or np.abs(end - at).max() > _SHORT:
            moves.append(Move(move.line, end, move.arc, move.speed))
        at = end
    if machine.moves[0].arc is not None or not moves:
        raise fault(machine.moves[0].line, "the file has no place from which its moves begin")
    if len(moves) > MAX_SEGMENTS:
        raise fault(moves[MAX_SEGMENTS].line, f"more than {MAX_SEGMENTS} moves")
    if machine.passed:
        lines = ", ".join(f"{code} (line {line})" for code, line in machine.passed.items())
        notes.append(f"passed over: {lines}")
    return Toolpath(begin, moves, notes)


def path_of(toolpath: Toolpath) -> dict[str, Any]:
    """Return the path of a request: `begin` and `segments`, each with its feed as tool speed."""
    segments, at = [], toolpath.begin
    for move in toolpath.moves:
        if move.arc is None:
            segment: dict[str, Any] = {"type": "line", "to": _pose(move.end)}
        elif abs(move.arc.rise) <= _SHORT:
            axis = [0.0, 0.0, 0.0]
            axis[move.arc.normal] = 1.0
            segment = {
                "type": "arc",
                "centre": move.arc.centre.tolist(),
                "axis": axis,
                "angle": move.arc.angle,
            }
        else:
            segment = {"type": "spline", "through": [_pose(p) for p in _helix(at, move.arc)]}
        if move.speed is not None:
            segment["limits"] = {"tool_speed": move.speed}
        segments.append(segment)
        at = move.end
    return {"begin": _pose(toolpath.begin), "segments": segments}


def read_gcode(path: str | os.PathLike[str], *, units: str | None = None) -> dict[str, Any]:
    """Read a G-code file as the path of a request.

    G0 and G1 become lines, G2 and G3 arcs (with a rise along the axis: splines through points of
    the helix), each with its feed as the limit of the tool's speed; rapid moves have none. The
    tool points down (minus z) in the program's frame, which is that of the path. What is passed
    over goes to the logger ``ikplan.gcode``.

    Args:
        path: The file.
        units: mm, in, m, cm or um, for a file that does not say G20 or G21.

    Returns:
        `begin` and `segments` [m, m/s]; add `frame`, `orientation_free` and the rest.

    Raises:
        InvalidRequest: The file cannot be read, is no G-code, or asks for what is not read: names
            the line.
    """
    try:
        data = Path(path).read_bytes()
    except (OSError, ValueError) as error:
        raise InvalidRequest(
            f"{os.fspath(path)!r} cannot be read: {error}", allowed="a G-code file"
        ) from error
    toolpath = read_toolpath(data, units)
    for note in toolpath.notes:
        _log.info("%s", note)
    return path_of(toolpath)


def gcode_request(toolpath: Toolpath, given: dict[str, Any]) -> dict[str, Any]:
    """Return the request for a path.

    Args:
        toolpath: The moves.
        given: The rest of the request; its `path` is filled up.

    Raises:
        InvalidRequest: No robot is named.
    """
    if given.get("robot") is None:
        raise InvalidRequest(
            "robot: a G-code file does not name a robot: give one (--robot NAME)", field="robot"
        )
    return {**given, "path": {**given.get("path", {}), **path_of(toolpath)}}


def _pose(place: Array) -> dict[str, Any]:
    return {"position": place.tolist(), "quaternion_xyzw": _DOWN}


def _helix(start: Array, arc: Arc) -> Array:
    """Points of a helix after its start, shape (n, 3) [m]."""
    a, b = (arc.normal + 1) % 3, (arc.normal + 2) % 3
    radius = float(np.hypot(start[a] - arc.centre[a], start[b] - arc.centre[b]))
    step = min(_STEP, float(np.sqrt(8.0 * _BULGE / radius)))
    count = max(int(np.ceil(abs(arc.angle) / step)), 4)
    turned = np.linspace(0.0, arc.angle, count + 1)[1:]
    first = np.arctan2(start[b] - arc.centre[b], start[a] - arc.centre[a])
    points = np.tile(start, (count, 1))
    points[:, a] = arc.centre[a] + radius * np.cos(first + turned)
    points[:, b] = arc.centre[b] + radius * np.sin(first + turned)
    points[:, arc.normal] += arc.rise * turned / arc.angle
    return points
