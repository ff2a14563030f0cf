"""CAN databases, as cantools reads them: DBC, KCD, SYM and ARXML."""

from __future__ import annotations

import logging
import re
from fractions import Fraction
from pathlib import PurePath
from typing import Any

from icdgen.definitions import dbc, frames, safe_xml
from icdgen.definitions.enumerations import Enumerations, members, special
from icdgen.definitions.model import Definitions, Item, Network, NotHeld, raws, unreadable
from icdgen.definitions.wording import formula, limits, line, node_name, printed, summary, unit
from icdgen.icd.fmt.emit import Spelled

BEYOND_FRAME = "IMP072"
_UNHEARD = logging.NullHandler()
_STANDARD, _EXTENDED = 11, 29  # bits of an id
_NOBODY = ("", "Vector__XXX")  # as a DBC names a sender that is not known


class _Database:
    """What the four kinds have in common. ``name`` is cantools' name of one, too, and ``begins`` tells a file of it."""

    needs: tuple[str, ...] = ("cantools",)
    name = title = begins = ""

    def knows(self, start: str) -> bool:
        return re.search(self.begins, start) is not None

    def read(self, file: str, data: bytes) -> Definitions:
        """Raises `Findings` for a file that cantools cannot read."""
        to = Definitions(file)
        for bus, messages in _buses(self.database(file, data, to)).items():
            stem = PurePath(file).stem
            to.networks.append(_network(f"{stem} {bus}".strip(), messages, to))
        return to

    def database(self, file: str, data: bytes, to: Definitions) -> Any:
        """cantools' own reading."""
        try:
            return self.load(_text(data), to)
        except Exception as error:  # its parsers raise whatever comes up
            found = re.search(r"at line (\d+)", str(error))
            said = line(str(error), 300) or type(error).__name__
            raise unreadable(file, f"not {self.title}: {said}", "", int(found[1]) if found else 1) from None

    def load(self, text: str, to: Definitions) -> Any:
        """What `database` asks of cantools."""
        from cantools import database

        # What it notes by the way is found again, and said as a finding.
        logging.getLogger("cantools").addHandler(_UNHEARD)
        return database.load_string(text, self.name, strict=False)


class Dbc(_Database):
    """Vector's CAN databases."""

    name = "dbc"
    title = "a CAN database (DBC)"
    begins = r"(?m)^(?:BO_ \d+ |BU_\s*:)"

    def load(self, text: str, to: Definitions) -> Any:
        return dbc.mended(text.replace("\r\n", "\n"), lambda mended: super(Dbc, self).load(mended, to), to)


class Sym(_Database):
    """PEAK's symbol files."""

    name = "sym"
    title = "a symbol file (SYM)"
    begins = r"\A\s*FormatVersion\s*="


class _Xml(_Database):
    needs = ("cantools", "defusedxml")
    root = ""

    def knows(self, start: str) -> bool:
        return safe_xml.root_of(start) == self.root

    def database(self, file: str, data: bytes, to: Definitions) -> Any:
        safe_xml.parse(file, data)  # cantools would expand entities
        return super().database(file, data, to)


class Kcd(_Xml):
    """Kayak's CAN definitions."""

    name, root = "kcd", "NetworkDefinition"
    title = "a CAN definition (KCD)"


class Arxml(_Xml):
    """AUTOSAR's system descriptions, as far as they describe CAN."""

    name, root = "arxml", "AUTOSAR"
    title = "an AUTOSAR system description (ARXML)"
    most_bytes = 64_000_000  # it says everything at length


def _text(data: bytes) -> str:
    try:
        return data.decode("utf-8-sig")
    except UnicodeDecodeError:
        return data.decode("cp1252", "replace")


def _buses(database: Any) -> dict[str, list[Any]]:
    """Messages by bus, where there are several."""
    found: dict[str, list[Any]] = {}
    for message in getattr(database, "messages", ()):
        found.setdefault(message.bus_name or "", []).append(message)
    return found if len(found) > 1 else {"": [one for messages in found.values() for one in messages]}


def _network(title: str, messages: list[Any], to: Definitions) -> Network:
    is_extended = any(message.is_extended_frame for message in messages)
    order = frames.usual(signal_place(signal) for message in messages for signal in message.signals)
    head = {**frames.ORDERS[order], "id_bits": _EXTENDED if is_extended else _STANDARD}
    network, enums = Network(node_name(title + ".can"), title, head), Enumerations()
    for message in messages:
        to.total += 1
        try:
            network.messages.append(_message(message, order, enums, to))
        except NotHeld as why:
            to.left_out(message.name, why)
    network.enums = enums.declared()
    return network


def _message(message: Any, order: str, enums: Enumerations, to: Definitions) -> Item:
    if message.is_container:
        raise NotHeld("it holds other messages in an order that each frame tells")
    made: Item = {"name": message.name, "id": Spelled(f"{message.frame_id:#05X}".replace("X", "x"))}
    made |= {"kind": "telemetry", "length": message.length}
    if senders := [one for one in message.senders if one not in _NOBODY]:
        made["group"] = senders[0]
    made |= summary(message.comment)
    placed: list[tuple[Item, frames.Place]] = []
    for signal in message.signals:
        place = signal_place(signal)
        if not 0 <= place.at <= place.at + place.bits <= 8 * message.length:
            where = "begins before" if place.at < 0 else "ends behind"
            what = f"message `{message.name}`: `{signal.name}` {where} its {message.length} bytes"
            to.warn(BEYOND_FRAME, what, "the signal is left out", "error")
            continue
        field = _field(message, signal, enums, to)
        same = next((one for one, other in placed if other == place and _is_alternative(one, field)), None)
        if same is None:
            placed.append((field, place))
        else:
            (by,) = field["when"]
            same["when"] = {by: [*frames.listed(same["when"][by]), *frames.listed(field["when"][by])]}
    return frames.laid_out(made, placed, order, to)


def _is_alternative(one: Item, other: Item) -> bool:
    """Whether two are one signal that a symbol file has under several values of a multiplexer."""
    plain = [{key: value for key, value in each.items() if key not in ("when", "enum")} for each in (one, other)]
    return plain[0] == plain[1] and "when" in one and one["when"].keys() == other.get("when", {}).keys()


def signal_place(signal: Any) -> frames.Place:
    """Where a signal lies; in a DBC the bits of a byte are numbered from the least significant in either order."""
    if signal.byte_order == "little_endian":
        return frames.Place(signal.start, signal.length, frames.LITTLE)
    return frames.Place(signal.start // 8 * 8 + 7 - signal.start % 8, signal.length, frames.BIG)


def _field(message: Any, signal: Any, enums: Enumerations, to: Definitions) -> Item:
    kind = "float" if signal.is_float else "int" if signal.is_signed else "uint"
    one: Item = {"name": signal.name, "type": kind, **unit(signal.unit), **summary(signal.comment)}
    factor, offset = printed(signal.scale), printed(signal.offset)
    scale = formula(factor, offset)
    first, last = _range(signal)
    choices = {int(value): str(name) for value, name in (signal.choices or {}).items()}
    where = f"message `{message.name}`, `{signal.name}`"
    named = members(choices, first, last, where, to) if choices and not signal.is_float else []
    if named and scale:
        one |= special(named)
    elif named:
        one["type"] = "enum"
        enums.give(one, signal.name, message.name, named)
    elif signal.length == 1 and kind == "uint" and not scale:
        one["type"] = "bool"
    if one["type"] in ("enum", "bool"):
        one.pop("unit", None)
    else:
        ends = sorted(Fraction(factor) * value + Fraction(offset) for value in (first, last))
        low, high = (None if end is None else Fraction(printed(end)) for end in (signal.minimum, signal.maximum))
        one |= scale | limits(low, high, ends[0], ends[1])
    if when := _condition(message, signal):
        one["when"] = when
    return one


def _range(signal: Any) -> tuple[int, int]:
    """The raw values that there are, from the first to the last; of floats nearly so."""
    if signal.is_float:
        return -(2**127), 2**127
    return raws(signal.length, signal.is_signed)


def _condition(message: Any, signal: Any) -> Item:
    """The multiplexer and its values with which a signal is there."""
    if signal.multiplexer_ids is None:
        return {}
    told = signal.multiplexer_signal
    by = next((one for one in message.signals if one.name == told), None)
    if by is None:
        raise NotHeld(f"`{signal.name}` depends on `{told}`, which it does not have")
    if by.multiplexer_ids is not None:
        raise NotHeld(f"`{signal.name}` depends on `{told}`, which is not always there itself")
    if by.is_signed or by.is_float or (by.scale, by.offset) != (1, 0):
        raise NotHeld(f"`{signal.name}` depends on `{told}`, which is no plain unsigned number")
    values = sorted(set(signal.multiplexer_ids))
    within = [value for value in values if value < 1 << by.length]
    if not within:
        raise NotHeld(f"`{signal.name}` depends on values of `{told}` that it cannot have")
    said: list[Any] = [bool(one) for one in within] if by.length == 1 and not by.choices else within
    return {told: said[0] if len(said) == 1 else said}
