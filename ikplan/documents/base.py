"""What the request and result documents are built of, and how their faults are reported.

Every model refuses unknown fields, NaN and infinities. A fault becomes an
:class:`~ikplan.errors.InvalidRequest` that names the field as a user writes it
(``path.waypoints[3].position``) and what is allowed there.
"""

from __future__ import annotations

import functools
import hashlib
from collections.abc import Mapping, Sequence
from typing import Annotated, Any, NamedTuple, NoReturn, TypeVar, get_args

import numpy as np
import orjson
from numpy.typing import NDArray
from pydantic import (
    VERSION,
    BaseModel,
    BeforeValidator,
    ConfigDict,
    Field,
    PlainSerializer,
    PlainValidator,
    ValidationError,
    WithJsonSchema,
)
from pydantic.fields import FieldInfo

from ikplan.documents.json_text import load_json, shortened
from ikplan.errors import InvalidRequest, near_names
from ikplan.processor_time import WALL_FACTOR

__all__ = [
    "AT_FIRST_USE",
    "BUDGET_COUNTS",
    "MAX_BUDGET_S",
    "MAX_NUMBER",
    "MAX_PLAN_S",
    "Booleans",
    "Document",
    "Floats",
    "IfGiven",
    "Matrix",
    "Number",
    "Vec3",
    "Vector",
    "as_list",
    "content_hash",
    "load_json",
    "parse",
    "parse_json",
    "raise_invalid",
    "write_json",
]

M = TypeVar("M", bound="Document")

MAX_BUDGET_S = 3600.0
"""Largest time budget [s]."""
MAX_PLAN_S = WALL_FACTOR * MAX_BUDGET_S
"""Longest wall time of a plan [s]."""
BUDGET_COUNTS = f"processor time, in at most {WALL_FACTOR:g} times as much wall time"
"""What a time budget counts, in words."""


AT_FIRST_USE = tuple(int(part) for part in VERSION.split(".")[:2]) >= (2, 14)
"""Value of pydantic's ``defer_build``: what checks and writes a document is built at its first use.

Earlier versions of pydantic take no lock then, so that of several threads that use a document
first at the same time one may have it checked as another.
"""


class Document(BaseModel):
    """Base of every request model: strict, closed, finite, immutable."""

    model_config = ConfigDict(
        extra="forbid", allow_inf_nan=False, frozen=True, strict=True, defer_build=AT_FIRST_USE
    )


class IfGiven:
    """Marks a field that enters the id of a request only where it differs from its default.

    A request without it then keeps the id that it had before there was such a field.
    """


HASHED = "hashed"
"""Key of the context in which a document is written for its hash."""


def content_hash(document: Document, *context: str) -> str:
    """Return a hash of a request in canonical form and its context, 32 hexadecimal digits.

    The budget is left out: it decides whether there is a plan, never which one.
    """
    left_out = {**_not_given(document), "budget_s": True}
    content = document.model_dump(mode="json", exclude=left_out, context={HASHED: True})
    canonical = orjson.dumps([content, *context], option=orjson.OPT_SORT_KEYS)
    return hashlib.sha256(canonical).hexdigest()[:32]


class _Default(NamedTuple):
    """What a field marked with :class:`IfGiven` is where it is not given."""

    value: Any


@functools.cache
def _marked_fields(model: type[Document]) -> tuple[tuple[str, _Default | None], ...]:
    """The fields of a model; None beside those without the mark :class:`IfGiven`."""
    return tuple(
        (name, _default(field) if any(isinstance(m, IfGiven) for m in field.metadata) else None)
        for name, field in model.model_fields.items()
    )


def _default(field: FieldInfo) -> _Default:
    return _Default(field.get_default(call_default_factory=True))


def _not_given(document: Document) -> dict[str, Any]:
    """The fields marked with :class:`IfGiven` at their default, as pydantic's ``exclude``."""
    found: dict[str, Any] = {}
    values = document.__dict__
    for name, default in _marked_fields(type(document)):
        value = values[name]
        if default is not None and value == default.value:
            found[name] = True
        elif isinstance(value, Document) and (inner := _not_given(value)):
            found[name] = inner
        elif isinstance(value, list) and value and isinstance(value[0], Document):
            rows = {k: _not_given(x) for k, x in enumerate(value) if isinstance(x, Document)}
            if rows := {k: row for k, row in rows.items() if row}:
                found[name] = rows
    return found


def as_list(value: Any) -> Any:
    """Let Python callers pass arrays and tuples where the document has lists."""
    if isinstance(value, np.ndarray):
        return value.tolist()
    if isinstance(value, tuple):
        return list(value)
    return value


MAX_NUMBER = 1e6
"""Largest length [m] or joint value [rad or m]: beyond it squares lose the digits that count."""

Number = Annotated[float, Field(ge=-MAX_NUMBER, le=MAX_NUMBER)]
Floats = Annotated[list[Number], BeforeValidator(as_list)]
Vec3 = Annotated[list[Number], BeforeValidator(as_list), Field(min_length=3, max_length=3)]


_ARRAYS = object()
"""Context in which arrays are left as they are."""


def _array(ndim: int, schema: dict[str, Any], dtype: type[np.generic] = np.float64) -> Any:
    def load(value: Any) -> NDArray[Any]:
        array = np.array(value, dtype=dtype)
        if array.size == 0 and array.ndim < ndim:
            array = array.reshape((0,) * ndim)
        if array.ndim != ndim:
            raise ValueError(f"expected {ndim} dimension(s), got {array.ndim}")
        array.setflags(write=False)
        return array

    return Annotated[
        NDArray[Any],
        PlainValidator(load),
        PlainSerializer(lambda a, info: a if info.context is _ARRAYS else a.tolist()),
        WithJsonSchema(schema),
    ]


_NUMBERS: dict[str, Any] = {"type": "array", "items": {"type": "number"}}
Vector = _array(1, _NUMBERS)
"""A float64 array of shape (n,) in Python, a list of numbers in JSON."""
Matrix = _array(2, {"type": "array", "items": _NUMBERS})
"""A float64 array of shape (n, m) in Python, a list of rows in JSON."""
Booleans = _array(1, {"type": "array", "items": {"type": "boolean"}}, np.bool_)
"""An array of booleans of shape (n,) in Python, a list in JSON."""


def write_json(document: BaseModel) -> bytes:
    """Write a document: byte for byte what ``model_dump_json`` does, long arrays much faster."""
    content = document.model_dump(context=_ARRAYS)
    return orjson.dumps(content, default=_rows, option=orjson.OPT_SERIALIZE_NUMPY)


def _rows(value: Any) -> Any:
    """What orjson does not know by itself: an array that is not one block of memory."""
    if isinstance(value, np.ndarray):
        return value.tolist()
    raise TypeError(f"{type(value).__name__} has no JSON")


def _resolve(model: type[BaseModel], loc: Sequence[int | str]) -> tuple[str, list[Any]]:
    """Return a pydantic location as a user writes it, and the models that may stand there.

    ``path.waypoints[3].position``: without the tags that pydantic adds for unions and functions.
    """
    text = ""
    current: list[Any] = [model]
    for part in loc:
        if isinstance(part, int):
            text += f"[{part}]"
        elif len(current) > 1 and any(part in _tags(m) for m in current):
            current = [m for m in current if part in _tags(m)]
        elif not any(c in part for c in "[(-"):
            text += f".{shortened(part)}" if text else shortened(part)
            fields = [m.model_fields[part] for m in current if part in m.model_fields]
            current = [m for field in fields for m in _models_in(field.annotation)]
    return text, current


def _tags(model: Any) -> Sequence[Any]:
    """The values of ``type`` that tell a model from the others of its union."""
    field = model.model_fields.get("type")
    return get_args(field.annotation) if field else ()


def _models_in(annotation: Any) -> list[Any]:
    """Every model inside an annotation such as ``list[Waypoint] | None``."""
    if hasattr(annotation, "model_fields"):
        return [annotation]
    return [m for argument in get_args(annotation) for m in _models_in(argument)]


MAX_FAULTS = 100
"""Most faults of one document that are described."""

_LENGTHS = {
    "too_short": "item(s)",
    "too_long": "item(s)",
    "string_too_short": "character(s)",
    "string_too_long": "character(s)",
}


def _describe(model: type[BaseModel], error: Mapping[str, Any]) -> tuple[str, str, Any]:
    """Return field path, sentence and what is allowed for one pydantic error."""
    loc: tuple[int | str, ...] = tuple(error["loc"])
    field, _ = _resolve(model, loc)
    kind, context = error["type"], error.get("ctx", {})
    if kind == "extra_forbidden":
        _, models = _resolve(model, loc[:-1])
        fields = sorted({name for m in models for name in m.model_fields})
        near = near_names(shortened(str(loc[-1])), fields)
        hint = f"; did you mean {near[0]!r}?" if near else f"; known fields: {', '.join(fields)}"
        return field, f"unknown field{hint}", fields
    if kind == "missing":
        return field, "this field is required", None
    if kind == "finite_number":
        return field, "NaN and infinities are not numbers a robot can follow", "a finite number"
    if kind == "literal_error":
        return field, f"must be {context['expected']}", context["expected"]
    if kind == "union_tag_invalid":
        tags = [tag.strip("' ") for tag in context["expected_tags"].split(",")]
        tag = shortened(str(context["tag"]))
        near = near_names(tag, tags)
        hint = f"; did you mean {near[0]!r}?" if near else f"; known: {', '.join(tags)}"
        return f"{field}.type", f"unknown type {tag!r}{hint}", tags
    if kind == "union_tag_not_found":
        return f"{field}.type", "this field is required", None
    if kind == "value_error":
        return field, str(context.get("error", error["msg"])), None
    if kind in _LENGTHS:
        least, most = context.get("min_length"), context.get("max_length")
        bound = f"at least {least}" if kind.endswith("short") else f"at most {most}"
        actual = context.get("actual_length")
        got = f", got {actual}" if actual is not None else ""
        return field, f"wants {bound} {_LENGTHS[kind]}{got}", bound
    message = str(error["msg"])
    allowed = {k: v for k, v in context.items() if isinstance(v, int | float | str)} or None
    return field, message[0].lower() + message[1:], allowed


def raise_invalid(
    model: type[BaseModel], errors: Sequence[Mapping[str, Any]], cause: Exception | None = None
) -> NoReturn:
    """Raise InvalidRequest for pydantic's list of errors on a document of ``model``."""
    described = [_describe(model, e) for e in errors[:MAX_FAULTS]]
    field, sentence, allowed = described[0]
    more = f" (and {len(errors) - 1} more)" if len(errors) > 1 else ""
    raise InvalidRequest(
        f"{field}: {sentence}{more}" if field else sentence + more,
        field=field,
        allowed=allowed,
        errors=[{"field": f, "detail": s} for f, s, _ in described],
    ) from cause


def parse(model: type[M], document: Any) -> M:
    """Read a document from a mapping.

    Args:
        model: The model wanted.
        document: A mapping, or already an instance of the model.

    Returns:
        The validated model.

    Raises:
        InvalidRequest: A field is wrong; names it.
    """
    if isinstance(document, model):
        return document
    if not isinstance(document, Mapping):
        raise InvalidRequest(
            f"a request is a JSON object, not {type(document).__name__}", allowed="an object"
        )
    try:
        return model.model_validate(dict(document))
    except ValidationError as error:
        raise_invalid(model, error.errors(include_url=False), error)


def parse_json(model: type[M], text: str | bytes) -> M:
    """Read a document from JSON text.

    Raises:
        InvalidRequest: The text is not JSON (with line and column), or a field is wrong.
    """
    return parse(model, load_json(text))
