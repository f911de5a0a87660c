"""A G-code file on the command line, as a request."""

from __future__ import annotations

import argparse
from typing import Any

from ikplan import gcode  # its readers are imported where there is G-code
from ikplan.cli.requests.points import changes_of_path
from ikplan.cli.terminal.telling import tell
from ikplan.errors import InvalidRequest

__all__ = ["is_gcode", "plan_of_gcode"]


def is_gcode(name: str) -> bool:
    """Whether a file's name says that it holds G-code."""
    return name.lower().endswith(gcode.SUFFIXES)


def plan_of_gcode(options: argparse.Namespace, data: bytes) -> dict[str, Any]:
    """Return the request for a plan along the moves of a G-code file, and tell what it left out.

    Raises:
        InvalidRequest: The file or an option is wrong; names the line, or the option.
    """
    for name in ("angles", "columns", "interpolation"):
        if getattr(options, name) is not None:
            raise InvalidRequest(f"--{name} does not go with G-code", field=f"--{name}")
    toolpath = gcode.read_toolpath(data, options.units)
    for note in toolpath.notes:
        tell(options, note)
    return gcode.gcode_request(
        toolpath, {"robot": options.robot_override, **changes_of_path(options)}
    )
