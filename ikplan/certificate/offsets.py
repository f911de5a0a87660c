"""How far outside what a target allows a tool pose is, by the words of the request.

A box's axes are those of its ``frame``: "path": of the path frame; "tool": of the orientation asked
for at that place, and of the base where none is asked for, as everywhere with
``orientation_free: "all"``.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ikplan.arrays import Array, Flags
from ikplan.certificate.offset_kernels import Allowed, offset_rows
from ikplan.certificate.requested.rotations import rotation_of
from ikplan.documents.path import PathRequest

__all__ = ["Allowance", "Offsets"]


_AXES = {"tool_x": 0, "tool_y": 1, "tool_z": 2}


@dataclass(frozen=True, eq=False)
class Offsets:
    """What poses are off beyond what is allowed, as vectors in the base.

    Attributes:
        apart: From the nearest position allowed, shape (m, 3) [m].
        turned: Rotation vector from the nearest orientation allowed, shape (m, 3) [rad]; 0 where
            none is asked for.
        steps: The squares of the ratios to both tolerances added, the Gauss-Newton step along the
            path [m], and how much the root of that sum changes with the length, at most [1/m],
            shape (m, 3).
    """

    apart: Array
    turned: Array
    steps: Array

    @property
    def distance(self) -> Array:
        """Distances, shape (m,) [m]."""
        return np.asarray(np.sqrt((self.apart * self.apart).sum(axis=1)))

    @property
    def angle(self) -> Array:
        """Angles, shape (m,) [rad]."""
        return np.asarray(np.sqrt((self.turned * self.turned).sum(axis=1)))


class Allowance:
    """What the tolerances and freedoms of a path allow at a target.

    Args:
        path: The path.
    """

    def __init__(self, path: PathRequest) -> None:
        box, free = path.tolerance.box, path.orientation_free
        self.position = path.tolerance.position
        self.orientation = path.tolerance.orientation
        self.positions_only = free == "all"
        self.free_axis: int | None = None
        self.cone = 0.0
        if free is not None and free != "all":
            self.free_axis, self.cone = _AXES[free.about], free.cone or 0.0
        self.box_position: Array = np.zeros(3) if box is None else np.array(box.position)
        self.box_orientation: Array = np.zeros(3) if box is None else np.array(box.orientation)
        axes: Array | None = None
        self._unturned = np.eye(3)
        if box is not None and box.frame == "path":
            axes = rotation_of(path.frame.quaternion_xyzw)
        self.rows = Allowed(
            self.position,
            self.orientation,
            -1 if self.free_axis is None else self.free_axis,
            self.cone,
            box is not None,
            axes is None,
            self._unturned if axes is None else axes,
            self.box_position,
            self.box_orientation,
        )

    def offsets(
        self,
        p: Array,
        R: Array,
        p_target: Array,
        R_target: Array,
        oriented: Flags,
        rates: tuple[Array, Array] | None = None,
    ) -> Offsets:
        """Return how far poses are outside what their targets allow.

        Args:
            p: Positions of the tool in the base, shape (m, 3) [m].
            R: Rotations of the tool in the base, shape (m, 3, 3).
            p_target: Positions asked for, shape (m, 3) [m].
            R_target: Rotations asked for, shape (m, 3, 3).
            oriented: Where an orientation is asked for, shape (m,); the others' is ignored.
            rates: Velocities and angular velocities of the targets by the path length, shape (m, 3)
                each; None: they stand still.
        """
        counts = oriented & (not self.positions_only)
        apart, turned, steps = np.empty_like(p), np.empty_like(p), np.empty_like(p)
        v, w = (np.zeros_like(p), np.zeros_like(p)) if rates is None else rates
        offset_rows(
            self.rows,
            p,
            R,
            p_target,
            R_target,
            counts,
            v,
            w,
            apart,
            turned,
            steps,
            np.empty((5, 3)),
            self._unturned,
        )
        return Offsets(apart, turned, steps)
