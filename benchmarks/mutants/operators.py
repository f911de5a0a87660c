"""Small faults, found in the syntax tree and made in the text.

A fault is the replacement of the text of one node. Docstrings and other strings, annotations,
imports, decorators, ``__all__``, assertions, the figures in messages, and the ``strict`` of ``zip``
stay as they are: they are for readers, or for the type checker.
"""

from __future__ import annotations

import ast
import functools
from dataclasses import dataclass

__all__ = ["Fault", "faults_of"]

_COMPARE: dict[type[ast.cmpop], tuple[str, ...]] = {
    ast.Lt: ("<=", ">="),
    ast.LtE: ("<", ">"),
    ast.Gt: (">=", "<="),
    ast.GtE: (">", "<"),
    ast.Eq: ("!=",),
    ast.NotEq: ("==",),
    ast.Is: ("is not",),
    ast.IsNot: ("is",),
    ast.In: ("not in",),
    ast.NotIn: ("in",),
}
"""The boundary moved, and the comparison turned round."""
_ARITHMETIC: dict[type[ast.operator], str] = {
    ast.Add: "-",
    ast.Sub: "+",
    ast.Mult: "/",
    ast.Div: "*",
    ast.FloorDiv: "*",
    ast.Mod: "*",
    ast.Pow: "*",
    ast.BitAnd: "|",
    ast.BitOr: "&",
}
_SWAPPED = (
    ("min", "max"),
    ("minimum", "maximum"),
    ("fmin", "fmax"),
    ("argmin", "argmax"),
    ("any", "all"),
    ("floor", "ceil"),
    ("sin", "cos"),
)
_SWAP = {a: b for pair in _SWAPPED for a, b in (pair, pair[::-1])}
_MAGNITUDE = ("abs", "fabs")


@dataclass(frozen=True)
class Fault:
    """The text of one node replaced.

    Attributes:
        kind: What was done, in a word or two.
        begin: Where the text begins [characters].
        end: Where it ends.
        new: What replaces it.
        line: Line it begins on, counted from 1.
    """

    kind: str
    begin: int
    end: int
    new: str
    line: int


@functools.cache
def faults_of(source: str) -> tuple[Fault, ...]:
    """Return every fault that can be made in a module, in the order of its text."""
    finder = _Finder(source)
    finder.visit(ast.parse(source))
    return tuple(sorted(finder.faults, key=lambda fault: (fault.begin, fault.end, fault.new)))


class _Finder(ast.NodeVisitor):
    """Walks a module and notes what can be done to each node."""

    def __init__(self, source: str) -> None:
        self.faults: list[Fault] = []
        self._source = source
        lines = source.splitlines(keepends=True)
        self._lines = [line.encode() for line in lines]
        self._starts = [0]
        for line in lines:
            self._starts.append(self._starts[-1] + len(line))
        self._returns: list[str] = []

    def _at(self, line: int, column: int) -> int:
        """Offset in characters of a place that the syntax tree gives in bytes of a line."""
        return self._starts[line - 1] + len(self._lines[line - 1][:column].decode())

    def _span(self, node: ast.expr | ast.stmt) -> tuple[int, int]:
        assert node.end_lineno is not None
        assert node.end_col_offset is not None
        return (
            self._at(node.lineno, node.col_offset),
            self._at(node.end_lineno, node.end_col_offset),
        )

    def _text(self, node: ast.expr | ast.stmt) -> str:
        begin, end = self._span(node)
        return self._source[begin:end]

    def _note(self, kind: str, node: ast.expr | ast.stmt, new: str) -> None:
        begin, end = self._span(node)
        if self._source[begin:end] != new:
            self.faults.append(Fault(kind, begin, end, new, node.lineno))

    def _note_between(self, kind: str, left: ast.expr, right: ast.expr, new: str) -> None:
        """Replace the operator between two operands, brackets about them left alone."""
        begin, end = self._span(left)[1], self._span(right)[0]
        gap = self._source[begin:end]
        bare = gap.lstrip(") \n").rstrip("( \n")
        if "#" in bare or not bare.strip():
            return
        start = begin + gap.index(bare)
        self.faults.append(Fault(kind, start, start + len(bare), new, left.lineno))

    # What stays as it is.

    def visit_JoinedStr(self, node: ast.JoinedStr) -> None:
        """Leave messages alone."""

    def visit_Import(self, node: ast.Import) -> None:
        """Leave imports alone."""

    def visit_ImportFrom(self, node: ast.ImportFrom) -> None:
        """Leave imports alone."""

    def visit_Assert(self, node: ast.Assert) -> None:
        """Leave assertions alone: they tell the type checker what holds."""

    def visit_arg(self, node: ast.arg) -> None:
        """Leave annotations alone."""

    def visit_AnnAssign(self, node: ast.AnnAssign) -> None:
        """Look at the value only."""
        if node.value is not None:
            self.visit(node.value)

    def visit_Assign(self, node: ast.Assign) -> None:
        """Leave the names that a module exports and the unions of types alone."""
        names = {t.id for t in node.targets if isinstance(t, ast.Name)}
        union = isinstance(node.value, ast.BinOp) and isinstance(node.value.op, ast.BitOr)
        if "__all__" not in names and not (union and node.col_offset == 0):
            self.generic_visit(node)

    def visit_keyword(self, node: ast.keyword) -> None:
        """Leave ``strict`` alone."""
        if node.arg != "strict":
            self.generic_visit(node)

    def visit_ClassDef(self, node: ast.ClassDef) -> None:
        """Look at the body only."""
        for statement in node.body:
            self.visit(statement)

    def visit_FunctionDef(self, node: ast.FunctionDef) -> None:
        """Look at the defaults and the body; note what the function says that it returns."""
        for default in (*node.args.defaults, *node.args.kw_defaults):
            if default is not None:
                self.visit(default)
        self._returns.append("" if node.returns is None else ast.unparse(node.returns))
        for statement in node.body:
            self.visit(statement)
        self._returns.pop()

    # Statements.

    def visit_If(self, node: ast.If) -> None:
        """Turn the condition round."""
        if "TYPE_CHECKING" in self._text(node.test):
            return
        self._negate(node.test)
        self.generic_visit(node)

    def visit_While(self, node: ast.While) -> None:
        """Turn the condition round."""
        self._negate(node.test)
        self.generic_visit(node)

    def visit_IfExp(self, node: ast.IfExp) -> None:
        """Turn the condition round."""
        self._negate(node.test)
        self.generic_visit(node)

    def _negate(self, test: ast.expr) -> None:
        if isinstance(test, ast.Compare) and len(test.ops) == 1:
            return  # the comparison is turned round as such
        if isinstance(test, ast.UnaryOp) and isinstance(test.op, ast.Not):
            return
        if not isinstance(test, ast.Constant):
            self._note("condition turned round", test, f"(not ({self._text(test)}))")

    def visit_Raise(self, node: ast.Raise) -> None:
        """Leave the error out; its message stays as it is."""
        self._note("error left out", node, "pass")

    def visit_Expr(self, node: ast.Expr) -> None:
        """Leave a call out that is made for what it does."""
        if isinstance(node.value, ast.Call):
            self._note("call left out", node, "pass")
            self.generic_visit(node)

    def visit_AugAssign(self, node: ast.AugAssign) -> None:
        """Leave an update out."""
        self._note("update left out", node, "pass")
        self.generic_visit(node)

    def visit_Continue(self, node: ast.Continue) -> None:
        """Go on with the rest of the loop."""
        self._note("continue left out", node, "pass")

    def visit_Break(self, node: ast.Break) -> None:
        """Go on with the loop."""
        self._note("break left out", node, "pass")

    def visit_Return(self, node: ast.Return) -> None:
        """Return something else of the same type."""
        if node.value is None:
            self._note("return left out", node, "pass")
            return
        promised = self._returns[-1] if self._returns else ""
        text = self._text(node.value)
        constant = isinstance(node.value, ast.Constant)
        if promised == "bool" and not constant:
            self._note("return turned round", node.value, f"(not ({text}))")
        elif promised == "float" and not constant:
            self._note("return of nothing", node.value, "0.0")
        elif promised == "Array" and not constant:
            self._note("return of nothing", node.value, f"(0.0 * ({text}))")
        elif promised.startswith("list[") and text != "[]":
            self._note("return of nothing", node.value, "[]")
        self.generic_visit(node)

    # Expressions.

    def visit_Compare(self, node: ast.Compare) -> None:
        """Move the boundary of a comparison, and turn it round."""
        operands = [node.left, *node.comparators]
        for k, op in enumerate(node.ops):
            for new in _COMPARE[type(op)]:
                self._note_between("comparison", operands[k], operands[k + 1], new)
        self.generic_visit(node)

    def visit_BoolOp(self, node: ast.BoolOp) -> None:
        """And for or, or for and."""
        new = "or" if isinstance(node.op, ast.And) else "and"
        for left, right in zip(node.values, node.values[1:], strict=False):
            self._note_between("and / or", left, right, new)
        self.generic_visit(node)

    def visit_BinOp(self, node: ast.BinOp) -> None:
        """Another operation of arithmetic."""
        new = _ARITHMETIC.get(type(node.op))
        text = isinstance(node.left, ast.JoinedStr | ast.Constant) and isinstance(
            getattr(node.left, "value", ""), str
        )
        if new is not None and not text:
            self._note_between("arithmetic", node.left, node.right, new)
        self.generic_visit(node)

    def visit_UnaryOp(self, node: ast.UnaryOp) -> None:
        """Leave a sign or a negation out."""
        self._note("sign or negation left out", node, f"({self._text(node.operand)})")
        self.generic_visit(node)

    def visit_Constant(self, node: ast.Constant) -> None:
        """A truth value turned round, a count one higher, a figure ten times as large."""
        value = node.value
        if isinstance(value, bool):
            self._note("constant", node, str(not value))
        elif isinstance(value, int):
            self._note("constant", node, str(value + 1))
        elif isinstance(value, float):
            self._note("constant", node, repr(1.0 if value == 0.0 else 10.0 * value))

    def visit_Call(self, node: ast.Call) -> None:
        """The least for the most and the like; a number for its magnitude."""
        function = node.func
        name = function.attr if isinstance(function, ast.Attribute) else ""
        name = function.id if isinstance(function, ast.Name) else name
        if name in _SWAP:
            text = self._text(function)
            self._note("least / most", function, text[: -len(name)] + _SWAP[name])
        if name in _MAGNITUDE and len(node.args) == 1:
            self._note("magnitude left out", node, f"({self._text(node.args[0])})")
        self.generic_visit(node)
