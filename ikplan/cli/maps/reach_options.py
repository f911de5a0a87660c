"""Options of ``ikplan reach``."""

from __future__ import annotations

import argparse

from ikplan.cli.options import add_json, add_robot_frames, add_scene, add_talk

__all__ = ["add_reach"]


def add_reach(parser: argparse.ArgumentParser) -> None:
    """The robot, the grid, the orientations, what is in the way, and where the map goes."""
    parser.add_argument("robot", metavar="ROBOT", help="a name or a file")
    add_robot_frames(parser)
    parser.add_argument(
        "--along",
        metavar="REQUEST",
        help="how much of the path of this request is reached, at each shift of it; the grid is "
        "then that of the shifts",
    )
    parser.add_argument(
        "--poses", type=int, default=24, metavar="N", help="poses along it; 24 if absent"
    )
    for name, what in (("lower", "first"), ("upper", "last")):
        parser.add_argument(
            f"--{name}",
            nargs=3,
            type=float,
            metavar=("X", "Y", "Z"),
            help=f"{what} corner of the grid in the base [m]; absent: of the box around its reach",
        )
    parser.add_argument(
        "--spacing",
        type=float,
        metavar="M",
        help="distance of neighbours [m]; absent: a tenth of the longest edge",
    )
    parser.add_argument(
        "--directions",
        type=int,
        default=20,
        metavar="N",
        help="directions of the tool's z axis, spread evenly; 20 if absent",
    )
    parser.add_argument(
        "--rolls", type=int, default=1, metavar="N", help="turns about each; 1 if absent"
    )
    parser.add_argument(
        "--toward",
        nargs=3,
        type=float,
        default=[0.0, 0.0, -1.0],
        metavar=("X", "Y", "Z"),
        help="axis of the cone of directions in the base; down if absent",
    )
    parser.add_argument(
        "--within",
        type=float,
        metavar="DEG",
        help="half the angle of that cone [deg]; absent: all directions",
    )
    add_scene(parser)
    parser.add_argument(
        "--self-collision",
        action="store_true",
        help="without a scene: a solution in which the arm touches itself does not count",
    )
    parser.add_argument("-o", "--output", metavar="FILE", help="write the map there (.parquet)")
    parser.add_argument("--plot", metavar="FILE", help="draw the map there (.png, .svg, .pdf)")
    add_json(parser)
    add_talk(parser)
