"""CAN databases of the opendbc package; cantools reads them and judges."""

from __future__ import annotations

import contextlib
import importlib.resources
from collections.abc import Callable, Iterator
from decimal import Decimal
from functools import reduce
from operator import or_
from pathlib import Path
from typing import Any

from tests.devices.definition import Definition, Definitions, Values, formula, node, unit


def databases() -> Iterator[Definitions]:
    """Every DBC file that cantools reads; what it refuses has no judge."""
    import cantools

    for number, path in enumerate(files()):
        try:
            database: Any = cantools.database.load_file(path, strict=False)
        except cantools.database.UnsupportedDatabaseFormatError:
            continue
        messages = [_definition(message) for message in database.messages]
        yield Definitions(node(f"{path.stem[:35]} {number}", path.stem, id_bits=29), messages)


def files() -> list[Path]:
    """The DBC files of the package, by name."""
    import opendbc

    folder = importlib.resources.files(opendbc)
    assert isinstance(folder, Path)
    return sorted(folder.rglob("*.dbc"), key=lambda path: path.name)


def _definition(message: Any) -> Definition:
    fields, enums = [], []
    for signal in message.signals:
        one = {"at": _first(signal), "bits": signal.length, "name": signal.name, **_kind(signal), **unit(signal.unit)}
        if signal.byte_order == "big_endian":
            one |= {"byte_order": "big", "bit_order": "msb0"}
        scale = formula(_printed(signal.scale), _printed(signal.offset))
        choices = {int(value): str(name) for value, name in (signal.choices or {}).items()}
        named = [(value, name) for value, name in sorted(choices.items()) if value in _range(signal)]
        if named and (scale or (one["type"] == "uint" and signal.length == 1)):
            one["special"] = [{"value": value, "meaning": name} for value, name in named]
        elif named and not signal.is_float:
            name = f"{message.name} {signal.name}"
            one = {**one, "type": "enum", "enum": name}
            one.pop("unit", None)
            enums.append({"name": name, "members": [{"value": value, "name": name} for value, name in named]})
        if signal.multiplexer_signal is not None:
            one["when"] = {signal.multiplexer_signal: sorted(signal.multiplexer_ids)}
        fields.append(one | scale)
    fields = sorted(_with_views(fields), key=lambda one: int(one["at"]))
    read = _reader(message, message.is_multiplexed() or any("view" in one for one in fields))
    return Definition(
        message.name, message.frame_id, "telemetry", message.length, fields, enums,
        "", lambda data: read(data, False), lambda data: read(data, True),
    )  # fmt: skip


def _reader(message: Any, is_by_signal: bool) -> Callable[[bytes, bool], Values]:
    """The library's reading, raw or scaled; signals that overlap, or that no selector has, it reads only one by one."""
    from cantools.database import Message
    from cantools.database.errors import DecodeError

    parts, head = [message], (message.frame_id, message.name, message.length)
    if is_by_signal:
        selectors = {signal.name: signal for signal in message.signals if signal.is_multiplexer}
        groups = [[*filter(None, [selectors.get(one.multiplexer_signal)]), one] for one in message.signals]
        parts = [Message(*head, group, is_extended_frame=True, strict=False) for group in groups]

    def read(data: bytes, scaled: bool) -> Values:
        found: Values = {}
        for part in parts:
            with contextlib.suppress(DecodeError):  # of a value of the selector that no signal has
                found |= part.decode(data, False, scaled)
        return found

    return read


def _with_views(fields: list[dict]) -> list[dict]:
    """The fields, those that overlap larger ones as views; bits of these that no signal has by itself become fields."""
    owners: list[dict] = []
    left = 0
    for one in sorted(fields, key=lambda one: ("when" in one, -int(one["bits"]))):
        if any(_mask(one) & _mask(other) and not _exclude(one, other) for other in owners):
            one["view"] = True
            left |= _mask(one)
        else:
            owners.append(one)
    owned = reduce(or_, map(_mask, owners), 0)
    return [*fields, *_remaining(left & ~owned)]


def _exclude(one: dict, other: dict) -> bool:
    """Whether two fields are never both there."""
    there, beside = one.get("when", {}), other.get("when", {})
    return any(name in beside and not set(values) & set(beside[name]) for name, values in there.items())


def _mask(one: dict) -> int:
    """The bits of the frame: bit w of byte b is bit 8 * b + w."""
    places = (divmod(at, 8) for at in range(one["at"], one["at"] + one["bits"]))
    return sum(1 << 8 * byte + (7 - bit if one.get("bit_order") == "msb0" else bit) for byte, bit in places)


def _remaining(mask: int) -> Iterator[dict]:
    """A field for each run of bits within a byte."""
    at = 0
    while mask >> at:
        start = at
        while mask >> at & 1 and (at == start or at % 8):
            at += 1
        if at > start:
            yield {"at": start, "bits": at - start, "name": f"Others at {start}", "type": "uint"}
        else:
            at += 1


def _range(signal: Any) -> range:
    """The raw values that there are: some members are of none of them."""
    half = 1 << signal.length - 1
    return range(-half, half) if signal.is_signed else range(2 * half)


def _first(signal: Any) -> int:
    """The field's first bit; in a DBC the bits of a byte are numbered from the least significant in either order."""
    return signal.start if signal.byte_order == "little_endian" else signal.start // 8 * 8 + 7 - signal.start % 8


def _kind(signal: Any) -> dict:
    return {"type": "float" if signal.is_float else "int" if signal.is_signed else "uint"}


def _printed(number: float) -> str:
    return format(Decimal(str(number)), "f" if abs(number) >= 1e-6 or not number else "e").replace("E", "e")
