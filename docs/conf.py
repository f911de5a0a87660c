"""The site of the documentation: the pages of this repository, and the reference from docstrings.

``make docs`` builds it. The source folder is the root of the repository, so that links between
pages lead to the same files here and there.
"""

from __future__ import annotations

import sys
from pathlib import Path
from typing import Any

sys.path[:0] = [str(Path(__file__).parents[1] / name) for name in ("", "api")]

from pydantic import BaseModel
from pydantic.fields import FieldInfo
from sphinx.application import Sphinx

import ikplan

project = "ikplan"
author = "ikplan developers"
project_copyright = "2026, the ikplan developers"
version = release = ikplan.__version__

extensions = ["myst_parser", "sphinx.ext.autodoc", "sphinx.ext.napoleon"]
root_doc = "docs/index"
include_patterns = [
    "*.md",
    "docs/*.md",
    "docs/*.rst",
    "robots/README.md",
    "docker/README.md",
    "kernels/README.md",
    "web/README.md",
    "benchmarks/*/README.md",
    "benchmarks/papers/REPORT.md",
]
exclude_patterns = [".*", "CHANGES-*.md", "out", "build", "dist", "**/node_modules", "web/dist"]
suppress_warnings = ["toc.not_included"]

html_theme = "furo"
html_title = f"ikplan {release}"
html_extra_path = ["site"]
html_copy_source = False
html_show_sphinx = False

myst_heading_anchors = 3

autodoc_member_order = "bysource"
autodoc_typehints = "description"
autodoc_typehints_description_target = "documented"
autodoc_preserve_defaults = True
napoleon_numpy_docstring = False
# The attributes of a class are those that its docstring names.
napoleon_use_ivar = True


def _default(field: FieldInfo) -> str:
    """The default of a field, in words."""
    if field.is_required():
        return "required"
    if field.default_factory is not None:
        return "default: that of each of its fields"
    return f"default ``{field.default!r}``"


def add_fields(app: Sphinx, what: str, name: str, obj: Any, options: Any, lines: list[str]) -> None:
    """Add the fields of a document to its docstring: name, default, and what the schema says."""
    if isinstance(obj, type) and issubclass(obj, BaseModel):
        for key, field in obj.model_fields.items():
            text = " ".join((field.description or "").split()).replace("*", r"\*")
            lines += ["", f":ivar {key}: {text} ({_default(field)})"]


def is_field(app: Sphinx, what: str, name: str, obj: Any, skip: bool, options: Any) -> bool | None:
    """Leave out what pydantic adds to a document; its fields are in its docstring."""
    return True if name.startswith("model_") else None


def setup(app: Sphinx) -> None:
    """Connect the two."""
    app.connect("autodoc-process-docstring", add_fields)
    app.connect("autodoc-skip-member", is_field)
