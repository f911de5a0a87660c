"""Where a motion stops on its way, in words."""

from __future__ import annotations

from ikplan.documents.certificate import Certificate
from ikplan.documents.path import PathRequest

__all__ = ["stop_hints"]


def stop_hints(
    certificate: Certificate, path: PathRequest | None, asked: PathRequest | None = None
) -> list[str]:
    """Say that a motion stops on its way, and which field lets it go on.

    Args:
        certificate: The certificate of the motion.
        path: The path that the motion follows; None: the waypoints are joint values.
        asked: The path of the request, where the motion stops at corners with a blend; None: it is
            the same.
    """
    count = len(certificate.stops)
    if path is None or count == 0:
        return []
    times = "once" if count == 1 else f"{count} times"
    first = f"the motion stops {times} between its ends, first at {certificate.stops[0]:.4g} s"
    if asked is not None and asked != path:
        return [f"{first}: stopping at the corners is faster than going through their blends"]
    exact = path.corners == "exact" or path.blend == 0.0
    change = "path.blend, a radius"
    if exact:
        change += ', or path.corners "tolerance" without a blend'
    return [f"{first}: {change}, rounds corners, which are then passed without a stop"]
