"""Structs and enumerations of C -> tables: of header files, and of `typedef struct` in
the text of documents.

A struct is a table with the columns `COLUMNS`, so that rules read it like any other:
its caption is the name of the struct, the texts before it are the comment above it and
`sizeof N`. Positions follow the System V ABI for little-endian machines, which gcc and
clang follow: bit fields from the least significant bit, members aligned to their size
unless the struct is packed.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

from icdgen.diagnostics import Finding, Findings, Place
from icdgen.errors import UserError
from icdgen.import_results.findings import ImportFinding, SourcePlace
from icdgen.importer.document import (
    Block,
    Cell,
    Document,
    Heading,
    SourceRow,
    SourceTable,
    Text,
)
from icdgen.importer.reading.c_text import CText
from icdgen.importer.reading.utf8 import utf8_text

CODE = "IMP002"
COLUMNS = ("Byte", "Bit", "Bits", "Type", "Name", "Count", "Members", "Comment")
MOST_ELEMENTS = 64  # of an array of structs, each of which is a group of fields
# `long` is missing: it has 8 bytes on 64-bit Linux and 4 on Windows.
_SIZES = {
    "_Bool": ("bool", 8), "char": ("char", 8), "signed char": ("int", 8), "unsigned char": ("uint", 8), "short": ("int", 16),
    "unsigned short": ("uint", 16), "int": ("int", 32), "unsigned int": ("uint", 32), "long long": ("int", 64),
    "unsigned long long": ("uint", 64), "float": ("float", 32), "double": ("float", 64),
}  # fmt: skip
_STANDARD = {
    "uint8_t": "unsigned char", "uint16_t": "unsigned short", "uint32_t": "unsigned int", "uint64_t": "unsigned long long",
    "int8_t": "signed char", "int16_t": "short", "int32_t": "int", "int64_t": "long long",
    "bool": "_Bool",
}  # fmt: skip
# C99 6.4.4.1: a number that begins with 0 is octal, which Python writes as `0o17`.
_INTEGER = re.compile(
    r"(?:0(?P<octal>[0-7]+)|(?P<other>0[xX][0-9A-Fa-f]+|0[bB][01]+|0|[1-9][0-9]*))[uUlL]*"
)
_PRELUDE = " ".join(f"typedef {base} {name};" for name, base in _STANDARD.items())


class Unreadable(Exception):
    """A struct that cannot be a table, with the reason and a remedy."""

    def __init__(self, message: str, help: str) -> None:
        super().__init__(message)
        self.message, self.help = message, help


@dataclass
class Member:
    """A member of a struct and its offset.

    ``bit`` is set for bit fields, ``count`` for arrays.
    """

    byte: int
    bits: int
    kind: str
    name: str
    bit: int | None = None
    count: int = 0
    members: str = ""
    line: int | None = None


@dataclass
class Layout:
    """The members of a struct, its size and its alignment in bytes, and its padding."""

    members: list[Member] = field(default_factory=list)
    size: int = 0
    alignment: int = 1
    padding: list[str] = field(default_factory=list)


def read_header(path: Path) -> Document:
    """Return the document of a header file.

    Raises `Findings` if it is no C, `UserError` without pycparser.
    """
    text = utf8_text(path, "save it as UTF-8")
    document = Document(str(path))
    try:
        document.blocks, document.import_findings = read_structs(text)
    except Unreadable as error:
        line = re.match(r"line ([0-9]+): ", error.message)
        place = Place(str(path), int(line[1])) if line else Place(str(path))
        raise Findings([Finding(CODE, error.message, place, error.help)]) from None
    return document


def in_document(document: Document) -> None:
    """Add a table behind each `typedef struct` in the text of a document.

    Text that is not valid C stays text.
    """
    blocks: list[Block] = []
    waiting: list[Text] = []
    for block in document.blocks:
        blocks.append(block)
        begins = isinstance(block, Text) and re.match(
            r"(?:typedef\s+)?(?:\w+\s+)?struct\b[^;]*$", block.text.strip()
        )
        if isinstance(block, Text) and (waiting or begins):
            waiting.append(block)
            text = "\n".join(line.text for line in waiting)
            if (
                "}" in block.text
                and text.count("{") == text.count("}")
                and block.text.rstrip().endswith(";")
            ):
                try:
                    tables, import_findings = read_structs(text)
                except (Unreadable, UserError):
                    tables, import_findings = [], []
                for table in tables:
                    if isinstance(table, SourceTable):
                        for row in table.rows:
                            # The parser counts lines within `text`, and not in the
                            # document.
                            row.page, row.line = waiting[0].page, None
                        blocks.append(table)
                document.import_findings += [
                    t._replace(spot=SourcePlace(waiting[0].page, waiting[0].line))
                    for t in import_findings
                ]
                waiting = []
        elif isinstance(block, (SourceTable, Heading)):
            waiting = []
    document.blocks = blocks


def read_structs(text: str) -> tuple[list[Block], list[ImportFinding]]:
    """Return the structs and enumerations of a text in C as blocks.

    Raises `Unreadable`, and `UserError` without pycparser.
    """
    try:
        from pycparser import c_ast, c_parser
    except ImportError:
        raise UserError(
            "reading structs in C needs pycparser", "pip install 'icdgen[import]'"
        ) from None
    source = CText(text)
    try:
        # `#line` gives errors and nodes the lines of the source.
        tree = c_parser.CParser().parse(f"{_PRELUDE}\n#line 1\n{source.code}", "text")
    except c_parser.ParseError as error:
        match = re.match(r"[^:]*:([0-9]+):[0-9]+: (.*)", str(error))
        line, reason = (
            (int(match[1]), match[2])
            if match
            else (_wrong_line(source, c_parser), str(error).partition(": ")[2])
        )
        message = f"line {line}: this C cannot be parsed: {reason}"
        raise Unreadable(
            message, "declare its types in the same file, and take out macros"
        ) from None
    reader = _Reader(source, c_ast)
    for declaration in tree.ext:
        # Types of the prelude, which the file may declare, too: `scalar` knows their
        # sizes.
        if (
            declaration.coord is not None
            and declaration.coord.file == "text"
            and getattr(declaration, "name", "") in _STANDARD
        ):
            continue
        reader.declaration(declaration)
    return reader.blocks, reader.import_findings


def _wrong_line(source: CText, c_parser: Any) -> int:
    """Return the line of the first invalid declaration, if the parser does not report
    it.
    """
    for line, code in source.beginnings:
        try:
            c_parser.CParser().parse(f"{_PRELUDE}\n{code}", "text")
        except c_parser.ParseError:
            return line
    return 1


class _Reader:
    """Makes tables of the declarations of a file; ``ast`` is pycparser's module of
    nodes.
    """

    def __init__(self, source: CText, ast: Any) -> None:
        self.source, self.ast = source, ast
        self.blocks: list[Block] = []
        self.import_findings: list[ImportFinding] = []
        self.typedefs: dict[str, Any] = {}
        self.structs: dict[str, Any] = {}
        self.enums: dict[str, list[tuple[int, str]]] = {}
        self.values: dict[str, int] = {}  # of enumerators, which may size arrays

    def declaration(self, node: Any) -> None:
        """Take a declaration into account; a struct with members becomes a table."""
        if isinstance(node, self.ast.Typedef):
            self.typedefs[node.name] = node.type
        inner = (
            node.type.type
            if isinstance(getattr(node, "type", None), self.ast.TypeDecl)
            else getattr(node, "type", None)
        )
        name = getattr(node, "name", None) or getattr(inner, "name", None) or ""
        if isinstance(inner, self.ast.Enum) and inner.values is not None:
            self.enum(inner, name)
        elif isinstance(inner, self.ast.Struct) and inner.decls is not None:
            if inner.name:
                self.structs[inner.name] = inner
            self.struct(inner, name)

    def enum(self, node: Any, name: str) -> None:
        # C99 6.7.2.2: the first value is 0, and each further one is the value before it
        # plus 1, unless the source states it.
        value, members = -1, []
        for enumerator in node.values.enumerators:
            value = (
                self.number(enumerator.value)
                if enumerator.value is not None
                else value + 1
            )
            members.append((value, enumerator.name))
            self.values[enumerator.name] = value
        for key in filter(None, (name, node.name)):
            self.enums[key] = members
        rows = [["Value", "Name", "Comment"]]
        rows += [
            [str(v), n, self.source.beside(enumerator.coord.line)]
            for (v, n), enumerator in zip(members, node.values.enumerators, strict=True)
        ]
        self.add(f"enum {name}", node.coord.line, rows, [])

    def struct(self, node: Any, name: str) -> None:
        line = node.coord.line
        try:
            layout = self.layout(node)
        except Unreadable as error:
            self.import_findings.append(
                ImportFinding(
                    "IMP037",
                    f"struct `{name}`: {error.message}",
                    SourcePlace(line=line),
                    error.help,
                    "error",
                )
            )
            return
        if layout.padding:
            self.import_findings.append(
                ImportFinding(
                    "IMP038",
                    f"struct `{name}` is not packed: padding stands {', '.join(layout.padding)}",
                    SourcePlace(line=line),
                    "if it is sent as it lies in memory, this depends on the compiler; else mark it as packed",
                )
            )
        rows = [list(COLUMNS)]
        for member in layout.members:
            count, bit = (
                str(member.count) if member.count else "",
                ("" if member.bit is None else str(member.bit)),
            )
            comment = self.source.beside(member.line)
            rows.append(
                [
                    str(member.byte),
                    bit,
                    str(member.bits),
                    member.kind,
                    member.name,
                    count,
                    member.members,
                    comment,
                ]
            )
        self.add(name, line, rows, [f"sizeof {layout.size}"])

    def add(
        self, caption: str, line: int, rows: list[list[str]], texts: list[str]
    ) -> None:
        above = self.source.above(line)
        self.blocks += [Text(text, line=line) for text in (above, *texts) if text]
        self.blocks.append(
            SourceTable(
                caption=caption,
                rows=[SourceRow(list(map(Cell, row)), line=line) for row in rows],
            )
        )

    def layout(self, node: Any) -> Layout:
        """Return the layout of a struct.

        Raise `Unreadable` if it is not a sequence of bytes.
        """
        if node.decls is None:
            inner = self.structs.get(node.name)
            if inner is None:
                raise Unreadable(
                    f"struct `{node.name}` is not declared",
                    "add its declaration in front of this one",
                )
            node = inner
        layout = Layout()
        is_packed = node.coord.line in self.source.packed
        at = 0  # bits used so far
        for declaration in node.decls:
            if declaration.bitsize is not None:
                kind, size = self.scalar(declaration.type)
                width = self.number(declaration.bitsize)
                # A bit field of a struct that is not packed crosses no boundary of its
                # type (System V ABI, "Bit-Fields").
                # C99 6.7.2.1: a width of 0 ends the unit.
                crosses = at // size != (at + width - 1) // size if width else True
                if width == 0 or (crosses and not is_packed):
                    at = self.aligned(at, size, layout, declaration.name or "")
                # C99 6.7.2 leaves the sign of a bit field of type `int` to the
                # compiler; gcc and clang take a signed one.
                # Bit fields without a name do not align the struct (System V ABI).
                if declaration.name and width:
                    kind = "int" if kind == "int" else "uint"
                    layout.members.append(
                        Member(
                            at // 8,
                            width,
                            kind,
                            declaration.name,
                            at % 8,
                            line=declaration.coord.line,
                        )
                    )
                    layout.alignment = max(
                        layout.alignment, 1 if is_packed else size // 8
                    )
                at += width
                continue
            members, size, alignment = self.member(declaration)
            alignment = 1 if is_packed else alignment
            at = self.aligned(
                at, 8 * alignment, layout, declaration.name or "an inner struct"
            )
            layout.alignment = max(layout.alignment, alignment)
            for inner_member in members:
                inner_member.byte += at // 8
            layout.members += members
            at += 8 * size
        layout.size = self.aligned(at, 8 * layout.alignment, layout, "") // 8
        return layout

    def aligned(self, at: int, boundary: int, layout: Layout, name: str) -> int:
        """Return the next multiple of a number of bits.

        Skipped bytes are recorded as padding.
        """
        padding = -at % boundary
        if padding >= 8:
            where = f"in front of `{name}`" if name else "at the end"
            layout.padding.append(
                f"{where} ({padding // 8} byte{'s' if padding >= 16 else ''})"
            )
        return at + padding

    def member(self, declaration: Any) -> tuple[list[Member], int, int]:
        """Return the members of a declaration, and its size and alignment in bytes.

        Offsets count from the beginning of the declaration.
        """
        kind, counts = declaration.type, []
        while isinstance(kind, self.ast.ArrayDecl):
            if kind.dim is None:
                raise Unreadable(
                    f"`{declaration.name}` has no size",
                    "write its size, or describe it in the ICD by hand",
                )
            counts.append(self.number(kind.dim))
            kind = kind.type
        if isinstance(kind, self.ast.PtrDecl):
            raise Unreadable(
                f"`{declaration.name}` is a pointer",
                "a struct with pointers is no frame",
            )
        inner = self.resolved(kind)
        if isinstance(inner, (self.ast.Struct, self.ast.Union)):
            if isinstance(inner, self.ast.Union):
                raise Unreadable(
                    f"`{declaration.name or 'a member'}` is a union",
                    "take one of its members in a copy of the header",
                )
            layout = self.layout(inner)
            total = 1
            for count in counts:
                total *= count
            if total > MOST_ELEMENTS:
                raise Unreadable(
                    f"`{declaration.name}` has {total} elements",
                    f"arrays of structs may have {MOST_ELEMENTS}",
                )
            result = []
            for index in range(total):
                prefix = (
                    f"{declaration.name}[{index}]."
                    if counts
                    else f"{declaration.name}."
                    if declaration.name
                    else ""
                )
                for member in layout.members:
                    byte, name = member.byte + index * layout.size, prefix + member.name
                    line = declaration.coord.line
                    result.append(replace(member, byte=byte, name=name, line=line))
            return result, layout.size * total, layout.alignment
        name, size = self.scalar(kind)
        count = 1
        for n in counts:
            count *= n
        members = "; ".join(
            f"{value}: {label}" for value, label in self.members_of(kind)
        )
        shown = name if name in ("char", "bool", "enum") else f"{name}{size}"
        shown = f"uint{size}" if name in ("bool", "enum") else shown
        place = Member(
            0,
            size,
            shown,
            declaration.name,
            None,
            count if counts else 0,
            members,
            declaration.coord.line,
        )
        return [place], size // 8 * count, size // 8

    def resolved(self, kind: Any) -> Any:
        """Return the type after resolving typedefs."""
        inner = kind.type if isinstance(kind, self.ast.TypeDecl) else kind
        while (
            isinstance(inner, self.ast.IdentifierType)
            and len(inner.names) == 1
            and inner.names[0] in self.typedefs
        ):
            definition = self.typedefs[inner.names[0]]
            inner = (
                definition.type
                if isinstance(definition, self.ast.TypeDecl)
                else definition
            )
        return inner

    def scalar(self, kind: Any) -> tuple[str, int]:
        """Kind and size in bits of a number.

        Raises `Unreadable` for types whose size no standard states.
        """
        inner = self.resolved(kind)
        # As gcc and clang do without `-fshort-enums`; C99 6.7.2.2 leaves the type to
        # the compiler.
        if isinstance(inner, self.ast.Enum):
            return "enum", 32
        if not isinstance(inner, self.ast.IdentifierType):
            raise Unreadable(
                "a member is neither a number nor a struct",
                "describe it in the ICD by hand",
            )
        names = [_STANDARD.get(name, name) for name in inner.names]
        spelled = " ".join(names)
        words = [
            word
            for word in spelled.split()
            if word not in ("int", "signed", "unsigned")
        ]
        sign = (
            "unsigned "
            if "unsigned" in spelled.split()
            else "signed "
            if words == ["char"] and "signed" in spelled.split()
            else ""
        )
        key = (sign + " ".join(words or ["int"])).strip()
        if key not in _SIZES:
            raise Unreadable(
                f"the size of the type `{spelled}` depends on the compiler",
                "write one of fixed size, such as uint32_t",
            )
        return _SIZES[key]

    def members_of(self, kind: Any) -> Iterator[tuple[int, str]]:
        """Return the enumerators of an enumeration, by its tag or typedef."""
        inner = kind.type if isinstance(kind, self.ast.TypeDecl) else kind
        names = list(inner.names) if isinstance(inner, self.ast.IdentifierType) else []
        resolved = self.resolved(kind)
        if isinstance(resolved, self.ast.Enum):
            names.append(resolved.name)
        yield from next((self.enums[name] for name in names if name in self.enums), [])

    def number(self, node: Any) -> int:
        """Return the value of a constant expression. Raise `Unreadable`."""
        if isinstance(node, self.ast.Constant):
            if match := _INTEGER.fullmatch(node.value):
                return (
                    int(match["octal"], 8) if match["octal"] else int(match["other"], 0)
                )
        if isinstance(node, self.ast.ID) and node.name in self.values:
            return self.values[node.name]
        if isinstance(node, self.ast.UnaryOp) and node.op == "-":
            return -self.number(node.expr)
        if isinstance(node, self.ast.BinaryOp) and node.op in ("+", "-", "*", "<<"):
            left, right = self.number(node.left), self.number(node.right)
            # C99 6.5.7: a shift by less than 0, or by all bits or more, is undefined.
            if node.op == "<<" and not 0 <= right < 64:
                raise Unreadable(
                    f"a shift by {right}, which C leaves undefined",
                    "write it as a number",
                )
            return {
                "+": left + right,
                "-": left - right,
                "*": left * right,
                # A hostile shift must not exhaust the memory.
                "<<": left << min(right, 64),
            }[node.op]
        raise Unreadable(
            "a size or value is not a constant that can be computed",
            "write it as a number",
        )
