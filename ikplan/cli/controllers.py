"""A robot's controller, in words."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from ikplan.documents.controller import Controller

__all__ = ["controller_lines"]


def controller_lines(controller: Controller) -> list[str]:
    """Return what a controller does, one fact a line, and where each comes from."""
    c = controller
    lines = [
        f"controller: {c.title}",
        f"- cycle: {1e3 * c.cycle:g} ms ({1.0 / c.cycle:g} Hz); interpolation: {c.interpolation}",
    ]
    if c.jerk is not None:
        lines.append(f"- jerk limits: {', '.join(f'{value:g}' for value in c.jerk)} (SI)")
    if c.zero_end_acceleration:
        lines.append("- a motion has to begin and end with zero acceleration")
    for language in c.languages:
        longest = language.longest_program
        bound = "" if longest is None else f", at most {longest} samples a program"
        lines.append(f"- runs {language.name}, {language.variant}{bound}")
    if c.base_frame is not None:
        origin = ", ".join(f"{v:g}" for v in c.base_frame.position)
        turn = ", ".join(f"{v:g}" for v in c.base_frame.quaternion_xyzw)
        lines.append(f"- base frame: at {origin} m, quaternion xyzw {turn}, in our base")
    return lines + [f"- source of {source.fact}: {source.source}" for source in c.sources]
