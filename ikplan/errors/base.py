"""The root of the tree of errors."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any, ClassVar

__all__ = ["IkplanError"]

_URN = "urn:ikplan:"


class IkplanError(Exception):
    """Root of the tree.

    Attributes:
        slug: Last part of the problem type ``urn:ikplan:<slug>``.
        title: A short name for people, the same for every occurrence.
        status: HTTP status of the problem document.
        fields: Names of the attributes that make up the error's own data, JSON-ready.
        added_fields: Those of them that documents of older services lack.
        detail: What happened this time, and what the user can do.
    """

    slug: ClassVar[str] = "error"
    title: ClassVar[str] = "Planning error"
    status: ClassVar[int] = 500
    fields: ClassVar[tuple[str, ...]] = ()
    added_fields: ClassVar[tuple[str, ...]] = ()

    def __init__(self, detail: str) -> None:
        super().__init__(detail)
        self.detail = detail

    @property
    def data(self) -> dict[str, Any]:
        """The error's own data, by field name, ready for JSON."""
        return {name: getattr(self, name) for name in self.fields}

    @classmethod
    def problem_type(cls) -> str:
        """The problem type URI of this class."""
        return _URN + cls.slug

    def to_problem(self) -> dict[str, Any]:
        """Return the RFC 9457 problem document of this error."""
        return {
            "type": self.problem_type(),
            "title": self.title,
            "status": self.status,
            "detail": self.detail,
            **self.data,
        }

    def __reduce__(self) -> tuple[Callable[..., IkplanError], tuple[Any, ...]]:
        # Keyword-only data does not survive the default pickling of exceptions.
        return _rebuild, (type(self), self.detail, self.data)


def _rebuild(cls: type[IkplanError], detail: str, data: Mapping[str, Any]) -> IkplanError:
    return cls(detail, **data)
