"""What a plan promises, in words: for the shell and for figures."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from ikplan.documents.certificate import Certificate, LimitPlace
    from ikplan.documents.clearance import NearestPlace
    from ikplan.documents.plan_document import PlanDocument

__all__ = ["certificate_rows"]


def certificate_rows(plan: PlanDocument) -> list[tuple[str, str]]:
    """Return the certificate as rows of a name and a value with its unit."""
    c = plan.certificate
    rows = []
    if c.max_position_error is not None:
        rows.append(("error at waypoints", _both(c.max_position_error, c.max_orientation_error)))
    if c.max_path_deviation is not None:
        between = _both(c.max_path_deviation, c.max_orientation_deviation)
        rows.append(("deviation from the path", between))
    rows += [
        ("position limits", _share(c.position_limit_ratio, c.position_limit_at)),
        ("velocity limits", _share(c.velocity_limit_ratio, c.velocity_limit_at)),
        ("acceleration limits", _share(c.acceleration_limit_ratio, c.acceleration_limit_at)),
        *_further_rows(c),
        *_segment_rows(c),
        *_clearance_rows(c),
        (
            "least singular value",
            f"{c.min_singular_value:.3g} at {c.min_singular_value_time:.2f} s",
        ),
        ("joint motion", _motion(plan, c)),
        *_order_rows(plan),
        *(("assumed", assumption) for assumption in c.assumptions),
    ]
    return rows


def _further_rows(c: Certificate) -> list[tuple[str, str]]:
    """Rows of the limits that not every request has."""
    rows = []
    for kind, ratio, place in (
        ("jerk", c.jerk_limit_ratio, c.jerk_limit_at),
        ("torque", c.torque_limit_ratio, c.torque_limit_at),
    ):
        if ratio is not None:
            rows.append((f"{kind} limits", _share(ratio, place)))
    for kind, ratio, time in (
        ("speed", c.tool_speed_ratio, c.tool_speed_time),
        ("acceleration", c.tool_acceleration_ratio, c.tool_acceleration_time),
    ):
        if ratio is not None:
            rows.append((f"tool {kind}", f"{_share(ratio, None)} at {time or 0.0:.2f} s"))
    return rows


def _segment_rows(c: Certificate) -> list[tuple[str, str]]:
    """A row for all segments with limits of their own: the one that uses most of them."""
    used = [
        (ratio, segment)
        for segment in c.segments
        for ratio in (
            segment.velocity_limit_ratio,
            segment.acceleration_limit_ratio,
            segment.torque_limit_ratio,
            segment.tool_speed_ratio,
            segment.tool_acceleration_ratio,
        )
        if ratio is not None
    ]
    if not used:
        return []
    ratio, segment = max(used, key=lambda pair: pair[0])
    return [("limits of segments", f"{_share(ratio, None)} on {segment.field.rpartition('.')[2]}")]


def _clearance_rows(c: Certificate) -> list[tuple[str, str]]:
    """Rows of the proof that nothing touches; none where nothing was checked."""
    clearance = c.clearance
    if clearance is None:
        return []
    rows = []
    if clearance.least is None or clearance.pair is None:
        rows.append(("clearance", "nothing checked: no shape of the robot is known"))
    else:
        said = "at least" if clearance.proven else "not proven: at least"
        rows.append(("clearance", f"{said} {_nearest(clearance)}"))
        rows.append(("nearest bodies", ", ".join(clearance.pair)))
        scene = clearance.scene
        if scene.pair is not None and scene.pair != clearance.pair:
            rows.append(("clearance to obstacles", f"{said} {_nearest(scene)}"))
            rows.append(("nearest there", ", ".join(scene.pair)))
    if clearance.unchecked:
        shown = ", ".join(clearance.unchecked[:8])
        more = len(clearance.unchecked) - 8
        rows.append(("not checked", shown + (f" and {more} more" if more > 0 else "")))
    return rows


def _order_rows(plan: PlanDocument) -> list[tuple[str, str]]:
    """A row for the order found; none where the path was passed as written."""
    order = plan.order
    if order is None:
        return []
    if order.gain is None:
        return [("order", "free; none was found as given")]
    return [("order", f"free: {100.0 * order.gain:.1f} % faster than as given")]


def _nearest(place: NearestPlace) -> str:
    """A distance, rounded down since more must not stand for a little less, and when."""
    distance = math.floor((place.least or 0.0) * 1e5 + 1e-9) / 100
    return f"{distance:.2f} mm at {place.time or 0.0:.2f} s"


def _both(position: float, orientation: float | None) -> str:
    text = f"{position:.1e} m"
    return text if orientation is None else f"{text}, {orientation:.1e} rad"


def _share(ratio: float, place: LimitPlace | None) -> str:
    where = f" by {place.joint} at {place.time:.2f} s" if place is not None else ""
    # Rounded up: 100.0 % must not stand for a little more.
    return f"{math.ceil(ratio * 1000 - 1e-6) / 10:.1f} % used{where}"


def _motion(plan: PlanDocument, c: Certificate) -> str:
    if set(plan.joint_units) == {"rad"}:
        total, least = math.degrees(c.elongation_sum), math.degrees(c.elongation_lower_bound)
        return f"{total:.1f} deg, at least {least:.1f} deg needed"
    return f"{c.elongation_sum:.3f}, at least {c.elongation_lower_bound:.3f} needed"
