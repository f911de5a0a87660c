"""Options of ``ikplan place``."""

from __future__ import annotations

import argparse

from ikplan.cli.options import add_json, add_robot, add_scene, add_talk

__all__ = ["add_place"]


def add_place(parser: argparse.ArgumentParser) -> None:
    """The request, what may change, what is least, the search, and where the map goes."""
    parser.add_argument(
        "request", metavar="REQUEST", help="a request for a plan; -: standard input"
    )
    add_robot(parser)
    add_scene(parser)
    for name in ("x", "y", "z"):
        parser.add_argument(
            f"--{name}",
            nargs=2,
            type=float,
            metavar=("FROM", "TO"),
            help=f"how far it may move along the base's {name} [m]",
        )
    for name, axis in (("roll", "x"), ("pitch", "y"), ("yaw", "z")):
        parser.add_argument(
            f"--{name}",
            nargs=2,
            type=float,
            metavar=("FROM", "TO"),
            help=f"how far it may turn about the base's {axis} [deg]",
        )
    parser.add_argument(
        "--move",
        choices=["part", "base"],
        default="part",
        help="what is moved: the part with its path, or the robot's base; part if absent",
    )
    parser.add_argument(
        "--carry",
        dest="carried",
        action="append",
        default=[],
        metavar="NAME",
        help="an obstacle that moves with the part; several times for several",
    )
    parser.add_argument(
        "--for",
        dest="minimise",
        choices=["time", "motion", "wrist-speed"],
        default="time",
        help="what is least: the duration, the motion of all joints, or the largest speed of the "
        "last three joints; time if absent",
    )
    parser.add_argument(
        "--solver", default="bode-cs", metavar="NAME", help="the search; bode-cs if absent"
    )
    parser.add_argument(
        "--evaluations",
        type=int,
        default=200,
        metavar="N",
        help="placements looked at in each search; 200 if absent",
    )
    parser.add_argument(
        "--searches",
        type=int,
        default=1,
        metavar="N",
        help="searches, each with its own seed; 1 if absent",
    )
    parser.add_argument(
        "--seed", type=int, default=0, metavar="N", help="seed of the first; 0 if absent"
    )
    parser.add_argument(
        "--on",
        default="local",
        metavar="WHERE",
        help="local (worker processes), ray or ray=ADDRESS; local if absent",
    )
    parser.add_argument(
        "--workers",
        type=int,
        default=0,
        metavar="N",
        help="workers; absent or 0: one a processor",
    )
    parser.add_argument(
        "-o", "--output", metavar="FILE", help="write every placement there (.parquet, .csv)"
    )
    parser.add_argument("--plot", metavar="FILE", help="draw them there (.png, .svg, .pdf)")
    parser.add_argument(
        "--best", metavar="FILE", help="write the request at the best placement there (.json)"
    )
    add_json(parser)
    add_talk(parser)
