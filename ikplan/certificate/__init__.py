"""The independent check of a finished trajectory: it shares no code with the planner."""

from ikplan.certificate.certify import Claim, certify

__all__ = ["Claim", "certify"]
