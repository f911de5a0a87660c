"""Joint limits that differ from place to place on a path."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from ikplan.arrays import Array
from ikplan.errors import InvalidRequest
from ikplan.joint_path.joint_path import JointPath
from ikplan.limits.joint_limits import JointLimits
from ikplan.timing.braking import acceleration_bounds, directions

__all__ = ["LimitProfile", "SegmentJointLimits"]


_RATES = ("velocity", "velocity_lower", "acceleration", "acceleration_lower")


@dataclass(frozen=True, eq=False)
class SegmentJointLimits:
    """Joint limits of their own for a range of a path.

    Attributes:
        start: Where the range begins, as a path position s.
        end: Where it ends.
        limits: Velocity, acceleration and jerk limits there; positions are limited for the whole
            path.
    """

    start: float
    end: float
    limits: JointLimits

    def __post_init__(self) -> None:
        if not self.start < self.end:
            raise InvalidRequest(
                f"a range of limits must begin before it ends, not [{self.start}, {self.end}]",
                field="limits.segments",
                allowed="start < end",
            )


@dataclass(frozen=True, eq=False)
class LimitProfile:
    """Velocity, acceleration and jerk limits of every joint on every piece of a path.

    Attributes:
        velocity: Upper velocity limits, shape (k, dof).
        velocity_lower: Lower velocity limits, shape (k, dof), negative.
        acceleration: Upper acceleration limits, shape (k, dof).
        acceleration_lower: Lower acceleration limits, shape (k, dof), negative.
        jerk: Jerk limits, both ways, shape (k, dof); inf: none.
        joint_names: Names of the joints.
    """

    velocity: Array
    velocity_lower: Array
    acceleration: Array
    acceleration_lower: Array
    jerk: Array
    joint_names: tuple[str, ...]

    @classmethod
    def merged(
        cls, path: JointPath, limits: JointLimits, segments: Sequence[SegmentJointLimits] = ()
    ) -> LimitProfile:
        """Give every piece the strictest of the limits that hold on it.

        Args:
            path: The path, with a knot at both ends of every range.
            limits: Limits of the whole path.
            segments: Limits of ranges.

        Returns:
            The profile.
        """
        k = len(path.s_knots) - 1
        if any(x.deceleration is not None for x in (limits, *(r.limits for r in segments))):
            up, down = directions(path)
        else:  # nothing depends on them
            up = down = np.zeros((k, path.dof), dtype=np.bool_)
        middle = 0.5 * (path.s_knots[:-1] + path.s_knots[1:])
        rates = {name: np.full((k, path.dof), getattr(limits, name)) for name in _RATES}
        rates["acceleration"], rates["acceleration_lower"] = acceleration_bounds(limits, up, down)
        jerk = np.full((k, path.dof), np.inf if limits.jerk is None else limits.jerk)
        for segment in segments:
            inside = (middle > segment.start) & (middle < segment.end)
            own = {name: getattr(segment.limits, name) for name in _RATES[:2]}
            bounds = acceleration_bounds(segment.limits, up[inside], down[inside])
            own |= dict(zip(_RATES[2:], bounds, strict=True))
            for name, values in own.items():
                stricter = np.maximum if name.endswith("lower") else np.minimum
                rates[name][inside] = stricter(rates[name][inside], values)
            if segment.limits.jerk is not None:
                jerk[inside] = np.minimum(jerk[inside], segment.limits.jerk)
        return cls(joint_names=limits.joint_names, jerk=jerk, **rates)

    def scaled(self, limit: str, joint: int, factor: float) -> LimitProfile:
        """Return the profile with one limit of one joint multiplied.

        Args:
            limit: "velocity" or "acceleration", the upper and the lower one, or "jerk".
            joint: Index of the joint.
            factor: The factor.

        Returns:
            The changed profile.
        """
        changed = {}
        for name in (limit,) if limit == "jerk" else (limit, f"{limit}_lower"):
            array = getattr(self, name).copy()
            array[:, joint] *= factor
            changed[name] = array
        return replace(self, **changed)
