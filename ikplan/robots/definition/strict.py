"""What the parts of a ``robot.yaml`` are built of."""

from __future__ import annotations

from typing import Annotated

from pydantic import BaseModel, ConfigDict, Field

from ikplan.documents import AT_FIRST_USE

__all__ = ["Number", "Strict", "Triple"]

Number = Annotated[float, Field(allow_inf_nan=False)]
Triple = tuple[Number, Number, Number]


class Strict(BaseModel):
    """Closed and immutable."""

    model_config = ConfigDict(extra="forbid", frozen=True, defer_build=AT_FIRST_USE)
