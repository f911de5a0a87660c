"""The manual of the service, and a page of words for each type of problem."""

from __future__ import annotations

from fastapi import APIRouter, HTTPException, Request, Response
from fastapi.responses import HTMLResponse
from werkzeug.datastructures import MIMEAccept
from werkzeug.http import parse_accept_header

from ikplan_api.documentation import problem_pages, swagger_ui
from ikplan_api.http.files import file_response

__all__ = ["router"]

router = APIRouter(include_in_schema=False)

_NO_SCRIPT = (
    "default-src 'none'; style-src 'self'; img-src data:; base-uri 'none'; form-action 'none'; "
    "frame-ancestors 'none'"
)
_MARKDOWN = ("text/markdown", "text/plain")


@router.get("/docs")
async def manual(request: Request) -> HTMLResponse:
    """Return the manual."""
    app = request.app
    page = swagger_ui.manual_page(f"{app.title} {app.version}")
    headers = {"content-security-policy": swagger_ui.POLICY, "cache-control": "no-cache"}
    return HTMLResponse(page, headers=headers)


@router.get("/docs/{name}")
async def manual_part(request: Request, name: str) -> Response:
    """Return a file of the manual."""
    found = swagger_ui.part(name)
    if found is None:
        raise HTTPException(404)
    file, media_type = found
    # The names stay while the content changes with a version: ask again, 304 if it is the same.
    return file_response(request, file, media_type, "no-cache")


@router.get("/problems")
async def problem_list(request: Request) -> Response:
    """Return the list of all types of problems."""
    return _words(request, problem_pages.index_html(), problem_pages.index_markdown())


@router.get("/problems/{slug}")
async def problem_page(request: Request, slug: str) -> Response:
    """Return what a type of problem means, and what to do about it."""
    page = problem_pages.PAGES.get(slug)
    if page is None:
        raise HTTPException(404)
    return _words(request, page.html(), page.markdown())


def _words(request: Request, html: str, markdown: str) -> Response:
    """Return HTML, or Markdown if the request prefers it."""
    accepted = parse_accept_header(request.headers.get("accept"), MIMEAccept)
    best = accepted.best_match(("text/html", *_MARKDOWN), "text/html")
    plain = best in _MARKDOWN
    headers = {
        "content-security-policy": _NO_SCRIPT,
        "cache-control": "no-cache",
        "vary": "Accept",
    }
    media_type = f"{best}; charset=utf-8"
    return Response(markdown if plain else html, media_type=media_type, headers=headers)
