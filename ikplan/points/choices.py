"""What a request says beside the points of a file."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, Literal

from ikplan.documents.poses import unit_quaternion
from ikplan.errors import InvalidRequest
from ikplan.points.rotations import rotation_vector

__all__ = ["Choices", "frame_of"]


@dataclass(frozen=True)
class Choices:
    """The rest of a request; None: its default.

    Attributes:
        robot: Name of the robot.
        interpolation: How points are joined: joint, line or spline. None: joint, or line for
            files with zones.
        approach: How the first point is reached: path or joint.
        start: Joint values at the start, or ``"free"``.
        frame: The frame of the points in the robot's base.
        tool: The tool frame in the tip frame.
    """

    robot: str | None = None
    interpolation: str | None = None
    approach: str | None = None
    start: Sequence[float] | Literal["free"] | None = None
    frame: dict[str, Any] | None = None
    tool: dict[str, Any] | None = None


def frame_of(numbers: Sequence[float], field: str) -> dict[str, Any]:
    """Return a frame from 3 numbers (a position), 6 (and a rotation vector) or 7 (a quaternion).

    Args:
        numbers: x, y, z [m]; then the rotation vector rx, ry, rz [rad], as robot controllers show a
            tool, or a unit quaternion x, y, z, w.
        field: What the frame is for, for the error.

    Returns:
        The frame as a request has it.

    Raises:
        InvalidRequest: Another count of numbers, or a quaternion that is not unit.
    """
    if len(numbers) not in (3, 6, 7):
        raise InvalidRequest(
            f"{field}: x y z, x y z rx ry rz (a rotation vector) or x y z qx qy qz qw are allowed, "
            f"not {len(numbers)} numbers",
            field=field,
            allowed="3, 6 or 7 numbers",
        )
    frame: dict[str, Any] = {"position": [float(v) for v in numbers[:3]]}
    turn = [float(v) for v in numbers[3:]]
    if len(turn) == 3:
        frame["quaternion_xyzw"] = rotation_vector(*turn)
    elif turn:
        try:
            frame["quaternion_xyzw"] = unit_quaternion(turn) or turn
        except ValueError as error:
            raise InvalidRequest(f"{field}: {error}", field=field) from error
    return frame
