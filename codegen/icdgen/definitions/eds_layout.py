"""Containers of electronic data sheets as fields one after the other, with what they inherit and hold, and what constrains them."""

from __future__ import annotations

from collections.abc import Hashable, Mapping
from dataclasses import dataclass, field
from fractions import Fraction
from xml.etree.ElementTree import Element

from icdgen.definitions import eds_parts, eds_ranges, packets
from icdgen.definitions.containers import Container, Counter, fixed_field, variable_field
from icdgen.definitions.eds_parts import Line, Part, Told
from icdgen.definitions.eds_sheets import Sheets
from icdgen.definitions.eds_types import ARRAY, CONTAINER, Types, described
from icdgen.definitions.eds_values import whole
from icdgen.definitions.frames import LITTLE
from icdgen.definitions.model import Item, NotHeld, again
from icdgen.definitions.reading import TooMuch
from icdgen.definitions.wording import line, shortest
from icdgen.icd.variable_length import MOST_BYTES, MOST_ELEMENTS

UNCHECKED = "IMP082"
_DEEPEST = 30  # containers that inherit or hold each other, and arrays of arrays
_FIELDS = ("Entry", "FixedValueEntry", "LengthEntry", "ErrorControlEntry")
_PACKET = Line(Fraction(1), Fraction(7))  # by which the length of a space packet makes that of its container


@dataclass
class Structs:
    """Containers of which there are arrays, by themselves."""

    items: dict[Element, Item] = field(default_factory=dict)
    names: set[str] = field(default_factory=set)


@dataclass
class Layout(Container[Part]):
    """Parts of a container, its own and inherited ones, with their constraints."""

    sheets: Sheets
    types: Types
    structs: Structs
    constraints: list[Told] = field(default_factory=list)
    told: dict[Hashable, int] = field(default_factory=dict)  # by what is constrained: its only raw value
    within: tuple[Element, ...] = ()  # containers in which this one is repeated

    def read(self, container: Element) -> None:
        """Raises `NotHeld`."""
        self._add(container, (), self.within)
        for constraint in self.constraints:
            part = next((part for part in self.parts if part.path == constraint.path), None)
            if part is None and self.lost is not None:
                raise self.missing(line(".".join(constraint.path), 100))
            raw = eds_parts.constrain(part, constraint, self.sheets, self.types)
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
                name = line(entry.get("name"), 100) or f"unnamed {at}"
                self.lose(Part((*path, name), {}, at, 0, entry=entry), why, before)

    def _placed(self, entry: Element, path: tuple[str, ...], within: tuple[Element, ...]) -> None:
        """Puts an entry where the last one ended. Raises `NotHeld`."""
        self.types.step()
        name = line(self.sheets.attribute(entry, "name"), 100) or f"unnamed {self.at}"
        if entry.find("PresentWhen") is not None:
            raise NotHeld(f"`{name}` is present only on a condition")
        if self.is_open:
            raise NotHeld(f"`{name}` follows `{self.parts[-1].path[-1]}`, whose length is not fixed")
        if entry.tag == "PaddingEntry":
            self.at += whole(self.sheets.attribute(entry, "sizeInBits"), "the size of a padding", 0, 8 * MOST_BYTES)
        elif entry.tag in (*_FIELDS, "ListEntry"):
            self._entry(entry, name, path, within)
        else:
            raise NotHeld(f"it has a `{line(entry.tag, 60)}`")
        self.check_size()

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
            self._put(Part(path, {**item, "count": count, **described(entry)}, self.at, bits * count, entry=entry))
        else:
            piece = self.types.piece(type_, entry, f"`{name}`")
            if entry.tag == "FixedValueEntry":
                eds_parts.fix(piece, self.sheets.attribute(entry, "fixedValue"), name)
            part = Part(path, piece.item, self.at, piece.bits, piece.order, entry=entry, piece=piece)
            if count != 1:
                self._repeat(part, count, name)
            again(part.item, {**part.item, **self._said(entry, name)})
            self._put(part)

    def _put(self, part: Part) -> None:
        if part.at % 8 and (part.order == LITTLE or "struct" in part.item):
            raise NotHeld(f"`{part.path[-1]}` begins within a byte")
        self.add(part)

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
        for element in owner.iterfind(path):
            if index := self.sheets.attribute(element, "indexTypeRef"):
                count *= self._indices(self.sheets.find("type", index, element), name)
            else:
                count *= whole(self.sheets.attribute(element, "size"), f"a dimension of `{name}`", 1, 8 * MOST_BYTES)
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
        by = next((part for part in reversed(self.parts) if part.path == (*path[:-1], *counter.split("."))), None)
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
        self.add(Part(path, item, self.at, 0, element=bits, counter=Counter(by), entry=entry))

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
        """The part at the beginning and its bits, if a header can have it as the id."""
        part = next(iter(self.parts), None)
        if part is None or part.piece is None or not part.is_message_id:
            return None
        return (part.path, part.entry), part.bits

    def fields(self, start: int) -> list[Item]:
        """Return the fields of the ICD from a bit on. Raises `NotHeld`."""
        parts = [part for part in self.parts if part.at >= start]
        called = shortest([_telling(part.path) for part in parts])
        names = {id(part): name for part, name in zip(parts, called, strict=True)}
        fields: list[Item] = []
        for part in parts:
            if not part.bits and part.counter is None:
                part.counter = self._length_of(part, names)
            name, at = names[id(part)], part.at - start
            fields.append(fixed_field(part, name, at) if part.bits else variable_field(part, name, at, names))
        return fields

    def _length_of(self, part: Part, names: Mapping[int, str]) -> Counter | None:
        """Return the field with the length of the container, if it counts the bytes of its last part."""
        counter = None
        for other in self.parts:
            is_length = other.entry.tag == "LengthEntry" and len(other.path) == 1 and id(other) in names
            if is_length and other.item["type"] == "uint":
                length = eds_parts.line_of(other.entry, self.sheets)
                if length is not None and length.factor == 1 and length.offset.denominator == 1:
                    counter = Counter(other, int(length.offset) - part.at // 8)
        return counter


def _telling(path: tuple[str, ...]) -> tuple[str, ...]:
    """Words of a path, the last of which tells something: a value is that of what it is in."""
    return (*path[:-2], f"{path[-2]} {path[-1]}") if len(path) > 1 and path[-1].casefold() == "value" else path
