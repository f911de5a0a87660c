"""The timed samples as comma-separated values."""

from __future__ import annotations

import csv
import io
from typing import TYPE_CHECKING

import numpy as np

from ikplan.plans.export.formats import Format

if TYPE_CHECKING:
    from ikplan.documents.plan_document import PlanDocument

__all__ = ["FORMAT", "header"]


def header(plan: PlanDocument) -> list[str]:
    """Return the column titles: ``time [s]``, then q, dq and ddq of each joint with its unit."""
    titles = ["time [s]"]
    for symbol, per in (("q", ""), ("dq", "/s"), ("ddq", "/s^2")):
        for name, unit in zip(plan.joint_names, plan.joint_units, strict=True):
            titles.append(f"{symbol} {name} [{unit}{per}]")
    return titles


def encode(plan: PlanDocument) -> bytes:
    """Return one row a sample; every number in the shortest form that reads back exactly."""
    motion = plan.trajectory
    table = np.column_stack([motion.time, motion.q, motion.dq, motion.ddq])
    text = io.StringIO(newline="")
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(header(plan))
    # Python floats are written by repr, the shortest text that gives the same float again.
    writer.writerows(table.tolist())
    return text.getvalue().encode()


FORMAT = Format(
    name="csv",
    title="the timed samples, one row a sample",
    suffixes=(".csv",),
    media_type="text/csv",
    encode=encode,
)
