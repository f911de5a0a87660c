"""Who planned what."""

from __future__ import annotations

import datetime
from typing import Annotated

from fastapi import APIRouter, Query, Request

from ikplan import errors
from ikplan.documents.status import Audit, AuditEntry
from ikplan_api.http.openapi import problems
from ikplan_api.store.plan_store import OpenStore

__all__ = ["router"]

router = APIRouter(prefix="/v1/audit", tags=["health"])


@router.get(
    "",
    summary="Tell who planned what",
    responses=problems(errors.InvalidRequest, errors.ServiceUnavailable, body=False),
)
async def list_audit(
    request: Request,
    owner: Annotated[
        str | None, Query(max_length=64, description="Only actions of this key.")
    ] = None,
    before: Annotated[
        int | None, Query(ge=0, le=2**62, description="The `next` of the page before.")
    ] = None,
    limit: Annotated[int, Query(ge=1, le=1000, description="Most actions of a page.")] = 100,
) -> Audit:
    """List accepted jobs, stored plans, failures and deletions of all keys, the newest first.

    With keys, only those with the role `auditor` may ask.
    """
    store: OpenStore = request.app.state.store
    rows = await store.audit(owner, before, limit + 1)
    entries = [
        AuditEntry(
            time=datetime.datetime.fromtimestamp(time, datetime.UTC).isoformat(),
            owner=who,
            action=action,
            id=subject,
            robot=robot,
            replica=replica,
            attempt=attempt,
        )
        for _, time, who, action, subject, robot, replica, attempt in rows[:limit]
    ]
    return Audit(entries=entries, next=rows[limit - 1][0] if len(rows) > limit else None)
