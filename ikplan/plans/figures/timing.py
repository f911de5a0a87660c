"""The figure of a timing: what every limit allows, and what the motion uses of it."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from matplotlib.figure import Figure

from ikplan.arrays import Array
from ikplan.certificate.limits import torque_ratios
from ikplan.documents import parse
from ikplan.documents.limits import LimitOptions
from ikplan.limits.motion_limits import MotionLimits
from ikplan.plans.figures.phase_plane import path_speed, path_speed_bound
from ikplan.plans.figures.style import (
    COLOURS,
    METADATA,
    check_image_suffix,
    colour,
    line_style,
    style,
)

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from ikplan.documents.plan_document import PlanDocument
    from ikplan.robots import Robot

__all__ = ["draw_timing", "plot_timing"]

_POSITIONS = "Positions over their ranges"
_LIMIT: dict[str, Any] = {"color": "#B00020", "lw": 1.0, "ls": (0, (4, 3))}


def plot_timing(
    plan: PlanDocument,
    path: str | Path,
    *,
    robot: Robot | None = None,
    limits: Mapping[str, Any] | LimitOptions | None = None,
) -> None:
    """Draw a plan's timing to a file: the same plan and limits give the same bytes.

    Args:
        plan: The plan.
        path: Image file; the suffix (png, svg, pdf) names the format.
        robot: The robot with its tool; None: the catalogue's, with no tool.
        limits: The limits of the request, which a plan does not tell; None: the robot's own.

    Raises:
        InvalidRequest: No image can be written with that suffix, or the limits are wrong.
        RobotNotFound: No robot is given, and the plan's is not in the catalogue.
        OSError: The file cannot be written.
    """
    suffix = check_image_suffix(path)
    figure = draw_timing(plan, robot=robot, limits=limits)
    with style():
        figure.savefig(path, format=suffix[1:], dpi=150, metadata=METADATA[suffix])


def draw_timing(
    plan: PlanDocument,
    *,
    robot: Robot | None = None,
    limits: Mapping[str, Any] | LimitOptions | None = None,
) -> Figure:
    """Draw a plan's timing; the arguments are those of :func:`plot_timing`."""
    from ikplan.robots import catalogue_robot
    from ikplan.robots.narrowing import narrowed

    robot = robot if robot is not None else catalogue_robot(plan.robot)
    options = parse(LimitOptions, limits or {})
    promised = MotionLimits.of(narrowed(robot, options.joints), options)
    with style():
        figure = Figure(figsize=(12.0, 9.0))
        panels: Any = figure.subplots(3, 2)
        # Placed by hand: a layout solver's last digits would change the bytes.
        figure.subplots_adjust(
            left=0.07, right=0.98, top=0.87, bottom=0.065, hspace=0.36, wspace=0.17
        )
        figure.suptitle(
            f"{plan.robot}: {plan.duration:.3f} s", x=0.012, y=0.985, ha="left", weight="bold"
        )
        if plan.timing is not None:
            figure.text(0.012, 0.944, _shortened(plan.timing.summary), color="#555555")
        if plan.certificate.segments:
            figure.text(
                0.98, 0.958, "shaded: a segment's own limits hold too", ha="right", color="#555555"
            )
        _joints(panels, plan, robot, promised)
        _tool_speed(panels[2, 0], plan, robot, promised)
        _phase_plane(panels[2, 1], plan, promised)
        handles = panels[0, 0].get_lines()[: len(plan.joint_names)]
        figure.legend(
            handles, plan.joint_names, loc="upper left", bbox_to_anchor=(0.005, 0.94), ncols=8
        )
    return figure


def _shortened(summary: str, most: int = 150) -> str:
    return summary if len(summary) <= most else summary[:most].rpartition(",")[0] + ", ..."


def _joints(panels: Any, plan: PlanDocument, robot: Robot, limits: MotionLimits) -> None:
    """Positions, velocities, accelerations and torques, each over its limit."""
    motion = plan.trajectory
    bounded = np.isfinite(robot.lower) & np.isfinite(robot.upper)
    middle = np.where(bounded, 0.5 * (robot.lower + robot.upper), 0.0)
    half = np.where(bounded, 0.5 * (robot.upper - robot.lower), np.pi)
    up = motion.dq / np.where(motion.dq > 0.0, limits.velocity, -limits.velocity_lower)
    above = motion.ddq / np.where(motion.ddq > 0.0, limits.acceleration, -limits.acceleration_lower)
    _ratios(panels[0, 0], plan, (motion.q - middle) / half, _POSITIONS)
    _ratios(panels[0, 1], plan, up, "Velocities over their limits")
    _ratios(panels[1, 0], plan, above, "Accelerations over their limits")
    effort = robot.effort_limit if limits.torque is None else limits.torque
    if robot.info().inertias_sourced and np.isfinite(effort).all():
        tau = torque_ratios(
            robot,
            motion.q,
            motion.dq,
            motion.ddq,
            effort,
            limits.payload_mass,
            limits.payload_position,
        )
        title = "Torques (size) over their limits"
        if limits.torque is None:
            title += " (not asked for)"
        _ratios(panels[1, 1], plan, tau, title, lowest=0.0)
        return
    panels[1, 1].set_title("Torques")
    panels[1, 1].set(xticks=[], yticks=[])
    panels[1, 1].text(
        0.5, 0.5, "the robot's inertias have no source", ha="center", color="#555555",
        transform=panels[1, 1].transAxes,
    )  # fmt: skip


def _ratios(
    axes: Axes, plan: PlanDocument, ratios: Array, title: str, lowest: float = -1.0
) -> None:
    for j in range(ratios.shape[1]):
        axes.plot(plan.trajectory.time, ratios[:, j], color=colour(j), ls=line_style(j), lw=1.2)
    for limit in {lowest, 1.0} - {0.0}:
        axes.axhline(limit, **_LIMIT)
    if title != _POSITIONS:
        _segments(axes, plan)
    top = 1.1 * max(1.0, float(np.abs(ratios).max(initial=0.0)))
    axes.set_ylim(-top if lowest < 0.0 else 0.0, top)
    _times(axes, plan, title, "share of the limit")


def _segments(axes: Axes, plan: PlanDocument) -> None:
    """Shade where limits of segments hold, which are not those drawn."""
    for segment in plan.certificate.segments:
        axes.axvspan(segment.begin, segment.end, color="#000000", alpha=0.06, lw=0.0, zorder=0.0)


def _times(axes: Axes, plan: PlanDocument, title: str, label: str) -> None:
    axes.set_xlim(0.0, max(plan.duration, 1e-9))
    axes.set_title(title)
    axes.set_xlabel("time [s]")
    axes.set_ylabel(label)


def _tool_speed(axes: Axes, plan: PlanDocument, robot: Robot, limits: MotionLimits) -> None:
    motion = plan.trajectory
    twist = np.einsum("mij,mj->mi", robot.jacobians(motion.q), motion.dq)
    for part, unit, line, limit in (
        (slice(0, 3), "linear [m/s]", COLOURS[0], limits.tool_speed[0]),
        (slice(3, 6), "angular [rad/s]", COLOURS[1], limits.tool_speed[1]),
    ):
        axes.plot(motion.time, np.linalg.norm(twist[:, part], axis=1), color=line, label=unit)
        if np.isfinite(limit):
            axes.axhline(limit, **_LIMIT)
    axes.set_ylim(0.0, 1.08 * max(float(axes.get_ylim()[1]), 1e-9))
    axes.legend(loc="lower right", bbox_to_anchor=(1.01, 0.98), ncols=2)
    _segments(axes, plan)
    _times(axes, plan, "Tool speed", "speed")


def _phase_plane(axes: Axes, plan: PlanDocument, limits: MotionLimits) -> None:
    """Speed along the joint path over the way made, under what joint limits allow there."""
    motion = plan.trajectory
    s, speed = path_speed(motion.time, motion.q, motion.dq)
    bound = path_speed_bound(motion.dq, motion.ddq, limits)
    axes.fill_between(s, speed, color=COLOURS[0], alpha=0.12, lw=0.0)
    axes.plot(s, speed, color=COLOURS[0], label="motion")
    axes.plot(s, bound, label="highest that joint limits allow", **_LIMIT)
    axes.set_xlim(0.0, max(float(s[-1]), 1e-9))
    axes.set_ylim(0.0, 1.3 * max(float(speed.max(initial=0.0)), 1e-9))
    axes.set_title("Phase plane")
    axes.set_xlabel("joint path length")
    axes.set_ylabel("path speed [1/s]")
    axes.legend(loc="lower right", bbox_to_anchor=(1.01, 0.98), ncols=2)
