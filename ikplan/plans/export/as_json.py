"""The whole plan as the JSON document of the service."""

from __future__ import annotations

from typing import TYPE_CHECKING

from ikplan.documents import write_json
from ikplan.plans.export.formats import Format

if TYPE_CHECKING:
    from ikplan.documents.plan_document import PlanDocument

__all__ = ["FORMAT"]


def encode(plan: PlanDocument) -> bytes:
    """Return the document, byte for byte as ``POST /v1/plans`` answers it."""
    return write_json(plan)


FORMAT = Format(
    name="json",
    title="the whole plan, as the service answers it",
    suffixes=(".json",),
    media_type="application/json",
    encode=encode,
)
