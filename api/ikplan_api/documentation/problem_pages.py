"""A page for each type of problem, as HTML and as Markdown, from the docstring of its class."""

from __future__ import annotations

import inspect
import re
from collections.abc import Iterable
from dataclasses import dataclass
from html import escape

from ikplan.errors import IkplanError
from ikplan_api.documentation.problem_words import WORDS

__all__ = ["PAGES", "ProblemPage", "index_html", "index_markdown"]


@dataclass(frozen=True, slots=True)
class ProblemPage:
    """What there is to say about one type of problem.

    Attributes:
        slug: Last part of the type.
        urn: The type.
        title: The title of every such problem.
        error: Name of the class in Python.
        meaning: What it means.
        statuses: The HTTP statuses with their causes; the usual one first, without a cause.
        fields: The fields of the document beside those of every problem, with their meanings.
        what_to_do: Steps, the most useful one first.
    """

    slug: str
    urn: str
    title: str
    error: str
    meaning: str
    statuses: tuple[tuple[int, str], ...]
    fields: tuple[tuple[str, str], ...]
    what_to_do: tuple[str, ...]

    def markdown(self) -> str:
        """Return the page as Markdown."""
        lines = [f"# {self.title}", "", self.meaning, "", f"- Type: `{self.urn}`"]
        lines += [f"- Status: {_status(*status)}" for status in self.statuses]
        lines += [f"- In Python: `ikplan.errors.{self.error}`", "", "## What to do", ""]
        lines += [f"{i}. {step}" for i, step in enumerate(self.what_to_do, 1)]
        if self.fields:
            lines += ["", "## Fields", "", *(f"- `{name}`: {words}" for name, words in self.fields)]
        return "\n".join([*lines, ""])

    def html(self) -> str:
        """Return the page as HTML; its links are relative to ``/problems/``."""
        facts = [f"Type: <code>{escape(self.urn)}</code>"]
        facts += [f"Status: {_inline(_status(*status))}" for status in self.statuses]
        facts.append(f"In Python: <code>ikplan.errors.{escape(self.error)}</code>")
        body = f"<h1>{escape(self.title)}</h1><p>{_inline(self.meaning)}</p>"
        body += _list("ul", facts)
        body += "<h2>What to do</h2>" + _list("ol", map(_inline, self.what_to_do))
        if self.fields:
            rows = "".join(
                f"<tr><td><code>{escape(name)}</code></td><td>{_inline(words)}</td></tr>"
                for name, words in self.fields
            )
            body += "<h2>Fields</h2><table><thead><tr><th>Field</th><th>Meaning</th></tr></thead>"
            body += f"<tbody>{rows}</tbody></table>"
        return _document(self.title, "../", body)


def _status(status: int, cause: str) -> str:
    return f"{status} ({cause})" if cause else str(status)


def _page(cls: type[IkplanError]) -> ProblemPage:
    meaning, fields = _read_docstring(cls)
    words = WORDS[cls]
    return ProblemPage(
        cls.slug,
        cls.problem_type(),
        cls.title,
        cls.__name__,
        meaning,
        ((cls.status, ""), *sorted(words.other_statuses.items())),
        tuple((name, fields[name]) for name in cls.fields),
        words.what_to_do,
    )


def _read_docstring(cls: type[IkplanError]) -> tuple[str, dict[str, str]]:
    """Return the words before ``Attributes:``, and those on each attribute."""
    text = inspect.cleandoc(cls.__doc__ or "").replace("``", "`")
    before, _, attributes = text.partition("\nAttributes:\n")
    entries = re.findall(r"^    (\w+): (.*(?:\n {8}.*)*)", attributes, re.MULTILINE)
    # The docstrings speak of Python; the page speaks of JSON.
    return _joined(before), {
        name: re.sub(r"\bNone\b", "null", _joined(words)) for name, words in entries
    }


def _joined(text: str) -> str:
    return " ".join(text.split())


def _inline(text: str) -> str:
    return re.sub(r"`([^`]+)`", r"<code>\1</code>", escape(text, quote=False))


def _list(tag: str, items: Iterable[str]) -> str:
    return f"<{tag}>" + "".join(f"<li>{item}</li>" for item in items) + f"</{tag}>"


def _document(title: str, root: str, body: str) -> str:
    return (
        f'<!doctype html><html lang="en"><head><meta charset="utf-8"><title>{escape(title)}</title>'
        f'<meta name="viewport" content="width=device-width"><link rel="icon" href="data:,">'
        f'<link rel="stylesheet" href="{root}docs/style.css"></head><body>'
        f'<nav class="top"><a href="{root}problems">Types of problems</a> '
        f'<a href="{root}docs">Manual</a></nav><main>{body}</main></body></html>\n'
    )


PAGES: dict[str, ProblemPage] = {cls.slug: _page(cls) for cls in WORDS}
"""The page of each type of problem, by the last part of the type."""

_TITLE = "Types of problems"
_INTRODUCTION = (
    "Every failure is a problem document (RFC 9457). Its `type` is one of these, and the header "
    "`Link` leads to the page of the type. Every document has `type`, `title`, `status`, `detail` "
    "(what happened, and what to do) and `instance` (the id of the request). The type "
    "`about:blank` stands for a plain HTTP status: a wrong path or method."
)


def index_markdown() -> str:
    """Return the list of all types as Markdown."""
    lines = [f"- [{page.title}](problems/{slug}): {page.meaning}" for slug, page in PAGES.items()]
    return "\n".join([f"# {_TITLE}", "", _INTRODUCTION, "", *lines, ""])


def index_html() -> str:
    """Return the list of all types as HTML."""
    rows = "".join(
        f'<tr><td><a href="problems/{slug}">{escape(page.title)}</a></td>'
        f"<td>{page.statuses[0][0]}</td><td>{_inline(page.meaning)}</td></tr>"
        for slug, page in PAGES.items()
    )
    head = "<tr><th>Type</th><th>Status</th><th>Meaning</th></tr>"
    table = f"<table><thead>{head}</thead><tbody>{rows}</tbody></table>"
    return _document(_TITLE, "", f"<h1>{_TITLE}</h1><p>{_inline(_INTRODUCTION)}</p>{table}")
