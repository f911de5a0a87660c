"""What programs in Python have in common: which arms they move, how they begin, their format."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Protocol

from ikplan.documents.controller import LanguageInfo
from ikplan.plans.export.formats import Arm, Format
from ikplan.plans.export.program_text import comments, language_of

if TYPE_CHECKING:
    from ikplan.documents.plan_document import PlanDocument
    from ikplan.plans.programs.certificate import ProgramCertificate
    from ikplan.robots import Robot

__all__ = ["PythonProgram"]


class Encode(Protocol):
    """Makes the program of a plan, by its name, its robot and a tolerance [m] where given."""

    def __call__(
        self,
        plan: PlanDocument,
        name: str = ...,
        robot: Robot | None = ...,
        tolerance: float | None = ...,
        /,
    ) -> bytes: ...


@dataclass(frozen=True)
class PythonProgram:
    """Programs of a Python library that moves arms.

    Attributes:
        name: Name of the language.
        title: The same, for people.
        variant: Release of the library that is known.
        joints: How many turning joints an arm may have.
        arms: Arms of the catalogue that the library moves; their controller blocks do not name it,
            so that their plans stay as they are.
    """

    name: str
    title: str
    variant: str
    joints: tuple[int, ...]
    arms: tuple[str, ...]

    def language(self, arm: Arm) -> LanguageInfo:
        """Return what is known of the programs of an arm.

        Raises:
            InvalidRequest: It can have no such program.
        """
        known = {name: LanguageInfo(name=self.name, variant=self.variant) for name in self.arms}
        return language_of(arm, self.name, self.title, self.joints, known)

    def text(
        self,
        plan: PlanDocument,
        certificate: ProgramCertificate,
        *,
        remarks: Sequence[str],
        values: Sequence[str],
        program: str,
    ) -> bytes:
        """Return the text of a program.

        Args:
            plan: The plan.
            certificate: Of the motion that the program makes.
            remarks: Comments behind those of every program.
            values: Lines of imports and of what was planned.
            program: What moves the arm, from its first blank lines on.
        """
        lines = [
            "#!/usr/bin/env python3",
            *(f"# {line}" for line in (*comments(plan, certificate), *remarks)),
            *values,
        ]
        return ("\n".join(lines) + "\n" + program).encode("ascii")

    def format(self, title: str, encode: Encode, check: Callable[[Arm], None]) -> Format:
        """Return the format that makes them.

        Args:
            title: What it is, for people.
            encode: Makes the program of a plan.
            check: Refuses an arm that can have none.
        """
        return Format(
            name=self.name,
            title=title,
            suffixes=(f".{self.name}.py",),
            media_type=f"text/x-python-{self.name}",
            encode=encode,
            check=check,
            program=encode,
            from_rest=True,
        )
