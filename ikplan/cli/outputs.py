"""Where plans go: files, standard output, figures, and a few lines for people."""

from __future__ import annotations

import argparse
import sys
from typing import TYPE_CHECKING, Any, TextIO

from ikplan.cli.terminal.output import say, table
from ikplan.cli.terminal.telling import tell
from ikplan.documents import parse
from ikplan.errors import InvalidRequest
from ikplan.plans.summary import certificate_rows

if TYPE_CHECKING:
    from ikplan.documents.plan_request import PlanRequest
    from ikplan.documents.timing_request import TimingRequest
    from ikplan.plans.export.formats import Format
    from ikplan.plans.plan import Plan
    from ikplan.robots import Robot, RobotInfo

__all__ = ["STDOUT", "check_formats", "check_outputs", "draw", "report"]

STDOUT = "-"


def _format(options: argparse.Namespace, output: str) -> Format:
    from ikplan.plans.export import format_for, format_named

    if options.format is not None:
        return format_named(options.format)
    return format_named("json") if output == STDOUT else format_for(output)


def check_outputs(options: argparse.Namespace) -> None:
    """Refuse names of files that no format or figure has: before the work, not after."""
    for output in options.output:
        _format(options, output)
    if options.format is not None and not options.output:
        raise InvalidRequest("--format belongs to -o FILE", field="command line")
    if options.output.count(STDOUT) + options.json > 1:
        raise InvalidRequest(
            "standard output takes one document: -o - once, or --json", field="command line"
        )
    for image in (options.plot, options.plot_timing):
        if image is not None:
            from ikplan.plans.figures.style import check_image_suffix

            check_image_suffix(image)


def check_formats(options: argparse.Namespace, robot: RobotInfo | None) -> None:
    """Refuse formats that plans of a robot cannot have.

    Raises:
        InvalidRequest: A format that this robot can have no plan in.
    """
    if robot is None:
        return
    from ikplan.plans.export import check_format

    for output in options.output:
        check_format(robot, output, _format(options, output).name)


def report(made: Plan, options: argparse.Namespace) -> None:
    """Write a plan to its files, and tell of it: on stderr where stdout takes the plan."""
    for output in options.output:
        if output != STDOUT:
            from ikplan.plans.export import save

            save(made, output, _format(options, output).name)
    if options.verbose:
        seconds = ", ".join(f"{stage} {s:.2f} s" for stage, s in made.stats.seconds.items())
        tell(options, f"took {seconds}")
    if options.json:
        say(made.model_dump_json())
        return
    piped = STDOUT in options.output
    if not options.quiet:
        _describe(made, options, sys.stderr if piped else sys.stdout)
    if piped:
        from ikplan.plans.export import encode

        sys.stdout.flush()
        sys.stdout.buffer.write(encode(made, _format(options, STDOUT).name))
        sys.stdout.buffer.flush()


def _describe(made: Plan, options: argparse.Namespace, stream: TextIO) -> None:
    lines = [
        f"plan {made.id}",
        f"{made.robot}, {len(made.waypoints.time)} waypoints, {made.duration:.3f} s, certified:",
        *(f"  {line}" for line in table((), certificate_rows(made), left=2)),
    ]
    if made.timing is not None and made.timing.summary:
        lines.append(f"binding: {made.timing.summary}")
        for wider in made.timing.what_if:
            limit = f"{wider.joint or ''} {wider.limit.replace('_', ' ')}".strip()
            lines.append(f"  {limit} {wider.factor:g} times as wide: {wider.duration:.3f} s")
    files = [output for output in options.output if output != STDOUT]
    for output in [*files, *filter(None, [options.plot, options.plot_timing])]:
        lines.append(f"wrote {output}")
    say(*lines, stream=stream)


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
    from ikplan.documents.plan_request import PlanRequest
    from ikplan.pipeline.collisions import requested_model
    from ikplan.pipeline.resolve import resolve_robot
    from ikplan.plans.figures.plan import plot_plan
    from ikplan.plans.figures.timing import plot_timing
    from ikplan.robots import robot_names

    request = parse(model, document)
    if robot is not None or request.robot in robot_names():
        robot = resolve_robot(request, robot)
    if options.plot is not None:
        bodies = None
        if robot is not None and not isinstance(request.scene, str):
            bodies = requested_model(
                robot,
                request.scene,
                request.fixed_joints,
                request.tool,
                always=isinstance(request, PlanRequest),
            )
        plot_plan(made, options.plot, robot=robot, model=bodies)
    if options.plot_timing is not None:
        plot_timing(made, options.plot_timing, robot=robot, limits=request.limits)
