"""Figures of a plan: joint positions, velocities against their limits, the tool's path.

Drawn on a Figure object, without pyplot's global state; the same plan gives the same bytes.
"""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from matplotlib.figure import Figure

from ikplan.errors import InvalidRobot
from ikplan.plans.figures.bodies import draw_bodies, draw_clearance
from ikplan.plans.figures.curves import known_robot, position_curves, velocity_curves
from ikplan.plans.figures.style import (
    COLOURS,
    IMAGE_SUFFIXES,
    METADATA,
    check_image_suffix,
    colour,
    style,
)
from ikplan.plans.summary import certificate_rows
from ikplan.scene.model import collision_model

if TYPE_CHECKING:
    from collections.abc import Sequence

    from matplotlib.axes import Axes
    from matplotlib.figure import SubFigure

    from ikplan.documents.plan_document import PlanDocument
    from ikplan.robots import Robot
    from ikplan.scene.body import CollisionModel

__all__ = ["IMAGE_SUFFIXES", "check_image_suffix", "draw_plan", "plot_plan", "save_figure"]

_AROUND = 0.25
"""Half width of what is shown around a path where there are obstacles, at least [m]."""


def plot_plan(
    plan: PlanDocument,
    path: str | Path,
    *,
    robot: Robot | None = None,
    model: CollisionModel | None = None,
) -> None:
    """Draw a plan to a file.

    Args:
        plan: The plan.
        path: Image file; the suffix (png, svg, pdf) names the format.
        robot: The robot with its tool. A plan tells neither limits nor the tool, so without
            this they are the catalogue's and the path is that of the tip; for a robot that is
            not in the catalogue, limits and path are left out.
        model: The bodies of the request. A plan does not tell obstacles nor what is carried, so
            without this the clearance drawn is that of the arm from itself.

    Raises:
        InvalidRequest: No image can be written with that suffix.
        OSError: The file cannot be written.
    """
    check_image_suffix(path)
    save_figure(draw_plan(plan, robot=robot, model=model), path)


def save_figure(figure: Figure, path: str | Path) -> None:
    """Write a figure, the same bytes each time.

    Raises:
        InvalidRequest: No image can be written with that suffix.
        OSError: The file cannot be written.
    """
    suffix = check_image_suffix(path)
    with style():
        figure.savefig(path, format=suffix[1:], dpi=150, metadata=METADATA[suffix])


def draw_plan(
    plan: PlanDocument, *, robot: Robot | None = None, model: CollisionModel | None = None
) -> Figure:
    """Draw a plan; the arguments are those of :func:`plot_plan`."""
    with style():
        return _draw(plan, robot, model)


def _draw(plan: PlanDocument, robot: Robot | None, model: CollisionModel | None) -> Figure:
    known = known_robot(plan, robot)
    checked = plan.certificate.clearance is not None and plan.certificate.clearance.pair is not None
    if checked and model is None and known is not None:
        model = _own_bodies(known)
    figure = Figure(figsize=(12.0, 8.8 if checked else 7.2), layout="constrained")
    figure.suptitle(_headline(plan), x=0.01, ha="left", fontsize=12, fontweight="bold")
    halves: Any = figure.subfigures(1, 2, width_ratios=[1.5, 1.0])
    units = [unit for unit in ("rad", "m") if unit in plan.joint_units]
    rows = halves[0].subplots(
        len(units) + 1 + checked, 2, width_ratios=[1.0, 0.22], sharey="row", squeeze=False
    )
    for row, unit in zip(rows, units, strict=False):
        _positions(row[0], row[1], plan, known, unit)
    _velocities(rows[-1][0], rows[-1][1], plan, known)
    if checked:
        draw_clearance(rows[-2][0], plan, known, model)
        rows[-2][1].axis("off")
    for curves, _ in rows:
        curves.set_xlim(0.0, max(plan.duration, 1e-9))
        curves.tick_params(labelbottom=curves is rows[-1][0])
    rows[-1][0].set_xlabel("time [s]")
    if len(units) == 1:  # the columns of both panels are the same joints
        rows[0][1].tick_params(labelbottom=False)
    above, below = halves[1].subfigures(2, 1, height_ratios=[1.0, 0.42])
    if known is not None:
        axes = above.add_subplot(projection="3d")
        _tool_path(axes, plan, known, model, tip=robot is None)
    else:
        reason = f"{plan.robot!r} is not in the catalogue:\nno limits and no path of the tool"
        above.text(0.5, 0.5, reason, ha="center", color="#555555")
    _certificate(below, plan)
    _settle(figure, [*halves, above, below])
    return figure


def _settle(figure: Figure, panels: Sequence[SubFigure]) -> None:
    """Lay the figure out once and for all.

    The layout solver's last digits depend on where its variables lie in memory, and the ids in
    an SVG are hashes of them.
    """
    figure.draw_without_rendering()
    figure.set_layout_engine("none")
    for panel in panels:
        panel.bbox_relative.set_points(np.round(panel.bbox_relative.get_points(), 6))
    for axes in figure.axes:
        axes.set_position(np.round(axes.get_position(original=True).bounds, 6))


def _own_bodies(robot: Robot) -> CollisionModel | None:
    """The bodies of the arm; None: its description makes no sense, which a plan has told."""
    try:
        return collision_model(robot)
    except InvalidRobot:
        return None


def _headline(plan: PlanDocument) -> str:
    count = len(plan.waypoints.time)
    return f"{plan.robot}: {count} waypoint{'s' if count != 1 else ''} in {plan.duration:.3f} s"


def _positions(
    axes: Axes, ranges: Axes, plan: PlanDocument, robot: Robot | None, unit: str
) -> None:
    """Positions over time, and beside them, on the same scale, the range of each joint."""
    position_curves(axes, plan, unit)
    scale = 180.0 / np.pi if unit == "rad" else 1.0
    joints = [j for j, u in enumerate(plan.joint_units) if u == unit]
    motion = plan.trajectory
    ranges.set_title("used of limits" if robot is not None else "range used")
    for place, j in enumerate(joints):
        low, high = scale * motion.q[:, j].min(), scale * motion.q[:, j].max()
        if robot is not None and np.isfinite(robot.lower[j]) and np.isfinite(robot.upper[j]):
            limits = [scale * robot.lower[j], scale * robot.upper[j]]
            ranges.plot([place, place], limits, color=colour(j), lw=1.0, marker="_", ms=7)
        ranges.plot([place, place], [low, high], color=colour(j), lw=5.0, solid_capstyle="butt")
    _joint_ticks(ranges, plan, joints)


def _velocities(axes: Axes, ranges: Axes, plan: PlanDocument, robot: Robot | None) -> None:
    """Velocities over their limits, and beside them the largest of each joint."""
    ratio = velocity_curves(axes, plan, robot)
    joints = list(range(len(plan.joint_names)))
    peaks = np.abs(ratio).max(axis=0)
    ranges.bar(joints, peaks, width=0.6, color=[colour(j) for j in joints])
    if robot is not None:
        for each in (axes, ranges):
            for limit in (-1.0, 1.0):
                each.axhline(limit, color="#B00020", lw=1.0, ls=(0, (4, 3)))
        reach = 1.12 * max(1.0, float(peaks.max()))
        axes.set_ylim(-reach, reach)
        axes.set_title("Joint velocities over their limits")
        axes.set_ylabel("velocity / limit")
    else:
        axes.set_title("Joint velocities")
        axes.set_ylabel("velocity [rad/s or m/s]")
    ranges.set_title("largest")
    _joint_ticks(ranges, plan, joints)


def _joint_ticks(axes: Axes, plan: PlanDocument, joints: list[int]) -> None:
    axes.set_xticks(range(len(joints)), [plan.joint_names[j] for j in joints], rotation=90)
    axes.set_axisbelow(True)
    axes.tick_params(labelleft=False, length=0)
    axes.set_xlim(-0.7, len(joints) - 0.3)
    axes.grid(visible=False, axis="x")
    for tick, j in zip(axes.get_xticklabels(), joints, strict=True):
        tick.set_color(colour(j))


def _tool_path(
    axes: Any, plan: PlanDocument, robot: Robot, model: CollisionModel | None, *, tip: bool
) -> None:
    """The path in the base frame, with the waypoints and the same scale on each axis."""
    samples = plan.trajectory.q
    if len(samples) > 600:
        samples = samples[np.linspace(0, len(samples) - 1, 600).astype(int)]
    _, path = robot.poses(samples)
    _, marks = robot.poses(plan.waypoints.q)
    axes.plot(*path.T, color=COLOURS[0], lw=1.6, label="path")
    axes.plot(*marks.T, "o", color=COLOURS[1], ms=4, label="waypoints")
    axes.plot(*path[:1].T, "^", color=COLOURS[2], ms=8, label="start")
    axes.plot(*path[-1:].T, "s", color=COLOURS[6], ms=6, label="end")
    frame = "tip" if tip else "tool"
    axes.set_title(f"Path of the {frame} in the base frame [m]", loc="left")
    axes.set_xlabel("x [m]")
    axes.set_ylabel("y [m]")
    axes.set_zlabel("z [m]")
    clearance = plan.certificate.clearance
    near = [] if clearance is None or clearance.points is None else clearance.points
    everything = np.vstack([path, marks, *([p] for p in near)])
    middle = (everything.max(axis=0) + everything.min(axis=0)) / 2
    half = 0.55 * max(float(np.ptp(everything, axis=0).max()), 1e-3)
    if model is not None and any(body.kind == "obstacle" for body in model.bodies):
        half = max(half, _AROUND)
    for set_limits, centre in zip(
        (axes.set_xlim, axes.set_ylim, axes.set_zlim), middle, strict=True
    ):
        set_limits(centre - half, centre + half)
    if model is not None:
        draw_bodies(axes, plan, robot, model, middle - half, middle + half)
    axes.set_box_aspect((1, 1, 1), zoom=0.9)
    axes.locator_params(nbins=5)
    axes.legend(loc="upper left", ncols=2)


def _certificate(panel: SubFigure, plan: PlanDocument) -> None:
    """What the independent check measured, in words."""
    panel.text(0.04, 0.95, "Certificate", va="top", fontweight="bold", fontsize=10)
    rows = certificate_rows(plan)
    # Seven rows fill the panel; more of them stand closer.
    step = min(0.105, 0.84 / len(rows))
    size = 9.0 * min(1.0, step / 0.085)
    for row, (what, value) in enumerate(rows):
        height = 0.84 - step * row
        panel.text(0.04, height, what, va="top", color="#555555", fontsize=size)
        panel.text(0.42, height, value, va="top", fontsize=size)
