"""The documents of events: signals at places or times of a motion."""

from __future__ import annotations

from typing import Annotated

from pydantic import Field, model_validator

from ikplan.documents.base import MAX_NUMBER, Document, Vector
from ikplan.documents.certificate import Result

__all__ = ["Event", "EventResult"]

_Signed = Annotated[float, Field(ge=-MAX_NUMBER, le=MAX_NUMBER)]


class Event(Document):
    """A place or a time of the motion, such as that of an output: exactly one of both."""

    name: str = Field(min_length=1, max_length=200, description="Its name.")
    segment: Annotated[int, Field(ge=0)] | None = Field(
        None,
        description="Number of the segment that it is on, from 0; of waypoints, segment k ends at "
        "waypoint k. null: the whole motion.",
    )
    distance: _Signed | None = Field(
        None,
        description="Distance of the tool from the begin of the segment, along the path [m]; "
        "negative: from its end, backwards. On joint motions and moves, along the tool's own way.",
    )
    time: _Signed | None = Field(
        None,
        description="Time since the begin of the segment [s]; negative: before its end.",
    )

    @model_validator(mode="after")
    def _one(self) -> Event:
        if (self.distance is None) == (self.time is None):
            raise ValueError("give a distance or a time")
        return self


class EventResult(Result):
    """When an event is, and where the tool is then."""

    name: str = Field(description="Its name.")
    segment: int | None = Field(description="The segment that was asked for.")
    time: float = Field(description="When it is, since the begin of the motion [s].")
    position: Vector = Field(description="Position of the tool then, in the base, shape (3,) [m].")
    q: Vector = Field(description="Joint values then, shape (dof,) [rad or m].")
    position_error: float | None = Field(
        description="Distance from the place asked for [m]; null: a time was asked for."
    )
