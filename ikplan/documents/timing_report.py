"""Why a motion takes as long as it does, and the motion itself, as result documents."""

from __future__ import annotations

from pydantic import BaseModel, ConfigDict, Field

from ikplan.documents import AT_FIRST_USE, Matrix, Vector

__all__ = ["BindingLimit", "MotionPolynomials", "TimingReport", "WiderLimit"]


class _Result(BaseModel):
    model_config = ConfigDict(
        frozen=True, extra="ignore", defer_build=AT_FIRST_USE, arbitrary_types_allowed=True
    )


class BindingLimit(_Result):
    """How much of the time one limit binds."""

    limit: str = Field(description='"velocity", "acceleration", "torque", "tool_linear_speed", ...')
    joint: str | None = Field(description="Name of the joint; null: a limit of the tool.")
    share: float = Field(description="Share of the duration, 0 to 1.")


class WiderLimit(_Result):
    """What a wider limit would bring, computed by timing the path again with it."""

    limit: str = Field(description="Kind of the limit.")
    joint: str | None = Field(description="Name of the joint; null: a limit of the tool.")
    factor: float = Field(description="By what the limit is multiplied.")
    duration: float = Field(description="Duration with it [s].")


class TimingReport(_Result):
    """Why the motion takes as long as it does: told by the timing, not by the certificate."""

    duration: float = Field(description="Duration of the motion [s].")
    unlimited_duration: float = Field(
        description="Duration that the same limits allow without those of the jerk [s]."
    )
    binding: list[BindingLimit] = Field(
        description="The limits that are reached, the one that binds for longest first."
    )
    summary: str = Field(description='The same in words: "62 % of the time A4 velocity, ...".')
    what_if: list[WiderLimit] = Field(
        description="The duration if one limit were 10 % wider, for those that bind for longest."
    )
    rate_hz: float | None = Field(None, description="Samples per second [Hz]; null: unknown.")
    rate_source: str | None = Field(
        None,
        description='Who gave the rate: "request", "controller" or "default"; null: unknown.',
    )
    grid_factor: float = Field(
        1.0,
        description="By what factor the motion was slowed at last, so that it ends at a multiple "
        "of the sampling period; >= 1.",
    )
    jerk_source: str | None = Field(
        None,
        description='Who gave the jerk limits of the whole motion: "request" (the maker\'s hold '
        'too) or "controller"; null: there are none.',
    )
    hints: list[str] = Field(
        [], description="What takes time and need not, in words, and the field that changes it."
    )
    zero_end_acceleration: bool = Field(
        False, description="Whether the motion begins and ends with zero joint accelerations."
    )


class MotionPolynomials(_Result):
    """The motion as polynomials: joint values cubic in s, s quadratic or cubic in time.

    Between knots, q(s) is the cubic with the given values and tangents at both ends. Between
    nodes, the path acceleration is constant, or, where ``sddot`` is given, linear in time.
    """

    s_knots: Vector = Field(description="Path positions of the knots, shape (k + 1,).")
    q_knots: Matrix = Field(description="Joint values there, shape (k + 1, dof) [rad or m].")
    tangents_start: Matrix = Field(description="dq/ds at the start of each piece, shape (k, dof).")
    tangents_end: Matrix = Field(description="dq/ds at the end of each piece, shape (k, dof).")
    node_time: Vector = Field(description="Times of the nodes, shape (n + 1,) [s].")
    node_s: Vector = Field(description="Path positions of the nodes, shape (n + 1,).")
    node_sdot: Vector = Field(description="Path velocities at the nodes, shape (n + 1,) [1/s].")
    node_sddot: Vector | None = Field(
        description="Path accelerations at the nodes, shape (n + 1,) [1/s^2]; null: constant "
        "between nodes."
    )
    pieces: list[int] = Field(
        description="Piece of the path of each interval between nodes, length n; empty with "
        "node_sddot."
    )
