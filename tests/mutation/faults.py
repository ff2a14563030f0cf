"""Faults that can be planted in a Python module: one changed operator, constant,
condition or statement each.

In: the source of a module. Out: `Fault`, whose `planted` gives the changed source. The
changes are made in the text, so that lines keep their numbers. Docstrings, annotations,
texts and ``if TYPE_CHECKING`` blocks are not changed, since tests do not check wording.
"""

from __future__ import annotations

import ast
from collections.abc import Iterator
from dataclasses import dataclass
from itertools import pairwise

COMPARISONS: dict[type[ast.cmpop], tuple[str, str]] = {
    ast.Lt: ("<", "<="),
    ast.LtE: ("<=", "<"),
    ast.Gt: (">", ">="),
    ast.GtE: (">=", ">"),
    ast.Eq: ("==", "!="),
    ast.NotEq: ("!=", "=="),
    ast.Is: ("is", "is not"),
    ast.IsNot: ("is not", "is"),
    ast.In: ("in", "not in"),
    ast.NotIn: ("not in", "in"),
}
ARITHMETIC: dict[type[ast.operator], tuple[str, str]] = {
    ast.Add: ("+", "-"),
    ast.Sub: ("-", "+"),
    ast.Mult: ("*", "+"),
    ast.FloorDiv: ("//", "*"),
    ast.Div: ("/", "*"),
    ast.LShift: ("<<", ">>"),
    ast.RShift: (">>", "<<"),
    ast.BitAnd: ("&", "|"),
    ast.BitOr: ("|", "&"),
    ast.Mod: ("%", "+"),
}


@dataclass(frozen=True)
class Fault:
    """One change: the characters from `start` to `end` of the source become `text`."""

    line: int
    start: int
    end: int
    text: str
    was: str

    def planted(self, source: str) -> str:
        return source[: self.start] + self.text + source[self.end :]

    def __str__(self) -> str:
        return f"line {self.line}: {self.was.strip()!r} -> {self.text.strip()!r}"


class _Places:
    """Offsets of the nodes of a syntax tree in its source."""

    def __init__(self, source: str) -> None:
        self.source = source
        self.lines = source.splitlines(keepends=True)
        self.offsets = [0]
        for line in self.lines:
            self.offsets.append(self.offsets[-1] + len(line))

    def offset(self, line: int, column: int) -> int:
        """Return the offset of a column, which Python counts in bytes of UTF-8."""
        head = self.lines[line - 1].encode()[:column].decode()
        return self.offsets[line - 1] + len(head)

    def start(self, node: ast.expr | ast.stmt) -> int:
        return self.offset(node.lineno, node.col_offset)

    def end(self, node: ast.expr | ast.stmt) -> int:
        assert node.end_lineno is not None and node.end_col_offset is not None
        return self.offset(node.end_lineno, node.end_col_offset)

    def text(self, node: ast.expr | ast.stmt) -> str:
        return self.source[self.start(node) : self.end(node)]

    def replaced(self, node: ast.expr | ast.stmt, text: str) -> Fault:
        return Fault(
            node.lineno, self.start(node), self.end(node), text, self.text(node)
        )

    def between(
        self, left: ast.expr, right: ast.expr, operator: str, text: str
    ) -> Iterator[Fault]:
        """Replace the operator between two operands."""
        gap = self.source[self.end(left) : self.start(right)]
        at = gap.find(operator)
        if at >= 0:
            start = self.end(left) + at
            line = self.source.count("\n", 0, start) + 1
            yield Fault(line, start, start + len(operator), text, operator)


def _of_expression(node: ast.AST, places: _Places) -> Iterator[Fault]:
    match node:
        case ast.Compare(left=left, ops=ops, comparators=comparators):
            for operator, first, second in zip(
                ops, [left, *comparators], comparators, strict=False
            ):
                yield from places.between(first, second, *COMPARISONS[type(operator)])
        case ast.BinOp(left=left, op=operation, right=right):
            words = ARITHMETIC.get(type(operation))
            is_text = any(isinstance(n, ast.JoinedStr) for n in (left, right)) or any(
                isinstance(n, ast.Constant) and isinstance(n.value, str)
                for n in (left, right)
            )
            if words and not is_text:
                yield from places.between(left, right, *words)
        case ast.BoolOp(op=operation, values=values):
            words = ("and", "or") if isinstance(operation, ast.And) else ("or", "and")
            for first, second in pairwise(values):
                yield from places.between(first, second, *words)
        case ast.UnaryOp(op=ast.Not(), operand=operand):
            yield places.replaced(node, f"bool({places.text(operand)})")
        case ast.Constant(value=bool(value)):
            yield places.replaced(node, str(not value))
        case ast.Constant(value=int(value)):
            yield places.replaced(node, str(value + 1))
        case ast.IfExp(test=test):
            yield places.replaced(test, f"(not ({places.text(test)}))")


def _of_statement(node: ast.AST, places: _Places) -> Iterator[Fault]:
    match node:
        case ast.If(test=test) | ast.While(test=test):
            yield places.replaced(test, f"(not ({places.text(test)}))")
        case ast.Expr(value=ast.Call()) | ast.AugAssign() | ast.Continue():
            yield places.replaced(node, "pass")
        case ast.Return(value=ast.expr() as value):
            if not (isinstance(value, ast.Constant) and value.value is None):
                yield places.replaced(node, "return None")


def _code(node: ast.AST) -> Iterator[ast.AST]:
    """Walk over the nodes that can contain a fault."""
    for name, value in ast.iter_fields(node):
        if name in ("annotation", "returns", "decorator_list", "type_params"):
            continue
        for child in value if isinstance(value, list) else [value]:
            if not isinstance(child, ast.AST) or isinstance(child, ast.JoinedStr):
                continue
            if isinstance(child, ast.If) and "TYPE_CHECKING" in ast.unparse(child.test):
                continue
            yield child
            yield from _code(child)


def faults_of(source: str) -> list[Fault]:
    """Return all faults that can be planted in a module, in the order of its lines.

    Each changed source is valid Python.
    """
    places = _Places(source)
    faults: list[Fault] = []
    for node in _code(ast.parse(source)):
        faults += [*_of_expression(node, places), *_of_statement(node, places)]
    return sorted(set(faults), key=lambda fault: (fault.start, fault.end, fault.text))
