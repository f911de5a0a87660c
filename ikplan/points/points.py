"""What a file of points comes down to."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

from ikplan.points.note import Note

__all__ = ["Points", "Speed"]


@dataclass(frozen=True)
class Speed:
    """How fast the motion to a point may be.

    Attributes:
        value: Speed of the tool [m/s], or the share of the joints' velocity limits.
        share: Whether it is a share, 0..1.
    """

    value: float
    share: bool = False

    def limits(self) -> dict[str, float]:
        """Return the limits of a request that say so."""
        return {"velocity_scale" if self.share else "tool_speed": self.value}


@dataclass(frozen=True)
class Points:
    """The points of a file, in SI units.

    Attributes:
        poses: Waypoints as a request has them; empty for a file of joint values.
        joints: Joint values, one row a point, in the robot's order [rad or m]; else empty.
        speeds: How fast the motion to each point may be; None: not said. Empty: no such column.
        zones: Radius within which the corner at each point is rounded [m]; None: not said. Empty:
            no such column.
        timed: Whether there is a column of times, which no plan keeps.
        free_axis: Axis of the tool about which it may turn, such as ``"tool_z"``, or None.
        notes: How the file was read, in words.
    """

    poses: list[dict[str, Any]] = field(default_factory=list)
    joints: list[list[float]] = field(default_factory=list)
    speeds: list[Speed | None] = field(default_factory=list)
    zones: list[float | None] = field(default_factory=list)
    timed: bool = False
    free_axis: str | None = None
    notes: list[Note] = field(default_factory=list)
