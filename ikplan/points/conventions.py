"""The ways in which people write an orientation: which columns, whose convention, which unit."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

from ikplan.points.rotations import fixed_axes, rotation_vector

__all__ = ["AXIS", "ORIENTATIONS", "POSITION", "QUATERNION", "ROTATION_VECTOR", "Orientation"]

POSITION = ("x", "y", "z")


@dataclass(frozen=True)
class Orientation:
    """One way to write an orientation.

    Attributes:
        columns: Names of its columns.
        words: What it is, with whose convention.
        unit: Unit where none is written: ``"deg"``, ``"rad"``; ``""``: it is guessed from the
            values; None: the values have none.
        build: From the values of the columns, angles in radians, to a quaternion (x, y, z, w);
            None: one value alone does not make an orientation, see ``AXIS``.
    """

    columns: tuple[str, ...]
    words: str
    unit: str | None
    build: Callable[[Sequence[float]], list[float]] | None


QUATERNION = Orientation(("qx", "qy", "qz", "qw"), "a unit quaternion", None, list)
ROTATION_VECTOR = Orientation(
    ("rx", "ry", "rz"),
    "a rotation vector, as Universal Robots write it",
    "rad",
    lambda v: rotation_vector(*v),
)
KUKA = Orientation(
    ("a", "b", "c"),
    "KUKA's A, B, C: turns about z, the turned y and the twice turned x",
    "deg",
    lambda v: fixed_axes(v[2], v[1], v[0]),
)
FANUC = Orientation(
    ("w", "p", "r"),
    "FANUC's W, P, R: turns about the fixed axes x, y and z",
    "deg",
    lambda v: fixed_axes(*v),
)
ROLL_PITCH_YAW = Orientation(
    ("roll", "pitch", "yaw"),
    "roll, pitch and yaw as in URDF and ROS: turns about the fixed axes x, y and z",
    "",
    lambda v: fixed_axes(*v),
)
AXIS = Orientation(("i", "j", "k"), "the direction of a tool axis", None, None)

ORIENTATIONS = (QUATERNION, ROTATION_VECTOR, KUKA, FANUC, ROLL_PITCH_YAW, AXIS)
"""Every way, in the order in which messages list them."""
