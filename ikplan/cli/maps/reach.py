"""``ikplan reach``."""

from __future__ import annotations

import argparse
import math
from typing import Any

import numpy as np

from ikplan.cli.requests.robot import named_or_loaded
from ikplan.cli.requests.scene import set_scene
from ikplan.cli.terminal.output import say, say_json
from ikplan.cli.terminal.progress import progress_bar
from ikplan.cli.terminal.telling import tell_start
from ikplan.errors import InvalidRequest

__all__ = ["reach"]

_STEPS = 10
"""Steps along the longest edge of a grid whose spacing is not given."""


def reach(options: argparse.Namespace) -> None:
    """Map which poses a robot reaches.

    Raises:
        InvalidRequest: An option makes no sense.
        RobotNotFound: No robot of that name.
        OSError: A file cannot be written.
    """
    tell_start(options, "loading")
    from ikplan.reach.poses import MAX_POSES, grid_positions, spread_orientations
    from ikplan.reach.reach_map import reach_map
    from ikplan.reach.save import check_files, draw_reach_map, save_reach_map
    from ikplan.robots.reach import reach as reach_of

    check_files(options.output, options.plot)
    robot = named_or_loaded(options, options.robot)
    farthest = reach_of(robot)
    lower = np.array(options.lower or [-farthest] * 3)
    upper = np.array(options.upper or [farthest] * 3)
    spacing = options.spacing
    if spacing is None:
        spacing = max(float((upper - lower).max()) / _STEPS, 1e-3)
    positions = grid_positions(lower, upper, spacing)
    within = math.pi if options.within is None else math.radians(options.within)
    rotations = spread_orientations(
        options.directions, options.rolls, toward=options.toward, within=within
    )
    if len(positions) * len(rotations) > MAX_POSES:
        raise InvalidRequest(
            f"--spacing: {len(positions) * len(rotations):,} poses, more than {MAX_POSES:,}",
            field="--spacing",
            allowed=MAX_POSES,
        )
    document: dict[str, Any] = {"scene": {} if options.self_collision else None}
    set_scene(options, document)
    with progress_bar(quiet=options.quiet) as bar:
        found = reach_map(
            robot,
            positions,
            rotations,
            scene=document["scene"],
            progress=None if bar is None else lambda done, count: bar("poses", done, count),
        )
    if options.output is not None:
        save_reach_map(found, options.output)
    if options.plot is not None:
        draw_reach_map(found, options.plot)
    summary: dict[str, Any] = {
        "robot": found.robot,
        "positions": len(found.positions),
        "orientations": len(found.rotations),
        "reached": int(found.reached.sum()),
        "in_contact": int(found.in_contact.sum()),
        "positions_reached": int(found.reached.any(axis=1).sum()),
        "positions_reached_in_every_orientation": int(found.reached.all(axis=1).sum()),
    }
    if options.json:
        say_json(summary)
        return
    count = found.reached.size
    say(
        f"{summary['reached']:,} of {count:,} poses are reached "
        f"({100.0 * summary['reached'] / count:.1f} %), {summary['in_contact']:,} only in contact",
        f"{summary['positions_reached']:,} of {len(positions):,} positions are reached, "
        f"{summary['positions_reached_in_every_orientation']:,} in every orientation",
    )
    for file in (options.output, options.plot):
        if file is not None:
            say(f"wrote {file}")
