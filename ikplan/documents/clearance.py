"""The document of a proof that nothing touches: how near bodies come, where and when."""

from __future__ import annotations

from pydantic import BaseModel, ConfigDict, Field

from ikplan.documents import AT_FIRST_USE

__all__ = [
    "AllowedPair",
    "BodySource",
    "Clearance",
    "LeftContact",
    "NearestPlace",
    "SegmentClearance",
]


class _Result(BaseModel):
    """A part of an answer; see :class:`ikplan.documents.certificate.Result`."""

    model_config = ConfigDict(
        frozen=True,
        extra="ignore",
        defer_build=AT_FIRST_USE,
        populate_by_name=True,
        serialize_by_alias=True,
    )


class NearestPlace(_Result):
    """How near bodies come to each other in a motion, or in a part of it."""

    proven: bool = Field(
        description="Whether the gap asked for is proven at every instant; with none asked for, "
        "that nothing touches."
    )
    least: float | None = Field(
        description="Distance proven at every instant, >= 0 [m]; null: no pair is checked."
    )
    found: float | None = Field(
        description="Smallest distance seen, 0 where bodies touch [m]; null: no pair is checked."
    )
    time: float | None = Field(description="When it is seen [s].")
    pair: list[str] | None = Field(description="Names of the two bodies.")
    points: list[list[float]] | None = Field(
        description="The point of each of them, in the robot's base frame [m]."
    )
    tolerance: float = Field(description="Most between the place found and what is proven [m].")
    pairs_checked: int = Field(description="How many pairs of bodies are kept apart.")
    undecided: bool = Field(
        False,
        description="Whether a pair came nearer to the gap asked for than the proof resolves; "
        "that counts as contact.",
    )


class SegmentClearance(NearestPlace):
    """The same of one segment."""

    begin: float = Field(description="When the segment begins [s].")
    end: float = Field(description="When it ends [s].")


class AllowedPair(_Result):
    """Two bodies that may touch."""

    pair: list[str] = Field(description="Their names.")
    reason: str = Field(description="Why.")


class BodySource(_Result):
    """Where the shape of a body is from."""

    body: str = Field(description="Its name.")
    source: str = Field(description="Where its shape is from.")
    excess: float = Field(description="How far the shape checked reaches beyond it [m].")


class LeftContact(_Result):
    """Contact at the start that the request asks to leave."""

    pairs: list[list[str]] = Field(description="Names of the bodies that touch at the start.")
    until: float = Field(description="From when on it is proven that they do not [s].")


class Clearance(NearestPlace):
    """What the proof between samples says of the whole motion."""

    clearance: float = Field(0.0, description="Gap asked for [m].")
    interpolation: str = Field(
        description='Motion that the proof holds for: "polynomials" of the plan\'s motion, or '
        '"cubic" between samples by their positions and velocities.'
    )
    self_: NearestPlace = Field(
        alias="self", description="Robot, tool and attached parts against each other."
    )
    scene: NearestPlace = Field(description="The same bodies against obstacles.")
    segments: list[SegmentClearance] = Field([], description="The same of each segment.")
    allowed: list[AllowedPair] = Field([], description="Pairs that may touch.")
    sources: list[BodySource] = Field([], description="Where each shape is from.")
    left: LeftContact | None = Field(
        None, description="Contact at the start that is left; null: there is none."
    )
    unchecked: list[str] = Field(
        [], description="Links without a shape, of which nothing is known."
    )
