"""What a list of plans asks a store for, and where its pages begin."""

from __future__ import annotations

import base64
import binascii
import datetime
from typing import NamedTuple

from ikplan.documents.status import Outcome, PlanList, PlanSummary
from ikplan.errors import InvalidRequest

__all__ = ["ListedPlan", "PlanQuery", "page_of", "read_cursor"]


class ListedPlan(NamedTuple):
    """A row of a list.

    Attributes:
        plan_id: Id of the plan.
        outcome: What became of it.
        kind: ``"plan"`` or ``"time"``.
        robot: Name of the robot; empty: unknown.
        time: When the plan was stored or the job accepted [s since 1970].
        size: Size of the plan [bytes], if there is one.
        problem: Type of the problem of a failed job.
    """

    plan_id: str
    outcome: Outcome
    kind: str
    robot: str
    time: float
    size: int | None
    problem: str | None


class PlanQuery(NamedTuple):
    """Which plans and jobs are listed, the newest first.

    Attributes:
        owner: Whose.
        limit: Most rows.
        robot: Name of the robot; None: any.
        outcome: The outcome; None: any.
        since: Earliest time [s since 1970].
        until: Time before which they were stored or accepted [s since 1970].
        after: Time and id of the last row of the page before.
    """

    owner: str
    limit: int
    robot: str | None = None
    outcome: Outcome | None = None
    since: float | None = None
    until: float | None = None
    after: tuple[float, str] | None = None


def page_of(rows: list[ListedPlan], limit: int) -> PlanList:
    """Return a page.

    Args:
        rows: The rows, one more than the limit if there is another page.
        limit: Most plans of the page.
    """
    last = rows[limit - 1] if len(rows) > limit else None
    return PlanList(
        plans=[_summary(row) for row in rows[:limit]],
        next=None if last is None else _cursor(last.time, last.plan_id),
    )


def _summary(row: ListedPlan) -> PlanSummary:
    moment = datetime.datetime.fromtimestamp(row.time, datetime.UTC)
    return PlanSummary(
        id=row.plan_id,
        outcome=row.outcome,
        kind="time" if row.kind == "time" else "plan",
        robot=row.robot or None,
        time=moment.isoformat(timespec="microseconds").replace("+00:00", "Z"),
        bytes=row.size,
        problem=row.problem,
    )


def _cursor(time: float, plan_id: str) -> str:
    return base64.urlsafe_b64encode(f"{time!r} {plan_id}".encode()).decode().rstrip("=")


def read_cursor(text: str) -> tuple[float, str]:
    """Return the time and the id after which a page begins.

    Raises:
        InvalidRequest: It is not a cursor of ours.
    """
    try:
        padded = text + "=" * (-len(text) % 4)
        time, _, plan_id = (
            base64.b64decode(padded, altchars=b"-_", validate=True).decode().partition(" ")
        )
        return float(time), plan_id
    except (ValueError, binascii.Error) as error:
        raise InvalidRequest(
            "after: not the `next` of a list of plans", field="after", allowed="`next` of a list"
        ) from error
