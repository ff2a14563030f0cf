"""Containers of electronic data sheets as fields one after the other, with what they inherit and hold, and what constrains them."""

from __future__ import annotations

from collections.abc import Hashable
from dataclasses import dataclass, field
from fractions import Fraction
from xml.etree.ElementTree import Element

from icdgen.definitions import eds_parts, eds_ranges, packets
from icdgen.definitions.eds_parts import Line, Part, Told
from icdgen.definitions.eds_sheets import Sheets
from icdgen.definitions.eds_types import ARRAY, CONTAINER, Types, described
from icdgen.definitions.eds_values import whole
from icdgen.definitions.frames import BIG, LITTLE
from icdgen.definitions.model import Item, NotHeld, again
from icdgen.definitions.reading import TooMuch
from icdgen.definitions.wording import line, shortest
from icdgen.icd.tails import MOST_BYTES, MOST_ELEMENTS, REST

UNCHECKED = "IMP082"
MOST_FIELDS = 5000  # of a message
_DEEPEST = 30  # containers that inherit or hold each other, and arrays of arrays
_FIELDS = ("Entry", "FixedValueEntry", "LengthEntry", "ErrorControlEntry")
_PACKET = Line(Fraction(1), Fraction(7))  # by which the length of a space packet makes that of its container


@dataclass
class Structs:
    """Containers of which there are arrays, by themselves."""

    items: dict[Element, Item] = field(default_factory=dict)
    names: set[str] = field(default_factory=set)


@dataclass
class Layout:
    """Everything that a container has, itself and by inheritance."""

    sheets: Sheets
    types: Types
    structs: Structs
    parts: list[Part] = field(default_factory=list)
    constraints: list[Told] = field(default_factory=list)
    told: dict[Hashable, int] = field(default_factory=dict)  # by what is constrained: its only raw value
    at: int = 0
    within: tuple[Element, ...] = ()  # containers in which this one is repeated
    lost: tuple[str, NotHeld] | None = None  # the entry from which on only bytes are imported, and why

    def read(self, container: Element) -> None:
        """Raises `NotHeld`."""
        self._add(container, (), self.within)
        for one in self.constraints:
            part = next((part for part in self.parts if part.path == one.path), None)
            if part is None and self.lost is not None:
                name, why = self.lost
                text = f"it depends on `{line('.'.join(one.path), 100)}`, which is in or behind `{name}`: {why}"
                raise NotHeld(text, why.help)
            raw = eds_parts.constrain(part, one, self.sheets, self.types)
            if raw is not None and part is not None:
                self.told[part.path, part.entry] = raw
        if self.parts and self.parts[-1].bits:
            for part in self.parts:
                if part.entry.tag == "LengthEntry" and len(part.path) == 1:
                    eds_parts.measure(part, -(-self.at // 8), self.sheets)

    def _add(self, container: Element, path: tuple[str, ...], within: tuple[Element, ...]) -> None:
        """What a container and those that it is based on have, and then what they end with."""
        chain = self.chain(container)
        if any(one in within for one in chain) or len(within) > _DEEPEST:
            circle = " -> ".join(one.get("name", "") for one in (*within[-5:], container))
            raise NotHeld(f"containers contain each other in a circle, or too deep: {line(circle, 200)}")
        users = {one: (*within, *chain[: number + 1]) for number, one in enumerate(chain)}  # who has its entries
        for one in reversed(chain):
            self._entries(one, "EntryList", path, users[one])
        for one in chain:
            self._entries(one, "TrailerEntryList", path, users[one])
            for constraint in one.iterfind("ConstraintSet/*"):
                entry = self.sheets.attribute(constraint, "entry")
                self.constraints.append(Told((*path, *entry.replace("/", ".").split(".")), constraint))

    def chain(self, container: Element) -> list[Element]:
        """A container, and those that it is based on. Raises `NotHeld` for a circle."""
        chain = [container]
        while base := self.sheets.attribute(chain[-1], "baseType"):
            self.types.step()
            found = self.sheets.find("type", base, chain[-1])
            if found.tag != CONTAINER:
                raise NotHeld(f"it is based on `{line(base, 60)}`, which is not a container")
            if found in chain or len(chain) > _DEEPEST:
                circle = " -> ".join(one.get("name", "") for one in (*chain[-5:], found))
                raise NotHeld(f"containers are based on each other in a circle, or too deep: {line(circle, 200)}")
            chain.append(found)
        return chain

    def _entries(self, container: Element, tag: str, path: tuple[str, ...], within: tuple[Element, ...]) -> None:
        for entry in container.iterfind(f"{tag}/*"):
            if self.lost is not None:
                break
            before, at = len(self.parts), self.at
            try:
                self._placed(entry, path, within)
            except TooMuch:
                raise
            except NotHeld as why:
                self._lose(entry, path, why, before, at)

    def _lose(self, entry: Element, path: tuple[str, ...], why: NotHeld, before: int, at: int) -> None:
        """Holds the bytes from an entry to the end instead of its fields. Raises ``why`` if there are none ahead."""
        if self.lost is not None or not before or at % 8 or not self.parts[before - 1].bits:
            raise why
        del self.parts[before:]
        name = line(entry.get("name"), 100) or f"unnamed {at}"
        item: Item = {"type": "bytes", "up_to": MOST_BYTES}
        self.parts.append(Part((*path, name), entry, item, at, 0, element=8))
        self.at, self.lost = at, (name, why)

    def _placed(self, entry: Element, path: tuple[str, ...], within: tuple[Element, ...]) -> None:
        """Puts an entry where the last one ended. Raises `NotHeld`."""
        self.types.step()
        name = line(self.sheets.attribute(entry, "name"), 100) or f"unnamed {self.at}"
        if entry.find("PresentWhen") is not None:
            raise NotHeld(f"`{name}` is present only on a condition")
        if self.parts and not self.parts[-1].bits:
            raise NotHeld(f"`{name}` follows `{self.parts[-1].path[-1]}`, whose length is not fixed")
        if entry.tag == "PaddingEntry":
            self.at += whole(self.sheets.attribute(entry, "sizeInBits"), "the size of a padding", 0, 8 * MOST_BYTES)
        elif entry.tag in (*_FIELDS, "ListEntry"):
            self._entry(entry, name, path, within)
        else:
            raise NotHeld(f"it has a `{line(entry.tag, 60)}`")
        if len(self.parts) > MOST_FIELDS or self.at > 8 * MOST_BYTES:
            raise NotHeld(f"it has more than {MOST_FIELDS} fields or {MOST_BYTES} bytes")

    def _entry(self, entry: Element, name: str, path: tuple[str, ...], within: tuple[Element, ...]) -> None:
        type_, count = self._element(entry, name)
        path = (*path, name)
        if type_.tag == CONTAINER:
            self._is_one(type_, name)
        if entry.tag == "ListEntry":
            self._list(entry, type_, count, path, within)
        elif type_.tag == CONTAINER and count == 1:
            if entry.tag != "Entry":
                raise NotHeld(f"`{name}` is a container, and has a value")
            self._add(type_, path, within)
        elif type_.tag == CONTAINER:
            item, bits = self._struct(type_, name, within)
            self._put(Part(path, entry, {**item, "count": count, **described(entry)}, self.at, bits * count))
        else:
            piece = self.types.piece(type_, entry, f"`{name}`")
            if entry.tag == "FixedValueEntry":
                eds_parts.fix(piece, self.sheets.attribute(entry, "fixedValue"), name)
            part = Part(path, entry, piece.item, self.at, piece.bits, piece)
            if count != 1:
                self._repeat(part, count, name)
            again(part.item, {**part.item, **self._said(entry, name)})
            if not piece.bits:
                part.element = 8
            self._put(part)

    def _put(self, part: Part) -> None:
        little = part.piece is not None and part.piece.order == LITTLE
        if part.at % 8 and (little or "struct" in part.item):
            raise NotHeld(f"`{part.path[-1]}` begins within a byte")
        self.parts.append(part)
        self.at += part.bits

    def _said(self, entry: Element, name: str) -> dict[str, str]:
        """What it is for; of an error control also how it is computed, for nothing else says so."""
        found = described(entry)
        if entry.tag != "ErrorControlEntry":
            return found
        kind = line(self.sheets.attribute(entry, "errorControlType"), 60) or "an error control"
        if self.types.is_new(("error control", entry)):
            message = f"`{name}` is {kind} of what is in the frame"
            help = "it is a field like others, neither checked nor set"
            self.types.to.warn(UNCHECKED, message, help, line=self.sheets.line(entry))
        text = found.get("summary", "")
        return {"summary": f"{text}{'' if text.endswith(('.', '!', '?')) else '.'} {kind}." if text else f"{kind}."}

    def _is_one(self, container: Element, name: str) -> None:
        """Refuses what may be any of several containers. Raises `NotHeld`."""
        if self.sheets.says(container, "abstract"):
            raise NotHeld(f"`{name}` is any container that is based on `{container.get('name', '')}`")

    def _element(self, entry: Element, name: str) -> tuple[Element, int]:
        """The type of an entry, or of its elements, and how many there are. Raises `NotHeld`."""
        type_ = self.sheets.find("type", self.sheets.attribute(entry, "type"), entry)
        count, depth = self._count(entry, "ArrayDimensions/Dimension", name), 0
        while type_.tag == ARRAY:
            self.types.step()
            count *= self._count(type_, "DimensionList/Dimension", name)
            type_, depth = self.sheets.find("type", self.sheets.attribute(type_, "dataTypeRef"), type_), depth + 1
            if depth > _DEEPEST:
                raise NotHeld(f"`{name}` is an array of itself, or of too many others")
            if count > 8 * MOST_BYTES:
                raise NotHeld(f"`{name}` is an array of {count:,} elements")
        return type_, count

    def _count(self, owner: Element, path: str, name: str) -> int:
        """Of several dimensions all elements; the index of the last one runs fastest."""
        count = 1
        for one in owner.iterfind(path):
            if index := self.sheets.attribute(one, "indexTypeRef"):
                count *= self._indices(self.sheets.find("type", index, one), name)
            else:
                count *= whole(self.sheets.attribute(one, "size"), f"a dimension of `{name}`", 1, 8 * MOST_BYTES)
            if count > 8 * MOST_BYTES:
                raise NotHeld(f"`{name}` is an array of {count:,} elements")
        return count

    def _indices(self, type_: Element, name: str) -> int:
        """How many elements an array has whose index is of a type."""
        chain = self.types.chain(type_)
        values = [value for _, value in self.sheets.labels(chain[-1])]
        if values:
            return max(values) - min(values) + 1
        low, high = self.types.piece(type_, type_, f"the index of `{name}`").range.of_integers()
        if low is None or high is None or high < low:
            raise NotHeld(f"the definition does not state how many elements `{name}` has")
        return int(high - low) + 1

    def _repeat(self, part: Part, count: int, name: str) -> None:
        """Makes an array of a scalar; one of bytes that is longer than any is bytes. Raises `NotHeld`."""
        item, bits = part.item, part.bits
        if not bits or "const" in item:
            raise NotHeld(f"`{name}` is an array of elements of variable length, or of a constant")
        if count > MOST_ELEMENTS and bits == 8 and item["type"] == "uint":
            item.clear()
            item["type"] = "bytes"
        elif count > MOST_ELEMENTS:
            raise NotHeld(f"`{name}` is an array of {count:,} elements")
        else:
            item |= {"bits": bits, "count": count}
        part.bits = bits * count

    def _struct(self, container: Element, name: str, within: tuple[Element, ...]) -> tuple[Item, int]:
        """The key of the struct that elements are, and the bits of one. Raises `NotHeld`."""
        known = self.structs.items.get(container)
        if known is None:
            inner = Layout(self.sheets, self.types, self.structs, within=within)
            inner.read(container)
            if inner.at % 8 or not inner.at or any(not part.bits for part in inner.parts):
                raise NotHeld(f"`{name}` is an array of containers of different or partial bytes")
            called = container.get("name", "")
            if called in self.structs.names:
                called = f"{self.sheets.package(container)} {called}"
            self.structs.names.add(called)
            fields = inner.fields(0)
            known = {"name": line(called, 100), "length": inner.at // 8, **described(container), "fields": fields}
            self.structs.items[container] = known
        return {"struct": known["name"]}, 8 * int(known["length"])

    def _list(
        self, entry: Element, type_: Element, count: int, path: tuple[str, ...], within: tuple[Element, ...]
    ) -> None:
        """What is there as often as another field says. Raises `NotHeld`."""
        name = path[-1]
        counter = self.sheets.attribute(entry, "listLengthField")
        by = next((one for one in reversed(self.parts) if one.path == (*path[:-1], *counter.split("."))), None)
        if by is None or by.piece is None or by.piece.item["type"] != "uint" or by.piece.bits != by.bits:
            raise NotHeld(
                f"`{name}` is there as often as `{line(counter, 60)}` says, which is not a number in front of it"
            )
        if count != 1 or self.at % 8:
            raise NotHeld(f"`{name}` is a list of arrays, or begins within a byte")
        if type_.tag == CONTAINER:
            item, bits = self._struct(type_, name, within)
        else:
            piece = self.types.piece(type_, entry, f"`{name}`")
            item, bits = piece.item, piece.bits
            order = {"byte_order": LITTLE} if piece.order == LITTLE and bits > 8 else {}
            again(item, {"bits": bits, **item, **order})
        if not bits or bits % 8:
            raise NotHeld(f"`{name}` is a list of elements without a fixed number of bytes")
        _, most = by.piece.range.within(eds_ranges.Range(Fraction(0), Fraction((1 << by.bits) - 1))).of_integers()
        item["up_to"] = max(1, min(int(most or 1), MOST_ELEMENTS))
        item |= {key: text for key, text in described(entry).items() if key not in item or "struct" in item}
        self.parts.append(Part(path, entry, item, self.at, 0, None, bits, by.path))

    def header(self) -> packets.Header | None:
        """The primary header of a space packet, if it begins with one."""
        ahead = self.parts[: packets.MOST_PARTS]
        plain = [one for one in ahead if one.piece is not None and one.piece.bits == one.bits]
        found = packets.header((one.at, one.bits, one.item.get("const")) for one in plain)
        length = next((one for one in ahead if one.end == packets.HEADER_BITS), None)
        if found is None or length is None:
            return None
        is_line = length.entry.find("PolynomialCalibrator") is not None
        return None if is_line and eds_parts.line_of(length.entry, self.sheets) != _PACKET else found

    def front(self) -> tuple[Hashable, int] | None:
        """What it begins with, and its bits, if a header can have it as an id."""
        part = next(iter(self.parts), None)
        if part is None or part.piece is None or part.at or part.bits not in (8, 16, 24, 32):
            return None
        is_id = part.piece.order == BIG and part.item["type"] in ("uint", "enum") and "formula" not in part.item
        return ((part.path, part.entry), part.bits) if is_id else None

    def fields(self, start: int) -> list[Item]:
        """As they stand in an ICD, from a bit on. Raises `NotHeld`."""
        parts = [one for one in self.parts if one.at >= start]
        made: list[Item] = []
        names = shortest([_telling(one.path) for one in parts])
        called = {one.path: name for one, name in zip(parts, names, strict=True)}
        for part, name in zip(parts, names, strict=True):
            if not part.bits:
                made.append(again(part.item, self._open(part, name, called, start)))
            elif "struct" in part.item:
                made.append({"at": part.at - start, "name": name, **part.item})
            else:
                bits = int(part.item.get("bits", part.bits))
                little = part.piece is not None and part.piece.order == LITTLE and bits > 8
                place = {"at": part.at - start, "bits": bits, "name": name}
                order = {"byte_order": LITTLE} if little and part.item["type"] not in ("bytes", "text") else {}
                made.append(again(part.item, {**place, **part.item, **order}))
        return made

    def _open(self, part: Part, name: str, called: dict[tuple[str, ...], str], start: int) -> Item:
        """What ends a message: counted by a field, by the length of the frame that a field has, or up to the end."""
        if part.at % 8:
            raise NotHeld(f"`{name}`, whose length is not fixed, begins within a byte")
        ahead = (part.at - start) // 8
        room = max(1, (MOST_BYTES - ahead) // (part.element // 8))
        place = {"at": part.at - start, "name": name}
        if part.counter:
            if part.counter not in called:
                raise NotHeld(f"`{name}` is counted by a field of the header")
            return {**place, **part.item, "count": called[part.counter], "up_to": min(room, part.item["up_to"])}
        size: object = REST
        for one in self.parts:
            is_length = one.entry.tag == "LengthEntry" and len(one.path) == 1 and one.path in called
            if not is_length or one.item["type"] != "uint":
                continue
            how = eds_parts.line_of(one.entry, self.sheets)
            if how is not None and how.factor == 1 and how.offset.denominator == 1:
                plus = int(how.offset) - part.at // 8
                size = {"field": called[one.path], "plus": plus} if plus else called[one.path]
        return {**place, **part.item, "size": size, "up_to": min(room, part.item["up_to"])}


def _telling(path: tuple[str, ...]) -> tuple[str, ...]:
    """Words of a path, the last of which tells something: a value is that of what it is in."""
    return (*path[:-2], f"{path[-2]} {path[-1]}") if len(path) > 1 and path[-1].casefold() == "value" else path
