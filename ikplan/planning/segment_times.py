"""When the segments of a request are passed."""

from __future__ import annotations

from collections.abc import Sequence

from ikplan.arrays import Array
from ikplan.planning.joint_route import JointRoute
from ikplan.planning.segment_number import segment_number

__all__ = ["segment_times"]


def segment_times(
    route: JointRoute, times: Array, order: Sequence[int] | None
) -> list[tuple[float, float]] | None:
    """Return when each segment of the request begins and ends, in the order passed [s].

    Args:
        route: The route.
        times: When it passes each configuration, shape (k,) [s].
        order: Numbers of the segments in the order in which they are passed; None: as written.

    Returns:
        None: the path has neither segments nor waypoints.
    """
    found: dict[int, tuple[float, float]] = {}
    for part in route.segments:
        number = segment_number(part.field)
        if number is not None:
            begin, end = float(times[part.first]), float(times[part.last])
            known = found.get(number, (begin, end))
            found[number] = min(begin, known[0]), max(end, known[1])
    if not found:
        ends = [float(times[w.index]) for w in route.waypoints]
        return list(zip([0.0, *ends], ends, strict=False)) or None
    last = begun = 0.0
    rows = []
    for number in range(max(found) + 1) if order is None else order:
        begin, end = found.get(number, (last, last))
        # One that leads nowhere, at a rounded corner, is passed after the next one has begun.
        begun = max(begun, begin)
        rows.append((begun, max(begun, end)))
        last = rows[-1][1]
    return rows
