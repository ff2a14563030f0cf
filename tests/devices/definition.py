"""A library's message as an ICD says it, or why it cannot."""

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
    """The format cannot say this; the text is the cause, short enough to be counted."""


@dataclass
class Definition:
    """One message: what an ICD says of it, or why it cannot be said; and the library's
    own reading of a frame.
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
    raw_only: str = ""  # why some physical values of it cannot be said
    # Why the library itself reads no frame of it, so that it is no message to be held.
    unread: str = ""
    may_end_early: bool = False  # whether zeros at the end may be cut off
    # the library's own frame of the values of a frame
    encoded: Callable[[bytes], bytes] | None = None

    def tree(self) -> dict:
        """As it stands in an ICD; bytes at the end that nothing describes are reserved."""
        closed = [one for one in self.fields if "up_to" not in one]
        end = max(
            (one["at"] + one["bits"] * one.get("count", 1) for one in closed), default=0
        )
        rest = self.length - -(-end // 8)
        return {
            "name": self.name, "id": self.id, "kind": self.kind, "length": self.length, **self.more,
            **({"reserved": rest} if rest > 0 else {}), "fields": self.fields,
        }  # fmt: skip

    @property
    def ends(self) -> list[dict]:
        """The fields of which not every frame has all."""
        return [one for one in self.fields if "up_to" in one]

    def parts(self, part: dict) -> list[dict]:
        """The fields of the struct that a part is made of; none where it is a field."""
        return next(
            (
                one["fields"]
                for one in self.structs
                if one["name"] == part.get("struct")
            ),
            [],
        )

    @property
    def inner(self) -> list[dict]:
        """The arrays of variable length in elements of the ends."""
        return [
            part for end in self.ends for part in self.parts(end) if "up_to" in part
        ]

    def element(self, end: dict, counts: dict[str, int] | None = None) -> int:
        """Bytes of an element of the open end, whose arrays have as many elements as
        ``counts`` says by the counters.
        """
        struct = next(
            (one for one in self.structs if one["name"] == end.get("struct")), None
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


def open_end(
    name: str, at: int, bits: int, type_: str, counter: str | dict, most: int
) -> dict:
    """What ends a message of variable length: elements that a field counts, or up to
    the end (`rest`); bytes and text as one.
    """
    number = (
        {"size": counter}
        if type_ in ("bytes", "text")
        else {"bits": bits, "count": counter}
    )
    return {"at": at, "name": name, "type": type_, **number, "up_to": most}


def open_structs(
    owner: str,
    name: str,
    at: int,
    fields: list[dict],
    bits: int,
    counter: str | dict,
    most: int,
) -> tuple[dict, dict]:
    """Likewise with elements that are structs of so many bits: the field, and the
    struct.

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
    """The messages that stand in one node: a CAN database, a dialect."""

    node: dict
    messages: list[Definition]
    tree: dict | None = None  # the ICD, where `icdgen import` made it

    @property
    def name(self) -> str:
        return str(self.node["name"])


@dataclass(frozen=True)
class Protocol:
    """``load`` gives the definitions; it raises `ImportError` where the library is not
    installed.
    """

    name: str
    library: str
    load: Callable[[], Iterator[Definitions]]


def node(name: str, title: str, **more: object) -> dict:
    """The head of an ICD."""
    return {
        "name": words(name)[:40].rstrip("_"),
        "title": title,
        "byte_order": "little",
        "bit_order": "lsb0",
        **more,
    }


def words(text: str) -> str:
    """Words that every language takes for the name of a node."""
    plain = re.sub(r"[^a-z0-9]+", "_", text.lower()).strip("_")
    return plain if plain[:1].isalpha() else f"n{plain}"


def unit(text: str | None) -> dict:
    """The key of a unit that the built-in table has; others are left out, as no value
    depends on them.
    """
    found = SPELLINGS.get(text or "", text or "")
    return {"unit": found} if found in STANDARD else {}


def formula(factor: str, offset: str = "0") -> dict:
    """The key of the formula of a factor and an offset as they are printed; none where
    the raw value is meant.
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


def twice(fields: list[dict]) -> set[str]:
    """Names that stand there more than once: a library keeps only the last of them."""
    return {
        name
        for name, count in Counter(one["name"] for one in fields).items()
        if count > 1
    }
