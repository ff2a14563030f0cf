"""Reader of MAVLink dialects: messages and enumerations of an XML file and its
includes, with the framing of version 2 or 1.

Fields are in the order of transmission (largest type first, then extensions), and the
framing contains CRC_EXTRA of each message, as pymavlink computes it.
"""

from __future__ import annotations

import os
import re
from collections.abc import Iterator
from fractions import Fraction
from pathlib import Path
from typing import Any
from xml.etree.ElementTree import Element

from icdgen.definitions import kinds, safe_xml
from icdgen.definitions.accounting import Account, settle
from icdgen.definitions.enumerations import BEYOND, is_enumeration, members, special
from icdgen.definitions.model import (
    Definitions,
    Item,
    Network,
    NotSupported,
    unreadable,
)
from icdgen.definitions.wording import line, node_name, summary, unit
from icdgen.frozen import NamedTuple
from icdgen.icd.fmt.emit import Spelled
from icdgen.icd.layout import integer_range

TWICE = "IMP077"
MOST_FILES = 100
# Attributes for the display in ground stations, and the number of the dialect.
_WITHOUT_MEANING = frozenset(
    {
        "dialect",
        "print_format",
        "display",
        "schemaLocation",
        "noNamespaceSchemaLocation",
    }
)
_BITS = {"int8_t": 8, "uint8_t": 8, "char": 8, "int16_t": 16, "uint16_t": 16, "int32_t": 32, "uint32_t": 32,
         "int64_t": 64, "uint64_t": 64, "float": 32, "double": 64}  # fmt: skip
_VERSION_FIELD = "uint8_t_mavlink_version"
# Units with a factor. For integers, the base unit is imported, and the factor as a
# formula.
_SCALED = {
    "degE7": ("deg", "1e-7"), "degE5": ("deg", "1e-5"), "cdeg": ("deg", "0.01"), "ddeg/s": ("deg/s", "0.1"),
    "cm/s": ("m/s", "0.01"), "dm/s": ("m/s", "0.1"), "mm/s": ("m/s", "0.001"), "dm": ("m", "0.1"), "dam": ("m", "10"),
    "cdegC": ("C", "0.01"), "cA": ("A", "0.01"), "cV": ("V", "0.01"), "c%": ("%", "0.01"), "d%": ("%", "0.1"),
    "mrad/s": ("rad/s", "0.001"), "hPa": ("Pa", "100"), "hJ": ("J", "100"), "ds": ("s", "0.1"), "cs": ("s", "0.01"),
}  # fmt: skip
_SPELLED = {"m/s/s": "m/s^2", "bits/s": "bit/s", "bytes": "byte"}
# Two digits of an exponent are enough: `2**999999999` would take all memory.
_NUMBER = re.compile(
    r"\s*(-?(?:0[xX][0-9A-Fa-f]+|[0-9]+))\s*(?:(<<|\*\*)\s*([0-9]{1,2})\s*)?\Z"
)
# CRC-16/MCRF4XX. MAVLink calls it X.25, but X.25 inverts the result.
_X25 = {"kind": "crc", "width": 16, "polynomial": Spelled("0x1021"), "init": Spelled("0xFFFF"),
        "reflect_in": True, "reflect_out": True, "xor_out": 0}  # fmt: skip


class _Field(NamedTuple):
    """Field of the XML. ``elements`` is 0 unless the field is an array."""

    name: str
    type: str
    elements: int
    element: Element

    @property
    def bits(self) -> int:
        """Width of all elements."""
        return _BITS[self.type] * max(self.elements, 1)


class MavLink2:
    """Reader of a dialect for MAVLink 2: ids of 24 bits, extension fields, and
    truncation of trailing zeros.
    """

    name = "mavlink"
    title = "a MAVLink dialect"
    needs: tuple[str, ...] = ("defusedxml",)
    starts_with = "0xFD"
    id_bits = 24
    has_extensions = True

    def knows(self, start: str) -> bool:
        return safe_xml.root_of(start) == "mavlink"

    def read(self, file: str, data: bytes) -> Definitions:
        """Return the messages of a dialect and its includes.

        Raises `Findings` if one of the files cannot be read.
        """
        to, account = Definitions(file), Account(_WITHOUT_MEANING)
        roots = dict(_with_included(file, data, account))
        enums = _enumerations(roots, to)
        stem = Path(file).stem
        network = Network(
            node_name(file), f"MAVLink {stem}", {"byte_order": "little", "bit_order": "lsb0", "id_bits": self.id_bits},
            protocol=self.protocol(),
        )  # fmt: skip
        # The mapping inside of the section `protocol`, which the messages fill below.
        seeds = network.seeds = network.protocol["link"]["checksums"]["x25"]["seeds"]  # type: ignore[index]
        for path, root in roots.items():
            versions = (node.text or "" for node in root.iter("version"))
            version = next(
                (int(text) for text in versions if text.strip().isdigit()), 2
            )
            for element in root.iterfind("messages/message"):
                name, id = element.get("name", ""), _number(element.get("id", ""))
                if id is not None and id >> self.id_bits and not self.has_extensions:
                    settle(element)
                    continue  # MAVLink 1 has no ids above 255
                to.total += 1
                try:
                    if id is None or id >> self.id_bits:
                        raise NotSupported(f"its id is `{element.get('id', '')}`")
                    seeds[name], item = self._message(
                        element, name, id, enums, version, to
                    )
                except NotSupported as why:
                    to.left_out(name, why)
                    settle(element)
                    continue
                network.messages.append(
                    item if len(roots) == 1 else {**item, "group": Path(path).stem}
                )
        network.messages.sort(key=lambda message: int(message["id"]))
        in_order = {
            message["name"]: seeds[message["name"]] for message in network.messages
        }
        # Filled again instead of replaced: the section has this very mapping.
        seeds.clear()
        seeds |= in_order
        network.declare(enum for _, enum in sorted(enums.items()))
        to.networks.append(network)
        for root in roots.values():
            account.elements(root)
        account.report(to)
        return to

    def _message(
        self,
        element: Element,
        name: str,
        id: int,
        enums: dict[str, Item],
        version: int,
        to: Definitions,
    ) -> tuple[int, Item]:
        """Return the CRC_EXTRA of a message, and the message of the ICD.

        Raises `NotSupported`.
        """
        base: list[_Field] = []
        more: list[_Field] = []
        is_more = False
        for child in element:
            tag = safe_xml.local(child.tag)
            if tag == "extensions":
                is_more = True
                settle(child)
            if tag == "field":
                (more if is_more else base).append(_field(child))
        # Wire order; the sort is stable for fields of equal width, as MAVLink requires.
        # By the type of an element: the length of an array does not count.
        base.sort(key=lambda field: -_BITS[field.type])
        item: Item = {"name": name, "id": id, "kind": "telemetry", "length": 0}
        if self.has_extensions:
            item["may_end_early"] = "zeros"
        item |= summary(_description(element))
        # Extension fields keep the order of the XML: MAVLink sorts the base fields
        # alone, so that old receivers find these at the same bytes.
        fields, at = [], 0
        for field in (*base, *(more if self.has_extensions else ())):
            fields.append({"at": at, **_icd_field(name, field, enums, version, to)})
            at += field.bits
        item["length"] = at // 8
        if at <= 8:
            # MAVLink 2 never truncates the first byte of the payload.
            item.pop("may_end_early", None)
        return _crc_extra(name, base), {**item, "fields": fields} if fields else item

    def protocol(self) -> Item:
        """Return the section `protocol`.

        Commands have the ids of a ground station (255, 190), telemetry of an autopilot
        (1, 1).
        """
        flags: list[Item] = [
            # Incompatibility flags: no signature.
            {"bits": 8, "role": "constant", "value": 0},
            {"bits": 8, "role": "flags"},
        ]
        header: list[Item] = [
            {"bits": 8, "role": "sync", "value": Spelled(self.starts_with)},
            {"bits": 8, "role": "length"},
            *(flags if self.has_extensions else ()),
            {"bits": 8, "role": "sequence"},
            {
                "bits": 8,
                "role": "source",
                "value": {"telecommand": 255, "telemetry": 1},
            },
            {"bits": 8, "role": "type", "value": {"telecommand": 190, "telemetry": 1}},
            {"bits": self.id_bits, "role": "id"},
        ]
        covers = {"from": "length", "to": "data"}
        checksum: Item = {"bits": 16, "role": "checksum", "checksum": "x25"}
        return {
            "link": {
                "framing": {"by": "length"},
                "header": header,
                "trailer": [{**checksum, "covers": covers}],
                "checksums": {"x25": {**_X25, "seeds": {}}},
            }
        }


class MavLink1(MavLink2):
    """Reader of a dialect for MAVLink 1: ids of 8 bits, no extension fields."""

    name = "mavlink1"
    title = "a MAVLink dialect, of version 1"
    starts_with = "0xFE"
    id_bits = 8
    has_extensions = False

    def knows(self, start: str) -> bool:
        # The XML does not differ from version 2: `--kind mavlink1` selects it.
        return False


def _with_included(
    file: str, data: bytes, account: Account
) -> Iterator[tuple[str, Element]]:
    """Yield the path and root of the XML and of all included files, each once.

    Raises `Findings` for circular includes, and for files that are missing or in
    another folder.
    """
    roots: dict[str, Element] = {}

    def read(path: str, content: bytes, stack: tuple[str, ...]) -> None:
        root = roots[path] = safe_xml.parse(path, content, account=account)
        for element in root.iterfind("include"):
            name = (element.text or "").strip()
            target = os.path.join(os.path.dirname(path), name)
            if not name or os.path.basename(name) != name:
                raise unreadable(
                    path,
                    f"`{line(name, 100)}`, which it includes, is not in its folder",
                    "put it there",
                )
            if target in (*stack, path):
                circle = " -> ".join(
                    map(
                        os.path.basename,
                        (*(*stack, path)[(*stack, path).index(target) :], target),
                    )
                )
                raise unreadable(
                    path,
                    f"files include each other in a circle: {circle}",
                    "take one `include` out",
                )
            if target in roots:
                continue
            if len(roots) >= MOST_FILES:
                raise unreadable(
                    file,
                    f"it includes more than {MOST_FILES} files",
                    "import it in parts",
                )
            if not os.path.isfile(target):
                raise unreadable(
                    path,
                    f"`{name}`, which it includes, is not in its folder",
                    "put it there",
                )
            read(target, kinds.contents(Path(target)), (*stack, path))

    read(file, data, ())
    yield from roots.items()


def _field(element: Element) -> _Field:
    """Return the field of an XML element.

    Raises `NotSupported` if MAVLink has no such type.
    """
    match = re.fullmatch(r"(\w+?)(?:\[([0-9]{1,3})\])?", element.get("type", ""))
    type_ = match[1] if match else ""
    # As in pymavlink, `array` means `int8_t`, and the suffix `_t` is optional.
    if type_ == _VERSION_FIELD:
        type_ = "uint8_t"
    elif type_ == "array":
        type_ = "int8_t"
    elif type_ not in _BITS:
        type_ = f"{type_}_t"
    if match is None or type_ not in _BITS:
        raise NotSupported(
            f"`{element.get('name', '')}` is of the type `{line(element.get('type'), 100)}`"
        )
    return _Field(element.get("name", ""), type_, int(match[2] or 0), element)


def _crc_extra(name: str, fields: list[_Field]) -> int:
    """Return CRC_EXTRA, a checksum of the name and the base fields of a message in 8
    bits.

    It excludes extensions.
    """
    data = f"{name} ".encode()
    for field in fields:
        data += f"{field.type} {field.name} ".encode() + (
            bytes([field.elements]) if field.elements else b""
        )
    # `_X25` over these bytes: 0x8408 is the polynomial 0x1021 with its bits reversed.
    checksum = 0xFFFF
    for byte in data:
        checksum ^= byte
        for _ in range(8):
            checksum = checksum >> 1 ^ (0x8408 if checksum & 1 else 0)
    return checksum & 0xFF ^ checksum >> 8


def _icd_field(
    owner: str, field: _Field, enums: dict[str, Item], version: int, to: Definitions
) -> Item:
    """Return the field of the ICD without its position."""
    element = field.element
    # An array of `char` is one text, not an array.
    if field.type == "char":
        return {
            "bits": field.bits,
            "name": field.name,
            "type": "text",
            **summary(_text(element)),
        }
    if field.type in ("float", "double"):
        kind = "float"
    else:
        kind = "uint" if field.type[0] == "u" else "int"
    bits = _BITS[field.type]
    item: Item = {"bits": bits, "name": field.name, "type": kind}
    item |= {"count": field.elements} if field.elements else {}
    if element.get("type") == _VERSION_FIELD:
        item["const"] = version
    symbol = element.get("units", "")
    unscaled = (_SPELLED.get(symbol, symbol), "1")
    base_unit, factor = unscaled if kind == "float" else _SCALED.get(symbol, unscaled)
    item |= unit(base_unit)
    if kind != "float" and (formula := _formula(factor, element.get("multiplier", ""))):
        item["formula"] = formula
    enum = enums.get(element.get("enum", ""))
    if enum and kind != "float":
        _name_values(item, enum, bits, f"message `{owner}`, `{field.name}`", to)
    invalid = _invalid(element.get("invalid", ""), kind, bits)
    if invalid and "const" not in item:
        named = (
            {member["value"] for member in enum["members"]}
            if enum and item["type"] == "enum"
            else set()
        )
        named |= {value["value"] for value in item.get("special", ())}
        if invalid["value"] not in named:
            item["special"] = [*item.get("special", ()), invalid]
    return {**item, **summary(_text(element))}


def _formula(factor: str, multiplier: str) -> str:
    """Return a formula such as ``raw*0.01``, empty without a scale.

    The multiplier may be a quotient: ``1E-2/3``.
    """
    match = re.fullmatch(
        r"\s*([0-9.]+(?:[eE][-+]?[0-9]+)?)(?:\s*/\s*([0-9]+))?\s*", multiplier
    )
    try:
        scale = Fraction(match[1]) if match else Fraction(1)
    except ValueError:
        return ""
    text = "" if factor == "1" else f"*{factor}"
    text += f"*{match[1].lower()}" if match and scale != 1 else ""
    return f"raw{text}" + (f"/{match[2]}" if match and match[2] else "") if text else ""


def _name_values(
    item: Item, enum: Item, bits: int, where: str, to: Definitions
) -> None:
    """Add an enumeration to an integer field, or its members as special values if the
    field cannot have all of them.
    """
    low, high = integer_range(bits, item["type"] == "int")
    # A value may be named that a narrow field can never have.
    named = [
        member
        for member in enum["members"]
        if low <= member["value"] and member.get("to", member["value"]) <= high
    ]
    if len(named) < len(enum["members"]):
        beyond = next(
            member["value"] for member in enum["members"] if member not in named
        )
        text = f"{where}: it never has the value {beyond} of `{enum['name']}`"
        to.warn(BEYOND, text, "the names of values that it can have are special values")
    elif is_enumeration(item, bits, named):
        item.pop("unit", None)
        item |= {"type": "enum", "enum": enum["name"]}
        return
    if "const" not in item:
        item |= special(
            [
                {key: member[key] for key in ("value", "to", "name") if key in member}
                for member in named
            ],
            where,
            to,
        )


def _invalid(text: str, kind: str, bits: int) -> Item:
    """Return the special value for 'not known': `NaN`, `[NaN]` of arrays, `UINT16_MAX`
    or `-1000`.

    Empty if out of range.
    """
    text = text.strip("[]:, ")
    if kind == "float" and text.lower() == "nan":
        return {"value": "nan", "meaning": "not known"}
    most = re.fullmatch(r"(U?)INT(8|16|32|64)_MAX", text)
    # A signed type has one bit less: `not` is 1 for it.
    value = (1 << int(most[2]) - (not most[1])) - 1 if most else _number(text)
    if value is None:
        return {}
    low, high = integer_range(bits, kind == "int")
    return (
        {"value": value, "meaning": "not known"}
        if kind == "float" or low <= value <= high
        else {}
    )


def _enumerations(roots: dict[str, Element], to: Definitions) -> dict[str, Item]:
    """Return the enumerations by name. Entries from several files are merged."""
    enums: dict[str, dict[int, tuple[str, str]]] = {}
    descriptions: dict[str, str] = {}
    for root in roots.values():
        for enum in root.iterfind("enums/enum"):
            name = enum.get("name", "")
            descriptions[name] = descriptions.get(name) or _description(enum)
            entries = enums.setdefault(name, {})
            for entry in enum.iterfind("entry"):
                # As in pymavlink, an entry without a value continues from the highest
                # one.
                value = _number(entry.get("value", str(max(entries, default=0) + 1)))
                label = entry.get("name", "")
                if value is None:
                    text = f"enumeration `{name}`: `{label}` has the value `{entry.get('value')}`"
                    to.warn(BEYOND, text, "the name is left out")
                elif (
                    entries.setdefault(value, (label, _description(entry)))[0] != label
                ):
                    text = f"enumeration `{name}`: {value} is `{entries[value][0]}` and `{label}`"
                    to.warn(TWICE, text, "the first name is imported")
    return {
        name: _enumeration(name, entries, descriptions[name], to)
        for name, entries in enums.items()
        if entries
    }


def _enumeration(
    name: str, entries: dict[int, tuple[str, str]], description: str, to: Definitions
) -> Item:
    """Return an enumeration.

    Its members lose the words that are common to all of them.
    """
    labels = [label for label, _ in entries.values()]
    prefix = f"{name}_" if len(labels) < 2 else _common_prefix(min(labels), max(labels))
    short = {
        value: label.removeprefix(prefix) or label
        for value, (label, _) in entries.items()
    }
    named = members(short, -(2**63), 2**64 - 1, f"enumeration `{name}`", to)
    for member in named:
        if "to" not in member:
            member |= summary(entries[member["value"]][1])
    return {"name": name, **summary(description), "members": named}


def _common_prefix(first: str, second: str) -> str:
    """Return the common first words of two names, up to an underscore.

    All names between the two in alphabetical order begin with them, too.
    """
    end = next(
        (
            at
            for at, pair in enumerate(zip(first, second, strict=False))
            if pair[0] != pair[1]
        ),
        len(first),
    )
    return first[: first.rfind("_", 0, end) + 1]


def _description(element: Element) -> str:
    """Return the description of a message, enumeration or entry, with its deprecation."""
    text = line(next((_text(child) for child in element.iterfind("description")), ""))
    for deprecation in element.iterfind("deprecated"):
        by = (
            f", replaced by {deprecation.get('replaced_by')}"
            if deprecation.get("replaced_by")
            else ""
        )
        text = f"{text} Deprecated since {deprecation.get('since', '?')}{by}.".strip()
    return text


def _text(element: Element) -> str:
    """Return the text of an element and of all elements within."""
    return "".join(element.itertext())


def _number(text: str) -> Any:
    """Return the value of ``12``, ``0x0C``, ``1<<3`` or ``2**3``, None for any other
    text.
    """
    match = _NUMBER.match(text)
    if match is None:
        return None
    # With the base 0, `int` rejects decimal numbers with zeros in front.
    value = int(match[1], 0) if "x" in match[1].lower() else int(match[1])
    power = int(match[3] or 0)
    if match[2] == "<<":
        return value << power
    return value**power if match[2] else value
