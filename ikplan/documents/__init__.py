"""What the request and result documents are built of; a file for each part of them."""

from ikplan.documents.base import (
    MAX_NUMBER,
    Document,
    Floats,
    Matrix,
    Number,
    Vec3,
    Vector,
    as_list,
    content_hash,
    load_json,
    parse,
    parse_json,
    raise_invalid,
    write_json,
)

__all__ = [
    "MAX_NUMBER",
    "Document",
    "Floats",
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
