"""Options that commands share."""

from __future__ import annotations

import argparse

from ikplan.points.names import INTERPOLATIONS, TOOL_AXES
from ikplan.points.units import ANGLES, LENGTHS

__all__ = [
    "add_changes",
    "add_json",
    "add_outputs",
    "add_path",
    "add_robot",
    "add_robot_frames",
    "add_scene",
    "add_server",
    "add_talk",
]


def add_talk(parser: argparse.ArgumentParser) -> None:
    """How much a command tells beside its answer."""
    group = parser.add_mutually_exclusive_group()
    group.add_argument(
        "-q", "--quiet", action="store_true", help="tell nothing but the answer and what is wrong"
    )
    group.add_argument(
        "-v", "--verbose", action="store_true", help="tell what is being done, and how long it took"
    )


def add_json(parser: argparse.ArgumentParser) -> None:
    """Documents instead of text."""
    parser.add_argument(
        "--json",
        action="store_true",
        help="print the JSON document instead; where there is none, the problem document",
    )


def add_server(parser: argparse.ArgumentParser) -> None:
    """Who plans."""
    parser.add_argument(
        "--server",
        metavar="URL",
        help="let the service at that address plan; absent: that of IKPLAN_SERVER, if it runs",
    )
    parser.set_defaults(may_use_service=True)


def add_robot_frames(parser: argparse.ArgumentParser) -> None:
    """What is said with a robot of a file."""
    group = parser.add_argument_group("a robot of a file", "what the file itself does not say")
    group.add_argument("--base", metavar="LINK", help="base link; absent: the root")
    group.add_argument(
        "--tip", metavar="LINK", help="tip link; absent: the tool frame of the only arm"
    )
    group.add_argument(
        "--home", metavar="Q,Q,...", help="home, one value a joint, with commas [rad or m]"
    )
    group.add_argument(
        "--joint-limits", metavar="FILE", help="a joint_limits.yaml, as MoveIt reads them"
    )
    group.add_argument(
        "--velocity-default",
        metavar="NAME",
        help="for turning joints whose velocity limit is 0 or absent: 90-deg-per-s",
    )
    group.add_argument(
        "--arg",
        action="append",
        default=[],
        metavar="NAME:=VALUE",
        help="argument of a xacro file, or setting of a DH table",
    )


def add_robot(parser: argparse.ArgumentParser) -> None:
    """Another robot than the request's."""
    parser.add_argument(
        "--robot",
        dest="robot_override",
        metavar="ROBOT",
        help="the robot: a name, or a file or folder (URDF, xacro, DH table); instead of that of "
        "the request",
    )
    add_robot_frames(parser)


def add_scene(parser: argparse.ArgumentParser) -> None:
    """What stands around the arm."""
    parser.add_argument(
        "--scene",
        metavar="FILE",
        help="what the arm must not touch, instead of the request's scene: a scene in JSON or "
        "YAML, a planning scene of MoveIt, or the URDF of a cell; with --server, also the id of "
        "an uploaded one",
    )


def add_outputs(parser: argparse.ArgumentParser) -> None:
    """Where an answer goes."""
    parser.add_argument(
        "-o",
        "--output",
        action="append",
        default=[],
        metavar="FILE",
        help="write the plan there, - for standard output; the suffix names the format (.json, "
        ".csv, .npz, .ros.json, .script)",
    )
    parser.add_argument(
        "--format", metavar="NAME", help="the format instead; for standard output: json if absent"
    )
    parser.add_argument("--plot", metavar="FILE", help="draw the plan there (.png, .svg, .pdf)")
    parser.add_argument(
        "--plot-timing", metavar="FILE", help="draw what it uses of its limits there"
    )
    add_server(parser)


def add_changes(parser: argparse.ArgumentParser) -> None:
    """Changes of the request."""
    parser.add_argument("--rate", type=float, metavar="HZ", help="samples per second")
    parser.add_argument(
        "--duration", type=float, metavar="S", help="how long the motion takes, if it can"
    )
    parser.add_argument(
        "--set",
        action="append",
        default=[],
        metavar="FIELD=VALUE",
        help="set a field of the request, such as limits.tool_speed=0.25 or path.blend=0.01",
    )


def add_path(parser: argparse.ArgumentParser) -> None:
    """A file of points, and the rest of a request for it."""
    points = parser.add_argument_group(
        "files of points", "what the file itself does not say; see docs/points.md"
    )
    points.add_argument(
        "--units", metavar="UNIT", help=f"unit of lengths in the file: {', '.join(LENGTHS)}"
    )
    points.add_argument(
        "--angles", metavar="UNIT", help=f"unit of angles in the file: {', '.join(ANGLES)}"
    )
    points.add_argument(
        "--columns",
        metavar="NAMES",
        help="names of the columns in order, such as x,y,z,qx,qy,qz,qw; - for one to pass over",
    )
    path = parser.add_argument_group("path", "metres and radians")
    path.add_argument(
        "--free-axis",
        metavar="AXIS",
        help="axis of the tool about which it may turn; the one that columns i, j, k give: "
        f"{', '.join(TOOL_AXES)} (write --free-axis=-z)",
    )
    path.add_argument(
        "--interpolation",
        metavar="HOW",
        help=f"how points are joined: {', '.join(INTERPOLATIONS)}",
    )
    path.add_argument(
        "--approach",
        metavar="HOW",
        help="how the first point is reached: path, or joint for a joint motion",
    )
    path.add_argument(
        "--start", nargs="+", metavar="Q", help="joint values at the start; or free, or home"
    )
    path.add_argument(
        "--frame",
        nargs="+",
        type=float,
        metavar="N",
        help="the frame of the points: x y z, x y z rx ry rz (a rotation vector), or x y z qx qy "
        "qz qw",
    )
    path.add_argument(
        "--base-frame",
        metavar="LINK",
        help="a link fixed to the base, in whose frame the points (and --frame) are; controller: "
        "the base of the pendant",
    )
    path.add_argument(
        "--tool",
        nargs="+",
        type=float,
        metavar="N",
        help="the tool in the tip frame, as numbers like those of --frame",
    )
