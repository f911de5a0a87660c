"""Strategies that damage a good document: JSON by its structure, XML by its tags, any by bytes."""

from __future__ import annotations

import copy
import json
import re
from collections.abc import Sequence
from typing import Any

from hypothesis import strategies as st

from benchmarks.fuzz.odd import ODD_NUMBERS, ODD_TEXTS, ODD_VALUES

__all__ = ["damaged_json", "damaged_text", "damaged_xml"]

_TAG = re.compile(r"<[^<>]*>")
_VALUE = re.compile(r'"[^"<>]*"')
_REPEATED = (2, 3, 70, 1500, 20_000)
_LONGEST = 2**23
"""Longest text that a repetition makes."""
_INSERTED = (
    "<!DOCTYPE robot []>", '<!ENTITY a "b">', "<!-- x -->", "<![CDATA[x]]>", "<?x y?>", "&x;",
    "&#0;", "&#x110000;", "<a xmlns:x='y' x:z='1'/>", '<?xml version="1.1" encoding="utf-16"?>',
    "<link name='l0'/>", "<joint/>", "<mimic joint='j1'/>", "<limit/>", "<robot>", "</robot>",
    "<a>" * 40, "<a>" * 5000, "<a/>" * 5000,
)  # fmt: skip
_ENCODINGS = ("utf-8", "utf-8-sig", "utf-16", "utf-32", "latin-1")

_Place = tuple[Any, Any]


def _places(document: Any) -> list[_Place]:
    """Each container of a document with one of its keys or indices."""
    found: list[_Place] = []
    pending = [document]
    while pending:
        item = pending.pop()
        keys = list(item) if isinstance(item, dict) else range(len(item))
        found += [(item, key) for key in keys]
        pending += [item[key] for key in keys if isinstance(item[key], dict | list)]
    return found


@st.composite
def damaged_json(draw: st.DrawFn, corpus: Sequence[Any]) -> bytes:
    """A document of the corpus, changed in up to six places, as text that may be damaged too."""
    document = copy.deepcopy(draw(st.sampled_from(corpus)))
    for _ in range(draw(st.integers(0, 6))):
        places = _places(document)
        if not places:
            break
        _change(draw, document, places)
    text = json.dumps(document, ensure_ascii=draw(st.booleans()))
    if draw(st.integers(0, 3)) == 0:
        text = draw(damaged_text(st.just(text)))
    return _encoded(draw, text)


def _change(draw: st.DrawFn, document: Any, places: list[_Place]) -> None:
    holder, key = draw(st.sampled_from(places))
    what = draw(st.integers(0, 7))
    if what <= 2:
        holder[key] = copy.deepcopy(draw(st.sampled_from(ODD_VALUES)))
    elif what == 3:
        del holder[key]
    elif what == 4:
        other, name = draw(st.sampled_from(places))
        holder[key] = copy.deepcopy(other[name])
    elif what == 5 and isinstance(holder, dict):
        _, name = draw(st.sampled_from(places))
        holder[name if isinstance(name, str) else draw(st.sampled_from(ODD_TEXTS))] = holder.pop(
            key
        )
    elif what == 6 and isinstance(holder, list) and len(json.dumps(document)) < 50_000:
        holder[key:key] = [holder[key]] * _times(draw, len(json.dumps(holder[key])))
    else:
        holder[key] = draw(st.floats() | st.integers() | st.text(max_size=20))


@st.composite
def damaged_text(draw: st.DrawFn, texts: st.SearchStrategy[str]) -> str:
    """A text with pieces removed, repeated, moved or replaced."""
    text = draw(texts)
    for _ in range(draw(st.integers(1, 4))):
        begin = draw(st.integers(0, len(text)))
        end = min(len(text), begin + draw(st.integers(0, 40)))
        piece = text[begin:end]
        what = draw(st.integers(0, 4))
        if what == 0:
            piece = ""
        elif what == 1 and len(text) < 50_000:
            piece *= _times(draw, len(piece))
        elif what == 2:
            piece = draw(st.sampled_from(ODD_NUMBERS + ODD_TEXTS))
        elif what == 3:
            piece += piece[::-1]
        else:
            piece = draw(st.text(max_size=10))
        text = text[:begin] + piece + text[end:]
    return text


@st.composite
def damaged_xml(draw: st.DrawFn, corpus: Sequence[str]) -> bytes:
    """A document of the corpus with tags and values changed, and bytes that may be damaged too."""
    text = draw(st.sampled_from(corpus))
    for _ in range(draw(st.integers(0, 5))):
        tags = list(_TAG.finditer(text))
        if not tags:
            break
        text = _change_xml(draw, text, tags)
    if draw(st.integers(0, 3)) == 0:
        text = draw(damaged_text(st.just(text)))
    return _encoded(draw, text)


def _change_xml(draw: st.DrawFn, text: str, tags: list[re.Match[str]]) -> str:
    first = draw(st.integers(0, len(tags) - 1))
    begin, end = tags[first].span()
    what = draw(st.integers(0, 5))
    if what <= 2 and (values := list(_VALUE.finditer(text, begin, end))):
        value = draw(st.sampled_from(values))
        others = _VALUE.findall(text)
        new = draw(st.sampled_from(ODD_NUMBERS + ODD_TEXTS) | st.sampled_from(others))
        return text[: value.start()] + '"' + new.strip('"') + '"' + text[value.end() :]
    last = min(len(tags) - 1, first + draw(st.integers(0, 12)))
    end = tags[last].end()
    if what == 3:
        return text[:begin] + text[end:]
    if what == 4:
        times = _times(draw, end - begin) if len(text) < 50_000 else 2
        return text[:begin] + text[begin:end] * times + text[end:]
    return text[:begin] + draw(st.sampled_from(_INSERTED)) + text[begin:]


def _times(draw: st.DrawFn, length: int) -> int:
    """How often a piece of some length is repeated."""
    return min(draw(st.sampled_from(_REPEATED)), 1 + _LONGEST // (length + 1))


def _encoded(draw: st.DrawFn, text: str) -> bytes:
    encoding = draw(st.sampled_from(_ENCODINGS)) if draw(st.integers(0, 15)) == 0 else "utf-8"
    return text.encode(encoding, "surrogatepass" if encoding.startswith("utf") else "replace")
