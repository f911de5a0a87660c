"""How far outside what a target allows a tool pose is, by the words of the request.

A box's axes are those of its ``frame``: "path": of the path frame; "tool": of the orientation asked
for at that place, and of the base where none is asked for, as everywhere with
``orientation_free: "all"``.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ikplan.arrays import Array, Flags
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
        axes: Axes of the box, shape (m, 3, 3); None: there is no box.
        lever: From the target to the pose, shape (m, 3) [m], where the box turns with the target;
            None: it does not.
        about: Direction asked for of the axis about which the tool may turn, shape (m, 3); None:
            there is none.
    """

    apart: Array
    turned: Array
    axes: Array | None = None
    lever: Array | None = None
    about: Array | None = None

    def felt(self, v: Array, w: Array) -> tuple[Array, Array]:
        """Return the parts of a target's twist that change what is off; all where there is no box.

        Args:
            v: Velocities of the targets, shape (m, 3).
            w: Angular velocities of the targets, shape (m, 3).
        """
        if self.about is not None:
            w = w - (w * self.about).sum(axis=1, keepdims=True) * self.about
        if self.axes is None:
            return v, w
        if self.lever is not None:
            v = v + np.cross(w, self.lever)
        return _felt(v, self.apart, self.axes), _felt(w, self.turned, self.axes)

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
        self._boxed = box is not None
        self._axes: Array | None = None
        if box is not None and box.frame == "path":
            self._axes = rotation_of(path.frame.quaternion_xyzw)

    def offsets(
        self, p: Array, R: Array, p_target: Array, R_target: Array, oriented: Flags
    ) -> Offsets:
        """Return how far poses are outside what their targets allow.

        Args:
            p: Positions of the tool in the base, shape (m, 3) [m].
            R: Rotations of the tool in the base, shape (m, 3, 3).
            p_target: Positions asked for, shape (m, 3) [m].
            R_target: Rotations asked for, shape (m, 3, 3).
            oriented: Where an orientation is asked for, shape (m,); the others' is ignored.
        """
        counts = oriented & (not self.positions_only)
        apart = p - p_target
        axes = lever = None
        if self._boxed:
            lever = apart if self._axes is None else None
            own = np.where(counts[:, None, None], R_target, np.eye(3))
            axes = own if self._axes is None else np.broadcast_to(self._axes, R.shape)
            apart = _outside(apart, axes, self.box_position)
        if not counts.any():
            return Offsets(apart, np.zeros_like(apart), axes, lever)
        turned = self._turned(R, R_target)
        if axes is not None and self.free_axis is None:
            turned = _outside(turned, axes, self.box_orientation)
        about = None if self.free_axis is None else R_target[:, :, self.free_axis]
        return Offsets(apart, np.where(counts[:, None], turned, 0.0), axes, lever, about)

    def _turned(self, R: Array, R_target: Array) -> Array:
        """Rotation vectors from the orientations asked for, or from the cone about their axis."""
        if self.free_axis is None:
            return _rotation_vectors(R @ np.swapaxes(R_target, 1, 2))
        target_axis, axis = R_target[:, :, self.free_axis], R[:, :, self.free_axis]
        about = np.cross(target_axis, axis)
        sine = np.sqrt((about * about).sum(axis=1))
        angle = np.arctan2(sine, (target_axis * axis).sum(axis=1))
        beyond = np.maximum(angle - self.cone, 0.0)
        return _along(about, sine, beyond)


def _outside(vectors: Array, axes: Array, half_widths: Array) -> Array:
    """The part of vectors beyond a box of given axes, shape (m, 3, 3), in the base, (m, 3)."""
    along = (np.swapaxes(axes, 1, 2) @ vectors[:, :, None])[:, :, 0]
    beyond = np.sign(along) * np.maximum(np.abs(along) - half_widths, 0.0)
    return np.asarray((axes @ beyond[:, :, None])[:, :, 0])


def _felt(rates: Array, beyond: Array, axes: Array) -> Array:
    """The part of rates along those axes of a box beyond whose faces something is."""
    inverse = np.swapaxes(axes, 1, 2)
    faces = np.abs(inverse @ beyond[:, :, None]) > 1e-15
    return np.asarray((axes @ (faces * (inverse @ rates[:, :, None])))[:, :, 0])


def _rotation_vectors(R: Array) -> Array:
    """Rotation vectors of rotations, shape (m, 3); exact but for the axis of half turns."""
    skew = np.empty((len(R), 3))
    skew[:, 0] = R[:, 2, 1] - R[:, 1, 2]
    skew[:, 1] = R[:, 0, 2] - R[:, 2, 0]
    skew[:, 2] = R[:, 1, 0] - R[:, 0, 1]
    sine = np.sqrt((skew * skew).sum(axis=1))
    angle = np.arctan2(sine, R[:, 0, 0] + R[:, 1, 1] + R[:, 2, 2] - 1.0)
    return _along(skew, sine, angle)


def _along(vectors: Array, norms: Array, lengths: Array) -> Array:
    """Vectors scaled to lengths; where one has none, along x."""
    some = norms > 1e-300
    scaled = vectors * (lengths / np.where(some, norms, 1.0))[:, None]
    if not some.all():
        scaled[~some] = 0.0
        scaled[~some, 0] = lengths[~some]
    return np.asarray(scaled)
