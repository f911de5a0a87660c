"""The independent check of a finished trajectory: it shares no code with the planner."""

from ikplan.certificate.certify import certify
from ikplan.certificate.claim import Claim, RequestedSegment

__all__ = ["Claim", "RequestedSegment", "certify"]
