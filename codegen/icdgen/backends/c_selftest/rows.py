"""Files of the C self-test: golden vectors as table rows.

Input are the vectors of `icdgen.vectors`; output are C files with tables of frames,
expected values and refused values. The engine in ``runtime/c-selftest`` runs through
them on a target board.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from pathlib import PurePosixPath

from icdgen import codec
from icdgen.backends.c import names, physical
from icdgen.backends.c.text import literal, plain
from icdgen.backends.c.types import type_of
from icdgen.backends.lines import in_rows
from icdgen.backends.origin import origin
from icdgen.describe import (
    FieldDescription,
    MessageDescription,
    NodeDescription,
    describe,
)
from icdgen.describe.accessors import Accessor, accessors_of
from icdgen.describe.description import VariablePartDescription
from icdgen.describe.nodes import DirectionMessages
from icdgen.frozen import NamedTuple
from icdgen.icd.model import Icd, Message
from icdgen.icd.places import NodePlace, raw_fields_in, scalars_in
from icdgen.render import Renderer
from icdgen.vectors.ids import test_ids
from icdgen.vectors.make import FrameVector, MessageVectors, RawValues, make_vectors
from icdgen.vectors.patterns import values
from icdgen.vectors.settings import NEVER, Assignments, bits_of
from icdgen.vectors.shared import SharedRow

BYTES_IN_ROW, NUMBERS_IN_ROW = 16, 4
TYPES = {"bool": "BOOL", "bytes": "BYTES", "text": "BYTES"}


class AccessorRows(NamedTuple):
    """Getter and setter of a physical value, with rows of test values."""

    get: str
    set: str
    type: str
    rows: list[str]


class SelftestField(NamedTuple):
    """Field with its entries in the table of a message's fields."""

    field: FieldDescription
    stem: str
    tables: str  # stem of its tables, which the elements of an array share
    element: str  # index of an array element with a comma
    size: int  # size of the member in bytes
    packed: int  # size in a vector in bytes
    type: str
    fresh: str
    view: str  # type of the getter of an overlay
    unfit: list[str]
    integer: AccessorRows | None
    scaled: AccessorRows | None
    text: AccessorRows | None


def files(icd: Icd, render: Renderer) -> Iterator[tuple[PurePosixPath, str]]:
    """Yield the engine, the list of nodes, and one file of vectors per node."""
    for name in render.runtime_files():
        yield PurePosixPath(name), f"/* {origin()} */\n{render.source(name)}"
    nodes = [node.name for node in icd.nodes]
    yield (
        PurePosixPath("icdgen_selftest_nodes.c"),
        render("nodes.c.j2", origin=origin(), nodes=nodes),
    )
    for node in describe(icd).nodes:
        text = render(
            "node.c.j2",
            origin=origin(node.model, with_digest=True),
            **_SelftestFile(icd, node).template_values(),
        )
        yield PurePosixPath(f"nodes/{node.name}.c"), text


class _SelftestFile:
    """Template values of the file of one node."""

    def __init__(self, icd: Icd, node: NodeDescription) -> None:
        self.icd, self.node = icd, node
        self.vectors = make_vectors(icd, node.model)

    def template_values(self) -> dict[str, object]:
        node, id_bits = self.node, describe(self.icd).id_bits
        return {
            "node": node.name,
            "enums": [names.stem(enum) for enum in node.enums],
            "names": list(self.enum_names()),
            "messages": [
                self.message_values(*message_and_vectors)
                for message_and_vectors in zip(
                    node.messages, self.vectors.messages, strict=True
                )
            ],
            "dispatchers": [
                self.dispatcher(direction, id_bits) for direction in node.directions
            ],
            "id_type": f"uint{id_bits}_t",
            "longest": max(
                (message.model.length for message in node.all_messages), default=0
            ),
            "constant": names.constant,
            "literal": literal,
            "plain": plain,
        }

    def enum_names(self) -> Iterator[tuple[str, str, str]]:
        """Yield enumeration, value and name."""
        for enum, (_, unknown) in zip(self.node.enums, self.vectors.enums, strict=True):
            stem = names.stem(enum)
            for member in enum.members:
                yield (
                    stem,
                    _unsigned_literal(member.model.value),
                    literal(member.model.name),
                )
            if unknown is not None:
                yield stem, _unsigned_literal(unknown), "NULL"

    def dispatcher(
        self, direction: DirectionMessages, id_bits: int
    ) -> tuple[str, list[str], bool, list[str]]:
        """Return the name of a dispatcher, rows of ids with message lengths (-1 for
        unknown ids), whether ids are shared, and frames of shared ids.
        """
        ids = self.node.ids(direction.kind)
        lengths = {
            entry.id: entry.first.message.model for entry in ids if not entry.is_shared
        }
        shared = {entry.id for entry in ids if entry.is_shared}
        unshared_ids = (
            id for id in test_ids((*lengths, *shared), id_bits) if id not in shared
        )
        rows = [_id_row(id, lengths.get(id)) for id in unshared_ids]
        frames = [
            _frame_row(row)
            for row in self.vectors.shared
            if row.direction == direction.kind
        ]
        return f"{self.node.name}_{direction.kind}", rows, bool(shared), frames

    def message_values(
        self, message: MessageDescription, vectors: MessageVectors
    ) -> dict[str, object]:
        """Return a message with its vectors.

        Each has a reason and bytes: the frame, then the packed raw values.
        """
        vectors = _vectors_in_c(message, vectors)
        used_bits = 0  # a bit that no encoded frame sets is reserved
        for row in vectors.rows:
            used_bits |= int.from_bytes(row.encoded, "little")
        tables: dict[tuple[int, ...], str] = {}
        fields = [
            self.selftest_field(field, vectors, tables) for field in _scalars(message)
        ]
        doubles = (
            f"UINT64_C(0x{double})"
            for row in vectors.rows
            for double in row.doubles.values()
        )
        differ = len(message.model.layout.lengths) > 1
        return {
            "message": message,
            "stem": names.stem(message),
            "vectors": [
                (plain(row.why), self.vector_rows(row, fields)) for row in vectors.rows
            ],
            "vector_size": message.model.length + sum(field.packed for field in fields),
            "kept": _byte_rows(used_bits.to_bytes(message.model.length, "little")),
            "doubles": in_rows(doubles, NUMBERS_IN_ROW),
            "texts": [
                f"{_text_literal(text)},"
                for row in vectors.rows
                for text in row.texts.values()
            ],
            "fields": fields,
            "lengths": (
                in_rows((str(len(row.frame)) for row in vectors.rows), BYTES_IN_ROW)
                if differ
                else []
            ),
            "refused_lengths": vectors.refused_lengths,
            "tail": (
                _variable_part_values(message, message.last_part, vectors)
                if message.last_part is not None
                else None
            ),
        }

    def vector_rows(self, row: FrameVector, fields: list[SelftestField]) -> list[str]:
        data = bytearray(
            row.frame.ljust(
                fields[0].field.message.model.length if fields else 0, b"\0"
            )
        )
        for field in fields:
            value = row.raw[field.field.model.name]
            # Negative values are packed in two's complement.
            bits = (1 << 8 * field.packed) - 1
            data += (
                value
                if isinstance(value, bytes)
                else (value & bits).to_bytes(field.packed, "little")
            )
        return _byte_rows(bytes(data))

    def selftest_field(
        self,
        description: FieldDescription,
        vectors: MessageVectors,
        tables_by_line: dict[tuple[int, ...], str],
    ) -> SelftestField:
        """Return the row of a field.

        ``tables_by_line``: stem of the tables for each line of the ICD.
        """
        field, storage = description.model, description.storage
        is_bytes, index = field.is_bytes, field.index
        line = tuple(id(step.node) for step in field.steps)
        stem = f"{names.stem(description.message)}_selftest_{description.name}"
        # Elements of an array have equal tables, which would multiply the code size.
        tables = tables_by_line.setdefault(line, stem)
        unfit = [
            v
            for v in vectors.refused_raws.get(field.name, ())
            if not is_bytes and storage.min <= v <= storage.max
        ]
        assignments = vectors.assignments.get(field.name)
        accessors = {
            accessor.kind: _accessor_rows(accessor, assignments)
            for accessor in accessors_of(description, "text", "double", "integer")
            if accessor.kind != "integer" or accessor.is_settable
        }
        return SelftestField(
            field=description,
            stem=stem,
            tables=tables,
            element="" if index is None else f"{index}u, ",
            size=field.bits // 8 if is_bytes else storage.bits // 8,
            packed=(field.bits + 7) // 8,
            type=_type_enumerator(field),
            fresh="0u"
            if is_bytes
            else _unsigned_literal(_integer_of(vectors.default[field.name])),
            view=type_of(description) if field.is_read_only else "",
            unfit=list(map(_unsigned_literal, unfit)),
            integer=accessors.get("integer"),
            scaled=accessors.get("double"),
            text=accessors.get("text"),
        )


def _type_enumerator(field: NodePlace) -> str:
    if field.derived is not None:
        return "ICDGEN_SELFTEST_DERIVED"
    return f"ICDGEN_SELFTEST_{'SIGNED' if field.is_signed else TYPES.get(field.type, 'UNSIGNED')}"


def _id_row(id: int, message: Message | None) -> str:
    """Return the row of an id: longest and shortest frame of its message, and the
    status of the shortest frame with zeros.
    """
    if message is None:
        return f"{{{id}u, -1, 0u, ICD_ERROR_UNKNOWN_ID}}"
    # Counters of 0 are below the minimum
    is_refused = any(part.low > 0 for part in message.layout.counted_parts)
    return f"{{{id}u, {message.length}, {message.layout.shortest}u, {'ICD_ERROR_LENGTH' if is_refused else 'ICD_OK'}}}"


def _frame_row(row: SharedRow) -> str:
    """Return the row of a frame with a shared id, and its expected status."""
    octets = (
        f"(const uint8_t[]){{{', '.join(f'0x{byte:02X}' for byte in row.frame)}}}"
        if row.frame
        else "NULL"
    )
    # A frame of no message has an unknown id for C, or a wrong length.
    refused = "ICD_ERROR_UNKNOWN_ID" if row.expected is None else "ICD_ERROR_LENGTH"
    status, name = (
        ("ICD_OK", literal(row.message))
        if row.message is not None
        else (refused, "NULL")
    )
    return f"{{{row.id}u, {len(row.frame)}u, {octets}, {status}, {name}}}"


def _vectors_in_c(
    message: MessageDescription, vectors: MessageVectors
) -> MessageVectors:
    """Return the vectors as C represents optional fields: absent members have initial
    values, and other bits are 0.
    """
    if message.has_inner_gaps:  # the position of reserved bits varies between frames
        return replace(
            vectors, rows=tuple(replace(row, frame=row.encoded) for row in vectors.rows)
        )
    if not message.optional_members:
        return vectors
    absent: RawValues = {
        field.model.name: field.model.initial_value
        for field in message.optional_members
    }
    scaled = [scalar.model for scalar in _scalars(message) if scalar.model.has_formula]
    rows = []
    for row in vectors.rows:
        raw = {
            field.name: (absent | row.raw)[field.name]
            for field in scalars_in(message.model.layout)
        }
        doubles = {
            field.name: bits_of(
                codec.physical_double(field, _integer_of(raw[field.name])) or 0.0
            )
            for field in scaled
        }
        rows.append(replace(row, frame=row.encoded, raw=raw, doubles=doubles))
    always = {
        name: raws for name, raws in vectors.refused_raws.items() if name not in absent
    }
    fresh = {
        field.name: field.initial_value for field in raw_fields_in(message.model.layout)
    }
    return replace(
        vectors, rows=tuple(rows), default=vectors.default | fresh, refused_raws=always
    )


def _scalars(message: MessageDescription) -> Iterator[FieldDescription]:
    """Return all scalars of a message, overlays and derived values included, in the
    order of the ICD.
    """
    return (scalar for member in message.declared_members for scalar in member.scalars)


def _variable_part_values(
    message: MessageDescription, tail: VariablePartDescription, vectors: MessageVectors
) -> dict[str, object]:
    """Return the template values of a message of variable length."""
    return {
        "least": message.model.layout.shortest,
        "counter": next(
            place
            for place, scalar in enumerate(_scalars(message))
            if scalar.model is tail.counter.model
        ),
        "high": tail.model.high,
        # `icdgen_selftest.c` expects frame i at byte i * `length` of a flat array.
        "frames": _byte_rows(
            b"".join(
                frame.ljust(message.model.length, b"\0")
                for frame in vectors.refused_frames
            )
        ),
        "frame_lengths": list(map(len, vectors.refused_frames)),
    }


def _accessor_rows(accessor: Accessor, assignments: Assignments | None) -> AccessorRows:
    """Return accessors with test values.

    ``assignments`` is None for an overlay field, because it has no setter.
    """
    if accessor.kind == "text":
        type, rows = "char", _text_rows(assignments or [])
    elif accessor.kind == "integer":
        type, rows = f"int{accessor.integer_access.bits}_t", _integer_rows(accessor)
    else:
        type = "double"
        rows = [] if assignments is None else _double_rows(accessor.field, assignments)
    stem = names.stem(accessor.field.declaration.message)
    return AccessorRows(
        f"{stem}_{accessor.name}", f"{stem}_set_{accessor.name}", type, rows
    )


def _text_rows(assignments: Assignments) -> list[str]:
    """Return assignments of texts: the resulting bytes, or a refusal.

    C strings cannot represent all bytes, so other contents are omitted.
    """
    lines = []
    for text, raw in assignments:
        assert not isinstance(raw, int)
        octets = (
            "NULL"
            if raw is None
            else f"(const uint8_t[]){{{', '.join(map(hex, raw))}}}"
        )
        lines.append(f"{{{_text_literal(text)}, {octets}}},")
    return lines


def _text_literal(text: str | None) -> str:
    return "NULL" if text is None else literal(text)


def _integer_of(value: int | bytes) -> int:
    assert isinstance(value, int)
    return value


def _double_rows(field: FieldDescription, assignments: Assignments) -> list[str]:
    """Return assignments of doubles: the resulting raw value, or a refusal."""
    lines = []
    # Floats accept NaN and infinities.
    never = () if field.model.type == "float" else NEVER
    for bits, raw in [*assignments, *((bits, None) for bits in never)]:
        assert not isinstance(raw, bytes)
        lines.append(
            f"{{UINT64_C(0x{bits}), {_unsigned_literal(raw or 0)}, {'true' if raw is None else 'false'}}},"
        )
    return lines


def _integer_rows(accessor: Accessor) -> list[str]:
    """Return raw values with their exact values in whole parts of the unit."""
    field, lines = accessor.field, []
    assert field.steps is not None
    for raw in values(field.model):
        assert isinstance(raw, int)
        exact = field.steps.physical(raw) * accessor.integer_access.scale.per
        assert exact.denominator == 1
        lines.append(f"{{{_unsigned_literal(raw)}, {physical.int64(int(exact))}}},")
    return lines


def _unsigned_literal(value: int) -> str:
    """Return the 64 bits of a raw value as a C literal."""
    return (
        f"{value}u"
        if 0 <= value < 1 << 16
        else f"UINT64_C(0x{value & ((1 << 64) - 1):X})"
    )


def _byte_rows(data: bytes) -> list[str]:
    return in_rows((f"0x{byte:02X}" for byte in data), BYTES_IN_ROW)
