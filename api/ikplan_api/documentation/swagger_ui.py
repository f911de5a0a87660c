"""The manual as Swagger UI, from an installed package: nothing comes from another address."""

from __future__ import annotations

from html import escape
from importlib.resources import files
from pathlib import Path

__all__ = ["POLICY", "manual_page", "part"]

# Scripts and data of this service only, none inline. The icons of Swagger UI are data addresses
# in its style sheet.
POLICY = (
    "default-src 'none'; script-src 'self'; style-src 'self'; connect-src 'self'; "
    "img-src 'self' data:; base-uri 'none'; form-action 'none'; frame-ancestors 'none'"
)
_HERE = Path(__file__).parent
_PACKAGE = "fastapi_swagger"
_PARTS = {
    "start.js": "text/javascript; charset=utf-8",
    "style.css": "text/css; charset=utf-8",
    "swagger-ui-bundle.js": "text/javascript; charset=utf-8",
    "swagger-ui.css": "text/css; charset=utf-8",
}
_PAGE = """<!doctype html>
<html lang="en"><head><meta charset="utf-8"><title>{title}</title>
<meta name="viewport" content="width=device-width">
<link rel="icon" href="data:,">
<link rel="stylesheet" href="docs/swagger-ui.css">
<link rel="stylesheet" href="docs/style.css">
<script src="docs/swagger-ui-bundle.js" defer></script>
<script src="docs/start.js" type="module"></script>
</head><body>
<nav class="top"><a href="./">Page</a> <a href="openapi.json">OpenAPI document</a>
<a href="problems">Types of problems</a></nav>
<noscript><main><h1>{title}</h1><p>This manual needs scripts, all of them from this service. Without
scripts, read the <a href="openapi.json">OpenAPI document</a>.</p></main></noscript>
<div id="swagger-ui"></div>
</body></html>
"""


def manual_page(title: str) -> str:
    """Return the page that starts Swagger UI."""
    return _PAGE.format(title=escape(title))


def part(name: str) -> tuple[Path, str] | None:
    """Return the file and the media type of a part of the manual, or None if it has no such part.

    The names are fixed: no path of a request reaches the file system.
    """
    if name not in _PARTS:
        return None
    own = _HERE / name
    # Swagger UI lies in a package: whoever updates that package updates it.
    file = own if own.is_file() else Path(str(files(_PACKAGE) / "resources" / name))
    return file, _PARTS[name]
