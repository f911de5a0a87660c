"""Rendering of an OpenAPI document as one HTML page."""

from __future__ import annotations

import json
from collections.abc import Iterator
from html import escape
from typing import Any

__all__ = ["render"]

Json = dict[str, Any]

_STYLE = """
:root { color-scheme: light dark; --line: #8884; --soft: #8881; --accent: #0072b2; }
@media (prefers-color-scheme: dark) { :root { --accent: #56b4e9; } }
body { font: 16px/1.5 system-ui, sans-serif; max-width: 60rem; margin: 2rem auto; padding: 0 1rem; }
h1, h2, h3 { line-height: 1.2; } h2 { margin-top: 2.5rem; border-bottom: 1px solid var(--line); }
code, pre { font: 0.875em/1.45 ui-monospace, monospace; }
pre { background: var(--soft); padding: 0.75rem; overflow-x: auto; border-radius: 6px; }
table { border-collapse: collapse; width: 100%; margin: 0.5rem 0 1rem; }
th, td { text-align: left; vertical-align: top; padding: 0.3rem 0.8rem 0.3rem 0;
         border-bottom: 1px solid var(--line); overflow-wrap: anywhere; }
a { color: var(--accent); } .method { color: var(--accent); font-weight: 600; }
nav ul { columns: 16rem; padding-left: 1.2rem; }
"""


def render(document: Json, base_url: str) -> str:
    """Return the page.

    Args:
        document: The OpenAPI document.
        base_url: Address of the service, for the examples.
    """
    return "\n".join(_page(document, base_url))


def _page(document: Json, base_url: str) -> Iterator[str]:
    info = document["info"]
    title = f"{info['title']} {info['version']}"
    yield f'<!doctype html><html lang="en"><head><meta charset="utf-8"><title>{escape(title)}'
    yield '</title><meta name="viewport" content="width=device-width">'
    yield f"<style>{_STYLE}</style></head><body><h1>{escape(title)}</h1>"
    yield f"<p><strong>{escape(info.get('summary', ''))}</strong></p>"
    yield f"<p>{escape(info.get('description', ''))} "
    yield 'Machine-readable: <a href="openapi.json">openapi.json</a>.</p>'
    operations = [
        (method, path, operation)
        for path, methods in document["paths"].items()
        for method, operation in methods.items()
    ]
    yield "<nav><h2>Endpoints</h2><ul>"
    for method, path, operation in operations:
        label = escape(f"{method.upper()} {path}")
        yield f'<li><a href="#{operation["operationId"]}"><code>{label}</code></a></li>'
    yield "</ul></nav><main>"
    for method, path, operation in operations:
        yield from _operation(method, path, operation, base_url)
    yield "<h2>Documents</h2>"
    for name, schema in document["components"]["schemas"].items():
        yield from _schema(name, schema)
    yield "</main></body></html>"


def _operation(method: str, path: str, operation: Json, base_url: str) -> Iterator[str]:
    yield f'<section id="{operation["operationId"]}"><h2>{escape(operation["summary"])}</h2>'
    yield f'<p><code><span class="method">{method.upper()}</span> {escape(path)}</code></p>'
    yield f"<p>{escape(operation.get('description', ''))}</p>"
    content = operation.get("requestBody", {}).get("content", {})
    for media_type, body in content.items():
        yield f"<p>Body, <code>{escape(media_type)}</code>: {_type(body['schema'])}</p>"
    yield f"<pre>{escape(_curl(method, base_url + path, content))}</pre>"
    parameters = [p for p in operation.get("parameters", []) if p["in"] != "path"]
    if parameters:
        yield "<table><thead><tr><th>Parameter</th><th>In</th><th>Type</th><th>Meaning</th></tr>"
        yield "</thead><tbody>"
        for parameter in parameters:
            yield f"<tr><td><code>{escape(parameter['name'])}</code></td>"
            yield f"<td>{escape(parameter['in'])}</td><td>{_type(parameter['schema'])}</td>"
            yield f"<td>{escape(parameter.get('description', ''))}</td></tr>"
        yield "</tbody></table>"
    yield "<table><thead><tr><th>Status</th><th>Response</th><th>Document</th></tr></thead><tbody>"
    for status, answer in operation["responses"].items():
        types = [_type(content.get("schema", {})) for content in answer.get("content", {}).values()]
        yield f"<tr><td>{escape(status)}</td><td>{escape(answer['description'])}</td>"
        yield f"<td>{', '.join(types)}</td></tr>"
    yield "</tbody></table></section>"


def _curl(method: str, url: str, content: Json) -> str:
    body = content.get("application/json")
    if body is None and content:
        media_type, other = next(iter(content.items()))
        words = f"curl {url} -H 'Content-Type: {media_type}'"
        return f"{words} \\\n  --data-binary '{other.get('example', '...')}'"
    if body is None:
        return f"curl {url}" if method == "get" else f"curl -X {method.upper()} {url}"
    example = json.dumps(body.get("example", {}))
    return f"curl {url} -H 'Content-Type: application/json' \\\n  -d '{example}'"


def _schema(name: str, schema: Json) -> Iterator[str]:
    yield f'<section id="{escape(name)}"><h3>{escape(name)}</h3>'
    yield f"<p>{escape(schema.get('description', ''))}</p>"
    required = schema.get("required", [])
    yield "<table><thead><tr><th>Field</th><th>Type</th><th>Default</th><th>Meaning</th></tr>"
    yield "</thead><tbody>"
    for field, what in schema.get("properties", {}).items():
        default = "required" if field in required else json.dumps(what.get("default", "see type"))
        yield f"<tr><td><code>{escape(field)}</code></td><td>{_type(what)}</td>"
        yield f"<td><code>{escape(default)}</code></td>"
        yield f"<td>{escape(what.get('description', ''))}</td></tr>"
    yield "</tbody></table></section>"


_BOUNDS = {
    "minimum": "≥ {}",
    "exclusiveMinimum": "> {}",
    "maximum": "≤ {}",
    "exclusiveMaximum": "< {}",
    "minItems": "at least {} items",
    "maxItems": "at most {} items",
    "minLength": "at least {} characters",
    "maxLength": "at most {} characters",
}


def _type(schema: Json) -> str:
    """Return the type of a value as HTML."""
    if "$ref" in schema:
        name = escape(schema["$ref"].rpartition("/")[2])
        return f'<a href="#{name}">{name}</a>'
    for key in ("anyOf", "oneOf", "allOf"):
        if key in schema:
            return " or ".join(_type(option) for option in schema[key])
    if "const" in schema:
        return f"<code>{escape(json.dumps(schema['const']))}</code>"
    if "enum" in schema:
        return " or ".join(f"<code>{escape(json.dumps(v))}</code>" for v in schema["enum"])
    text = escape(str(schema.get("type", "anything")))
    if schema.get("type") == "array":
        text = f"array of {_type(schema.get('items', {}))}"
    extra = schema.get("additionalProperties")
    if isinstance(extra, dict) and extra:
        text += f" of {_type(extra)}"
    bounds = [escape(words.format(schema[k])) for k, words in _BOUNDS.items() if k in schema]
    return f"{text} ({', '.join(bounds)})" if bounds else text
