"""A small interpreter of FANUC TP programs in text form: as much as timed joint moves need.

It plays as the certificate names: FANUC does not publish how long the end of a move overlaps with
the begin of the next. Numbers are held in single precision.
"""

from __future__ import annotations

import re

import numpy as np

from benchmarks.programs.blending import Motion, played
from benchmarks.programs.urscript import ScriptError

__all__ = ["play"]

_NAME = re.compile(r"/PROG  ([A-Z][A-Z0-9_]{0,35})")
_LINE = re.compile(r" *(\d+):(.*) ;")
_MOVE = re.compile(r"J P\[(\d+)\] (\d+)(msec|%) (FINE|CNT100)   ")
_SET = re.compile(r"  (?:UFRAME_NUM=0|UTOOL_NUM=1|!.{0,32})")
_POINT = re.compile(
    r"P\[(\d+)\]\{\n   GP1:\n\tUF : 0, UT : 1,\n\tJ1= +(\S+) deg,\tJ2= +(\S+) deg,\tJ3= +(\S+) deg,"
    r"\n\tJ4= +(\S+) deg,\tJ5= +(\S+) deg,\tJ6= +(\S+) deg\n\};\n"
)
_NUMBER = re.compile(r"-?\d+\.\d{3}")
_LONGEST_TIME = 32000


def play(program: str, cycle: float) -> Motion:
    """Run a program.

    Args:
        program: The text.
        cycle: The controller's cycle [s].

    Raises:
        ScriptError: It does not parse, or does what this interpreter knows no answer to.
    """
    text = program.replace("\r\n", "\n")
    head, main, rest = text.partition("/MN\n")
    if not _NAME.fullmatch(head.partition("\n")[0]) or not main:
        raise ScriptError("not a program")
    body, positions, points = rest.partition("/POS\n")
    if not positions or not points.endswith("/END\n"):
        raise ScriptError("no positions, or no end")
    places = _points(points.removesuffix("/END\n"))
    lines = body.splitlines()
    if f"LINE_COUNT\t= {len(lines)};" not in head:
        raise ScriptError("another count of lines")
    moves = [move for k, line in enumerate(lines, start=1) if (move := _move(line, k)) is not None]
    if moves[0][2] != "%" or moves[0][3] != "FINE" or moves[-1][3] != "FINE":
        raise ScriptError("the motion does not begin and end at rest")
    if any(unit != "msec" for _, _, unit, _ in moves[1:]):
        raise ScriptError("a move without a time")
    if any(zone == "FINE" for _, _, _, zone in moves[1:-1]):
        raise ScriptError("a stop on the way")
    times = [time for _, time, _, _ in moves[1:]]
    if not all(1 <= time <= _LONGEST_TIME for time in times):
        raise ScriptError("a time out of range")
    try:
        q = np.array([places[number] for number, _, _, _ in moves])
    except KeyError as missing:
        raise ScriptError(f"no such point: {missing}") from missing
    return played(q, np.array(times) / 1e3, cycle)


def _move(line: str, number: int) -> tuple[int, int, str, str] | None:
    found = _LINE.fullmatch(line)
    if found is None or int(found[1]) != number:
        raise ScriptError(f"not line {number}: {line}")
    if _SET.fullmatch(found[2]):
        return None
    move = _MOVE.fullmatch(found[2])
    if move is None:
        raise ScriptError(f"no such instruction: {found[2]}")
    return int(move[1]), int(move[2]), move[3], move[4]


def _points(text: str) -> dict[int, list[float]]:
    places, at = {}, 0
    for found in _POINT.finditer(text):
        if found.start() != at:
            break
        at = found.end()
        values = found.groups()[1:]
        for value in values:
            if not _NUMBER.fullmatch(value):
                raise ScriptError(f"not a number: {value}")
        places[int(found[1])] = [float(np.float32(value)) for value in values]
    if at != len(text):
        raise ScriptError("not a position")
    return places
