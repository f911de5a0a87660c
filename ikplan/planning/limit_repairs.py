"""Changes of the limits of a request that make a motion possible which has no timing."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import Any

from ikplan.documents.limits import LimitOptions, ToolRate
from ikplan.errors import BudgetExceeded, TimingFailed
from ikplan.planning.repair_kinds import Repair

__all__ = [
    "ATTEMPTS",
    "limit_repairs",
    "nearest_repairs",
    "offered",
    "own_torques",
    "slower_tool",
    "smaller_payload",
]

ATTEMPTS = 4
"""Changes of a kind that are planned to the end."""
_SLOWER = (0.5, 0.2, 0.05, 0.01)
"""Shares of the tool's highest speed that are tried."""
_SPEEDS = (0.5, 0.1, 0.02, 0.005)
"""Speeds of the tool that are tried where the request limits none [m/s]."""
_LIGHTER = (0.5, 0.2, 0.05, 0.005)
"""Shares of the payload that are tried."""
_LEAST_SPEED = 1e-6

Survives = Callable[[dict[str, Any]], bool]


def offered(
    kinds: Iterator[Iterator[Repair]], survives: Survives | None, most: int | None = None
) -> list[dict[str, Any]]:
    """Return the first change of each kind that survives, as documents.

    Args:
        kinds: Kind by kind, in order of price, changes that may do.
        survives: Tells whether a change holds once it is planned, timed, sampled and certified;
            None: they do.
        most: Ends the search once so many are found; None: never.

    Returns:
        Repairs as ``{"change": fields of the request, "detail": in words}``; those found so far
        where the time budget runs out.
    """
    found: list[dict[str, Any]] = []
    try:
        for kind in kinds:
            if len(found) == most:
                break
            for _, repair in zip(range(ATTEMPTS), kind, strict=False):
                if survives is None or survives(repair.change):
                    found.append({"change": repair.change, "detail": repair.detail})
                    break
    except BudgetExceeded:
        return found
    return found


def nearest_repairs(error: TimingFailed) -> list[dict[str, Any]]:
    """Return the nearest feasible values that an error carries as the change of the request."""
    names = " and ".join(error.nearest)
    detail = f"ask for the nearest feasible {names}".replace("_", " ")
    return [{"change": error.nearest, "detail": detail}]


def limit_repairs(error: TimingFailed, limits: LimitOptions) -> Iterator[Iterator[Repair]]:
    """Yield, kind by kind in order of price, changes of the limits."""
    if error.limit == "torque":
        yield smaller_payload(limits)
        yield own_torques(limits)
    yield slower_tool(limits)


def slower_tool(limits: LimitOptions) -> Iterator[Repair]:
    """Yield smaller speeds of the tool, the largest first."""
    speed = limits.tool_speed
    if isinstance(speed, ToolRate):
        for share in _SLOWER:
            rates = {
                key: max(share * value, _LEAST_SPEED)
                for key, value in (("linear", speed.linear), ("angular", speed.angular))
                if value is not None
            }
            if rates:
                detail = f"move the tool at {share:g} times its highest speeds"
                yield Repair({"limits": {"tool_speed": rates}}, detail)
        return
    speeds = _SPEEDS if speed is None else [max(share * speed, _LEAST_SPEED) for share in _SLOWER]
    for slower in speeds:
        detail = f"move the tool at {slower * 1e3:g} mm/s at most"
        yield Repair({"limits": {"tool_speed": slower}}, detail)


def smaller_payload(limits: LimitOptions) -> Iterator[Repair]:
    """Yield smaller masses that the tool carries, the largest first."""
    if limits.payload is None:
        return
    for share in _LIGHTER:
        mass = float(f"{share * limits.payload.mass:.3g}")
        if 0.0 < mass < limits.payload.mass:
            detail = f"carry {mass:g} kg instead of {limits.payload.mass:g} kg"
            yield Repair({"limits": {"payload": {"mass": mass}}}, detail)


def own_torques(limits: LimitOptions) -> Iterator[Repair]:
    """Yield the robot's own torque limits alone, where the request has some of its own."""
    if isinstance(limits.torque, list):
        yield Repair({"limits": {"torque": True}}, "keep the robot's own torque limits alone")
