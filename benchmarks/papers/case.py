"""A case: an arm, targets, what is minimised, and where the arm starts."""

from __future__ import annotations

import hashlib
from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from ikplan.ik.objective import POSITION, Objective, pose_objective, wrist_objective
from ikplan.kinematics.arm import Arm
from ikplan.kinematics.chain import Chain
from ikplan.kinematics.forward import forward
from ikplan.kinematics.wrist import nearest_wrist
from ikplan.robots import Robot

__all__ = ["Case"]

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Case:
    """An arm, targets, what is minimised, and where the arm starts.

    Attributes:
        name: Such as "E1b".
        title: What it is, for people.
        robot: The robot.
        arm: Its kinematics.
        R: Rotations wanted, shape (n, 3, 3); not checked to be rotations.
        p: Positions wanted, shape (n, 3) [m].
        oriented: Whether the rotation is a part of the target at all.
        q_start: Where the arm starts, shape (dof,) [rad].
        starts: Where it starts for each target, shape (n, dof) [rad]; None: see ``tracks``.
        kind: Kind of the objective.
        weight_position: omega_P per metre.
        weight_orientation: omega_R.
        decouple: Whether the wrist is taken from the decoupling.
        penalise: Whether wrist limits are penalised then.
        searched: Joints searched over; None: all, or without the wrist.
        tracks: Whether each target starts from the solution of the one before.
        stop_value: A search ends at this value.
        reachable: Which targets can be met within the limits, shape (n,).
        finish: Completes the joints searched over to a configuration.
    """

    name: str
    title: str
    robot: Robot
    arm: Arm
    R: Array
    p: Array
    oriented: bool
    q_start: Array
    starts: Array | None = None
    kind: int = POSITION
    weight_position: float = 1.0
    weight_orientation: float = 0.0
    decouple: bool = False
    penalise: bool = False
    searched: int | None = None
    tracks: bool = True
    stop_value: float = -1.0
    reachable: NDArray[np.bool_] = field(default_factory=lambda: np.zeros(0, dtype=np.bool_))
    finish: Callable[[Array], Array] | None = None

    @property
    def count(self) -> int:
        """Number of targets."""
        return len(self.p)

    @property
    def width(self) -> int:
        """Number of joints searched over."""
        if self.searched is not None:
            return self.searched
        return self.arm.dof - 3 if self.decouple else self.arm.dof

    def start(self, k: int) -> Array:
        """Return where the arm starts for target k, unless it starts from the solution before."""
        return self.q_start if self.starts is None else self.starts[k]

    def digest(self) -> str:
        """Return a digest of what results depend on."""
        h = hashlib.sha256(repr((self.name, self.kind, self.weight_position)).encode())
        h.update(repr((self.weight_orientation, self.decouple, self.penalise)).encode())
        h.update(repr((self.tracks, self.stop_value, self.robot.fingerprint)).encode())
        for array in (self.R, self.p, self.q_start, self.arm.lower, self.arm.upper):
            h.update(np.ascontiguousarray(array).tobytes())
        if self.starts is not None:
            h.update(np.ascontiguousarray(self.starts).tobytes())
        return h.hexdigest()[:8]

    def objective(self, k: int, q_s: Array, penalise: bool = False) -> Objective:
        """Return what is minimised for target k, near to ``q_s``."""
        if self.decouple:
            assert self.arm.wrist is not None
            return wrist_objective(
                self.arm.wrist, self.R[k], self.p[k], q_s[-3:], penalise=penalise or self.penalise
            )
        chain = self.arm.chain
        if self.searched is not None:
            chain = Chain(
                chain.placements,
                chain.prismatic,
                True,
                np.ascontiguousarray(chain.coupling[:, : self.searched]),
                chain.offset,
            )
        return pose_objective(
            chain,
            self.R[k],
            self.p[k],
            self.kind,
            weight_position=self.weight_position,
            weight_orientation=self.weight_orientation,
        )

    def complete(self, x: Array, k: int, q_s: Array) -> Array:
        """Return the configuration, shape (dof,), of the joints searched over."""
        if self.finish is not None:
            return self.finish(x)
        if not self.decouple:
            return x
        assert self.arm.wrist is not None
        R_arm, _ = forward(self.arm.wrist.arm, x)
        angles = np.empty(3)
        near = np.ascontiguousarray(q_s[-3:])
        nearest_wrist(self.arm.wrist, R_arm, np.ascontiguousarray(self.R[k]), near, angles)
        return np.concatenate([x, angles])
