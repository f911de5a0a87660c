"""``ikplan plan``."""

from __future__ import annotations

import argparse
import sys
from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, Any

from ikplan.cli.output import say, table
from ikplan.cli.progress import progress_bar
from ikplan.documents import load_json, parse
from ikplan.errors import InvalidRequest
from ikplan.request import PlanRequest
from ikplan.summary import certificate_rows

if TYPE_CHECKING:
    from ikplan.client import PlanJob
    from ikplan.documents.timing import TimingRequest
    from ikplan.result import Plan
    from ikplan.robots import Robot

__all__ = ["check_outputs", "draw", "plan", "report", "robot_of_file", "watched"]


def plan(options: argparse.Namespace) -> None:
    """Make a plan, here or by a service, and write it."""
    check_outputs(options)
    document = _read(options.request)
    robot = robot_of_file(options.robot, options, document)
    made = _by_service(options.server, document) if options.server else _here(document, robot)
    draw(made, options, document, PlanRequest, robot)
    report(made, options)


def check_outputs(options: argparse.Namespace) -> None:
    """Refuse names of files that no format or figure has: before the work, not after."""
    from ikplan.export import format_for

    for output in options.output:
        format_for(output)
    for image in (options.plot, options.plot_timing):
        if image is not None:
            from ikplan.figures.style import check_image_suffix

            check_image_suffix(image)


def report(made: Plan, options: argparse.Namespace) -> None:
    """Write a plan to its files, and tell of it."""
    from ikplan.export import save

    for output in options.output:
        save(made, output)
    if options.json:
        say(made.model_dump_json())
        return
    say(f"plan {made.id}")
    say(f"{made.robot}, {len(made.waypoints.time)} waypoints, {made.duration:.3f} s, certified:")
    say(*(f"  {line}" for line in table((), certificate_rows(made), left=2)))
    if made.timing is not None and made.timing.summary:
        say(f"binding: {made.timing.summary}")
        for wider in made.timing.what_if:
            limit = f"{wider.joint or ''} {wider.limit.replace('_', ' ')}".strip()
            say(f"  {limit} {wider.factor:g} times as wide: {wider.duration:.3f} s")
    for output in [*options.output, *filter(None, [options.plot, options.plot_timing])]:
        say(f"wrote {output}")


def _read(name: str) -> Any:
    """The request document; a file that cannot be read raises OSError."""
    return load_json(sys.stdin.buffer.read() if name == "-" else Path(name).read_bytes())


def robot_of_file(file: str | None, options: argparse.Namespace, document: Any) -> Robot | None:
    """The robot of a file, whose name then stands in the document; None: the document's."""
    if file is None:
        if options.base is not None or options.tip is not None:
            raise InvalidRequest("--base and --tip belong to --robot FILE", field="command line")
        return None
    if options.server is not None:
        _upload(Path(file), options, document)
        if options.plot is None and options.plot_timing is None:
            return None
    from ikplan.robots import load_robot

    robot = load_robot(Path(file), base=options.base, tip=options.tip)
    if isinstance(document, dict) and options.server is None:
        document["robot"] = robot.name
    return robot


def _upload(file: Path, options: argparse.Namespace, document: Any) -> None:
    """Let the service have the robot of a file; its id then stands in the document."""
    if file.suffix in (".yaml", ".yml") or file.is_dir():
        raise InvalidRequest(
            f"--robot {file}: only a URDF can be uploaded to a service", field="command line"
        )
    from ikplan.client import Client

    frames = {"base": options.base, "tip": options.tip}
    with Client(options.server) as client:
        said = {key: link for key, link in frames.items() if link is not None}
        info = client.upload_robot(file.read_bytes(), title=file.stem or "robot", **said)
    if isinstance(document, dict):
        document["robot"] = info["name"]


def _here(document: Any, robot: Robot | None) -> Plan:
    from ikplan.pipeline import plan as make

    with progress_bar() as progress:
        return make(document, robot=robot, progress=progress)


def _by_service(url: str, document: Any) -> Plan:
    from ikplan.client import Client

    with Client(url, timeout=3600.0) as client:
        return watched(lambda: client.plan(document), lambda: client.submit(document))


def watched(answer: Callable[[], Plan], submit: Callable[[], PlanJob]) -> Plan:
    """Let a service make a plan; where somebody looks, with a bar that shows how far it is.

    Args:
        answer: Asks for the plan and waits.
        submit: Asks for the plan as a job.
    """
    with progress_bar() as progress:
        if progress is None:
            return answer()
        job = submit()
        try:
            return job.wait(progress=lambda s: progress(s.stage or s.state, s.done, s.total))
        except KeyboardInterrupt:
            job.cancel()
            raise


def draw(
    made: Plan,
    options: argparse.Namespace,
    document: Any,
    model: type[PlanRequest] | type[TimingRequest],
    robot: Robot | None = None,
) -> None:
    """Draw a plan with the tool and the limits of its request, which a plan does not tell."""
    if options.plot is None and options.plot_timing is None:
        return
    from ikplan.figures.plan import plot_plan
    from ikplan.figures.timing import plot_timing
    from ikplan.identity import with_tool
    from ikplan.robots import catalogue_robot, robot_names

    request = parse(model, document)
    if robot is None and made.robot in robot_names():
        robot = catalogue_robot(made.robot)
    if robot is not None:
        robot = with_tool(robot, request.tool)
    if options.plot is not None:
        plot_plan(made, options.plot, robot=robot)
    if options.plot_timing is not None:
        plot_timing(made, options.plot_timing, robot=robot, limits=request.limits)
