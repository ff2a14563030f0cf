"""The self-test's files: the golden vectors as rows of tables."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from pathlib import PurePosixPath
from typing import NamedTuple

from icdgen import codec
from icdgen.backends.c import names, physical
from icdgen.backends.c.text import literal, plain
from icdgen.backends.c.types import type_of
from icdgen.backends.lines import in_rows
from icdgen.backends.origin import origin
from icdgen.describe import FieldDescription, MessageDescription, NodeDescription, describe
from icdgen.describe.description import VariablePartDescription
from icdgen.describe.nodes import Direction
from icdgen.icd.model import Icd, Message
from icdgen.icd.places import NodePlace, raw_fields_in, scalars_in
from icdgen.render import Renderer
from icdgen.vectors.ids import test_ids
from icdgen.vectors.make import MessageVectors, Raw, Row, make
from icdgen.vectors.patterns import values
from icdgen.vectors.settings import NEVER, Settings, bits_of
from icdgen.vectors.shared import SharedRow

BYTES_IN_ROW, NUMBERS_IN_ROW = 16, 4
TYPES = {"bool": "BOOL", "bytes": "BYTES", "text": "BYTES"}


class Accessors(NamedTuple):
    """Getter and setter of a physical value, and rows of values for them."""

    get: str
    set: str
    type: str
    rows: list[str]


class FieldRow(NamedTuple):
    """A field, with what the table of a message's fields says of it."""

    field: FieldDescription
    stem: str
    tables: str  # of the names of its tables: elements of an array have the same
    element: str  # the index of an element of an array, and a comma
    size: int  # bytes of the member
    packed: int  # bytes in a vector
    type: str
    fresh: str
    view: str  # the type of its getter, where it is one
    unfit: list[str]
    whole: Accessors | None
    scaled: Accessors | None
    text: Accessors | None


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
        node, id_bits = self.node, describe(self.icd).id_bits
        return {
            "node": node.name,
            "enums": [names.stem(enum) for enum in node.enums],
            "names": list(self.names()),
            "messages": [self.message(*both) for both in zip(node.messages, self.vectors.messages, strict=True)],
            "dispatchers": [self.dispatcher(one, id_bits) for one in node.directions],
            "id_type": f"uint{id_bits}_t",
            "longest": max((one.model.length for one in node.all_messages), default=0),
            "constant": names.constant,
            "literal": literal,
            "plain": plain,
        }

    def names(self) -> Iterator[tuple[str, str, str]]:
        """Enumeration, value and its name."""
        for enum, (_, unknown) in zip(self.node.enums, self.vectors.enums, strict=True):
            stem = names.stem(enum)
            for one in enum.members:
                yield stem, _unsigned(one.model.value), literal(one.model.name)
            if unknown is not None:
                yield stem, _unsigned(unknown), "NULL"

    def dispatcher(self, direction: Direction, id_bits: int) -> tuple[str, list[str], bool, list[str]]:
        """Its name; some ids and the lengths of their messages, -1 where there is none; the frames of ids that are shared."""
        known = self.node.ids(direction.kind)
        lengths = {one.id: one.first.message.model for one in known if not one.is_shared}
        shared = {one.id for one in known if one.is_shared}
        asked = (id for id in test_ids((*lengths, *shared), id_bits) if id not in shared)
        rows = [_id(id, lengths.get(id)) for id in asked]
        frames = [_frame(row) for row in self.vectors.shared if row.direction == direction.kind]
        return f"{self.node.name}_{direction.kind}", rows, bool(shared), frames

    def message(self, message: MessageDescription, vectors: MessageVectors) -> dict[str, object]:
        """A message with its vectors: the reason for each, and its bytes, which are the frame, then the packed raw values."""
        kept = bytes(message.model.length)
        vectors = _plain(message, vectors)
        for row in vectors.rows:  # reserved bits are those that no vector keeps
            kept = bytes(a | b for a, b in zip(kept, row.encoded.ljust(len(kept), b"\0"), strict=True))
        tables: dict[tuple[int, ...], str] = {}
        fields = [self.field(field, vectors, tables) for field in _scalars(message)]
        doubles = (f"UINT64_C(0x{double})" for row in vectors.rows for double in row.doubles.values())
        differ = len(message.model.layout.lengths) > 1
        return {
            "message": message,
            "stem": names.stem(message),
            "vectors": [(plain(row.why), self.vector(row, fields)) for row in vectors.rows],
            "vector_size": message.model.length + sum(field.packed for field in fields),
            "kept": _bytes(kept),
            "doubles": in_rows(doubles, NUMBERS_IN_ROW),
            "texts": [f"{_text(text)}," for row in vectors.rows for text in row.texts.values()],
            "fields": fields,
            "lengths": in_rows((str(len(row.frame)) for row in vectors.rows), BYTES_IN_ROW) if differ else [],
            "refused_lengths": vectors.lengths,
            "tail": _tail(message, message.last_part, vectors) if message.last_part is not None else None,
        }

    def vector(self, row: Row, fields: list[FieldRow]) -> list[str]:
        data = bytearray(row.frame.ljust(fields[0].field.message.model.length if fields else 0, b"\0"))
        for field in fields:
            value = row.raw[field.field.model.name]
            bits = (1 << 8 * field.packed) - 1
            data += value if isinstance(value, bytes) else (value & bits).to_bytes(field.packed, "little")
        return _bytes(bytes(data))

    def field(self, one: FieldDescription, vectors: MessageVectors, known: dict[tuple[int, ...], str]) -> FieldRow:
        """``known``: of each line of the ICD the field that has its tables."""
        field, storage = one.model, one.storage
        is_bytes, index = field.is_bytes, field.index
        line = tuple(id(step.node) for step in field.steps)
        stem = f"{names.stem(one.message)}_selftest_{one.name}"
        tables = known.setdefault(line, stem)
        unfit = [v for v in vectors.unfit.get(field.name, ()) if not is_bytes and storage.min <= v <= storage.max]
        return FieldRow(
            field=one,
            stem=stem,
            tables=tables,
            element="" if index is None else f"{index}u, ",
            size=field.bits // 8 if is_bytes else storage.bits // 8,
            packed=(field.bits + 7) // 8,
            type=_type(field),
            fresh="0u" if is_bytes else _unsigned(_number(vectors.default[field.name])),
            view=type_of(one) if field.view else "",
            unfit=list(map(_unsigned, unfit)),
            whole=None if field.view else _whole(one),
            scaled=_scaled(one, vectors.settings.get(field.name)) if one.is_scaled else None,
            text=_texts(one, vectors.settings[field.name]) if one.is_text else None,
        )


def _type(field: NodePlace) -> str:
    if field.derived is not None:
        return "ICDGEN_SELFTEST_DERIVED"
    return f"ICDGEN_SELFTEST_{'SIGNED' if field.is_signed else TYPES.get(field.type, 'UNSIGNED')}"


def _id(id: int, message: Message | None) -> str:
    """An id, the longest and the shortest frame of its message, and what becomes of the latter where all is 0."""
    if message is None:
        return f"{{{id}u, -1, 0u, ICD_ERROR_UNKNOWN_ID}}"
    is_refused = any(part.low > 0 for part in message.layout.parts)  # zeros count less than there can be
    return f"{{{id}u, {message.length}, {message.layout.shortest}u, {'ICD_ERROR_LENGTH' if is_refused else 'ICD_OK'}}}"


def _frame(row: SharedRow) -> str:
    """A frame of an id that several messages have, and what becomes of it."""
    octets = f"(const uint8_t[]){{{', '.join(f'0x{byte:02X}' for byte in row.frame)}}}" if row.frame else "NULL"
    refused = "ICD_ERROR_UNKNOWN_ID" if row.expected is None else "ICD_ERROR_LENGTH"
    status, name = ("ICD_OK", literal(row.message)) if row.message is not None else (refused, "NULL")
    return f"{{{row.id}u, {len(row.frame)}u, {octets}, {status}, {name}}}"


def _plain(message: MessageDescription, vectors: MessageVectors) -> MessageVectors:
    """As C sees a message of which a field is not always there: its members are as in a new one then; other bits are 0."""
    if message.earlier_parts:  # bits that are no field's are not at one place in all frames
        return replace(vectors, rows=tuple(replace(row, frame=row.encoded) for row in vectors.rows))
    if not message.optional_members:
        return vectors
    absent: Raw = {field.model.name: field.model.initial_value for field in message.optional_members}
    scaled = [one.model for one in _scalars(message) if one.model.has_formula]
    rows = []
    for row in vectors.rows:
        raw = {field.name: (absent | row.raw)[field.name] for field in scalars_in(message.model.layout)}
        doubles = {one.name: bits_of(codec.physical_double(one, _number(raw[one.name])) or 0.0) for one in scaled}
        rows.append(replace(row, frame=row.encoded, raw=raw, doubles=doubles))
    always = {name: given for name, given in vectors.unfit.items() if name not in absent}
    fresh = {field.name: field.initial_value for field in raw_fields_in(message.model.layout)}
    return replace(vectors, rows=tuple(rows), default=vectors.default | fresh, unfit=always)


def _scalars(message: MessageDescription) -> Iterator[FieldDescription]:
    """All scalars of a message, overlay fields and derived values among them, in the order of the ICD."""
    return (scalar for member in message.declared_members for scalar in member.scalars)


def _tail(message: MessageDescription, tail: VariablePartDescription, vectors: MessageVectors) -> dict[str, object]:
    """What there is of a message whose frames differ in length."""
    return {
        "least": message.model.layout.shortest,
        "counter": next(place for place, one in enumerate(_scalars(message)) if one.model is tail.counter.model),
        "high": tail.model.high,
        "frames": _bytes(b"".join(frame.ljust(message.model.length, b"\0") for frame in vectors.miscounted)),
        "frame_lengths": list(map(len, vectors.miscounted)),
    }


def _accessors(field: FieldDescription, end: str, type: str, rows: list[str]) -> Accessors:
    stem = names.stem(field.declaration.message)
    return Accessors(f"{stem}_{end}", f"{stem}_set_{end}", type, rows)


def _texts(field: FieldDescription, settings: Settings) -> Accessors:
    """Setting texts: the bytes that each gives, or that it is refused. C has no text with characters of other bytes."""
    lines = []
    for text, raw in settings:
        assert not isinstance(raw, int)
        octets = "NULL" if raw is None else f"(const uint8_t[]){{{', '.join(map(hex, raw))}}}"
        lines.append(f"{{{_text(text)}, {octets}}},")
    return _accessors(field, field.physical_name, "char", lines)


def _text(text: str | None) -> str:
    return "NULL" if text is None else literal(text)


def _number(value: int | bytes) -> int:
    assert isinstance(value, int)
    return value


def _scaled(field: FieldDescription, settings: Settings | None) -> Accessors:
    """Setting doubles; of a view, which has no ``settings``, there is the getter alone."""
    lines: list[str] = []
    if settings is None:
        return _accessors(field, field.physical_name, "double", lines)
    never = () if field.model.type == "float" else NEVER
    for bits, raw in [*settings, *((bits, None) for bits in never)]:
        assert not isinstance(raw, bytes)
        lines.append(f"{{UINT64_C(0x{bits}), {_unsigned(raw or 0)}, {'true' if raw is None else 'false'}}},")
    return _accessors(field, field.physical_name, "double", lines)


def _whole(field: FieldDescription) -> Accessors | None:
    """The integer accessors, if the field has some, with their exact values."""
    whole = physical.scaled(field).integers if field.steps else None
    if whole is None or field.steps is None:
        return None
    lines = []
    for raw in values(field.model):
        assert isinstance(raw, int)
        exact = field.steps.physical(raw) * whole.scale.per
        assert exact.denominator == 1
        lines.append(f"{{{_unsigned(raw)}, {physical.int64(int(exact))}}},")
    return _accessors(field, field.integer_name(whole.scale.per), whole.type, lines)


def _unsigned(value: int) -> str:
    """The 64 bits of a raw value as a literal."""
    return f"{value}u" if 0 <= value < 1 << 16 else f"UINT64_C(0x{value & ((1 << 64) - 1):X})"


def _bytes(data: bytes) -> list[str]:
    return in_rows((f"0x{byte:02X}" for byte in data), BYTES_IN_ROW)
