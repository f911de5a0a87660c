"""What the request and result documents are built of; a file for each part of them."""

from ikplan.documents.base import (
    HASHED,
    MAX_NUMBER,
    Document,
    Floats,
    IfGiven,
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
    "HASHED",
    "MAX_NUMBER",
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
