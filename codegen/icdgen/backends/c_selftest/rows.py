"""The self-test's files: the golden vectors as rows of tables."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from pathlib import PurePosixPath
from typing import NamedTuple

from icdgen.backends.c import names, physical
from icdgen.backends.c.accessors import whole_name
from icdgen.backends.c.text import literal, plain
from icdgen.backends.origin import origin
from icdgen.describe import FieldDescription, MessageDescription, NodeDescription, describe
from icdgen.icd.model import Icd
from icdgen.render import Renderer
from icdgen.vectors import MessageVectors, Row, make
from icdgen.vectors.ids import worth_asking
from icdgen.vectors.patterns import values
from icdgen.vectors.settings import NEVER

WIDTH = 116
TYPES = {"bool": "BOOL", "bytes": "BYTES", "int": "SIGNED"}


class Accessors(NamedTuple):
    """Getter and setter of a physical value, and rows of values for them."""

    get: str
    set: str
    type: str
    rows: list[str]


class FieldRow(NamedTuple):
    """An entry of a message's table of fields."""

    text: str
    stem: str
    member: str
    size: int
    packed: int
    type: str
    fresh: str
    unfit: str
    unfit_count: int
    whole: Accessors | None
    scaled: Accessors | None


class VectorRow(NamedTuple):
    """The bytes of one vector: the frame, then the packed raw values."""

    why: str
    lines: list[str]


class Constant(NamedTuple):
    """A macro and the value that it must have."""

    name: str
    value: str


class MessageRow(NamedTuple):
    """A message with its vectors."""

    title: str
    text: str
    stem: str
    member: str
    length: int
    vectors: list[VectorRow]
    vector_count: int
    vector_size: int
    kept: list[str]
    doubles: list[str]
    fields: list[FieldRow]
    refused_lengths: str
    refused_length_count: int
    constants: list[Constant]


class Name(NamedTuple):
    """A value of an enumeration and its name."""

    enum: str
    value: str
    text: str


class Dispatcher(NamedTuple):
    """A dispatcher and the length of the message under some ids, -1 where there is none."""

    name: str
    id_type: str
    lengths: list[str]
    id_count: int


class EnumRow(NamedTuple):
    """An enumeration."""

    name: str


def files(icd: Icd, render: Renderer) -> Iterator[tuple[PurePosixPath, str]]:
    """The engine, the list of nodes, and one file of vectors a node."""
    for name in render.runtime_files():
        yield PurePosixPath(name), f"/* {origin()} */\n{render.source(name)}"
    nodes = [node.name for node in icd.nodes]
    yield PurePosixPath("icdgen_selftest_nodes.c"), render("nodes.c.j2", origin=origin(), nodes=nodes)
    for node in describe(icd).nodes:
        text = render("node.c.j2", origin=origin(node.model, with_digest=True), **_Rows(icd, node).all())
        yield PurePosixPath(f"nodes/{node.name}.c"), text


class _Rows:
    """The finished values of one node's file."""

    def __init__(self, icd: Icd, node: NodeDescription) -> None:
        self.icd, self.node = icd, node
        self.vectors = make(icd, node.model)

    def all(self) -> dict[str, object]:
        node = self.node
        directions = (("telecommand", node.telecommands), ("telemetry", node.telemetry))
        return {
            "node": node.name,
            "header": f"{node.name}.h",
            "enums": [EnumRow(names.stem(enum)) for enum in node.enums],
            "names": list(self.names()),
            "messages": [self.message(*both) for both in zip(node.messages, self.vectors.messages, strict=True)],
            "dispatchers": [self.dispatcher(way, messages) for way, messages in directions if messages],
            "longest": max((one.model.length for one in node.spoken), default=0),
        }

    def names(self) -> Iterator[Name]:
        for enum, (_, unknown) in zip(self.node.enums, self.vectors.enums, strict=True):
            stem = names.stem(enum)
            for one in enum.members:
                yield Name(stem, _unsigned(one.model.value), literal(one.model.name))
            if unknown is not None:
                yield Name(stem, _unsigned(unknown), "NULL")

    def dispatcher(self, direction: str, messages: Iterable[MessageDescription]) -> Dispatcher:
        lengths = {getattr(one.model, f"{direction}_id"): one.model.length for one in messages}
        bits = describe(self.icd).id_bits
        rows = [f"{{{id}u, {lengths.get(id, -1)}}}" for id in worth_asking(lengths, bits)]
        return Dispatcher(f"{self.node.name}_{direction}", f"uint{bits}_t", _lines(rows), len(rows))

    def message(self, message: MessageDescription, vectors: MessageVectors) -> MessageRow:
        length = message.model.length
        kept = bytes(length)
        for row in vectors.rows:  # reserved bits are those that no vector keeps
            kept = bytes(a | b for a, b in zip(kept, row.encoded, strict=True))
        fields = [self.field(field, vectors) for field in message.fields]
        vector_rows = [self.vector(message, row, fields) for row in vectors.rows]
        size = length + sum(field.packed for field in fields)
        return MessageRow(
            title=plain(message.model.name),
            text=literal(message.model.name),
            stem=names.stem(message),
            member=message.name if message.name != "bytes" else "bytes_",
            length=length,
            vectors=vector_rows if size else [],
            vector_count=len(vector_rows),
            vector_size=size,
            kept=_lines(f"0x{byte:02X}" for byte in kept),
            doubles=_lines(f"UINT64_C(0x{double})" for row in vectors.rows for double in row.doubles.values()),
            fields=fields,
            refused_lengths=", ".join(map(str, vectors.lengths)),
            refused_length_count=len(vectors.lengths),
            constants=[
                *(Constant(names.constant(message, id.name), f"{id.value}u") for id in message.ids),
                Constant(names.constant(message, "length"), f"{length}u"),
            ],
        )

    def vector(self, message: MessageDescription, row: Row, fields: list[FieldRow]) -> VectorRow:
        data = bytearray(row.frame)
        for one, field in zip(message.fields, fields, strict=True):
            value = row.raw[one.model.name]
            if isinstance(value, bytes):
                data += value
            else:
                data += (value & ((1 << 8 * field.packed) - 1)).to_bytes(field.packed, "little")
        return VectorRow(plain(row.why), _lines(f"0x{byte:02X}" for byte in data))

    def field(self, one: FieldDescription, vectors: MessageVectors) -> FieldRow:
        field, storage = one.model, one.storage
        is_bytes = field.type == "bytes"
        unfit = [v for v in vectors.unfit.get(field.name, ()) if not is_bytes and storage.min <= v <= storage.max]
        return FieldRow(
            text=literal(field.name),
            stem=f"{names.stem(one.message)}_selftest_{one.name}",
            member=one.name,
            size=field.bits // 8 if is_bytes else storage.bits // 8,
            packed=(field.bits + 7) // 8,
            type=f"ICDGEN_SELFTEST_{TYPES.get(field.type, 'UNSIGNED')}",
            fresh=_unsigned(one.fresh),
            unfit=", ".join(map(_unsigned, unfit)),
            unfit_count=len(unfit),
            whole=_whole(one),
            scaled=_scaled(one, vectors.settings[field.name]) if field.scale else None,
        )


def _accessors(field: FieldDescription, end: str, type: str, rows: list[str]) -> Accessors:
    stem = names.stem(field.message)
    return Accessors(f"{stem}_{end}", f"{stem}_set_{end}", type, rows)


def _scaled(field: FieldDescription, settings: Iterable[tuple[str, int | None]]) -> Accessors:
    lines = [
        f"{{UINT64_C(0x{bits}), {_unsigned(raw or 0)}, {'true' if raw is None else 'false'}}},"
        for bits, raw in [*settings, *((bits, None) for bits in NEVER)]
    ]
    return _accessors(field, field.physical_name, "double", lines)


def _whole(field: FieldDescription) -> Accessors | None:
    """The integer accessors, if the field has some, with their exact values."""
    whole = physical.scaled(field).whole if field.steps else None
    if whole is None or field.steps is None:
        return None
    per = {"milli": 1000, "micro": 1_000_000}[whole.prefix]
    lines = []
    for raw in values(field.model):
        assert isinstance(raw, int)
        exact = field.steps.physical(raw) * per
        assert exact.denominator == 1
        lines.append(f"{{{_unsigned(raw)}, {physical.int64(int(exact))}}},")
    return _accessors(field, whole_name(field, whole), whole.type, lines)


def _unsigned(value: int) -> str:
    """The 64 bits of a raw value as a literal."""
    return f"{value}u" if 0 <= value < 1 << 16 else f"UINT64_C(0x{value & ((1 << 64) - 1):X})"


def _lines(items: Iterable[str]) -> list[str]:
    """The items separated by commas, as many on a line as fit."""
    lines, line = [], ""
    for item in items:
        if line and len(line) + len(item) + 2 > WIDTH:
            lines.append(line)
            line = ""
        line += f" {item}," if line else f"{item},"
    return [*lines, line] if line else lines
