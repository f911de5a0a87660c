"""Options of ``ikplan batch``."""

from __future__ import annotations

import argparse

from ikplan.cli.options import add_robot, add_server, add_talk

__all__ = ["add_batch"]


def add_batch(parser: argparse.ArgumentParser) -> None:
    """Lines, who answers them, and where the rows go."""
    parser.add_argument("requests", metavar="FILE", help="JSON lines, or - for standard input")
    parser.add_argument(
        "-o",
        "--output",
        metavar="FILE",
        help="write the rows there, not to standard output; FOLDER/: in shards, which a batch that "
        "was ended in any way continues",
    )
    parser.add_argument(
        "--kind",
        default="plan",
        metavar="KIND",
        help="what the lines are: plan (if absent), ik (as for POST /v1/ik), time (as for ikplan "
        "time) or move (the arguments of ikplan.move)",
    )
    parser.add_argument(
        "--on",
        default="local",
        metavar="WHERE",
        help="who answers: local (if absent), processes of this machine; ray, or ray=ADDRESS, "
        "actors of a Ray cluster",
    )
    parser.add_argument(
        "--resume",
        action="store_true",
        help="keep the rows that the output has, and answer the other lines",
    )
    parser.add_argument(
        "--format", metavar="NAME", help="of shards: jsonl.zst (if absent) or parquet"
    )
    parser.add_argument(
        "--shard-lines", type=int, metavar="N", help="rows of a shard; absent: by the kind"
    )
    add_server(parser)
    add_robot(parser)
    parser.add_argument(
        "--workers",
        type=int,
        default=0,
        metavar="N",
        help="without a service: requests answered at the same time; 0: one a processor",
    )
    add_talk(parser)
