"""Decoding of many frames into columns. Needs numpy; tables also need pyarrow.

`decode_many` and `decode_table` take the bytes of consecutive frames and read each
field of all frames at once.
"""

from __future__ import annotations

import json
from collections.abc import Callable
from importlib import import_module
from typing import Any, NamedTuple

from ._codec import text
from ._conditions import absent
from ._curves import columns_on_curve
from ._derived import column as derived_column
from ._dicts import OCTETS
from ._errors import IcdError, LengthError
from ._hints import Buffer, Frames
from ._layout import Piece, byte_order, pieces
from ._tails import padded
from ._types import FieldInfo, MessageFacts

_EXACT = 1 << 53  # integers below this are exact as 64-bit floats


def decode_many(
    message: type[MessageFacts],
    decode: Callable[[Buffer], Any],
    frames: Frames,
    physical: bool,
) -> dict[str, Any]:
    """Implement `Message.decode_many`. ``decode`` is `Message.from_bytes`."""
    numpy: Any = import_module("numpy")
    columns, counts = _columns(numpy, message, decode, frames, physical)
    for (info, parts), (name, column) in zip(_column_fields(message), columns.items()):
        if info.is_open and column.ndim > 1:
            is_octets = info.type in OCTETS and not info.elements
            columns[name] = rows = numpy.empty(len(counts), object)
            for row, count in enumerate(counts):
                elements = column[row, :count]
                rows[row] = elements.tobytes() if is_octets else elements
    return columns


def _columns(
    numpy: Any,
    message: type[MessageFacts],
    decode: Callable[[Buffer], Any],
    frames: Frames,
    physical: bool,
) -> tuple[dict[str, Any], Any]:
    """Return the columns by name, and the number of elements at the end of each frame.

    Shorter frames are padded with zeros.
    """
    joined, counts = _joined(message, decode, frames)
    decoder = _Decoder(numpy, message, joined)
    columns: dict[str, Any] = {}
    fields = {info.attribute: info for info in message.FIELDS}
    for info, parts in _column_fields(message):
        if info.elements:
            elements = [decoder.column(element) for element in parts]
            column = numpy.stack(elements, axis=1)
        else:
            column = decoder.column(info)
        if physical and info.type == "text":
            cells = column.reshape(-1, column.shape[-1])
            texts = numpy.array([text(cell) for cell in cells], dtype=str)
            columns[info.physical] = texts.reshape(column.shape[:-1])
        elif physical and info.physical:
            values = _physical(numpy, info, column.ravel())
            columns[info.physical] = values.reshape(column.shape)
        else:
            columns[info.attribute] = column
    for info in message.FIELDS if message.CONDITIONAL else ():
        if info.when:
            name = info.physical if physical and info.physical else info.attribute
            raw = {key: decoder.column(fields[key]) for key, _ in info.when}
            mask = absent(numpy, info, raw)
            columns[name] = numpy.ma.array(columns[name], mask=mask)
    return columns, numpy.array(counts, numpy.int32)


def _joined(
    message: type[MessageFacts], decode: Callable[[Buffer], Any], frames: Frames
) -> tuple[Buffer, list[int]]:
    """Join frames to one buffer of equally long frames.

    Frames of different lengths are padded to the longest. The second result is then the
    number of elements of each frame, and otherwise empty.
    """
    is_buffer = isinstance(frames, (bytes, bytearray, memoryview))
    if message.ENDS_EARLY and not is_buffer:
        shortened: list[Any] = list(frames)
        for frame in shortened:
            decode(frame)  # raises `LengthError` if it is not a frame
        return b"".join(padded(message, frame) for frame in shortened), []
    if message.TAIL is None:
        return (frames if is_buffer else b"".join(frames)), []  # type: ignore[return-value, arg-type]
    if is_buffer:
        raise IcdError(
            f"frames of {message.NAME} differ in length: give them as a list"
        )
    given: list[Any] = list(frames)
    messages = [decode(frame) for frame in given]  # raises `LengthError`
    counts = [len(getattr(decoded, message.TAIL.part)) for decoded in messages]
    return b"".join(padded(message, frame) for frame in given), counts


def decode_table(
    message: type[MessageFacts],
    decode: Callable[[Buffer], Any],
    frames: Frames,
    physical: bool,
) -> Any:
    """Implement `Message.decode_table`."""
    numpy: Any = import_module("numpy")
    pyarrow: Any = import_module("pyarrow")
    columns, counts = _columns(numpy, message, decode, frames, physical)
    fields, arrays = [], []
    for (info, parts), (name, column) in zip(_column_fields(message), columns.items()):
        if info.when:
            array = pyarrow.array(
                numpy.ascontiguousarray(column.data), mask=column.mask
            )
            fields.append(pyarrow.field(name, array.type, metadata=_metadata(info)))
            arrays.append(array)
            continue
        column = numpy.ascontiguousarray(column)
        if info.is_open and column.ndim > 1:
            is_octets = info.type in OCTETS and not info.elements
            array = _lists(numpy, pyarrow, column, counts, is_octets)
        else:
            is_octets = info.type in OCTETS and name != info.physical
            array = (
                _octets(pyarrow, column, info.bits // 8)
                if is_octets
                else pyarrow.array(column.ravel())
            )
            if info.elements:
                array = pyarrow.FixedSizeListArray.from_arrays(array, info.elements)
        fields.append(pyarrow.field(name, array.type, metadata=_metadata(info)))
        arrays.append(array)
    about = {
        "node": message.NODE,
        "message": message.NAME,
        "ids": json.dumps(message.IDS),
    }
    schema = pyarrow.schema(fields, metadata=about)
    return pyarrow.Table.from_arrays(arrays, schema=schema)


_ColumnField = tuple[FieldInfo, tuple[FieldInfo, ...]]
"""A field or array with one column, and its elements in a frame."""


def _column_fields(message: type[MessageFacts]) -> list[_ColumnField]:
    """Return everything that has a column, in order.

    These are fields, arrays, overlay fields, derived values and the fields of each
    struct. A field of the structs at a variable-length end has one column for all
    structs.
    """
    lines: list[_ColumnField] = []
    for info in message.FIELDS:
        if info.struct is not None and info.is_open:
            lines += _open_column_fields(info)
        else:
            lines += [(line, line.parts) for line in info.lines]
    return [*lines, *((view, view.parts) for view in message.VIEWS)]


def _open_column_fields(info: FieldInfo) -> list[_ColumnField]:
    """Return one column per field of the structs in a variable-length array.

    The names are like ``satellites.gnss`` and ``satellites.angles[1]``.
    """
    each = [
        [leaf for line in lines for leaf in line.parts]
        for lines in (part.lines for part in info.parts)
    ]
    physical = [
        (
            f"{line.physical}[{index}]"
            if line.elements and line.physical
            else line.physical
        )
        for line in info.parts[0].lines
        for index in range(len(line.parts))
    ]
    result = []
    for leaves, name in zip(zip(*each), physical):
        facts = {key: getattr(leaves[0], key) for key in FieldInfo.__slots__}
        facts["physical"] = name
        for key in ("attribute", "name", "physical"):
            head = info.name if key == "name" else info.attribute
            facts[key] = facts[key].replace(f"{head}[0].", f"{head}.", 1)
        facts.update(elements=info.elements, is_open=True)
        result.append((FieldInfo(**facts), leaves))
    return result


def _lists(numpy: Any, pyarrow: Any, rows: Any, counts: Any, is_octets: bool) -> Any:
    """Return the first elements of each row, as lists or as bytes.

    ``counts`` are per row.
    """
    mask = numpy.arange(rows.shape[1]) < counts[:, None]
    values = rows[mask]
    ends = numpy.concatenate(([0], numpy.cumsum(counts))).astype(numpy.int32)
    if is_octets:
        buffers = [None, pyarrow.py_buffer(ends), pyarrow.py_buffer(values)]
        return pyarrow.Array.from_buffers(pyarrow.binary(), len(rows), buffers)
    if values.ndim == 2:
        strings = _octets(pyarrow, numpy.ascontiguousarray(values), values.shape[1])
        return pyarrow.ListArray.from_arrays(pyarrow.array(ends), strings)
    return pyarrow.ListArray.from_arrays(pyarrow.array(ends), pyarrow.array(values))


def _octets(pyarrow: Any, rows: Any, size: int) -> Any:
    """Return a column of byte strings of ``size`` bytes."""
    buffers = [None, pyarrow.py_buffer(rows)]
    return pyarrow.Array.from_buffers(pyarrow.binary(size), rows.size // size, buffers)


def _metadata(info: FieldInfo) -> dict[str, str]:
    metadata = {"name": info.name}
    if info.unit:
        metadata["unit"] = info.unit
    if info.enum:
        names = {int(member): member.label for member in info.enum}
        metadata["values"] = json.dumps(names)
    return metadata


def _physical(numpy: Any, info: FieldInfo, raw: Any) -> Any:
    """Return the physical values of a column, correctly rounded.

    Doubles are used if all but the division is exact, otherwise Python's integers.
    """
    if info.curve:
        return columns_on_curve(numpy, info.curve, raw)
    p, c, q = info.scale
    low, high = info.raw_range
    bounds = [p, c, q, low, high, low * p, high * p, low * p + c, high * p + c]
    # Every intermediate value must be exact in doubles. Otherwise compute in integers.
    if max(map(abs, bounds)) > _EXACT:
        values = ((value * p + c) / q for value in raw.tolist())
        return numpy.fromiter(values, numpy.float64, len(raw))
    column = raw.astype(numpy.float64)
    if p != 1:
        column *= p
    if c:
        column += c
    if q != 1:
        column /= q
    return column


class _Decoder:
    """Columns of consecutive frames.

    Byte-aligned fields are views. Frames that can change are copied first.
    """

    def __init__(self, numpy: Any, message: type[MessageFacts], frames: Buffer) -> None:
        view = memoryview(frames)
        size = message.LENGTH
        count, remainder = divmod(view.nbytes, size) if size else (0, view.nbytes)
        if remainder:
            raise LengthError(message.NAME, (count + 1) * size, view.nbytes)
        data: Any = view if view.readonly and view.c_contiguous else view.tobytes()
        self.numpy, self.message, self.count = numpy, message, count
        self.words = (count + 7) // 8  # 64-bit words that contain a byte of every frame
        self.rows = numpy.frombuffer(data, numpy.uint8).reshape(count, size)
        if message not in _plans:
            _plans[message] = _plan(message)
        plan = _plans[message]
        self.bytes: dict[int, Any] = {}
        for byte, width in plan.runs:
            self._split(self._column(f"<u{width}", byte), byte)
        self.flags = self._flags(plan)

    def _split(self, run: Any, byte: int) -> None:
        """Store each byte of the integers ``run``, which begin at a byte of the frame.

        Reading a run from every frame takes as long as reading one byte.
        """
        width = run.itemsize
        if width == 1:
            self._store_byte(run, byte)
            return
        run = self.numpy.ascontiguousarray(run)
        if width == 2:
            self._store_byte(run, byte)
            self._store_byte(run >> 8, byte + 1)
        else:
            self._split(run.astype("<u2"), byte)  # the lower 16 bits
            self._split((run >> 16).astype("<u2"), byte + 2)

    def _store_byte(self, values: Any, byte: int) -> None:
        """Store the lowest byte of each integer."""
        self.bytes[byte] = self.numpy.empty(self.words * 8, self.numpy.uint8)
        self.bytes[byte][: self.count] = values

    def _flags(self, plan: _Plan) -> dict[str, Any]:
        """Return all columns of booleans.

        Each 64-bit word processes eight frames at a time.
        """
        numpy = self.numpy
        flags = numpy.empty((len(plan.names), self.words), numpy.uint64)
        lowest = numpy.uint64(0x0101010101010101)  # lowest bit of each byte of a word
        row = 0
        for byte, shifts in plan.flags:
            words = self.bytes[byte].view(numpy.uint64)
            bits = flags[row : row + len(shifts)]
            by = numpy.array(shifts, numpy.uint64)[:, None]
            numpy.right_shift(words, by, out=bits)
            numpy.bitwise_and(bits, lowest, out=bits)
            row += len(shifts)
        columns = flags.view(numpy.bool_)[:, : self.count]
        return dict(zip(plan.names, columns))

    def column(self, info: FieldInfo) -> Any:
        """Return the raw values of a field, or the results of a derived value."""
        if info.type == "bool":
            return self.flags[info.attribute]
        if info.derived:
            columns = [self._value(name) for name in info.derived[0]]
            return derived_column(self.numpy, info.derived, columns)
        if _is_aligned(info):
            return self._aligned_column(info)
        runs = pieces(info, self.message)
        if len(runs) == 1:
            return self._single_byte_column(info, runs[0])
        return self._assembled_column(info, runs)

    def _value(self, name: str) -> Any:
        """Return the column of an attribute: physical or raw values."""
        infos = (*self.message.FIELDS, *self.message.VIEWS)
        info = next(
            candidate
            for candidate in infos
            if name in (candidate.physical, candidate.attribute)
        )
        column = self.column(info)
        return _physical(self.numpy, info, column) if name == info.physical else column

    def _aligned_column(self, info: FieldInfo) -> Any:
        start, size = info.at // 8, info.bits // 8
        if info.type in OCTETS:
            return self.rows[:, start : start + size]
        code = "i" if info.signed else "f" if info.type == "float" else "u"
        order = ">" if byte_order(info, self.message) == "big" else "<"
        kind = self.numpy.dtype(f"{order}{code}{size}")
        column = self._column(kind, start)
        return column if kind.isnative else column.astype(kind.newbyteorder("="))

    def _column(self, kind: Any, start: int) -> Any:
        """Return a view of the numbers that begin at byte ``start`` of every frame."""
        if not self.count:
            return self.numpy.empty(0, kind)
        return self.numpy.ndarray(
            self.count, kind, self.rows, start, (self.message.LENGTH,)
        )

    def _byte(self, byte: int) -> Any:
        return self.bytes[byte][: self.count]

    def _single_byte_column(self, info: FieldInfo, piece: Piece) -> Any:
        column, shift, bits = self._byte(piece.byte), piece.shift, piece.bits
        if info.signed:
            column = (column << (8 - shift - bits)).view(self.numpy.int8)
            return column >> (8 - bits)
        if shift + bits < 8:
            return (column >> shift) & ((1 << bits) - 1)
        return column >> shift

    def _assembled_column(self, info: FieldInfo, runs: list[Piece]) -> Any:
        numpy = self.numpy
        total = numpy.zeros(self.count, numpy.uint64)
        for piece in runs:
            part = (self._byte(piece.byte) >> piece.shift) & ((1 << piece.bits) - 1)
            total |= part.astype(numpy.uint64) << numpy.uint64(piece.at)
        size = next(size for size in (8, 16, 32, 64) if size >= info.bits)
        if info.type == "float":
            return total.astype(f"u{size // 8}").view(f"f{size // 8}")
        if not info.signed:
            return total.astype(f"u{size // 8}")
        # Shift to the top of a word and back, which copies the sign to the upper bits.
        spare = numpy.uint64(64 - info.bits)
        return ((total << spare).view(numpy.int64) >> spare.view(numpy.int64)).astype(
            f"i{size // 8}"
        )


class _Plan(NamedTuple):
    """Bytes to read for the fields of a message that are not byte-aligned."""

    runs: list[tuple[int, int]]
    """First byte and width of each run of 1, 2 or 4 bytes."""
    flags: list[tuple[int, list[int]]]
    """Each byte that has booleans, with their bits."""
    names: list[str]
    """Attributes of the booleans, in the order of `flags`."""


_plans: dict[type[MessageFacts], _Plan] = {}


def _plan(message: type[MessageFacts]) -> _Plan:
    needed: set[int] = set()
    flags: dict[int, list[int]] = {}
    names: dict[int, list[str]] = {}
    for info in (part for _, parts in _column_fields(message) for part in parts):
        if _is_aligned(info):
            continue
        for piece in pieces(info, message):
            needed.add(piece.byte)
            if info.type == "bool":
                flags.setdefault(piece.byte, []).append(piece.shift)
                names.setdefault(piece.byte, []).append(info.attribute)
    runs = []
    while needed:
        byte = min(needed)
        width = next(w for w in (4, 2, 1) if needed.issuperset(range(byte, byte + w)))
        runs.append((byte, width))
        needed.difference_update(range(byte, byte + width))
    ordered = [name for attributes in names.values() for name in attributes]
    return _Plan(runs, list(flags.items()), ordered)


def _is_aligned(info: FieldInfo) -> bool:
    """Return whether numpy can read the field directly as a byte-aligned array element."""
    is_wide = info.type in OCTETS or info.bits in (8, 16, 32, 64)
    return is_wide and info.at % 8 == 0
