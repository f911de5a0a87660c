"""The web page, which plans and shows the arm in a browser; it loads nothing from elsewhere."""

from __future__ import annotations

from pathlib import Path

from fastapi import APIRouter, HTTPException, Request, Response
from fastapi.responses import HTMLResponse

from ikplan_api.http.files import file_response

__all__ = ["BUNDLE_HINT", "bundle_folder", "router"]

router = APIRouter(include_in_schema=False)

BUNDLE_HINT = "make page"
"""The command that builds the page's bundle in a checkout."""

# Scripts, styles and data from this service only; no inline script, no frame, no other origin.
_POLICY = (
    "default-src 'none'; script-src 'self'; style-src 'self'; connect-src 'self'; "
    "img-src 'self' data:; base-uri 'none'; form-action 'none'; frame-ancestors 'none'"
)
_MEDIA = {
    ".css": "text/css; charset=utf-8",
    ".html": "text/html; charset=utf-8",
    ".js": "text/javascript; charset=utf-8",
    ".svg": "image/svg+xml",
    ".txt": "text/plain; charset=utf-8",
}
_MISSING = f"""<!doctype html>
<html lang="en"><head><meta charset="utf-8"><title>ikplan</title>
<meta name="viewport" content="width=device-width"></head>
<body><h1>ikplan</h1>
<p>The service runs, but the page is not built in this checkout. Build it with</p>
<pre>{BUNDLE_HINT}</pre>
<p>and reload this page. See also <a href="docs">the manual of the service</a>.</p>
</body></html>
"""


def bundle_folder() -> Path:
    """Return the folder of the bundle: in the installed package, else in the checkout."""
    here = Path(__file__).resolve().parents[1]
    installed = here / "page"
    return installed if installed.is_dir() else here.parents[1] / "web" / "dist"


@router.get("/")
async def page(request: Request) -> Response:
    """Return the page, or how to build it."""
    file = bundle_folder() / "index.html"
    if file.is_file():
        answer = file_response(request, file, _MEDIA[".html"], "no-cache")
    else:
        answer = HTMLResponse(_MISSING, headers={"cache-control": "no-cache"})
    answer.headers["content-security-policy"] = _POLICY
    return answer


@router.get("/page/{name}")
async def part(request: Request, name: str) -> Response:
    """Return a file of the page; its name changes with its content."""
    folder = bundle_folder()
    # The name is compared with the listing and never joined to a path: no path traversal.
    files = {file.name: file for file in folder.iterdir()} if folder.is_dir() else {}
    file = files.get(name)
    if file is None or not file.is_file() or file.suffix not in _MEDIA:
        raise HTTPException(404)
    return file_response(request, file, _MEDIA[file.suffix], "max-age=31536000, immutable")
