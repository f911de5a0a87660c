"""Whether the inertias of a description can belong to bodies, so that torques mean something."""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np

from ikplan.robots.urdf.tree import Inertial, Joint, KinematicTree

__all__ = ["inertia_faults"]

_ROUNDING = 1e-3
"""Share of the largest moment by which printed figures may miss a law."""


def inertia_faults(tree: KinematicTree, chain: Iterable[Joint]) -> list[str]:
    """Say why no torques can be computed from a description; an empty list: they can.

    Args:
        tree: The description.
        chain: The joints that move; each must move a link that has a mass.

    Returns:
        One sentence a fault, naming the link and the joint that carries it.
    """
    carrier = {joint.child: joint.name for joint in tree.joints}
    moved = {joint.child for joint in chain}
    broken, faults = [], []
    for link in tree.links:
        where = f"link {link.name!r}"
        if link.name in carrier:
            where += f" (on joint {carrier[link.name]!r})"
        if link.fault:
            broken.append(link.fault)
        elif link.inertial is None or link.inertial.mass == 0.0:
            if link.name in moved:
                faults.append(f"{where} has no mass")
        elif fault := _fault(link.inertial):
            faults.append(f"{where} {fault}")
    return broken + faults


def _fault(inertial: Inertial) -> str:
    """What is wrong with a body, or nothing."""
    ixx, ixy, ixz, iyy, iyz, izz = inertial.inertia
    moments = np.linalg.eigvalsh([[ixx, ixy, ixz], [ixy, iyy, iyz], [ixz, iyz, izz]])
    smallest, middle, largest = (float(v) for v in moments)
    slack = _ROUNDING * max(largest, 0.0)
    if smallest < -slack or largest < 0.0:
        return f"has a negative moment of inertia, {smallest:.3g} kg m2"
    if smallest + middle < largest - slack:
        # Each is an integral of two of three squares.
        return (
            f"has moments of inertia that no body has: {smallest:.3g} + {middle:.3g} kg m2 "
            f"are less than {largest:.3g}"
        )
    return ""
