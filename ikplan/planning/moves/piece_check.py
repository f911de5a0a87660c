"""What tells which pieces of the motion of a move are proven: clear of contact, within a region."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from ikplan.arrays import Array, Flags
from ikplan.collision.check import ContactCheck
from ikplan.planning.moves.region.kernels import cubic_inside
from ikplan.planning.moves.region.tool_region import ToolRegion, region_scratch

__all__ = ["PieceCheck", "piece_check"]

_CURVES = 0.99
"""Share of the region that rounded corners keep within."""

PieceCheck = Callable[[Array, Array, tuple[Array, Array], float], Flags]


def piece_check(
    region: ToolRegion | None, contact: ContactCheck | None, segment: int | None
) -> PieceCheck | None:
    """Return what tells which pieces of a cubic motion are not proven; None: there is nothing.

    Args:
        region: Where the tool may be; None: anywhere.
        contact: Refuses motions in contact; None: nothing is in the way.
        segment: The segment that the motion belongs to.

    Returns:
        A function of knots, shape (k + 1,), values there, shape (k + 1, dof), slopes at both ends
        of each piece, (k, dof) each, and the gap asked for on top [m]: which pieces, shape (k,).
    """
    if region is None and contact is None:
        return None
    w = None if region is None else region_scratch(region.chain)

    def check(s: Array, q: Array, m: tuple[Array, Array], extra: float) -> Flags:
        found = np.zeros(len(s) - 1, dtype=bool)
        if contact is not None:
            found |= contact.contacts_on_curve(s, q, m, segment, extra)
        if region is not None and w is not None:
            thirds = np.diff(s)[:, None] / 3.0
            for k in range(len(found)):
                w.controls[0, 0], w.controls[0, 3] = q[k], q[k + 1]
                w.controls[0, 1] = q[k] + thirds[k] * m[0][k]
                w.controls[0, 2] = q[k + 1] - thirds[k] * m[1][k]
                found[k] |= not cubic_inside(region, _CURVES, w)
        return found

    return check
