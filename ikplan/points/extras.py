"""Columns beside the poses: speed and zone of each point."""

from __future__ import annotations

import re

from ikplan.points.points import Speed
from ikplan.points.table import fault
from ikplan.points.units import in_si
from ikplan.points.values import Values

__all__ = ["read_speeds", "read_zones"]

_EXACT = ("fine", "exact", "stop")
_ABB_ZONE = re.compile(r"z(\d+)")
_LARGEST_ZONE = 10.0
"""Largest blend of a request [m]."""
_SLOWEST, _FASTEST = 1e-3, 10.0
"""Highest speeds of a file that can be meant so where no unit is written [m/s]."""


def read_speeds(values: Values, length: float) -> list[Speed | None]:
    """Return the speed of each point; ``length``: factor of the file's lengths to metres.

    Raises:
        InvalidRequest: A speed is no positive number, or a feed has no unit.
    """
    place = values.place("speed")
    feed = values.place("feed")
    if place is None and feed is not None:
        if values.columns[feed].factor is None:
            raise fault(
                values.rows[0],
                "a feed needs a unit in the header, as in 'feed [mm/min]'",
                column=values.columns[feed].title,
            )
        place = feed
    if place is None:
        return []
    column = values.columns[place]
    share = column.unit in ("%", "percent")
    factor = column.factor if column.factor is not None else length
    if column.factor is None:
        _check_unwritten(values, place, factor)
    speeds: list[Speed | None] = []
    for row in values.rows:
        if not row.cells[place]:
            speeds.append(None)
            continue
        speed = in_si(values.number(row, place), factor)
        if speed <= 0.0 or (share and speed > 1.0):
            most = " and at most 100 %" if share else ""
            raise fault(row, f"a speed is above 0{most}", column=column.title)
        speeds.append(Speed(speed, share))
    return speeds


def _check_unwritten(values: Values, place: int, factor: float) -> None:
    """Refuse speeds that are none of a tool in the unit of the coordinates by the second."""
    rows = [row for row in values.rows if row.cells[place]]
    largest = max((in_si(values.number(row, place), factor) for row in rows), default=0.0)
    if rows and not _SLOWEST <= largest <= _FASTEST and largest > 0.0:
        raise fault(
            rows[0],
            f"in the unit of the coordinates by the second, the highest speed is {largest:g} m/s: "
            "write the unit into the header, as in 'speed [mm/s]'",
            column=values.columns[place].title,
        )


def read_zones(values: Values, length: float) -> list[float | None]:
    """Return the radius at which the corner at each point is rounded [m].

    A number, ``fine`` for an exact corner, or a zone of ABB such as ``z10``, in millimetres.

    Raises:
        InvalidRequest: It is none of these.
    """
    place = values.place("zone")
    if place is None:
        return []
    column = values.columns[place]
    factor = column.factor if column.factor is not None else length
    zones: list[float | None] = []
    for row in values.rows:
        word = row.cells[place].lower()
        if not word:
            zones.append(None)
        elif word in _EXACT:
            zones.append(0.0)
        elif match := _ABB_ZONE.fullmatch(word):
            zones.append(float(match[1]) * 1e-3 or 0.3e-3)  # ABB's z0 is 0.3 mm
        else:
            zone = in_si(values.number(row, place), factor)
            if not 0.0 <= zone <= _LARGEST_ZONE:
                raise fault(
                    row,
                    f"a zone is a radius of 0 to {_LARGEST_ZONE:g} m, fine, or z10 as ABB has it",
                    column=column.title,
                )
            zones.append(zone)
    return zones
