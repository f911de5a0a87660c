"""A small interpreter of DRL: as much of the language as a program of timed joint moves needs.

DRL is Python with functions of its own, so the program is parsed as Python. It plays as the
certificate names: Doosan does not publish how the moves are superposed within a radius.
"""

from __future__ import annotations

import ast
from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from benchmarks.programs.blending import Motion, played
from benchmarks.programs.urscript import ScriptError

__all__ = ["play"]

Array = NDArray[np.float64]


def play(program: str, cycle: float, way: Callable[[Array, Array], float]) -> Motion:
    """Run a program.

    Args:
        program: The text.
        cycle: The controller's cycle [s].
        way: How far the tool moves between two points [mm].

    Raises:
        ScriptError: It does not parse, or does what this interpreter knows no answer to.
    """
    try:
        tree = ast.parse(program)
    except SyntaxError as error:
        raise ScriptError(f"not Python: {error}") from error
    moves = [_move(statement) for statement in tree.body]
    if not moves or set(moves[0][1]) != {"v", "a"}:
        raise ScriptError("no slow move to the first point")
    points = np.array([point for point, _ in moves])
    times = [options.get("t") for _, options in moves[1:]]
    if any(time is None or time <= 0.0 for time in times):
        raise ScriptError("a move without a time")
    if "r" in moves[-1][1]:
        raise ScriptError("the motion does not end at rest")
    for k, (_, options) in enumerate(moves[1:-1], start=1):
        radius = options.get("r", 0.0)
        if radius <= 0.0:
            raise ScriptError("a stop on the way")
        if radius > min(way(points[k - 1], points[k]), way(points[k], points[k + 1])) / 2.0:
            raise ScriptError("the radius is larger than half of the way to the nearest point")
    return played(points, np.array(times, dtype=np.float64), cycle)


def _move(statement: ast.stmt) -> tuple[list[float], dict[str, float]]:
    if not isinstance(statement, ast.Expr) or not isinstance(statement.value, ast.Call):
        raise ScriptError(f"not a call: {ast.unparse(statement)}")
    call = statement.value
    if _name(call.func) != "movej" or len(call.args) != 1 or not isinstance(call.args[0], ast.Call):
        raise ScriptError(f"no such instruction: {ast.unparse(statement)}")
    point = call.args[0]
    if _name(point.func) != "posj" or len(point.args) != 6 or point.keywords:
        raise ScriptError("a point has six joint values")
    options = {}
    for keyword in call.keywords:
        if keyword.arg == "ra":
            if _name(keyword.value) != "DR_MV_RA_DUPLICATE":
                raise ScriptError("moves that replace each other")
        elif keyword.arg in ("t", "r", "v", "a"):
            options[keyword.arg] = _number(keyword.value)
        else:
            raise ScriptError(f"no such argument: {keyword.arg}")
    return [_number(value) for value in point.args], options


def _name(node: ast.expr) -> str:
    return node.id if isinstance(node, ast.Name) else ""


def _number(node: ast.expr) -> float:
    try:
        value = ast.literal_eval(node)
    except ValueError as error:
        raise ScriptError(f"not a number: {ast.unparse(node)}") from error
    if not isinstance(value, int | float):
        raise ScriptError(f"not a number: {ast.unparse(node)}")
    return float(value)
