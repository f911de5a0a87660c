"""The manual of the service: one page, rendered from the OpenAPI document, without scripts."""

from __future__ import annotations

from fastapi import APIRouter, Request
from fastapi.responses import HTMLResponse

from ikplan_api.http.manual import render

__all__ = ["router"]

router = APIRouter(include_in_schema=False)

# No script, no frame, no other origin.
_POLICY = "default-src 'none'; style-src 'unsafe-inline'; base-uri 'none'; frame-ancestors 'none'"


@router.get("/docs")
async def manual(request: Request) -> HTMLResponse:
    """Return the manual."""
    page = render(request.app.openapi(), str(request.base_url).rstrip("/"))
    return HTMLResponse(page, headers={"content-security-policy": _POLICY})
