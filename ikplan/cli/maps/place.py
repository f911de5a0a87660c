"""``ikplan place``."""

from __future__ import annotations

import argparse
import json
import math
import sys
from pathlib import Path
from typing import Any

from ikplan.cli.requests.robot import name_robot
from ikplan.cli.requests.scene import set_scene, with_meshes_beside
from ikplan.cli.terminal.exit_codes import NO_PLAN
from ikplan.cli.terminal.output import say, say_json
from ikplan.cli.terminal.telling import tell_start
from ikplan.documents import load_json
from ikplan.errors import InvalidRequest

__all__ = ["place"]

_ANGLES = ("roll", "pitch", "yaw")
_UNITS = {"time": "s", "motion": "rad or m", "wrist-speed": "rad/s"}


def place(options: argparse.Namespace) -> int:
    """Find where to put the part or the robot's base.

    Returns:
        The exit code.

    Raises:
        InvalidRequest: The request or an option makes no sense.
        OSError: A file cannot be read or written.
    """
    from ikplan.placement.place import place as find
    from ikplan.placement.save import check_map_file, draw_placement, save_placement
    from ikplan.plans.figures.style import check_image_suffix

    for file, check in ((options.output, check_map_file), (options.plot, check_image_suffix)):
        if file is not None:
            check(file)
    bounds = _bounds(options)
    data = sys.stdin.buffer.read() if options.request == "-" else Path(options.request).read_bytes()
    document: Any = with_meshes_beside(load_json(data), options.request)
    set_scene(options, document)
    tell_start(options, "loading")
    robot = name_robot(options, document)
    found = find(
        document,
        bounds,
        robot=robot,
        move=options.move,
        minimise=options.minimise,
        solver=options.solver,
        evaluations=options.evaluations,
        searches=options.searches,
        seed=options.seed,
        carried=options.carried,
        on=options.on,
        workers=options.workers,
    )
    if options.output is not None:
        save_placement(found, options.output)
    if options.plot is not None:
        draw_placement(found, options.plot)
    if options.best is not None and found.best:
        text = json.dumps(found.best[0].request, indent=1, allow_nan=False)
        Path(options.best).write_text(text + "\n", encoding="utf-8")
    planned = sum(row.outcome == "planned" for row in found.rows)
    summary: dict[str, Any] = {
        "minimise": found.aim,
        "given": {
            "outcome": found.given.outcome,
            "value": None if math.isnan(found.given.value) else found.given.value,
            "reached": found.given.reached,
        },
        "best": [
            {"values": each.values, "value": each.value, "plan": each.plan.id}
            for each in found.best
        ],
        "gain": None if math.isnan(found.gain) else found.gain,
        "placements": len(found.rows),
        "planned": planned,
    }
    if options.json:
        say_json(summary)
    else:
        say(*_lines(summary))
        for file in (options.output, options.plot, options.best if found.best else None):
            if file is not None:
                say(f"wrote {file}")
    return 0 if found.best else NO_PLAN


def _bounds(options: argparse.Namespace) -> dict[str, tuple[float, float]]:
    found = {}
    for name in ("x", "y", "z", *_ANGLES):
        pair = getattr(options, name)
        if pair is not None:
            low, high = (math.radians(v) for v in pair) if name in _ANGLES else pair
            found[name] = (low, high)
    if not found:
        raise InvalidRequest(
            "say what may change: --x, --y, --z, --roll, --pitch, --yaw, each with two numbers",
            field="command line",
        )
    return found


def _lines(summary: dict[str, Any]) -> list[str]:
    unit = _UNITS[summary["minimise"]]
    given, best = summary["given"], summary["best"]
    lines = [f"{summary['planned']} of {summary['placements']} placements looked at have a plan"]
    if given["value"] is None:
        share = f"{100.0 * given['reached']:.0f} % of the path"
        lines.append(f"as given: no plan ({given['outcome']}, {share} reached)")
    else:
        lines.append(f"as given: {given['value']:.4g} {unit}")
    for each in best:
        values = ", ".join(_shown(name, value) for name, value in each["values"].items())
        lines.append(f"{each['value']:.4g} {unit}: {values} (plan {each['plan']})")
    if summary["gain"] is not None:
        lines.append(f"{100.0 * summary['gain']:.1f} % less than as given")
    return lines


def _shown(name: str, value: float) -> str:
    return f"{name} {math.degrees(value):.2f} deg" if name in _ANGLES else f"{name} {value:.4f} m"
