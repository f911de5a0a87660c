"""Options of ``ikplan compare``."""

from __future__ import annotations

import argparse

from ikplan.cli.options import add_json, add_robot_frames, add_scene, add_talk

__all__ = ["add_compare"]


def add_compare(parser: argparse.ArgumentParser) -> None:
    """The solvers, the robot, the targets, the budget, and where the comparison goes."""
    parser.add_argument(
        "solvers",
        nargs="+",
        metavar="SOLVER",
        help="names of searches (see `ikplan solvers`), each with parameters of its own if wanted: "
        "ik-ba:noise=normal,eps_scale=0.1",
    )
    parser.add_argument("--robot", required=True, metavar="ROBOT", help="a name or a file")
    add_robot_frames(parser)
    parser.add_argument(
        "--targets", type=int, default=20, metavar="N", help="random targets; 20 if absent"
    )
    parser.add_argument(
        "--seeds", type=int, default=10, metavar="N", help="runs a target; 10 if absent"
    )
    parser.add_argument(
        "--first-seed", type=int, default=0, metavar="N", help="the first seed; 0 if absent"
    )
    parser.add_argument(
        "--budget",
        type=int,
        default=10_000,
        metavar="N",
        help="most evaluations of a run; 10,000 if absent",
    )
    parser.add_argument(
        "--kind",
        choices=("position", "pose"),
        default="position",
        help="what is drawn; position if absent",
    )
    parser.add_argument(
        "--start-distance",
        type=float,
        metavar="DEG",
        help="start within this angle a joint of a solution [deg]; absent: at home",
    )
    parser.add_argument(
        "--param",
        action="append",
        default=[],
        metavar="NAME=VALUE",
        help="a parameter of all of them, such as weight_motion=0.05; may be repeated",
    )
    parser.add_argument("--population", type=int, metavar="N", help="N of all; absent: the papers'")
    add_scene(parser)
    parser.add_argument(
        "--self-collision",
        action="store_true",
        help="without a scene: keep the arm clear of itself, as a term of the objective",
    )
    parser.add_argument(
        "--module",
        action="append",
        default=[],
        metavar="FILE",
        help="a Python file that registers solvers by ikplan.register_solver; may be repeated",
    )
    parser.add_argument(
        "-o", "--output", metavar="DIR", help="write rows, table, figure and COCO files there"
    )
    add_json(parser)
    add_talk(parser)
