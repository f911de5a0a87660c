"""``ikplan time``."""

from __future__ import annotations

import argparse
import csv
import io
import sys
from pathlib import Path
from typing import TYPE_CHECKING, Any

from ikplan.cli.planning import check_outputs, draw, report, robot_of_file, watched
from ikplan.cli.progress import progress_bar
from ikplan.documents import load_json
from ikplan.documents.timing import TimingRequest
from ikplan.errors import InvalidRequest

if TYPE_CHECKING:
    from ikplan.result import Plan
    from ikplan.robots import Robot

__all__ = ["time"]


def time(options: argparse.Namespace) -> None:
    """Time a joint path, here or by a service, and write the trajectory."""
    check_outputs(options)
    document = _document(options)
    robot = robot_of_file(options.urdf, options, document)
    made = _by_service(options.server, document) if options.server else _here(document, robot)
    draw(made, options, document, TimingRequest, robot)
    report(made, options)


def _document(options: argparse.Namespace) -> Any:
    """The request of the files and options."""
    read = _read(options.path)
    if isinstance(read, dict) and options.robot is None:
        document = read
    elif isinstance(read, list) and (options.robot is None) != (options.urdf is None):
        document = {"robot": options.robot or "a file's", "waypoints": read}
    else:
        raise InvalidRequest(
            "give either a request document, or a robot (a name, or --robot FILE) and a file of "
            "joint values: a JSON list of rows, or CSV",
            field="command line",
        )
    if options.rate is not None:
        _merge(document, "sampling", {"rate_hz": options.rate})
    if options.jerk is not None:
        _merge(document, "limits", {"jerk": options.jerk})
    if options.scale is not None:
        scales = {"velocity_scale": options.scale, "acceleration_scale": options.scale}
        _merge(document, "limits", scales)
    return document


def _merge(document: dict[str, Any], key: str, values: dict[str, Any]) -> None:
    present = document.get(key, {})
    # What is no object is left for the request's own check to refuse.
    document[key] = {**present, **values} if isinstance(present, dict) else present


def _read(name: str) -> Any:
    """The JSON document, or the rows of a CSV file; a file that cannot be read raises OSError."""
    data = sys.stdin.buffer.read() if name == "-" else Path(name).read_bytes()
    if not name.lower().endswith(".csv"):
        return load_json(data)
    try:
        rows = [row for row in csv.reader(io.StringIO(data.decode())) if row]
        if not rows:
            return []
        # Of a trajectory written by ikplan, the columns of the joint values.
        chosen = [c for c, title in enumerate(rows[0]) if title.startswith("q ")]
        if chosen:
            rows = [[row[c] for c in chosen] for row in rows[1:]]
        return [[float(cell) for cell in row] for row in rows]
    except (ValueError, IndexError, csv.Error) as error:
        raise InvalidRequest(
            f"{name}: a CSV file of joint values has a row of numbers for each waypoint: {error}",
            field="waypoints",
            allowed="rows of numbers",
        ) from error


def _here(document: Any, robot: Robot | None) -> Plan:
    from ikplan.retiming import time_request

    with progress_bar() as progress:
        return time_request(document, robot=robot, progress=progress)


def _by_service(url: str, document: Any) -> Plan:
    from ikplan.client import Client

    with Client(url, timeout=3600.0) as client:
        return watched(lambda: client.time(document), lambda: client.submit_time(document))
