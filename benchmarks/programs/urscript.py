"""A small interpreter of URScript: as much of the language as a motion program needs.

It runs a program as a controller does: definitions move nothing until they are called, and every
``servoj`` takes a whole number of the controller's cycles, one at least.
"""

from __future__ import annotations

import math
import re
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

__all__ = ["Played", "ScriptError", "play"]

Array = NDArray[np.float64]
Value = float | list[float]

_DEFINITION = re.compile(r"def ([A-Za-z_]\w*)\(\):")
_CALL = re.compile(r"([A-Za-z_]\w*)\((.*)\)")
_ARGUMENT = re.compile(r"(?:([A-Za-z_]\w*)\s*=\s*)?(\[[^\]]*\]|[^,\[\]]+)\s*(?:,\s*|$)")
# No exponents: not every controller reads them.
_NUMBER = re.compile(r"-?\d+(?:\.\d+)?")
_JOINTS = 6


class ScriptError(Exception):
    """The program is not one that a controller would run."""


@dataclass
class Played:
    """What the arm does while a program runs.

    Attributes:
        approach: Joint values of the move before the motion [rad], None if there is none.
        time: Times at the ends of the controller's cycles [s], from 0 at the first step.
        q: Joint values commanded then, shape (m, 6) [rad].
        stopped: Whether the program ends by stopping the joints.
    """

    approach: Array | None = None
    time: list[float] = field(default_factory=list)
    q: list[Array] = field(default_factory=list)
    stopped: bool = False


def play(program: str, cycle: float) -> Played:
    """Run a program.

    Args:
        program: The text.
        cycle: The controller's cycle [s].

    Raises:
        ScriptError: It does not parse, calls what there is not, or moves nothing.
    """
    functions, top = _parsed(program)
    played = Played()
    for line in top:
        _run(line, functions, cycle, played)
    if played.approach is None:
        raise ScriptError("the program moves nothing")
    return played


def _parsed(program: str) -> tuple[dict[str, list[str]], list[str]]:
    functions: dict[str, list[str]] = {}
    top: list[str] = []
    body: list[str] | None = None
    for raw in program.split("\n"):
        line = raw.partition("#")[0].strip()
        if not line:
            continue
        if found := _DEFINITION.fullmatch(line):
            if body is not None:
                raise ScriptError(f"a definition in a definition: {line}")
            body = functions[found[1]] = []
        elif line == "end":
            if body is None:
                raise ScriptError("an end without a definition")
            body = None
        else:
            (top if body is None else body).append(line)
    if body is not None:
        raise ScriptError("a definition without an end")
    return functions, top


def _run(line: str, functions: dict[str, list[str]], cycle: float, played: Played) -> None:
    found = _CALL.fullmatch(line)
    if found is None:
        raise ScriptError(f"not a call: {line}")
    name, text = found[1], found[2]
    if name in functions:
        for each in functions[name]:
            _run(each, functions, cycle, played)
        return
    plain, named = _arguments(text)
    if name == "movej" and set(named) <= {"a", "v", "t", "r"}:
        played.approach = _joints(plain)
    elif name == "servoj" and set(named) <= {"a", "v", "t", "lookahead_time", "gain"}:
        _servo(_joints(plain), _number(named, "t"), cycle, played)
    elif name == "stopj" and len(plain) == 1:
        played.stopped = True
    else:
        raise ScriptError(f"no such call: {line}")


def _servo(target: Array, seconds: float, cycle: float, played: Played) -> None:
    if played.approach is None:
        raise ScriptError("servoj before the arm is where the motion begins")
    if not played.q:
        played.time.append(0.0)
        played.q.append(played.approach)
    cycles = max(math.ceil(seconds / cycle - 1e-6), 1)
    begin, last = len(played.time) - 1, played.q[-1]
    for k in range(1, cycles + 1):
        played.time.append((begin + k) * cycle)
        played.q.append(last + (target - last) * (k / cycles))


def _arguments(text: str) -> tuple[list[Value], dict[str, Value]]:
    plain: list[Value] = []
    named: dict[str, Value] = {}
    at = 0
    while at < len(text):
        found = _ARGUMENT.match(text, at)
        if found is None:
            raise ScriptError(f"arguments: {text[at:]}")
        value = _value(found[2].strip())
        if found[1] is not None:
            named[found[1]] = value
        elif named:
            raise ScriptError("an argument without a name after one with a name")
        else:
            plain.append(value)
        at = found.end()
    return plain, named


def _value(text: str) -> Value:
    if text.startswith("["):
        values = [_value(part.strip()) for part in text[1:-1].split(",")]
        return [v for v in values if isinstance(v, float)]
    if not _NUMBER.fullmatch(text):
        raise ScriptError(f"not a number: {text}")
    return float(text)


def _joints(plain: list[Value]) -> Array:
    if len(plain) != 1 or not isinstance(plain[0], list) or len(plain[0]) != _JOINTS:
        raise ScriptError("a target has six joint values")
    return np.array(plain[0])


def _number(named: dict[str, Value], key: str) -> float:
    value = named.get(key)
    if not isinstance(value, float):
        raise ScriptError(f"the argument {key} is missing")
    return value
