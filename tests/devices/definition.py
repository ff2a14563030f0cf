"""A message of a library as an ICD describes it, or the reason why it cannot."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from fractions import Fraction

from icdgen.icd.units import SPELLINGS, STANDARD

Values = dict[
    str, object
]  # by name of the field; integers, the bits of floats, bytes, lists of these


class NotSupported(ValueError):
    """The format does not support a construct; the text is a short cause, for counting."""


@dataclass
class Definition:
    """One message: its description in an ICD, or the cause why it is not supported.

    It also has the library's own decoder of a frame.
    """

    name: str
    id: int
    kind: str
    length: int
    fields: list[dict]
    enums: list[dict] = field(default_factory=list)
    cause: str = ""
    raw: Callable[[bytes], Values] = lambda _: {}
    physical: Callable[[bytes], Values] = lambda _: {}
    more: dict = field(default_factory=dict)
    structs: list[dict] = field(default_factory=list)
    raw_only: str = ""  # why some of its physical values are not supported
    # Why the library itself decodes no frame of it. Such a message is not counted.
    unread: str = ""
    may_end_early: bool = False  # whether zeros at the end may be cut off
    # the library's own frame of the values of a frame
    encoded: Callable[[bytes], bytes] | None = None

    def tree(self) -> dict:
        """Return the message as it appears in an ICD. Bytes at the end without a field
        are reserved.
        """
        fixed = [field for field in self.fields if "up_to" not in field]
        end = max(
            (field["at"] + field["bits"] * field.get("count", 1) for field in fixed),
            default=0,
        )
        reserved = self.length - -(-end // 8)
        return {
            "name": self.name, "id": self.id, "kind": self.kind, "length": self.length, **self.more,
            **({"reserved": reserved} if reserved > 0 else {}), "fields": self.fields,
        }  # fmt: skip

    @property
    def ends(self) -> list[dict]:
        """The variable-length fields."""
        return [field for field in self.fields if "up_to" in field]

    def parts(self, part: dict) -> list[dict]:
        """Return the fields of the struct of an array; an empty list for other fields."""
        return next(
            (
                struct["fields"]
                for struct in self.structs
                if struct["name"] == part.get("struct")
            ),
            [],
        )

    @property
    def inner(self) -> list[dict]:
        """The variable-length arrays within the elements of the variable-length fields."""
        return [
            part for end in self.ends for part in self.parts(end) if "up_to" in part
        ]

    def element(self, end: dict, counts: dict[str, int] | None = None) -> int:
        """Return the size of an element of a variable-length field in bytes.

        ``counts`` has the numbers of elements of arrays within it, by their counters.
        """
        struct = next(
            (each for each in self.structs if each["name"] == end.get("struct")), None
        )
        if struct is None:
            return end.get("bits", 8) // 8
        size = struct["length"]
        for part in struct["fields"]:
            if "up_to" in part:
                size += self.element(part) * (counts or {})[part["count"]]
            elif "after" in part:
                size += part["bits"] // 8
        return size


def variable_length_field(
    name: str, at: int, bits: int, type_: str, counter: str | dict, most: int
) -> dict:
    """Return a variable-length field at the end of a message.

    Its elements are counted by a field, or it goes up to the end (`rest`). Bytes and
    text are one value.
    """
    number = (
        {"size": counter}
        if type_ in ("bytes", "text")
        else {"bits": bits, "count": counter}
    )
    return {"at": at, "name": name, "type": type_, **number, "up_to": most}


def variable_length_structs(
    owner: str,
    name: str,
    at: int,
    fields: list[dict],
    bits: int,
    counter: str | dict,
    most: int,
) -> tuple[dict, dict]:
    """Return a variable-length array of structs of ``bits`` bits, and its struct.

    Raises `NotSupported`.
    """
    if bits % 8:
        raise NotSupported("a struct that does not end with a byte")
    struct = {"name": f"{owner} {name}", "length": bits // 8, "fields": fields}
    return {
        "at": at,
        "name": name,
        "struct": struct["name"],
        "count": counter,
        "up_to": most,
    }, struct


@dataclass
class Definitions:
    """The messages of one node: a CAN database, or a dialect."""

    node: dict
    messages: list[Definition]
    tree: dict | None = None  # the ICD, if `icdgen import` created it

    @property
    def name(self) -> str:
        return str(self.node["name"])


@dataclass(frozen=True)
class Protocol:
    """A protocol; ``load`` yields its definitions.

    ``load`` raises `ImportError` if the library is not installed.
    """

    name: str
    library: str
    load: Callable[[], Iterator[Definitions]]


def node(name: str, title: str, **more: object) -> dict:
    """Return the head of an ICD."""
    return {
        "name": words(name)[:40].rstrip("_"),
        "title": title,
        "byte_order": "little",
        "bit_order": "lsb0",
        **more,
    }


def words(text: str) -> str:
    """Return words that are valid as the name of a node in every language."""
    plain = re.sub(r"[^a-z0-9]+", "_", text.lower()).strip("_")
    return plain if plain[:1].isalpha() else f"n{plain}"


def unit(text: str | None) -> dict:
    """Return the key of a unit of the built-in table; other units are omitted.

    No value depends on a unit.
    """
    standard = SPELLINGS.get(text or "", text or "")
    return {"unit": standard} if standard in STANDARD else {}


def formula(factor: str, offset: str = "0") -> dict:
    """Return the key of the formula of a factor and an offset, both as printed
    decimals.

    It is empty if the value is the raw value.
    """
    slope, constant = Fraction(factor), Fraction(offset)
    if slope == 1 and constant == 0:
        return {}
    text = (
        "raw" if slope == 1 else f"{'-' if slope < 0 else ''}raw*{factor.lstrip('-')}"
    )
    if constant:
        text += f" {'-' if constant < 0 else '+'} {offset.lstrip('-')}"
    return {"formula": text}


def repeated_names(fields: list[dict]) -> set[str]:
    """Return names that occur more than once; a library keeps only the last of such
    fields.
    """
    return {
        name
        for name, count in Counter(field["name"] for field in fields).items()
        if count > 1
    }
