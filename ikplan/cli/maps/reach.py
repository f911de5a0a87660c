"""``ikplan reach``."""

from __future__ import annotations

import argparse
import math
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from ikplan.cli.requests.robot import named_or_loaded
from ikplan.cli.requests.scene import set_scene, with_meshes_beside
from ikplan.cli.terminal.output import say, say_json
from ikplan.cli.terminal.progress import progress_bar
from ikplan.cli.terminal.telling import tell_start
from ikplan.documents import load_json
from ikplan.errors import InvalidRequest

if TYPE_CHECKING:
    from ikplan.arrays import Array
    from ikplan.robots import Robot

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
    if options.along is not None and (options.lower is None or options.upper is None):
        raise InvalidRequest(
            "--along: say how the path is shifted: --lower and --upper", field="--along"
        )
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
    if options.along is not None:
        _along(options, robot, positions)
        return
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


def _along(options: argparse.Namespace, robot: Robot, shifts: Array) -> None:
    """Map how much of a request's path is reached."""
    from ikplan.reach.path_reach import path_reach
    from ikplan.reach.save import draw_reach_map, save_path_reach

    document: Any = with_meshes_beside(load_json(Path(options.along).read_bytes()), options.along)
    set_scene(options, document)
    if isinstance(document, dict):
        document["robot"] = robot.name
    with progress_bar(quiet=options.quiet) as bar:
        found = path_reach(
            document,
            shifts,
            robot=robot,
            scene={} if options.self_collision and not document.get("scene") else None,
            poses=options.poses,
            progress=None if bar is None else lambda done, count: bar("poses", done, count),
        )
    if options.output is not None:
        save_path_reach(found, options.output)
    if options.plot is not None:
        draw_reach_map(found, options.plot)
    best = int(np.argmax(found.share))
    summary: dict[str, Any] = {
        "robot": found.robot,
        "shifts": len(found.positions),
        "poses": options.poses,
        "reached_whole": int(found.reached.all(axis=1).sum()),
        "best": {"shift": found.positions[best].tolist(), "reached": float(found.share[best])},
    }
    if options.json:
        say_json(summary)
        return
    x, y, z = summary["best"]["shift"]
    say(
        f"all {options.poses} poses are reached at {summary['reached_whole']:,} of "
        f"{summary['shifts']:,} shifts of the path",
        f"most at x {x:.3f}, y {y:.3f}, z {z:.3f} m: {100.0 * found.share[best]:.1f} %",
    )
    for file in (options.output, options.plot):
        if file is not None:
            say(f"wrote {file}")
