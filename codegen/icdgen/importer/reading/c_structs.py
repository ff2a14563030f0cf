"""Structs and enumerations of C -> tables: of header files, and of `typedef struct` in
the text of documents.

A struct is a table with the columns `COLUMNS`, so that rules read it like any other:
its caption is the name of the struct, the texts before it are the comment above it and
`sizeof N`. Positions follow the System V ABI for little-endian machines, which gcc and
clang follow: bit fields from the least significant bit, members aligned to their size
unless the struct is packed.
"""

from __future__ import annotations

import operator
import re
from collections.abc import Callable
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

from icdgen.diagnostics import Finding, Findings, Place
from icdgen.errors import UserError
from icdgen.import_results.findings import ImportFinding, SourcePlace
from icdgen.importer.document import (
    Block,
    Document,
    Heading,
    SourceCell,
    SourceRow,
    SourceTable,
    TextBlock,
)
from icdgen.importer.reading.c_text import CText, Definition
from icdgen.importer.reading.utf8 import utf8_text

CODE = "IMP002"
COLUMNS = ("Byte", "Bit", "Bits", "Type", "Name", "Count", "Members", "Comment")
MOST_ELEMENTS = 64  # of an array of structs, each of which is a group of fields
MOST_MEMBERS = 4096  # of a struct, with those of inner structs
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
_OPERATIONS: dict[str, Callable[[int, int], int]] = {
    "+": operator.add, "-": operator.sub, "*": operator.mul, "<<": operator.lshift, ">>": operator.rshift,
    "|": operator.or_, "&": operator.and_, "^": operator.xor,
}  # fmt: skip
_PRELUDE = " ".join(f"typedef {base} {name};" for name, base in _STANDARD.items())


_UNION_HELP = "take one of its members in a copy of the header"


class Unreadable(Exception):
    """A struct that cannot be a table, with the reason and a remedy."""

    def __init__(self, message: str, help: str) -> None:
        super().__init__(message)
        self.message, self.help = message, help


@dataclass
class StructMember:
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
class StructLayout:
    """The members of a struct, its size and its alignment in bytes, and its padding."""

    members: list[StructMember] = field(default_factory=list)
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
    waiting: list[TextBlock] = []
    for block in document.blocks:
        blocks.append(block)
        begins = isinstance(block, TextBlock) and re.match(
            r"(?:typedef\s+)?(?:\w+\s+)?struct\b[^;]*$", block.text.strip()
        )
        if isinstance(block, TextBlock) and (waiting or begins):
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
    reader = _DeclarationReader(source, c_ast)
    reader.take_definitions(tree)
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


class _DeclarationReader:
    """Makes tables of the declarations of a file; ``ast`` is pycparser's module of
    nodes.
    """

    def __init__(self, source: CText, ast: Any) -> None:
        self.source, self.ast = source, ast
        self.blocks: list[Block] = []
        self.import_findings: list[ImportFinding] = []
        self.typedefs: dict[str, Any] = {}
        self.structs: dict[str, Any] = {}
        self.enums: dict[str, Any] = {}
        self.enumerators: dict[int, list[tuple[int, str]] | Unreadable] = {}
        self.taken: set[int] = set()  # the `id` of nodes that are tables
        self.values: dict[str, int] = {}  # of enumerators, which may size arrays
        self.definitions: dict[int, Definition] = {}  # by the `id` of their nodes
        self.opened: list[Any] = []  # the structs whose layout is being computed

    def take_definitions(self, tree: Any) -> None:
        """Note the packing of each struct and enumeration, and the enumerators.

        Raise `Unreadable`.
        """
        nodes: list[Any] = []
        waiting, seen = [tree], set()
        while waiting:
            node = waiting.pop()
            waiting += [child for _, child in reversed(node.children())]
            has_body = (
                node.values is not None
                if isinstance(node, self.ast.Enum)
                else isinstance(node, (self.ast.Struct, self.ast.Union))
                and node.decls is not None
            )
            # Several declarators share the node of their struct.
            if has_body and id(node) not in seen:
                nodes.append(node)
                seen.add(id(node))
        if len(nodes) != len(self.source.definitions):
            raise Unreadable(
                "structs and enumerations within expressions cannot be read",
                "keep only the declarations in a copy of the header",
            )
        for node, definition in zip(nodes, self.source.definitions, strict=True):
            self.definitions[id(node)] = definition
            if isinstance(node, self.ast.Enum):
                self.enumerators[id(node)] = self.computed_enumerators(node)
                self.enums[node.name] = node
            elif isinstance(node, self.ast.Struct):
                self.structs[node.name] = node

    def declaration(self, node: Any) -> None:
        """Take a declaration into account; a struct with members becomes a table."""
        if isinstance(node, self.ast.Typedef):
            self.typedefs[node.name] = node.type
        inner: Any = getattr(node, "type", None)
        if isinstance(inner, self.ast.TypeDecl):
            inner = inner.type
        while isinstance(inner, (self.ast.ArrayDecl, self.ast.PtrDecl)):
            # In `struct a {...} b, *c`, the struct is that of `b`.
            inner = inner.type
            if isinstance(inner, self.ast.TypeDecl):
                inner = None if id(inner.type) in self.taken else inner.type
        if id(inner) not in self.definitions:
            return
        self.taken.add(id(inner))
        name = getattr(node, "name", None) or inner.name or ""
        kind = type(inner).__name__.lower()
        try:
            if isinstance(inner, self.ast.Enum):
                self.enum(inner, name)
            elif isinstance(inner, self.ast.Struct):
                self.struct(inner, name)
            else:
                raise Unreadable("it is a union", _UNION_HELP)
        except Unreadable as error:
            self.import_findings.append(
                ImportFinding(
                    "IMP037",
                    f"{kind} `{name}`: {error.message}",
                    SourcePlace(line=inner.coord.line),
                    error.help,
                    "error",
                )
            )

    def computed_enumerators(self, node: Any) -> list[tuple[int, str]] | Unreadable:
        """Return the values and names of an enumeration, or why they are unknown."""
        # C99 6.7.2.2: the first value is 0, and each further one is the value before it
        # plus 1, unless the source states it.
        value, members = -1, []
        try:
            self.check_conditions(node)
            for enumerator in node.values.enumerators:
                value = (
                    self.number(enumerator.value)
                    if enumerator.value is not None
                    else value + 1
                )
                members.append((value, enumerator.name))
                self.values[enumerator.name] = value
        except Unreadable as error:
            return error
        return members

    def check_conditions(self, node: Any) -> None:
        """Raise `Unreadable` if the preprocessor decides about parts of a definition."""
        if self.definitions[id(node)].is_conditional:
            raise Unreadable(
                "the preprocessor decides about its members",
                "in a copy of the header, keep the members of one variant only",
            )

    def enum_node(self, node: Any) -> Any:
        """Return the definition of an enumeration. Raise `Unreadable`."""
        if node.values is not None:
            return node
        if node.name not in self.enums:
            raise Unreadable(
                f"enum `{node.name}` is not declared",
                "add its declaration in front of this one",
            )
        return self.enums[node.name]

    def enumerators_of(self, node: Any) -> list[tuple[int, str]]:
        """Return the values and names of an enumeration. Raise `Unreadable`."""
        members = self.enumerators[id(self.enum_node(node))]
        if isinstance(members, Unreadable):
            raise members
        return members

    def enum(self, node: Any, name: str) -> None:
        members = self.enumerators_of(node)
        rows = [["Value", "Name", "Comment"]]
        rows += [
            [str(v), n, self.source.beside(enumerator.coord.line, node.coord.line)]
            for (v, n), enumerator in zip(members, node.values.enumerators, strict=True)
        ]
        self.add(f"enum {name}", node.coord.line, rows, [])

    def struct(self, node: Any, name: str) -> None:
        line = node.coord.line
        layout = self.layout(node)
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
            comment = self.source.beside(member.line, line)
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
        self.blocks += [TextBlock(text, line=line) for text in (above, *texts) if text]
        self.blocks.append(
            SourceTable(
                caption=caption,
                rows=[SourceRow(list(map(SourceCell, row)), line=line) for row in rows],
            )
        )

    def layout(self, node: Any) -> StructLayout:
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
        if any(node is other for other in self.opened):
            raise Unreadable(
                f"struct `{node.name}` contains itself", "a frame cannot do this"
            )
        self.check_conditions(node)
        definition = self.definitions[id(node)]
        if definition.has_packed_member:
            raise Unreadable(
                "one of its members has the attribute `packed`",
                "pack the struct and write its padding as members",
            )
        self.opened.append(node)
        try:
            return self.computed_layout(node, definition)
        finally:
            self.opened.pop()

    def computed_layout(self, node: Any, definition: Definition) -> StructLayout:
        layout = StructLayout()
        # Bytes to which members are aligned at most.
        most = 1 if definition.is_packed else definition.most
        at = 0  # bits used so far
        for declaration in node.decls or ():
            # `_Static_assert` and `_Pragma` are no members.
            if not isinstance(declaration, self.ast.Decl):
                continue
            if declaration.align:
                raise Unreadable(
                    f"`{declaration.name}` has an alignment of its own",
                    "write the padding as a member, and pack the struct",
                )
            if declaration.bitsize is not None:
                member, size = self.bit_field(declaration)
                # A bit field of a struct without packing crosses no boundary of its
                # type (System V ABI, "Bit-Fields").
                # C99 6.7.2.1: a width of 0 ends the unit.
                if member.bits == 0 or (
                    most is None and at // size != (at + member.bits - 1) // size
                ):
                    at = self.aligned(at, size, layout, member.name)
                # Bit fields without a name do not align the struct (System V ABI).
                if member.name:
                    member.byte, member.bit = at // 8, at % 8
                    layout.members.append(member)
                    # gcc and clang heed the pragma for it even in a packed struct.
                    limit = definition.most or most or size // 8
                    layout.alignment = max(layout.alignment, min(size // 8, limit))
                at += member.bits
                continue
            members, size, alignment = self.member(declaration)
            alignment = min(alignment, most or alignment)
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

    def bit_field(self, declaration: Any) -> tuple[StructMember, int]:
        """Return a bit field at bit 0, and the size of its type in bits."""
        name = declaration.name or ""
        kind, size = self.scalar(declaration.type)
        width = self.number(declaration.bitsize)
        # C99 6.7.2.1: only an unnamed bit field may have 0 bits.
        least, most = 1 if name else 0, 1 if kind == "bool" else size
        if kind == "float" or not least <= width <= most:
            raise Unreadable(
                f"the bit field `{name}` has {width} bits, which its type does not allow",
                "correct the width, or the type",
            )
        # C99 6.7.2 leaves the sign of a bit field of type `int` to the compiler; gcc
        # and clang take a signed one. That of `char` depends on the processor.
        if kind == "char":
            raise Unreadable(
                f"the sign of `{name}` depends on the compiler",
                "write `int8_t` or `uint8_t`",
            )
        kind = "int" if kind == "int" else "uint"
        members = self.members_of(declaration.type)
        line = declaration.coord.line if declaration.coord is not None else None
        return StructMember(0, width, kind, name, 0, 0, members, line), size

    def aligned(self, at: int, boundary: int, layout: StructLayout, name: str) -> int:
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

    def member(self, declaration: Any) -> tuple[list[StructMember], int, int]:
        """Return the members of a declaration, and its size and alignment in bytes.

        Offsets count from the beginning of the declaration.
        """
        kind, counts = declaration.type, []
        while isinstance(array := self.resolved(kind), self.ast.ArrayDecl):
            if array.dim is None:
                raise Unreadable(
                    f"`{declaration.name}` has no size",
                    "write its size, or describe it in the ICD by hand",
                )
            counts.append(self.number(array.dim))
            # 0 elements are a flexible array of GNU C.
            if counts[-1] < 1:
                raise Unreadable(
                    f"`{declaration.name}` has {counts[-1]} elements",
                    "write its size, or describe it in the ICD by hand",
                )
            kind = array.type
        if isinstance(self.resolved(kind), self.ast.PtrDecl):
            raise Unreadable(
                f"`{declaration.name}` is a pointer",
                "a struct with pointers is no frame",
            )
        inner = self.resolved(kind)
        if isinstance(inner, (self.ast.Struct, self.ast.Union)):
            if isinstance(inner, self.ast.Union):
                raise Unreadable(
                    f"`{declaration.name or 'a member'}` is a union",
                    _UNION_HELP,
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
            if total * len(layout.members) > MOST_MEMBERS:
                raise Unreadable(
                    f"`{declaration.name}` has {total * len(layout.members)} members",
                    f"a struct may have {MOST_MEMBERS}",
                )
            result = []
            for index in range(total):
                prefix = f"{declaration.name}." if declaration.name else ""
                if counts:
                    prefix = f"{declaration.name}[{index}]."
                for member in layout.members:
                    byte, name = member.byte + index * layout.size, prefix + member.name
                    line = declaration.coord.line
                    result.append(replace(member, byte=byte, name=name, line=line))
            return result, layout.size * total, layout.alignment
        name, size = self.scalar(kind)
        count = 1
        for n in counts:
            count *= n
        shown = {"char": "char", "bool": f"uint{size}"}.get(name, f"{name}{size}")
        place = StructMember(
            0,
            size,
            shown,
            declaration.name,
            None,
            count if counts else 0,
            self.members_of(kind),
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
        if isinstance(inner, self.ast.Enum):
            return self.enum_type(inner)
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
        sign = ""
        if "unsigned" in spelled.split():
            sign = "unsigned "
        elif words == ["char"] and "signed" in spelled.split():
            sign = "signed "
        key = (sign + " ".join(words or ["int"])).strip()
        if key not in _SIZES:
            raise Unreadable(
                f"the size of the type `{spelled}` depends on the compiler",
                "write one of fixed size, such as uint32_t",
            )
        return _SIZES[key]

    def enum_type(self, node: Any) -> tuple[str, int]:
        """Return kind and size in bits of an enumeration."""
        values = [value for value, _ in self.enumerators_of(node)]
        low, high = min(values), max(values)
        # As gcc and clang do without `-fshort-enums`; C99 6.7.2.2 leaves the type to
        # the compiler.
        sizes = (
            (8, 16, 32, 64)
            if self.definitions[id(self.enum_node(node))].is_packed
            else (32, 64)
        )
        for size in sizes:
            half = 1 << (size - 1)
            if low < 0 and -half <= low and high < half:
                return "int", size
            if low >= 0 and high < 2 * half:
                return "uint", size
        raise Unreadable(
            f"enum `{node.name or ''}` has values of more than 64 bits",
            "correct its values",
        )

    def members_of(self, kind: Any) -> str:
        """Return the enumerators of the type; empty if it is no enumeration."""
        node = self.resolved(kind)
        if not isinstance(node, self.ast.Enum):
            return ""
        members = self.enumerators_of(node)
        return "; ".join(f"{value}: {label}" for value, label in members)

    def number(self, node: Any) -> int:
        """Return the value of a constant expression. Raise `Unreadable`."""
        # More digits are no number of C, and would take long.
        if isinstance(node, self.ast.Constant) and len(node.value) < 70:
            if match := _INTEGER.fullmatch(node.value):
                return (
                    int(match["octal"], 8) if match["octal"] else int(match["other"], 0)
                )
        if isinstance(node, self.ast.ID) and node.name in self.values:
            return self.values[node.name]
        if isinstance(node, self.ast.UnaryOp) and node.op == "-":
            return -self.number(node.expr)
        if isinstance(node, self.ast.BinaryOp) and node.op in _OPERATIONS:
            left, right = self.number(node.left), self.number(node.right)
            # C99 6.5.7: a shift by less than 0, or by all bits or more, is undefined.
            if node.op in ("<<", ">>") and not 0 <= right < 64:
                raise Unreadable(
                    f"a shift by {right}, which C leaves undefined",
                    "write it as a number",
                )
            result = _OPERATIONS[node.op](left, right)
            # A hostile product must not exhaust the memory.
            if abs(result) < 1 << 64:
                return result
        raise Unreadable(
            "a size or value is not a constant that can be computed",
            "write it as a number",
        )
