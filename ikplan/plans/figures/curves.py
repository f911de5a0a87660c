"""Curves of the joints over time, into any axes."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from ikplan.arrays import Array
from ikplan.errors import InvalidRequest, RobotNotFound
from ikplan.plans.figures.style import colour, line_style

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from ikplan.documents.plan_document import PlanDocument
    from ikplan.robots import Robot

__all__ = ["draw_curves", "known_robot", "position_curves", "velocity_curves"]


def draw_curves(plan: PlanDocument, axes: Any) -> Figure:
    """Draw joint positions, and velocities where there are two axes; return their figure.

    Args:
        plan: The plan.
        axes: One axes of Matplotlib, or two.

    Raises:
        InvalidRequest: More than two axes, or none.
    """
    given = list(np.atleast_1d(np.asarray(axes, dtype=object)).ravel())
    if len(given) not in (1, 2):
        raise InvalidRequest("axes: must be one or two", field="axes", allowed="1 or 2 axes")
    for unit in ("rad", "m"):
        if unit in plan.joint_units:
            position_curves(given[0], plan, unit, labels=True)
    if len(set(plan.joint_units)) > 1:
        given[0].set_ylabel("position [deg or m]")
    if len(given) == 2:
        robot = known_robot(plan, None)
        velocity_curves(given[1], plan, robot)
        given[1].set_title("Joint velocities over their limits" if robot else "Joint velocities")
        given[1].set_ylabel("velocity / limit" if robot else "velocity [rad/s or m/s]")
    given[-1].set_xlabel("time [s]")
    drawn: Figure = given[0].figure
    return drawn


def known_robot(plan: PlanDocument, robot: Robot | None) -> Robot | None:
    """Return the robot given or that of the catalogue; None: it has not the joints of the plan."""
    from ikplan.robots import catalogue_robot

    if robot is None:
        try:
            robot = catalogue_robot(plan.robot)
        except RobotNotFound:
            return None
    return robot if list(robot.joint_names) == plan.joint_names else None


def position_curves(axes: Axes, plan: PlanDocument, unit: str, *, labels: bool = False) -> None:
    """Draw the positions of the joints of a unit, with dots at the waypoints."""
    scale = 180.0 / np.pi if unit == "rad" else 1.0
    motion = plan.trajectory
    for j in (j for j, u in enumerate(plan.joint_units) if u == unit):
        label = plan.joint_names[j] if labels else None
        axes.plot(
            motion.time, scale * motion.q[:, j], color=colour(j), ls=line_style(j), label=label
        )
        axes.plot(plan.waypoints.time, scale * plan.waypoints.q[:, j], ".", ms=5, color=colour(j))
    axes.set_title("Joint positions, dots at the waypoints")
    axes.set_ylabel(f"position [{'deg' if unit == 'rad' else 'm'}]")


def velocity_curves(axes: Axes, plan: PlanDocument, robot: Robot | None) -> Array:
    """Draw the velocities, over their limits where the robot is known; return what is drawn."""
    motion = plan.trajectory
    limits = robot.velocity_limit if robot is not None else np.ones(len(plan.joint_names))
    ratio: Array = motion.dq / limits
    for j in range(len(plan.joint_names)):
        axes.plot(motion.time, ratio[:, j], color=colour(j), ls=line_style(j))
    return ratio
