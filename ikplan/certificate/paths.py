"""Part of the certificate: where the tool is, against where it was asked to be.

Like the certificate, it uses Pinocchio and the definition of the path, and nothing of the planner.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from ikplan.certificate.places import (
    TimedSpan,
    nearest_allowed,
    offsets_at,
    share_used,
    windows_about,
)
from ikplan.path import path_deviation
from ikplan.request import PathRequest
from ikplan.robots import Robot

__all__ = ["Followed", "TimedSpan", "follow_checks"]

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Followed:
    """How far the tool was from its paths.

    Attributes:
        distance: Largest distance [m]; None: there is no tool path.
        distance_time: When [s].
        angle: Largest rotation [rad]; None: no orientation is asked for along a path.
        angle_time: When [s].
    """

    distance: float | None = None
    distance_time: float | None = None
    angle: float | None = None
    angle_time: float | None = None


def follow_checks(
    robot: Robot, path: PathRequest, spans: list[TimedSpan], time: Array, q: Array
) -> Followed:
    """Measure the tool against its paths on every sample.

    Args:
        robot: The robot, with its tool.
        path: The path of the request.
        spans: The tool paths.
        time: Sample times, shape (m,) [s].
        q: Joint values, shape (m, dof) [rad or m].
    """
    worst = Followed()
    for span in spans:
        inside = np.flatnonzero((time >= span.time[0]) & (time <= span.time[-1]))
        if len(inside) == 0:
            continue
        R, p = robot.poses(q[inside])
        hints = np.interp(time[inside], span.time, span.s)
        windows = windows_about(span, hints)
        plain = path.orientation_free is None and path.tolerance.box is None
        weight = path.tolerance.position / path.tolerance.orientation if plain else 0.0
        distance, angle, nearest = path_deviation(
            span.path, p, R, hints, window=windows, rotation_weight=weight
        )
        if not plain:
            # Where nothing is free the search's own figures hold: where an oriented piece and a
            # free one meet, the path length alone does not tell which of them it measured.
            distance, angle = offsets_at(span, path, p, R, nearest)
        left = np.flatnonzero(share_used(path, distance, angle) > 1.0)
        if len(left):
            # The path may bend, or the tool turn, faster than that search expects.
            p, R = p[left], R[left]
            s = nearest_allowed(span, path, p, R, hints[left], windows[left])
            closer = offsets_at(span, path, p, R, s)
            kept = share_used(path, *closer) <= 1.0
            for column, found in zip((nearest, distance, angle), (s, *closer), strict=True):
                column[left[kept]] = found[kept]
        at = int(np.argmax(distance))
        if worst.distance is None or distance[at] > worst.distance:
            worst = replace(
                worst, distance=float(distance[at]), distance_time=float(time[inside[at]])
            )
        counts = span.path.orientation_mask(nearest) & (path.orientation_free != "all")
        if not counts.any():
            continue
        at = int(np.argmax(np.where(counts, angle, -1.0)))
        if worst.angle is None or angle[at] > worst.angle:
            worst = replace(worst, angle=float(angle[at]), angle_time=float(time[inside[at]]))
    return worst
