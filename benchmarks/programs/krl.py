"""A small interpreter of KRL: as much of the language as a program of one timed spline needs.

KUKA does not publish the polynomials of its splines. This plays the cubic splines that the
certificate names, by B-splines, with the times that ``TIME_BLOCK`` shares out. Numbers are held in
single precision, as KRL holds a REAL.
"""

from __future__ import annotations

import re

import numpy as np
from numpy.typing import NDArray
from scipy.interpolate import make_interp_spline

from benchmarks.programs.blending import Motion
from benchmarks.programs.urscript import ScriptError

__all__ = ["play"]

Array = NDArray[np.float64]

_DEF = re.compile(r"DEF ([A-Za-z]\w{0,23})\(\)")
_POINT = re.compile(r"(S?PTP) \{A1 (\S+),A2 (\S+),A3 (\S+),A4 (\S+),A5 (\S+),A6 (\S+)\}")
_PART = re.compile(r"TIME_BLOCK PART=(\S+)")
_END = re.compile(r"TIME_BLOCK END=(\S+)")
_SET = re.compile(
    r"BAS\(#(?:INITMOV|VEL_PTP|ACC_PTP),\d+\)|\$(?:BASE|TOOL)=\$NULLFRAME|&ACCESS RVP"
)
_NUMBER = re.compile(r"-?\d+(?:\.\d+)?")
_LONGEST_LINE = 471


def play(program: str, cycle: float) -> Motion:
    """Run a program.

    Args:
        program: The text.
        cycle: The controller's cycle [s].

    Raises:
        ScriptError: It does not parse, or does what this interpreter knows no answer to.
    """
    lines = [raw.partition(";")[0].strip() for raw in program.split("\r\n")]
    lines = [line for line in lines if line and not _SET.fullmatch(line)]
    if any(len(line) > _LONGEST_LINE for line in lines):
        raise ScriptError("a line is too long")
    if not _DEF.fullmatch(lines[0]) or lines[-1] != "END":
        raise ScriptError("not a program")
    first, begin, *block = lines[1:-1]
    home = _point(first, "PTP")
    if begin != "PTP_SPLINE" or block[-1] != "ENDSPLINE" or block[1] != "TIME_BLOCK START":
        raise ScriptError("not one timed spline")
    if _point(block[0], "SPTP") != home:
        raise ScriptError("the spline begins elsewhere than the arm is")
    ends = _END.fullmatch(block[-2])
    if ends is None:
        raise ScriptError("the spline has no time")
    inner = block[2:-2]
    if len(inner) % 2:
        raise ScriptError("a point without a time")
    points = [home, *(_point(line, "SPTP") for line in inner[0::2])]
    parts = [found[1] for line in inner[1::2] if (found := _PART.fullmatch(line))]
    if len(parts) != len(points) - 1:
        raise ScriptError("a point without a time")
    shares = np.array([_number(text) for text in parts])
    steps = _number(ends[1]) * shares / shares.sum()
    due = np.concatenate([[0.0], np.cumsum(steps)])
    count = int(np.ceil(due[-1] / cycle - 1e-9))
    time = np.minimum(np.arange(count + 1) * cycle, due[-1])
    q = np.array(points)
    spline = make_interp_spline(due, q, k=3, bc_type="clamped")
    return Motion(q, steps, time, np.asarray(spline(time)))


def _point(line: str, kind: str) -> list[float]:
    found = _POINT.fullmatch(line)
    if found is None or found[1] != kind:
        raise ScriptError(f"not a {kind}: {line}")
    return [_number(text) for text in found.groups()[1:]]


def _number(text: str) -> float:
    if not _NUMBER.fullmatch(text):
        raise ScriptError(f"not a number: {text}")
    return float(np.float32(text))
