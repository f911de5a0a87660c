"""Limits of the tool's speed and acceleration."""

from __future__ import annotations

import functools
from collections.abc import Callable
from dataclasses import dataclass, fields, replace

import numpy as np

from ikplan.arrays import Array, Flags, Indices
from ikplan.errors import InvalidRequest
from ikplan.timing.constraints.constraints import (
    MARGIN,
    SPEED_MARGIN,
    ConstraintRows,
    Label,
    PathPoints,
)
from ikplan.timing.constraints.tool_kernels import disc_rows, speed_bounds, tool_ratios

__all__ = ["ToolLimits", "ToolRates"]

# (q, dq, ddq), each (m, dof), to the twists of the tool and their time derivatives, (m, 6) each:
# linear first [m/s, m/s^2], then angular [rad/s, rad/s^2], in axes that do not turn with the tool.
ToolRates = Callable[[Array, Array, Array], tuple[Array, Array]]

# Directions in which an acceleration vector is bounded: a polygon inside the circle, by 0.2 % at
# most.
_DIRECTIONS = 48
_KINDS = ("linear_speed", "angular_speed", "linear_acceleration", "angular_acceleration")


@dataclass(frozen=True, eq=False)
class ToolLimits:
    """Upper bounds of the norms of the tool's velocity and acceleration.

    Along a path, the twist of the tool is V sdot and its derivative V u + A x, where V and A are
    the twist and its derivative for joint velocities q' and joint accelerations q''.

    Attributes:
        motion: The tool's velocity and acceleration for given joint motions.
        linear_speed: [m/s], None: no limit.
        angular_speed: [rad/s].
        linear_acceleration: [m/s^2].
        angular_acceleration: [rad/s^2].
        start: Where the limits begin, as a path position s.
        end: Where they end.

    Raises:
        InvalidRequest: A limit is not positive and finite, or there is none.
    """

    motion: ToolRates
    linear_speed: float | None = None
    angular_speed: float | None = None
    linear_acceleration: float | None = None
    angular_acceleration: float | None = None
    start: float = 0.0
    end: float = np.inf

    def __post_init__(self) -> None:
        for kind in _KINDS:
            value = getattr(self, kind)
            if value is not None and not (np.isfinite(value) and value > 0.0):
                raise InvalidRequest(
                    f"the tool's {kind.replace('_', ' ')} limit must be positive and finite, "
                    f"not {value!r}",
                    field=f"limits.tool.{kind}",
                    allowed="a positive number",
                )
        if not self.labels:
            raise InvalidRequest(
                "a tool limit needs one of " + ", ".join(_KINDS), field="limits.tool"
            )

    @property
    def labels(self) -> tuple[Label, ...]:
        """The limits that are set."""
        names = [f.name for f in fields(self) if f.name in _KINDS]
        return tuple((f"tool_{n}", None) for n in names if getattr(self, n) is not None)

    def _limit(self, kind: str) -> float | None:
        value = getattr(self, kind)
        margin = SPEED_MARGIN if kind.endswith("speed") else MARGIN
        return None if value is None else float(value) * (1.0 - margin)

    @functools.cached_property
    def _limits(self) -> tuple[Array, Flags]:
        """The limits with their margins, and which are set; the others are infinite, ratios 0."""
        limits = np.array([self._limit(kind) or np.inf for kind in _KINDS])
        return limits, np.isfinite(limits)

    @functools.cached_property
    def _squares(self) -> tuple[float, float]:
        """Squares of the limits of the speeds with their margins; inf where there is none."""
        linear, angular = (self._limit(kind) or np.inf for kind in _KINDS[:2])
        return float(linear**2), float(angular**2)

    @functools.cached_property
    def _bounded_accelerations(self) -> dict[str, float]:
        """The limits of the accelerations that are set, with their margins."""
        limits = {kind: self._limit(kind) for kind in _KINDS[2:]}
        return {kind: limit for kind, limit in limits.items() if limit is not None}

    def at(self, points: PathPoints) -> ConstraintRows:
        """Write the limits at points of a path; see PathConstraint."""
        V, A = self.motion(points.q, points.qs, points.qss)
        limits, bounded_kinds = self._limits
        x_max = speed_bounds(V, *self._squares)
        bounded = self._bounded_accelerations

        def coefficients(index: Indices) -> tuple[Array, Array]:
            a, b = np.zeros((2, len(index), _DIRECTIONS * len(bounded)))
            for k, (kind, limit) in enumerate(bounded.items()):
                part, place = _part(kind), slice(k * _DIRECTIONS, (k + 1) * _DIRECTIONS)
                P, R = (np.ascontiguousarray(rate[index, part]) for rate in (V, A))
                a[:, place], b[:, place] = disc_rows(P, R, _DIRECTIONS, limit)
            return a, b

        def ratios(index: Indices, u: Array, x: Array) -> Array:
            found: Array = tool_ratios(V, A, index, u, x, limits)[:, bounded_kinds]
            return found

        return ConstraintRows(_DIRECTIONS * len(bounded), coefficients, x_max, ratios)

    def ratio(self, q: Array, dq: Array, ddq: Array) -> Array:
        """Return how far joint motions use the limits; see PathConstraint."""
        rates = dict(zip(("speed", "acceleration"), self.motion(q, dq, ddq), strict=True))
        ratio = np.zeros(len(q))
        for kind in _KINDS:
            limit, rate = getattr(self, kind), kind.split("_")[1]
            if limit is not None:
                rate_ratio = np.linalg.norm(rates[rate][:, _part(kind)], axis=1) / limit
                ratio = np.maximum(ratio, np.square(rate_ratio) if rate == "speed" else rate_ratio)
        return ratio

    def scaled(self, label: Label, factor: float) -> ToolLimits:
        """Return the limits with one multiplied; see PathConstraint."""
        if label not in self.labels:
            return self
        kind = label[0].removeprefix("tool_")
        return replace(self, **{kind: getattr(self, kind) * factor})


def _part(kind: str) -> slice:
    return slice(0, 3) if kind.startswith("linear") else slice(3, 6)
