"""A finished plan broke a promise: a bug of ours."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from ikplan.errors.base import IkplanError

__all__ = ["CertificateViolated"]


class CertificateViolated(IkplanError):
    """A finished plan broke one of its promises: a bug of ours, never returned as a plan.

    Attributes:
        certificate: The certificate as a JSON-ready mapping.
        violations: The promises broken, in words.
    """

    slug = "certificate-violated"
    title = "Certificate violated"
    status = 500
    fields = ("certificate", "violations")

    def __init__(
        self, detail: str, *, certificate: Mapping[str, Any], violations: Sequence[str] = ()
    ) -> None:
        super().__init__(detail)
        self.certificate = dict(certificate)
        self.violations = list(violations)
