"""No contact, proven: the least distance of bodies over every instant of a motion.

The proof has a distance kernel, forward kinematics and motion bounds of its own; nothing of the
planner's collision checks is used.
"""

from ikplan.certificate.clearance.curve import JointCurve
from ikplan.certificate.clearance.prove import ClearanceProof, prove_clearance
from ikplan.certificate.clearance.result import ClearanceResult, ClearanceViolation

__all__ = [
    "ClearanceProof",
    "ClearanceResult",
    "ClearanceViolation",
    "JointCurve",
    "prove_clearance",
]
