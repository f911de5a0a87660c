"""The joint values of a file, in the robot's order."""

from __future__ import annotations

from collections.abc import Sequence

from ikplan.points.columns import JointName
from ikplan.points.note import Note
from ikplan.points.points import Points
from ikplan.points.poses import one_factor
from ikplan.points.table import Row, fault
from ikplan.points.units import ANGLES, LENGTHS, guess_angle, guess_length, in_si
from ikplan.points.values import Values

__all__ = ["read_joints"]

# A metre is 1, as a radian: only another unit of length shows that a joint slides.
_LENGTHS_ONLY = frozenset(factor for unit, factor in LENGTHS.items() if unit != "m")


def read_joints(
    values: Values,
    header: Row,
    units: str | None,
    angles: str | None,
    joints: Sequence[JointName],
) -> Points:
    """Return the joint values of a file.

    Args:
        values: Its numbers.
        header: Its header.
        units: Unit of lengths that the caller gives, or None.
        angles: Unit of angles that the caller gives, or None.
        joints: The joints of the robot; none: those of the file, all turning unless a column has
            a unit of length.

    Raises:
        InvalidRequest: A joint has no column, a value is wrong, or its unit is open.
    """
    present = sorted((c.joint, k) for k, c in enumerate(values.columns) if c.role == "joint")
    places = [k for _, k in present]
    if joints and [joint for joint, _ in present] != [*range(len(joints))]:
        known = {joint for joint, _ in present}
        missing = [j.name for k, j in enumerate(joints) if k not in known]
        what = f"{', '.join(missing)} is missing" if missing else "there are more"
        raise fault(
            header,
            f"the robot has {len(joints)} joints, the file {len(present)}: {what}",
            allowed=[joint.name for joint in joints],
        )
    slides = [
        joints[n].slides if joints else values.columns[k].factor in _LENGTHS_ONLY
        for n, k in present
    ]
    sliding = [k for k, slide in zip(places, slides, strict=True) if slide]
    turning = [k for k, slide in zip(places, slides, strict=True) if not slide]
    for k in turning:
        if values.columns[k].factor not in (None, *ANGLES.values()):
            raise fault(
                header, "the joint turns, its unit is one of length", column=values.columns[k].title
            )
    titles = ", ".join(values.columns[k].title for k in places)
    notes = [Note(f"{titles} read as joint values")]
    scale: dict[int, float] = {}
    if turning:
        factor, said = one_factor(
            values, turning, "angles", angles, ANGLES,
            lambda: guess_angle(values.numbers(turning), "joint values"),
        )  # fmt: skip
        scale |= dict.fromkeys(turning, factor)
        notes += said
    if sliding:
        factor, said = one_factor(
            values, sliding, "units", units, LENGTHS,
            lambda: guess_length(values.numbers(sliding)),
        )  # fmt: skip
        scale |= dict.fromkeys(sliding, factor)
        notes += said
    rows = [[in_si(values.number(row, k), scale[k]) for k in places] for row in values.rows]
    return Points(joints=rows, notes=notes)
