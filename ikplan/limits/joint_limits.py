"""The limits of the joints that a timing has to keep."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, Protocol

import numpy as np
from numpy.typing import ArrayLike

from ikplan.arrays import Array
from ikplan.errors import InvalidRequest

__all__ = ["JointLimits", "LimitedRobot"]


_SIGNS = {
    "velocity": 1.0,
    "velocity_lower": -1.0,
    "acceleration": 1.0,
    "acceleration_lower": -1.0,
    "jerk": 1.0,
    "deceleration": 1.0,
}
"""The rates that are limited, and the sign of each limit."""


class LimitedRobot(Protocol):
    """What a robot has to show to be timed: arrays of shape (dof,)."""

    @property
    def lower(self) -> Array: ...  # noqa: D102
    @property
    def upper(self) -> Array: ...  # noqa: D102
    @property
    def velocity_limit(self) -> Array: ...  # noqa: D102
    @property
    def acceleration_limit(self) -> Array: ...  # noqa: D102
    @property
    def joint_names(self) -> Sequence[str]: ...  # noqa: D102


def _vector(value: ArrayLike, dof: int, field: str) -> Array:
    try:
        vector = np.array(value, dtype=np.float64)
    except (TypeError, ValueError) as error:
        raise InvalidRequest(f"{field} must be {dof} numbers", field=field) from error
    if vector.shape != (dof,):
        raise InvalidRequest(
            f"{field} must have one value for each of the {dof} joints, not shape {vector.shape}",
            field=field,
            allowed=f"{dof} numbers",
        )
    vector.setflags(write=False)
    return vector


@dataclass(frozen=True, eq=False)
class JointLimits:
    """Position, velocity and acceleration limits, one value a joint.

    Velocities and accelerations are bounded above by ``velocity`` and ``acceleration`` and below
    by ``velocity_lower`` and ``acceleration_lower``, which are the negatives of the upper bounds
    unless they are given.

    Attributes:
        lower: Lowest positions [rad or m], shape (dof,), may be -inf.
        upper: Highest positions [rad or m], shape (dof,), may be +inf.
        velocity: Highest velocities [rad/s or m/s], shape (dof,), > 0.
        acceleration: Highest accelerations [rad/s^2 or m/s^2], shape (dof,), > 0.
        joint_names: Names of the joints.
        velocity_lower: Lowest velocities, shape (dof,), < 0.
        acceleration_lower: Lowest accelerations, shape (dof,), < 0.
        jerk: Highest jerks, both ways [rad/s^3 or m/s^3], shape (dof,), > 0; None: no limit.
        deceleration: Highest rates of slowing down, both ways, shape (dof,), > 0; None: those of
            the accelerations.

    Raises:
        InvalidRequest: An array has the wrong length, is not finite (positions apart), is not
            positive (the lower ones: not negative), or a lower position exceeds the upper one.
    """

    lower: Array
    upper: Array
    velocity: Array
    acceleration: Array
    joint_names: tuple[str, ...]
    velocity_lower: Array = None  # type: ignore[assignment]
    acceleration_lower: Array = None  # type: ignore[assignment]
    jerk: Array | None = None
    deceleration: Array | None = None

    def __post_init__(self) -> None:
        names = tuple(str(name) for name in self.joint_names)
        object.__setattr__(self, "joint_names", names)
        for field in ("velocity", "acceleration"):
            if getattr(self, f"{field}_lower") is None:
                upper = _vector(getattr(self, field), self.dof, f"limits.{field}")
                object.__setattr__(self, f"{field}_lower", -upper)
        for field in self.__dataclass_fields__:
            if field != "joint_names" and getattr(self, field) is not None:
                value = _vector(getattr(self, field), self.dof, f"limits.{field}")
                object.__setattr__(self, field, value)
        self._check_positions()
        given = [name for name in _SIGNS if getattr(self, name) is not None]
        rates = np.array([_SIGNS[name] * getattr(self, name) for name in given])
        if not ((rates > 0.0) & (rates < np.inf)).all():
            for name in given:
                self._check_rate(name, _SIGNS[name])

    def _check_positions(self) -> None:
        # A comparison with NaN is false, so NaN is refused here as well.
        bad = ~(self.lower <= self.upper)
        if bad.any():
            j = int(np.argmax(bad))
            raise InvalidRequest(
                f"limits of joint {self.joint_names[j]!r}: lower {self.lower[j]:.6g} must not "
                f"exceed upper {self.upper[j]:.6g}",
                field=f"limits.lower[{j}]",
                allowed="numbers with lower <= upper",
            )

    def _check_rate(self, field: str, sign: float) -> None:
        value = sign * getattr(self, field)
        bad = ~(np.isfinite(value) & (value > 0.0))
        if bad.any():
            j = int(np.argmax(bad))
            word = "positive" if sign > 0 else "negative"
            raise InvalidRequest(
                f"limits.{field} of joint {self.joint_names[j]!r} must be finite and {word}, "
                f"not {sign * value[j]:g}",
                field=f"limits.{field}[{j}]",
                allowed=f"a finite {word} number",
            )

    @property
    def dof(self) -> int:
        """Number of joints."""
        return len(self.joint_names)

    @classmethod
    def from_robot(
        cls,
        robot: LimitedRobot,
        velocity_scale: float = 1.0,
        acceleration_scale: float = 1.0,
        jerk: ArrayLike | None = None,
    ) -> JointLimits:
        """Take the limits of a robot.

        Args:
            robot: Anything with ``lower``, ``upper``, ``velocity_limit``, ``acceleration_limit``
                and ``joint_names``.
            velocity_scale: Share of the velocity limits to use, in (0, 1].
            acceleration_scale: Share of the acceleration limits to use, in (0, 1].
            jerk: Jerk limits, shape (dof,) [rad/s^3 or m/s^3]; None: no limit.

        Returns:
            The robot's limits, scaled.

        Raises:
            InvalidRequest: A scale is outside (0, 1], or a jerk limit makes no sense.
        """
        scales: dict[str, Any] = {
            "velocity_scale": velocity_scale,
            "acceleration_scale": acceleration_scale,
        }
        for field, scale in scales.items():
            if not 0.0 < scale <= 1.0:
                raise InvalidRequest(
                    f"{field} must be in (0, 1], not {scale!r}",
                    field=f"limits.{field}",
                    allowed="a number in (0, 1]",
                )
        return cls(
            lower=robot.lower,
            upper=robot.upper,
            velocity=velocity_scale * np.asarray(robot.velocity_limit, dtype=np.float64),
            acceleration=acceleration_scale
            * np.asarray(robot.acceleration_limit, dtype=np.float64),
            joint_names=tuple(robot.joint_names),
            jerk=None if jerk is None else np.asarray(jerk, dtype=np.float64),
        )

    def check_positions(self, q: Array, field: str) -> None:
        """Refuse joint positions that are not finite or leave the position limits.

        Args:
            q: Joint positions, shape (n, dof) [rad or m].
            field: Name of the field they came from.

        Raises:
            InvalidRequest: Names the row and the joint.
        """
        if q.ndim != 2 or q.shape[1] != self.dof or q.shape[0] == 0:
            raise InvalidRequest(
                f"{field} must have shape (n, {self.dof}) with n >= 1, not {q.shape}",
                field=field,
                allowed=f"rows of {self.dof} numbers",
            )
        bad = ~(np.isfinite(q) & (q >= self.lower) & (q <= self.upper))
        if bad.any():
            row, j = (int(i) for i in np.argwhere(bad)[0])
            value, name = q[row, j], self.joint_names[j]
            where = f"{field}[{row}], joint {name!r}: "
            if not np.isfinite(value):
                raise InvalidRequest(
                    f"{where}{value} is not a finite number",
                    field=f"{field}[{row}][{j}]",
                    allowed="a finite number",
                )
            raise InvalidRequest(
                f"{where}{value:.9g} is outside the position limits "
                f"[{self.lower[j]:.9g}, {self.upper[j]:.9g}]",
                field=f"{field}[{row}][{j}]",
                allowed=[float(self.lower[j]), float(self.upper[j])],
            )
