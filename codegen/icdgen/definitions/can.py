"""Readers of CAN databases (DBC, KCD, SYM and ARXML), based on cantools.

Each bus of a database becomes a network of messages. cantools drops some content of a
file without a warning, and rejects a whole DBC file for others: `can_accounting` and
`dbc` report the former and repair the latter.
"""

from __future__ import annotations

import logging
import re
from fractions import Fraction
from pathlib import PurePath
from typing import Any

from icdgen.definitions import can_accounting, dbc, frames, safe_xml
from icdgen.definitions.accounting import UNUSED, Account, AccountedObject
from icdgen.definitions.enumerations import Enumerations
from icdgen.definitions.model import (
    SAME_NAME,
    Definitions,
    Item,
    Network,
    NotSupported,
    unreadable,
)
from icdgen.definitions.wording import (
    MOST_LIMIT,
    formula,
    limits,
    line,
    node_name,
    printed,
    summary,
    unit,
)
from icdgen.frozen import NamedTuple
from icdgen.icd.fmt.emit import Spelled
from icdgen.icd.layout import integer_range
from icdgen.icd.wire_ids import CAN_BOTH, CAN_EXTENDED, CAN_EXTENDED_FLAG, CAN_STANDARD

BEYOND_FRAME = "IMP072"
CONTRADICTION = "IMP076"
_DISCARDING = logging.NullHandler()
# Attributes of cantools objects whose absence in the ICD needs no finding: they have no
# meaning for it, or are read in another way.
_NOT_REPORTED = frozenset(
    {
        "conversion", "is_multiplexer", "minimum", "maximum", "initial", "invalid", "comments", "signal_tree", "codecs",
        "signals", "unused_bit_pattern", "header_byte_order", "autosar", "dbc", "receivers_of_signals", "is_fd", "frame_id",
        "is_extended_frame", "bus_name", "message.receivers", "contained_messages",
    }
)  # fmt: skip
_UNKNOWN_SENDERS = ("", "Vector__XXX")  # placeholder of DBC files for an unknown sender


class _Database:
    """Reader shared by the four database formats.

    ``name`` is the format name of cantools; ``signature`` is a pattern that recognizes
    a file of the format.
    """

    needs: tuple[str, ...] = ("cantools",)
    name = title = signature = ""

    def knows(self, start: str) -> bool:
        return re.search(self.signature, start) is not None

    def read(self, file: str, data: bytes) -> Definitions:
        """Read a database. Raises `Findings` if cantools cannot read the file."""
        to = Definitions(file)
        account = Account(_NOT_REPORTED)
        for bus, messages in _buses(self.database(file, data, to)).items():
            stem = PurePath(file).stem
            to.networks.append(_network(f"{stem} {bus}".strip(), messages, account, to))
        self.account_for(
            file, data, account, {finding.spot.line for finding in to.import_findings}
        )
        account.report(to)
        return to

    def account_for(
        self, file: str, data: bytes, account: Account, reported: set[int | None]
    ) -> None:
        """Count unused parts of the file.

        ``reported`` (DBC only) has the lines that already have a finding.
        """
        raise NotImplementedError

    def database(self, file: str, data: bytes, to: Definitions) -> Any:
        """Return the database that cantools parses.

        Raises `Findings` if cantools raises an exception.
        """
        try:
            return self.load(_text(data), to)
        except (
            Exception
        ) as error:  # the parsers of cantools raise exceptions of many classes
            match = re.search(r"at line (\d+)", str(error))
            reason = line(str(error), 300) or type(error).__name__
            raise unreadable(
                file, f"not {self.title}: {reason}", "", int(match[1]) if match else 1
            ) from None

    def load(self, text: str, to: Definitions) -> Any:
        """Parse the text with cantools."""
        from cantools import database

        # Warnings of cantools are suppressed, because the import reports the same
        # faults as findings.
        logging.getLogger("cantools").addHandler(_DISCARDING)
        # With `strict`, cantools rejects a whole file for one signal that overlaps
        # another or ends behind its frame. Such signals get findings here.
        return database.load_string(text, self.name, strict=False)


class Dbc(_Database):
    """Vector CAN databases (DBC)."""

    name = "dbc"
    title = "a CAN database (DBC)"
    signature = r"(?m)^(?:BO_ \d+ |BU_\s*:)"

    def load(self, text: str, to: Definitions) -> Any:
        plain = dbc.with_short_names(text.replace("\r\n", "\n"))
        database = dbc.mended(
            plain, lambda mended: super(Dbc, self).load(mended, to), to
        )
        dbc.give_long_names(database.messages)
        return database

    def account_for(
        self, file: str, data: bytes, account: Account, reported: set[int | None]
    ) -> None:
        dbc.account_for(_text(data).replace("\r\n", "\n"), account, reported)


class Sym(_Database):
    """PEAK symbol files (SYM)."""

    name = "sym"
    title = "a symbol file (SYM)"
    signature = r"\A\s*FormatVersion\s*="

    def account_for(
        self, file: str, data: bytes, account: Account, reported: set[int | None]
    ) -> None:
        can_accounting.account_for_sym(_text(data), account)


class _Xml(_Database):
    needs = ("cantools", "defusedxml")
    root = ""

    def knows(self, start: str) -> bool:
        return safe_xml.root_of(start) == self.root

    def database(self, file: str, data: bytes, to: Definitions) -> Any:
        safe_xml.parse(file, data)  # cantools would expand entities
        return super().database(file, data, to)


class Kcd(_Xml):
    """Kayak CAN definitions (KCD)."""

    name, root = "kcd", "NetworkDefinition"
    title = "a CAN definition (KCD)"

    def account_for(
        self, file: str, data: bytes, account: Account, reported: set[int | None]
    ) -> None:
        can_accounting.account_for_kcd(
            safe_xml.parse(file, data, account=Account()), account
        )


class Arxml(_Xml):
    """AUTOSAR system descriptions (ARXML), limited to CAN."""

    name, root = "arxml", "AUTOSAR"
    title = "an AUTOSAR system description (ARXML)"
    # larger than for other kinds, because the format is verbose
    most_bytes = 64_000_000

    def account_for(
        self, file: str, data: bytes, account: Account, reported: set[int | None]
    ) -> None:
        can_accounting.account_for_arxml(
            safe_xml.parse(file, data, account=Account()), account
        )


def _text(data: bytes) -> str:
    try:
        return data.decode("utf-8-sig")
    except UnicodeDecodeError:
        # A DBC declares no encoding. Tools for Windows write its code page.
        return data.decode("cp1252", "replace")


def _buses(database: Any) -> dict[str, list[Any]]:
    """Return the messages by bus if the database has several buses."""
    buses: dict[str, list[Any]] = {}
    for message in getattr(database, "messages", ()):
        buses.setdefault(message.bus_name or "", []).append(message)
    return (
        buses
        if len(buses) > 1
        else {"": [message for messages in buses.values() for message in messages]}
    )


def _network(
    title: str, messages: list[Any], account: Account, to: Definitions
) -> Network:
    # With both frame formats on a bus, bit 31 of the id marks extended frames.
    formats = {bool(message.is_extended_frame) for message in messages}
    if len(formats) > 1:
        id_bits = CAN_BOTH
    else:
        id_bits = CAN_EXTENDED if True in formats else CAN_STANDARD
    order = frames.usual_order(
        signal_place(signal) for message in messages for signal in message.signals
    )
    head = {**frames.ORDERS[order], "id_bits": id_bits}
    network, enums = Network(node_name(title + ".can"), title, head), Enumerations()
    for message in messages:
        to.total += 1
        id = message.frame_id | (
            CAN_EXTENDED_FLAG
            if id_bits == CAN_BOTH and message.is_extended_frame
            else 0
        )
        of, signals = (
            AccountedObject(message),
            [AccountedObject(signal) for signal in message.signals],
        )
        try:
            network.messages.append(_message(of, signals, id, order, enums, to))
        except NotSupported as why:
            to.left_out(message.name, why)
            continue
        account.attributes(of, "message", f"`{message.name}`")
        for signal in signals:
            account.attributes(
                signal, "signal", f"message `{message.name}`, `{signal.name}`"
            )
    network.name_messages_apart(to)
    network.declare(enums.declared())
    return network


class _PlacedField(NamedTuple):
    """Field of a message, its bits in the frame, and the names of its raw values."""

    field: Item
    place: frames.FrameBits
    value_names: dict[int, str]


def _message(
    message: Any,
    signals: list[Any],
    id: int,
    order: str,
    enums: Enumerations,
    to: Definitions,
) -> Item:
    if message.is_container:
        raise NotSupported(
            "it contains other messages in an order that differs from frame to frame"
        )
    # At least three hexadecimal digits, as CAN ids are usually printed.
    item: Item = {"name": message.name, "id": Spelled(f"{id:#05X}".replace("X", "x"))}
    item |= {"kind": "telemetry", "length": message.length}
    senders = [sender for sender in message.senders if sender not in _UNKNOWN_SENDERS]
    if senders:
        item["group"] = senders[0]
    cycle = message.cycle_time
    # The key takes whole numbers; any other cycle becomes a sentence.
    is_whole = isinstance(cycle, int) and cycle > 0
    if is_whole:
        item["period_ms"] = cycle
    item |= summary(
        _sentences(
            message.comment,
            f"Sent every {printed(cycle)} ms." if cycle and not is_whole else "",
            f"Also sent by {', '.join(senders[1:])}." if len(senders) > 1 else "",
        )
    )
    placed: list[_PlacedField] = []
    for signal in signals:
        place = signal_place(signal)
        if not 0 <= place.at <= place.at + place.bits <= 8 * message.length:
            where = "begins before" if place.at < 0 else "ends behind"
            what = f"message `{message.name}`: `{signal.name}` {where} its {message.length} bytes"
            to.warn(BEYOND_FRAME, what, "the signal is left out", "error")
            signal.settle()
            continue
        try:
            field = _field(message, signal, signals, enums, to)
        except NotSupported as why:
            to.without_field(message.name, signal.name, why)
            signal.settle()
            continue
        # SYM declares a signal of several multiplexer values several times. These
        # become one field, unless their values have other names.
        value_names = _value_names(signal)
        same = next(
            (
                candidate.field
                for candidate in placed
                if candidate.place == place
                and candidate.value_names == value_names
                and _is_alternative(candidate.field, field)
            ),
            None,
        )
        if same is None:
            placed.append(_PlacedField(field, place, value_names))
        else:
            (by,) = field["when"]
            same["when"] = {
                by: [
                    *frames.values_of_condition(same["when"][by]),
                    *frames.values_of_condition(field["when"][by]),
                ]
            }
    fields = [candidate.field for candidate in placed]
    _name_fields_apart(message.name, fields, to)
    # A multiplexer that was left out takes the signals that depend on it along.
    missing = {name for field in fields for name in field.get("when", ())} - {
        field["name"] for field in fields
    }
    for field in fields:
        if missing & set(field.get("when", ())):
            to.without_field(
                message.name,
                field["name"],
                "the multiplexer that it depends on is left out",
            )
    return frames.laid_out(
        item,
        [
            (field, place)
            for field, place, _ in placed
            if not missing & set(field.get("when", ()))
        ],
        order,
        to,
    )


def _sentences(*texts: str | None) -> str:
    """Join texts to sentences, each with a full stop."""
    plain = [text for each in texts if (text := line(each))]
    return " ".join(
        text if text.endswith((".", "!", "?")) or len(plain) == 1 else f"{text}."
        for text in plain
    )


def _is_alternative(field: Item, other: Item) -> bool:
    """Return whether two fields are the same signal, declared for several values of a
    multiplexer (SYM).

    The caller compares the names of their values, because the key `enum` is set later
    (`Enumerations.declared`).
    """
    plain = [
        {key: value for key, value in item.items() if key not in ("when", "enum")}
        for item in (field, other)
    ]
    return (
        plain[0] == plain[1]
        and "when" in field
        and field["when"].keys() == other.get("when", {}).keys()
    )


def _name_fields_apart(owner: str, fields: list[Item], to: Definitions) -> None:
    """Add a value of the multiplexer to the name of a field that an earlier field has
    (IMP092).

    SYM files declare different signals of equal name for several values.
    """
    names: set[str] = set()
    for field in fields:
        name = field["name"]
        if name in names and "when" in field:
            ((multiplexer, condition),) = field["when"].items()
            value = frames.values_of_condition(condition)[0]
            field["name"] = f"{name} {multiplexer} {value}"
            text = f"message `{owner}`: several signals have the name `{name}`: one is imported as `{field['name']}`"
            help = "rename it in the ICD if you want another name"
            to.warn(SAME_NAME, text, help, "note")
        names.add(field["name"])


def signal_place(signal: Any) -> frames.FrameBits:
    """Return the position of a signal of any of the four formats.

    cantools numbers bits as DBC does: from the least significant bit of a byte, in both
    byte orders.
    """
    if signal.byte_order == "little_endian":
        return frames.FrameBits(signal.start, signal.length, frames.LITTLE)
    # A big-endian signal starts at its most significant bit, from which `BIG`
    # counts as well.
    return frames.FrameBits(
        signal.start // 8 * 8 + 7 - signal.start % 8, signal.length, frames.BIG
    )


def _field(
    message: Any, signal: Any, signals: list[Any], enums: Enumerations, to: Definitions
) -> Item:
    kind = "int" if signal.is_signed else "uint"
    if signal.is_float:
        kind = "float"
    start = (
        ""
        if signal.raw_initial is None
        else f"Start value: {printed(signal.raw_initial)} (raw)."
    )
    field: Item = {
        "name": signal.name,
        "type": kind,
        **unit(signal.unit),
        **summary(_sentences(signal.comment, start)),
    }
    factor, offset = printed(signal.scale), printed(signal.offset)
    first, last = _range(signal)
    # A negative factor swaps the ends.
    ends = sorted(
        Fraction(factor) * value + Fraction(offset) for value in (first, last)
    )
    low, high = (
        None if end is None else Fraction(printed(end))
        for end in (signal.minimum, signal.maximum)
    )
    field |= formula(factor, offset) | limits(low, high, ends[0], ends[1])
    where = f"message `{message.name}`, `{signal.name}`"
    for limit, end in ((low, signal.minimum), (high, signal.maximum)):
        if limit is None or abs(limit) < MOST_LIMIT:
            continue
        if ends[0] < limit < ends[1]:
            text = f"{where}: the limit {printed(end)} is not used"
            help = (
                "limits have at most 38 digits: state it in the `summary` of the field"
            )
            to.warn(UNUSED, text, help, "note")
    if choices := _value_names(signal):
        enums.assign_value_names(
            field, signal.length, choices, signal.name, message.name, where, to
        )
    elif _is_flag(signal):
        field["type"] = "bool"
        field.pop("unit", None)
    if (invalid := signal.raw_invalid) is not None and field["type"] in ("uint", "int"):
        if first <= invalid <= last and invalid not in choices:
            field["special"] = [
                *field.get("special", ()),
                {"value": int(invalid), "meaning": "invalid"},
            ]
    if when := _condition(signal, signals, where, to):
        field["when"] = when
    return field


def _value_names(signal: Any) -> dict[int, str]:
    """Return the names of raw values of a signal."""
    return {int(value): str(name) for value, name in (signal.choices or {}).items()}


def _is_flag(signal: Any) -> bool:
    """Return whether a signal is a single bit without scale, sign or labels."""
    is_plain = not (signal.choices or signal.is_signed or signal.is_float)
    return is_plain and signal.length == 1 and (signal.scale, signal.offset) == (1, 0)


def _range(signal: Any) -> tuple[int, int]:
    """Return the smallest and largest raw value.

    For floats, these are powers of two below the largest finite number: limits such as
    3.4E+38, the rounded range of the type, state nothing.
    """
    if signal.is_float:
        largest = 2**1023 if signal.length == 64 else 2**127
        return -largest, largest
    return integer_range(signal.length, signal.is_signed)


def _condition(signal: Any, signals: list[Any], where: str, to: Definitions) -> Item:
    """Return the multiplexer and its values for which the signal is present.

    Values that the multiplexer cannot have are left out (IMP076).
    """
    if signal.multiplexer_ids is None:
        return {}
    name = signal.multiplexer_signal
    multiplexer = next(
        (candidate for candidate in signals if candidate.name == name), None
    )
    if multiplexer is None:
        raise NotSupported(
            f"it depends on `{name}`, which is not a signal of the message"
        )
    if multiplexer.multiplexer_ids is not None:
        raise NotSupported(f"it depends on `{name}`, which is optional itself")
    if multiplexer.is_float or (multiplexer.scale, multiplexer.offset) != (1, 0):
        raise NotSupported(f"it depends on `{name}`, which is scaled or not an integer")
    first, last = integer_range(multiplexer.length, multiplexer.is_signed)
    values = sorted(set(signal.multiplexer_ids))
    within = [value for value in values if first <= value <= last]
    if not within:
        raise NotSupported(f"it depends on values of `{name}` that it cannot have")
    if beyond := [value for value in values if value not in within]:
        shown = ", ".join(map(str, beyond[:5])) + (" ..." if len(beyond) > 5 else "")
        text = f"{where}: it depends on `{name}`, which never has the value {shown}"
        to.warn(CONTRADICTION, text, "the other values are imported")
    condition: list[Any] = (
        [bool(value) for value in within] if _is_flag(multiplexer) else within
    )
    return {name: condition[0] if len(condition) == 1 else condition}
