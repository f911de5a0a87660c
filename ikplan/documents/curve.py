"""Named curves as segments of a path, each drawn in a frame of its own."""

from __future__ import annotations

from typing import Literal

from pydantic import Field, field_validator, model_validator

from ikplan.documents.poses import Frame, Quaternion, unit_quaternion
from ikplan.documents.segment import OrientationRule, ToolSegment

__all__ = [
    "CircleSegment",
    "CurveSegment",
    "HelixSegment",
    "RoseSegment",
    "SawtoothSegment",
    "SinusoidSegment",
    "TrapezoidSegment",
]

MAX_REPEATS = 1000
_LEAST = 1e-6
"""Smallest size [m] and smallest turn [rad or turns] that a curve can have: less is a point."""


class CurveSegment(ToolSegment):
    """What every named curve has.

    ``blend`` holds for the corner at the curve's first point and for those inside it as well.
    """

    frame: Frame = Field(
        default_factory=Frame, description="The curve's own frame, in the path frame."
    )
    quaternion_xyzw: Quaternion | None = Field(
        None,
        description="Tool orientation at the curve's first point, in the path frame; null: that "
        "at the end of the segment before.",
    )
    orientation: OrientationRule = Field(
        "constant",
        description='From the first point on: "constant"; "follow": the tool turns about the '
        "z axis of the curve's frame as the curve's direction does; \"free\"; or the orientation "
        "at the end.",
    )
    connect: bool = Field(
        True,
        description="Whether a straight line joins the end of the segment before to the curve's "
        "first point; false: a gap is an error.",
    )

    _check = field_validator("quaternion_xyzw")(unit_quaternion)

    @model_validator(mode="after")
    def _orientation_fits(self) -> CurveSegment:
        if self.orientation == "free" and self.quaternion_xyzw is not None:
            raise ValueError("quaternion_xyzw has no meaning where the orientation is free")
        if self.orientation == "follow" and isinstance(self, SawtoothSegment | TrapezoidSegment):
            raise ValueError("a tool cannot follow corners; choose another orientation")
        return self


class CircleSegment(CurveSegment):
    """``(radius cos a, radius sin a, 0)``, a from ``phase`` to ``phase + angle``."""

    type: Literal["circle"] = Field(description="A circle about the frame's z axis.")
    radius: float = Field(ge=_LEAST, le=100, description="Radius [m].")
    angle: float = Field(
        6.283185307179586, ge=-10_000, le=10_000, description="Angle turned, signed [rad]."
    )
    phase: float = Field(0.0, ge=-1000, le=1000, description="Angle of the first point [rad].")

    @field_validator("angle")
    @classmethod
    def _moves(cls, angle: float) -> float:
        return _not_zero(angle)


class HelixSegment(CurveSegment):
    """``(radius cos a, radius sin a, rise u)``, ``a = phase + 2 pi turns u``, u from 0 to 1."""

    type: Literal["helix"] = Field(description="A helix about the frame's z axis.")
    radius: float = Field(ge=_LEAST, le=100, description="Radius [m].")
    rise: float = Field(ge=-100, le=100, description="Way along the axis, signed [m].")
    turns: float = Field(
        ge=-MAX_REPEATS, le=MAX_REPEATS, description="Turns, positive anticlockwise about z [1]."
    )
    phase: float = Field(0.0, ge=-1000, le=1000, description="Angle of the first point [rad].")

    @field_validator("turns")
    @classmethod
    def _moves(cls, turns: float) -> float:
        return _not_zero(turns)


class RoseSegment(CurveSegment):
    """``(rho cos b, rho sin b, 0)``, ``rho = radius cos(petals b)``, b from phase on by angle."""

    type: Literal["rose"] = Field(description="A rose (rhodonea) in the frame's x-y plane.")
    radius: float = Field(ge=_LEAST, le=100, description="Length of a petal [m].")
    petals: int = Field(3, ge=1, le=50, description="Factor of the angle; even: twice the petals.")
    phase: float = Field(0.0, ge=-1000, le=1000, description="First polar angle b [rad].")
    angle: float | None = Field(
        None,
        ge=-1000,
        le=1000,
        description="Polar angle swept, signed [rad]; null: the whole rose, pi for an odd number "
        "of petals and 2 pi for an even one.",
    )

    @field_validator("angle")
    @classmethod
    def _moves(cls, angle: float | None) -> float | None:
        return None if angle is None else _not_zero(angle)


class SinusoidSegment(CurveSegment):
    """``(x, amplitude sin(2 pi x / wavelength + phase), 0)``, x from 0 to ``length``."""

    type: Literal["sinusoid"] = Field(description="A sine wave along the frame's x axis.")
    length: float = Field(ge=_LEAST, le=100, description="Way along x [m].")
    amplitude: float = Field(ge=-100, le=100, description="Amplitude along y [m].")
    wavelength: float = Field(ge=_LEAST, le=1e6, description="Way along x of one period [m].")
    phase: float = Field(0.0, ge=-1000, le=1000, description="Phase of the first point [rad].")

    @model_validator(mode="after")
    def _bounded(self) -> SinusoidSegment:
        if self.length / self.wavelength > MAX_REPEATS:
            raise ValueError(f"at most {MAX_REPEATS} periods: length / wavelength is too large")
        return self


class SawtoothSegment(CurveSegment):
    """Teeth along x: each rises to ``height`` and falls back to 0 over the last part of it."""

    type: Literal["sawtooth"] = Field(description="A sawtooth along the frame's x axis.")
    length: float = Field(ge=_LEAST, le=100, description="Way along x of all teeth [m].")
    height: float = Field(ge=-100, le=100, description="Height of the teeth along y, signed [m].")
    teeth: int = Field(ge=1, le=MAX_REPEATS, description="Number of teeth.")
    fall: float = Field(
        0.0, ge=0, le=1, description="Share of a tooth in which it falls; 0: straight down."
    )


class TrapezoidSegment(CurveSegment):
    """Trapezoids along x: up to ``height``, along the top, down to 0, along the bottom."""

    type: Literal["trapezoid"] = Field(description="A trapezoid wave along the frame's x axis.")
    length: float = Field(ge=_LEAST, le=100, description="Way along x of all periods [m].")
    height: float = Field(ge=-100, le=100, description="Height along y, signed [m].")
    periods: int = Field(ge=1, le=MAX_REPEATS, description="Number of periods.")
    ramp: float = Field(
        0.25,
        ge=0,
        le=0.5,
        description="Share of a period in each flank; 0: a square wave, 0.5: triangles. Top and "
        "bottom share the rest.",
    )


def _not_zero(value: float) -> float:
    if abs(value) < _LEAST:
        raise ValueError(f"a curve must turn: the value must differ from 0 by at least {_LEAST:g}")
    return value
