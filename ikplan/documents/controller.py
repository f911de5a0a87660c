"""The document of a robot's controller: what runs the samples and the programs of a plan.

SI units: metres, radians, seconds.
"""

from __future__ import annotations

from typing import Annotated, Any, Literal

from pydantic import (
    BaseModel,
    BeforeValidator,
    ConfigDict,
    Field,
    SerializerFunctionWrapHandler,
    model_serializer,
    model_validator,
)

from ikplan.documents import AT_FIRST_USE
from ikplan.documents.base import Document, as_list
from ikplan.documents.poses import Frame

__all__ = ["VARIANTS", "Controller", "ControllerInfo", "LanguageInfo", "ProgramLanguage", "Source"]

LanguageName = Literal["urscript", "rapid", "krl", "fanuc-ls", "drl", "xarm", "franky"]
Variant = Literal["cb3", "e-series", "irc5", "krc4", "r-30ib", "drcf2", "xarm-sdk", "franky-2"]
VARIANTS: dict[str, tuple[str, ...]] = {
    "urscript": ("cb3", "e-series"),
    "rapid": ("irc5",),
    "krl": ("krc4",),
    "fanuc-ls": ("r-30ib",),
    "drl": ("drcf2",),
    "xarm": ("xarm-sdk",),
    "franky": ("franky-2",),
}
"""The variants of each language."""
Numbers = Annotated[list[float], Field(min_length=1, max_length=64)]
Interpolation = Literal["none", "linear", "cubic", "quintic"]
Jerks = Annotated[
    list[Annotated[float, Field(gt=0, le=1e9)]],
    BeforeValidator(as_list),
    Field(min_length=1, max_length=64),
]
_Text = Annotated[str, Field(min_length=1, max_length=1000)]

_CYCLE = "Time between two samples that it takes [s]."
_INTERPOLATION = (
    'What it puts between two samples: "none" (it takes one a cycle and holds it), "linear", '
    '"cubic" or "quintic".'
)
_JERK = "Highest joint jerks that the maker publishes, one each [rad/s^3 or m/s^3]; null: none."
_ZERO_ENDS = "Whether a motion has to begin and end with zero acceleration; this needs jerk limits."
_BASE_FRAME = "The controller's own base frame in the robot's base; null: not known."
_LONGEST = "Most samples or points of a program; null: not known."
_VARIANT = (
    'Generation of the controller: "cb3" or "e-series" (and later) for URScript, "irc5" (and '
    'OmniCore) for RAPID, "krc4" (KSS 8 and later) for KRL, "r-30ib" (and Plus, Mini) for FANUC '
    'TP programs, "drcf2" (and later) for DRL, "xarm-sdk" for the xArm SDK, "franky-2" for franky.'
)
_JOINTS = (
    "Joint values as programs count them are this matrix times those of the robot; null: the same."
)


class Source(Document):
    """A fact and the document it comes from."""

    fact: _Text
    source: _Text

    def __str__(self) -> str:
        return f"{self.fact}: {self.source}"


def _without_joints(document: dict[str, Any]) -> dict[str, Any]:
    """Leave the matrix out where joints are counted alike: such documents stay as they were."""
    return {k: v for k, v in document.items() if k != "joints" or v is not None}


class ProgramLanguage(Document):
    """A language of programs that a controller runs."""

    name: LanguageName = Field(description="Name of the language.")
    variant: Variant = Field(description=_VARIANT)
    longest_program: int | None = Field(None, ge=2, le=10_000_000, description=_LONGEST)
    joints: Annotated[list[Numbers], Field(min_length=1, max_length=64)] | None = Field(
        None, description=_JOINTS
    )

    @model_serializer(mode="wrap")
    def _written(self, write: SerializerFunctionWrapHandler) -> dict[str, Any]:
        return _without_joints(write(self))

    @model_validator(mode="after")
    def _known(self) -> ProgramLanguage:
        if self.variant not in VARIANTS[self.name]:
            raise ValueError(
                f"{self.name} has the variants {', '.join(VARIANTS[self.name])}, not {self.variant}"
            )
        if self.joints is not None and {len(row) for row in self.joints} != {len(self.joints)}:
            raise ValueError("joints has as many rows as columns")
        return self


class Controller(Document):
    """A robot's controller, as its description gives it."""

    title: _Text = Field(description="Its name, for people.")
    cycle: float = Field(ge=1e-4, le=1.0, description=_CYCLE)
    interpolation: Interpolation = Field("none", description=_INTERPOLATION)
    jerk: Jerks | None = Field(None, description=_JERK)
    zero_end_acceleration: bool = Field(False, description=_ZERO_ENDS)
    languages: list[ProgramLanguage] = Field(
        [], max_length=16, description="Languages of the programs that it runs."
    )
    base_frame: Frame | None = Field(None, description=_BASE_FRAME)
    sources: list[Source] = Field([], max_length=64, description="Where these facts come from.")

    @model_validator(mode="after")
    def _ends(self) -> Controller:
        if self.zero_end_acceleration and self.jerk is None:
            raise ValueError("zero_end_acceleration needs jerk limits")
        return self

    def info(self) -> ControllerInfo:
        """Return what a plan says of the controller: all but the sources."""
        return ControllerInfo.model_validate(self.model_dump(exclude={"sources"}))


class _Result(BaseModel):
    model_config = ConfigDict(frozen=True, extra="ignore", defer_build=AT_FIRST_USE)


class LanguageInfo(_Result):
    """A language of programs that a controller runs."""

    name: str = Field(
        description='Name of the language: "urscript", "rapid", "krl", "fanuc-ls", "drl", "xarm" '
        'or "franky".'
    )
    variant: str = Field(description=_VARIANT)
    longest_program: int | None = Field(None, description=_LONGEST)
    joints: list[list[float]] | None = Field(None, description=_JOINTS)

    @model_serializer(mode="wrap")
    def _written(self, write: SerializerFunctionWrapHandler) -> dict[str, Any]:
        return _without_joints(write(self))


class FrameInfo(_Result):
    """A frame given by its origin and orientation in another frame."""

    position: list[float] = Field(description="Origin [m].")
    quaternion_xyzw: list[float] = Field(description="Orientation, unit quaternion (x, y, z, w).")


class ControllerInfo(_Result):
    """The controller that a plan is for."""

    title: str = Field(description="Its name, for people.")
    cycle: float = Field(description=_CYCLE)
    interpolation: str = Field("none", description=_INTERPOLATION)
    jerk: list[float] | None = Field(None, description=_JERK)
    zero_end_acceleration: bool = Field(False, description=_ZERO_ENDS)
    languages: list[LanguageInfo] = Field([], description="Languages of the programs that it runs.")
    base_frame: FrameInfo | None = Field(None, description=_BASE_FRAME)

    def language(self, name: str) -> LanguageInfo | None:
        """Return the language of that name, None if it runs no such programs."""
        return next((known for known in self.languages if known.name == name), None)
