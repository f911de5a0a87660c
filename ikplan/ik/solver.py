"""What a solver is: its parameters, its source, its presets and where its kernel lives.

Nothing compiled is imported before a solver is used.
"""

from __future__ import annotations

import importlib
import math
from collections.abc import Callable, Mapping
from numbers import Real
from typing import Any

from pydantic import BaseModel, ConfigDict, Field

from ikplan.documents import AT_FIRST_USE
from ikplan.errors import InvalidRequest, near_names

__all__ = ["Parameter", "Preset", "Solver", "common_parameters"]

Scalar = bool | int | float | str


class Parameter(BaseModel):
    """A named parameter of a solver.

    A parameter with ``choices`` reaches the kernel as the index of the choice.
    """

    model_config = ConfigDict(frozen=True, defer_build=AT_FIRST_USE)

    name: str
    default: Scalar
    description: str
    unit: str | None = Field(None, description="Unit; null: a pure number or a choice.")
    choices: list[str] | None = Field(None, description="The choices, of a parameter that has any.")
    minimum: float | None = None
    maximum: float | None = None

    def check(self, value: Scalar, field: str) -> Scalar:
        """Return ``value`` as this parameter's type.

        Raises:
            InvalidRequest: It is of another type or out of range; gives the range.
        """
        allowed: Any = self.choices or f"{self._low()}..{self._high()}"
        if self.choices is not None:
            if value not in self.choices:
                raise InvalidRequest(
                    f"{field}: must be one of {', '.join(self.choices)}, not {value!r}",
                    field=field,
                    allowed=self.choices,
                )
            return value
        if isinstance(self.default, bool):
            if not isinstance(value, bool):
                raise InvalidRequest(
                    f"{field}: must be true or false, not {value!r}",
                    field=field,
                    allowed=[True, False],
                )
            return value
        if isinstance(value, bool) or not isinstance(value, Real) or not math.isfinite(value):
            raise InvalidRequest(
                f"{field}: must be a number, not {value!r}", field=field, allowed=allowed
            )
        if isinstance(self.default, int) and value != int(value):
            raise InvalidRequest(
                f"{field}: must be a whole number, not {value!r}", field=field, allowed=allowed
            )
        below = self.minimum is not None and value < self.minimum
        if below or (self.maximum is not None and value > self.maximum):
            raise InvalidRequest(
                f"{field}: must be in {allowed}, not {value!r}", field=field, allowed=allowed
            )
        return type(self.default)(value)

    def _low(self) -> str:
        return "-inf" if self.minimum is None else f"{self.minimum:g}"

    def _high(self) -> str:
        return "inf" if self.maximum is None else f"{self.maximum:g}"


def common_parameters(warm: str = "cold") -> list[Parameter]:
    """Return the parameters that every search takes.

    Args:
        warm: Default of the parameter ``warm``.
    """
    return [
        Parameter(
            name="objective",
            default="auto",
            choices=["auto", "position", "orientation", "weighted", "bode-cs"],
            description="What is minimised: the distance (Eq. 1 of Slim et al.); the relative "
            "orientation error (Eq. 3); omega_P Delta P + omega_R Delta R (Eq. 6 of Li et al.); "
            "the same in millimetres with omega_R computed from the robot (Eqs. 8-12 of Li et "
            "al.); auto: weighted for a pose, position for a position.",
        ),
        Parameter(
            name="weight_position",
            default=1.0,
            minimum=0.0,
            unit="1/m",
            description="omega_P of the weighted objective.",
        ),
        Parameter(
            name="weight_orientation",
            default=0.1,
            minimum=0.0,
            description="omega_R of the weighted objective, per unit of ||R - R_d||_F.",
        ),
        Parameter(
            name="weight_motion",
            default=0.0,
            minimum=0.0,
            unit="m/rad",
            description="What the distance of the joint values from the start weighs beside the "
            "error of the pose, in the unit of the objective.",
        ),
        Parameter(
            name="decouple",
            default=False,
            description="Search the wrist centre with the first joints only, and take the last "
            "three joints from the spherical-wrist decoupling (Slim et al., section 4.3).",
        ),
        Parameter(
            name="wrist_limits",
            default="ignore",
            choices=["ignore", "penalise"],
            description="Decoupled: ignore the wrist limits in the search, as the paper does, or "
            "add 1 m to the objective where no wrist solution is inside them.",
        ),
        Parameter(
            name="bounds",
            default="clip",
            choices=["clip", "reflect", "resample"],
            description="What happens to a position outside the joint limits: set to the limit, "
            "mirrored there, or drawn anew. No paper says it.",
        ),
        Parameter(
            name="warm",
            default=warm,
            choices=["cold", "individual", "cloud"],
            description="Use of the start configuration in the first population: none, as one "
            "individual, or as the centre of a normal cloud of 10 degrees around it.",
        ),
    ]


_COMMON = {p.name for p in common_parameters()}


class Preset(BaseModel):
    """A parametrisation of a solver, from one of the papers.

    Attributes:
        source: Where it is from.
        values: Parameters that differ from the defaults.
        population: N there.
        iterations: T there.
    """

    model_config = ConfigDict(frozen=True, defer_build=AT_FIRST_USE)

    source: str
    values: dict[str, Scalar]
    population: int
    iterations: int


class Solver(BaseModel):
    """A solver of the registry."""

    model_config = ConfigDict(frozen=True, defer_build=AT_FIRST_USE)

    name: str
    title: str
    source: str = Field(description="Paper, equations and tables.")
    family: str = Field(description='"metaheuristic", "newton", "refinement" or "closed-form".')
    notes: str = ""
    parameters: list[Parameter]
    population: int | None = Field(description="N of the paper; null: the method has none.")
    iterations: int | None = Field(description="T of the paper, or the most steps from one seed.")
    min_population: int = Field(1, description="Smallest population the method works with.")
    planner_population: int | None = Field(None, description="N of the planner's own budget.")
    planner_iterations: int | None = Field(None, description="T of the planner's own budget.")
    evaluations: str = Field("", description="Evaluations for N and T.")
    presets: dict[str, Preset] = Field(
        default={}, description="Values of the parameter `preset`, first the default."
    )
    module: str = Field(exclude=True)
    kernel: str = Field(exclude=True)
    params_type: str | None = Field(None, exclude=True)
    fixed: dict[str, int] = Field({}, exclude=True)

    @property
    def searches(self) -> bool:
        """Whether it is run by :class:`ikplan.ik.metaheuristic_seeds.Searcher`."""
        return self.params_type is not None

    def load(self) -> Callable[..., Any]:
        """Import and return the kernel."""
        function: Callable[..., Any] = getattr(importlib.import_module(self.module), self.kernel)
        return function

    def own_parameters(self) -> list[Parameter]:
        """The parameters that the kernel takes, without the common ones."""
        return [p for p in self.parameters if p.name not in _COMMON and p.name != "preset"]

    def check(self, params: Mapping[str, Scalar]) -> dict[str, Scalar]:
        """Return every parameter with its value, defaults filled in.

        Raises:
            InvalidRequest: Unknown name (near names given), wrong type, out of range.
        """
        known = {p.name: p for p in self.parameters}
        for name in params:
            if name not in known:
                near = near_names(name, known)
                hint = f"; did you mean {near[0]!r}?" if near else ""
                raise InvalidRequest(
                    f"ik.params.{name}: {self.name} has no parameter {name!r}{hint}",
                    field=f"ik.params.{name}",
                    allowed=sorted(known),
                )
        given = {name: known[name].check(v, f"ik.params.{name}") for name, v in params.items()}
        defaults: dict[str, Scalar] = {name: p.default for name, p in known.items()}
        if self.presets:
            preset = str(given.get("preset", known["preset"].default))
            defaults.update(self.presets[preset].values)
        return {**defaults, **given}

    def paper_budget(self, values: Mapping[str, Scalar]) -> tuple[int | None, int | None]:
        """Return N and T of the paper whose parameters ``values`` are."""
        if self.presets:
            preset = self.presets[str(values["preset"])]
            return preset.population, preset.iterations
        return self.population, self.iterations

    def pack(self, values: Mapping[str, Scalar]) -> Any:
        """Return the kernel's parameter tuple from checked values."""
        if self.params_type is None:
            return None
        cls = getattr(importlib.import_module(self.module), self.params_type)
        packed: dict[str, bool | int | float] = dict(self.fixed)
        for p in self.own_parameters():
            value = values[p.name]
            packed[p.name] = p.choices.index(str(value)) if p.choices else value  # type: ignore[assignment]
        return cls(**packed)
