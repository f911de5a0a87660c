"""A machine that runs the lines of a G-code file and notes the moves of its tool."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, field

import numpy as np

from ikplan.arrays import Array
from ikplan.gcode.arcs import Arc, arc_of
from ikplan.gcode.blocks import Block, fault

__all__ = ["Machine", "Move"]

_AXES = ("X", "Y", "Z")
_LENGTHS = {20: 0.0254, 21: 0.001}
# Codes that change nothing here: tool length and radius offsets off, work offsets, exact path and
# continuous modes, feeds per minute, canned cycles off, retract modes.
_PASSED = {40, 43, 49, 54, 55, 56, 57, 58, 59, 61, 64, 80, 94, 98, 99}
_OTHERS = {
    28: "a return to the reference point", 30: "a return to the reference point",
    41: "a radius offset", 42: "a radius offset", 53: "machine coordinates",
    92: "an offset of the origin", 93: "inverse-time feed", 95: "feed per revolution",
}  # fmt: skip
_PLANES = (17, 18, 19)
_MOTIONS = (0, 1, 2, 3)


@dataclass(frozen=True)
class Move:
    """A motion of the tool.

    Attributes:
        line: The line that it comes from.
        end: Where it ends, shape (3,) [m].
        arc: The arc; None: a straight line.
        speed: Highest speed of the tool [m/s]; None: a rapid move.
    """

    line: int
    end: Array
    arc: Arc | None
    speed: float | None


@dataclass
class Machine:
    """Modal state, and the moves so far.

    Attributes:
        moves: The moves, in order; nan in an end: the axis has no value yet.
        passed: Codes that were passed over, with the line where each is first met.
    """

    moves: list[Move] = field(default_factory=list)
    passed: dict[str, int] = field(default_factory=dict)
    _at: Array = field(default_factory=lambda: np.full(3, np.nan))
    _motion: int | None = None
    _plane: int = 17
    _unit: float | None = None
    _absolute: bool = True
    _centres_absolute: bool = False
    _feed: float | None = None
    _ended: bool = False

    def run(self, blocks: Iterable[Block], unit: float | None = None) -> None:
        """Run lines.

        Args:
            blocks: The lines.
            unit: Metres in a unit of length until the file says it; None: the file has to.

        Raises:
            InvalidRequest: A line asks for what is not read, or for no motion; names it.
        """
        self._unit = unit
        for block in blocks:
            if self._ended:
                return
            self._run(block)

    def _run(self, block: Block) -> None:
        dwell = False
        for code in block.codes("G"):
            dwell = self._set(block.line, code) or dwell
        for code in block.codes("M"):
            if code in (2, 30):
                self._ended = True
            else:
                self.passed.setdefault(f"M{code:g}", block.line)
        for letter in ("S", "T", "E", "A", "B", "C", "U", "V", "W"):
            if block.value(letter) is not None:
                if letter not in ("S", "T"):
                    raise fault(block.line, f"axis {letter}: only X, Y and Z are read")
                self.passed.setdefault(letter, block.line)
        if dwell:
            return
        feed = block.value("F")
        if feed is not None:
            if feed <= 0.0:
                raise fault(block.line, "a feed of 0")
            self._feed = feed * self._length(block.line) / 60.0
        given = [block.value(axis) for axis in _AXES]
        turning = self._motion in (2, 3) and any(block.codes(letter) for letter in "IJKR")
        if any(value is not None for value in given) or turning:
            self._move(block, given)

    def _set(self, line: int, code: float) -> bool:
        """Take over a G code; whether the line is a dwell."""
        if code in _MOTIONS:
            self._motion = int(code)
        elif code in _PLANES:
            self._plane = int(code)
        elif code in _LENGTHS:
            self._unit = _LENGTHS[int(code)]
        elif code in (90, 91):
            self._absolute = code == 90
        elif code in (90.1, 91.1):
            self._centres_absolute = code == 90.1
        elif code == 4:
            self.passed.setdefault("G4", line)
            return True
        elif code in _PASSED:
            self.passed.setdefault(f"G{code:g}", line)
        else:
            what = _OTHERS.get(int(code), "this code")
            raise fault(
                line, f"G{code:g}: {what} is not read", "G0, G1, G2, G3, G17 to G21, G90, G91"
            )
        return False

    def _length(self, line: int) -> float:
        if self._unit is None:
            raise fault(
                line,
                "the file does not say its unit of length before this line (G20, G21)",
                "mm or in",
            )
        return self._unit

    def _move(self, block: Block, given: list[float | None]) -> None:
        unit = self._length(block.line)
        if self._motion is None:
            raise fault(block.line, "a place without a motion (G0, G1, G2 or G3)")
        start, end = self._at, np.array(self._at)
        for k, value in enumerate(given):
            if value is not None:
                before = 0.0 if self._absolute or np.isnan(start[k]) else start[k]
                end[k] = before + value * unit
        speed = None if self._motion == 0 else self._feed
        if self._motion != 0 and speed is None:
            raise fault(block.line, "a motion with feed, and no feed yet (F)")
        arc = None
        if self._motion in (2, 3):
            if np.isnan(start).any():
                raise fault(block.line, "an arc before X, Y and Z have values")
            arc = arc_of(
                block, start, end, self._motion == 2, self._plane, unit, not self._centres_absolute
            )
        self._at = end
        self.moves.append(Move(block.line, end, arc, speed))
