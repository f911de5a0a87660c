"""G-code as a path for the tool: G0 to G3 of a three-axis program, as a request."""

from __future__ import annotations

from typing import TYPE_CHECKING

from ikplan._lazy import on_first_use

if TYPE_CHECKING:
    from ikplan.gcode.machine import Move
    from ikplan.gcode.reading import Toolpath, gcode_request, read_gcode, read_toolpath
    from ikplan.gcode.suffixes import SUFFIXES
else:
    __getattr__ = on_first_use(
        __name__,
        {
            "Move": "machine",
            "SUFFIXES": "suffixes",
            "Toolpath": "reading",
            "gcode_request": "reading",
            "read_gcode": "reading",
            "read_toolpath": "reading",
        },
    )

__all__ = ["SUFFIXES", "Move", "Toolpath", "gcode_request", "read_gcode", "read_toolpath"]
