"""Containers of electronic data sheets as sequences of fields, with inheritance,
nesting and constraints.

An `EdsLayout` reads one container. Its `fields` are the fields of the ICD, and its
`header` is the primary header of a space packet if the container begins with one.
`eds_types` has the fields of types, `eds_parts` the constants.
"""

from __future__ import annotations

from collections.abc import Hashable, Mapping
from dataclasses import dataclass, field
from fractions import Fraction
from xml.etree.ElementTree import Element

from icdgen.definitions import eds_parts, eds_ranges, packets
from icdgen.definitions.containers import (
    Container,
    Counter,
    bits_of_counted,
    fixed_field,
    in_sequence,
    variable_field,
)
from icdgen.definitions.eds_parts import Constraint, EdsPart, LinearConversion
from icdgen.definitions.eds_sheets import Sheets
from icdgen.definitions.eds_types import ARRAY, CONTAINER, EdsTypes, described
from icdgen.definitions.eds_values import integer_value
from icdgen.definitions.frames import LITTLE
from icdgen.definitions.model import Item, NotSupported, replace_keys
from icdgen.definitions.reading import TooMuch
from icdgen.definitions.wording import line, shortest
from icdgen.icd.variable_length import MOST_BYTES, MOST_ELEMENTS

UNCHECKED = "IMP082"
_DEEPEST = 30  # levels of inheritance, nesting, and arrays of arrays
_FIELDS = ("Entry", "FixedValueEntry", "LengthEntry", "ErrorControlEntry")
# Packet data length of CCSDS 133.0-B: bytes after the 6-byte header, minus 1.
_PACKET = LinearConversion(Fraction(1), Fraction(7))


@dataclass
class Structs:
    """Structs of the ICD by container, for containers that are elements of arrays."""

    items: dict[Element, Item] = field(default_factory=dict)
    names: set[str] = field(default_factory=set)


@dataclass
class EdsLayout(Container[EdsPart]):
    """Parts of a container, including inherited ones, with their constraints."""

    sheets: Sheets
    types: EdsTypes
    structs: Structs
    constraints: list[Constraint] = field(default_factory=list)
    # Raw value that a constraint requires, by path and entry.
    constants: dict[Hashable, int] = field(default_factory=dict)
    within: tuple[Element, ...] = ()  # containers in which this one is repeated

    def read(self, container: Element) -> None:
        """Add the parts of a container and apply its constraints.

        Raises `NotSupported` if the container is not supported.
        """
        self._add(container, (), self.within)
        for constraint in self.constraints:
            part = next(
                (part for part in self.parts if part.path == constraint.path), None
            )
            if part is None and self.lost is not None:
                raise self.missing(line(".".join(constraint.path), 100))
            if part is not None and self.is_behind(part):
                raise NotSupported(
                    f"it depends on `{part.path[-1]}`, which follows a part of variable length"
                )
            raw = eds_parts.apply_constraint(part, constraint, self.sheets, self.types)
            if raw is not None and part is not None:
                self.constants[part.path, part.entry] = raw
        # The length entry of a fixed-length container is a constant.
        if self.first_variable is None:
            for part in self.parts:
                if part.entry.tag == "LengthEntry" and len(part.path) == 1:
                    eds_parts.set_length(part, -(-self.at // 8), self.sheets)

    def _add(
        self, container: Element, path: tuple[str, ...], within: tuple[Element, ...]
    ) -> None:
        """Add the entries of a container and its base containers, base first, then the
        trailers in reverse order.
        """
        chain = self.chain(container)
        if any(ancestor in within for ancestor in chain) or len(within) > _DEEPEST:
            circle = " -> ".join(
                ancestor.get("name", "") for ancestor in (*within[-5:], container)
            )
            raise NotSupported(
                f"containers contain each other in a circle, or too deep: {line(circle, 200)}"
            )
        # Entries of a base container may not contain a container that derives from it.
        users = {
            ancestor: (*within, *chain[: number + 1])
            for number, ancestor in enumerate(chain)
        }
        for ancestor in reversed(chain):
            self._entries(ancestor, "EntryList", path, users[ancestor])
        # Trailers enclose the body like the headers: that of the most derived container
        # comes first.
        for ancestor in chain:
            self._entries(ancestor, "TrailerEntryList", path, users[ancestor])
            for constraint in ancestor.iterfind("ConstraintSet/*"):
                entry = self.sheets.attribute(constraint, "entry")
                self.constraints.append(
                    Constraint((*path, *entry.replace("/", ".").split(".")), constraint)
                )

    def chain(self, container: Element) -> list[Element]:
        """Return a container, followed by its base containers.

        Raises `NotSupported` if a base is not a container, or for a circular or too
        deep inheritance.
        """
        chain = [container]
        while base := self.sheets.attribute(chain[-1], "baseType"):
            self.types.step()
            ancestor = self.sheets.find_element("type", base, chain[-1])
            if ancestor.tag != CONTAINER:
                raise NotSupported(
                    f"it is based on `{line(base, 60)}`, which is not a container"
                )
            if ancestor in chain or len(chain) > _DEEPEST:
                circle = " -> ".join(
                    type_.get("name", "") for type_ in (*chain[-5:], ancestor)
                )
                raise NotSupported(
                    f"containers are based on each other in a circle, or too deep: {line(circle, 200)}"
                )
            chain.append(ancestor)
        return chain

    def _entries(
        self,
        container: Element,
        tag: str,
        path: tuple[str, ...],
        within: tuple[Element, ...],
    ) -> None:
        for entry in container.iterfind(f"{tag}/*"):
            if self.lost is not None:
                break
            before, at = len(self.parts), self.at
            try:
                self._add_entry(entry, path, within)
            except TooMuch:
                # The limit applies to the file, so the rest cannot become bytes.
                raise
            except NotSupported as why:
                name = line(entry.get("name"), 100) or f"unnamed {at}"
                self.lose(EdsPart((*path, name), {}, at, 0, entry=entry), why, before)

    def _add_entry(
        self, entry: Element, path: tuple[str, ...], within: tuple[Element, ...]
    ) -> None:
        """Add an entry at the current position.

        Raises `NotSupported` if the entry is not supported.
        """
        self.types.step()
        name = line(self.sheets.attribute(entry, "name"), 100) or f"unnamed {self.at}"
        if entry.find("PresentWhen") is not None:
            raise NotSupported(f"`{name}` is present only on a condition")
        first = self.first_variable
        if first is not None and (self.is_open or entry.tag == "PaddingEntry"):
            raise NotSupported(
                f"`{name}` follows `{first.path[-1]}`, whose length is not fixed"
            )
        if entry.tag == "PaddingEntry":
            self.at += integer_value(
                self.sheets.attribute(entry, "sizeInBits"),
                "the size of a padding",
                0,
                8 * MOST_BYTES,
            )
        elif entry.tag in (*_FIELDS, "ListEntry"):
            self._add_field_or_container(entry, name, path, within)
        else:
            raise NotSupported(f"it has a `{line(entry.tag, 60)}`")
        self.check_size()

    def _add_field_or_container(
        self,
        entry: Element,
        name: str,
        path: tuple[str, ...],
        within: tuple[Element, ...],
    ) -> None:
        type_, count = self._element_type(entry, name)
        path = (*path, name)
        if type_.tag == CONTAINER:
            self._check_not_abstract(type_, name)
        if entry.tag == "ListEntry":
            self._add_list(entry, type_, count, path, within)
        elif type_.tag == CONTAINER and count == 1:
            if entry.tag != "Entry":
                raise NotSupported(f"`{name}` is a container, and has a value")
            self._add(type_, path, within)
        elif type_.tag == CONTAINER:
            item, bits = self._struct(type_, name, within)
            self._put(
                EdsPart(
                    path,
                    {**item, "count": count, **described(entry)},
                    self.at,
                    bits * count,
                    entry=entry,
                )
            )
        else:
            field_type = self.types.field_type(type_, entry, f"`{name}`")
            if entry.tag == "FixedValueEntry":
                eds_parts.set_fixed_value(
                    field_type, self.sheets.attribute(entry, "fixedValue"), name
                )
            part = EdsPart(
                path,
                field_type.item,
                self.at,
                field_type.bits,
                field_type.order,
                entry=entry,
                field_type=field_type,
            )
            if count != 1:
                self._repeat(part, count, name)
            replace_keys(part.item, {**part.item, **self._summary(entry, name)})
            self._put(part)

    def _put(self, part: EdsPart) -> None:
        if part.at % 8 and (part.order == LITTLE or "struct" in part.item):
            raise NotSupported(f"`{part.path[-1]}` begins within a byte")
        self.add(part)

    def _summary(self, entry: Element, name: str) -> dict[str, str]:
        """Return the summary of an entry.

        For an error control it includes the kind of checksum, which no other key
        states.
        """
        description = described(entry)
        if entry.tag != "ErrorControlEntry":
            return description
        kind = (
            line(self.sheets.attribute(entry, "errorControlType"), 60)
            or "an error control"
        )
        if self.types.is_new(("error control", entry)):
            message = f"`{name}` is {kind} of what is in the frame"
            help = "it is a field like others, neither checked nor set"
            self.types.to.warn(UNCHECKED, message, help, line=self.sheets.line(entry))
        text = description.get("summary", "")
        return {
            "summary": (
                f"{text}{'' if text.endswith(('.', '!', '?')) else '.'} {kind}."
                if text
                else f"{kind}."
            )
        }

    def _check_not_abstract(self, container: Element, name: str) -> None:
        """Raise `NotSupported` if a container is abstract, because the entry could then
        contain any derived container.
        """
        if self.sheets.is_true(container, "abstract"):
            raise NotSupported(
                f"`{name}` is any container that is based on `{container.get('name', '')}`"
            )

    def _element_type(self, entry: Element, name: str) -> tuple[Element, int]:
        """Return the element type of an entry and the number of elements.

        Raises `NotSupported` if an array is too large or too deep.
        """
        type_ = self.sheets.find_element(
            "type", self.sheets.attribute(entry, "type"), entry
        )
        count, depth = self._count(entry, "ArrayDimensions/Dimension", name), 0
        while type_.tag == ARRAY:
            self.types.step()
            count *= self._count(type_, "DimensionList/Dimension", name)
            type_, depth = (
                self.sheets.find_element(
                    "type", self.sheets.attribute(type_, "dataTypeRef"), type_
                ),
                depth + 1,
            )
            if depth > _DEEPEST:
                raise NotSupported(
                    f"`{name}` is an array of itself, or of too many others"
                )
            if count > 8 * MOST_BYTES:
                raise NotSupported(f"`{name}` is an array of {count:,} elements")
        return type_, count

    def _count(self, owner: Element, path: str, name: str) -> int:
        """Return the number of elements over all dimensions.

        Elements are in row-major order: the last index varies fastest.
        """
        count = 1
        for element in owner.iterfind(path):
            if index := self.sheets.attribute(element, "indexTypeRef"):
                count *= self._indices(
                    self.sheets.find_element("type", index, element), name
                )
            else:
                count *= integer_value(
                    self.sheets.attribute(element, "size"),
                    f"a dimension of `{name}`",
                    1,
                    8 * MOST_BYTES,
                )
            if count > 8 * MOST_BYTES:
                raise NotSupported(f"`{name}` is an array of {count:,} elements")
        return count

    def _indices(self, type_: Element, name: str) -> int:
        """Return the number of elements of an array dimension with the given index
        type.

        Raises `NotSupported` if it has no bounds.
        """
        chain = self.types.chain(type_)
        values = [value for _, value in self.sheets.labels(chain[-1])]
        if values:
            # An enumeration as index has an element for each number between its labels,
            # too.
            return max(values) - min(values) + 1
        low, high = self.types.field_type(
            type_, type_, f"the index of `{name}`"
        ).range.of_integers()
        if low is None or high is None or high < low:
            raise NotSupported(
                f"the definition does not state how many elements `{name}` has"
            )
        return int(high - low) + 1

    def _repeat(self, part: EdsPart, count: int, name: str) -> None:
        """Make a scalar an array.

        An array of bytes above `MOST_ELEMENTS` becomes a field of type `bytes`.

        Raises `NotSupported` for other large arrays, variable-length elements and
        constants.
        """
        item, bits = part.item, part.bits
        if not bits or "const" in item:
            raise NotSupported(
                f"`{name}` is an array of elements of variable length, or of a constant"
            )
        if count > MOST_ELEMENTS and bits == 8 and item["type"] == "uint":
            item.clear()
            item["type"] = "bytes"
        elif count > MOST_ELEMENTS:
            raise NotSupported(f"`{name}` is an array of {count:,} elements")
        else:
            item |= {"bits": bits, "count": count}
        part.bits = bits * count

    def _struct(
        self, container: Element, name: str, within: tuple[Element, ...]
    ) -> tuple[Item, int]:
        """Return the `struct` key for elements of a container type, and the bits of an
        element.

        Raises `NotSupported` if their size varies or is not whole bytes.
        """
        struct = self.structs.items.get(container)
        if struct is None:
            inner = EdsLayout(self.sheets, self.types, self.structs, within=within)
            inner.read(container)
            if (
                inner.at % 8
                or not inner.at
                or any(not part.bits for part in inner.parts)
            ):
                raise NotSupported(
                    f"`{name}` is an array of containers of different or partial bytes"
                )
            struct_name = container.get("name", "")
            if struct_name in self.structs.names:
                struct_name = f"{self.sheets.package(container)} {struct_name}"
            self.structs.names.add(struct_name)
            fields = inner.fields(0)
            struct = {
                "name": line(struct_name, 100),
                "length": inner.at // 8,
                **described(container),
                "fields": fields,
            }
            self.structs.items[container] = struct
        return {"struct": struct["name"]}, 8 * int(struct["length"])

    def _add_list(
        self,
        entry: Element,
        type_: Element,
        count: int,
        path: tuple[str, ...],
        within: tuple[Element, ...],
    ) -> None:
        """Add a list whose number of elements is in another field.

        Raises `NotSupported` if the list is not supported.
        """
        name = path[-1]
        counter = self.sheets.attribute(entry, "listLengthField")
        length_part = next(
            (
                part
                for part in reversed(self.parts)
                if part.path == (*path[:-1], *counter.split("."))
            ),
            None,
        )
        if (
            length_part is None
            or self.is_behind(length_part)
            or length_part.field_type is None
            or length_part.field_type.item["type"] != "uint"
            or length_part.field_type.bits != length_part.bits
        ):
            raise NotSupported(
                f"`{name}` is there as often as `{line(counter, 60)}` says, which is not a number in front of it"
            )
        if count != 1 or self.at % 8:
            raise NotSupported(f"`{name}` is a list of arrays, or begins within a byte")
        if type_.tag == CONTAINER:
            item, bits = self._struct(type_, name, within)
        else:
            field_type = self.types.field_type(type_, entry, f"`{name}`")
            item, bits = field_type.item, field_type.bits
            order = (
                {"byte_order": LITTLE}
                if field_type.order == LITTLE and bits > 8
                else {}
            )
            replace_keys(item, {"bits": bits, **item, **order})
        if not bits or bits % 8:
            raise NotSupported(
                f"`{name}` is a list of elements without a fixed number of bytes"
            )
        _, most = length_part.field_type.range.within(
            eds_ranges.Range(Fraction(0), Fraction((1 << length_part.bits) - 1))
        ).of_integers()
        item["up_to"] = max(1, min(int(most or 1), MOST_ELEMENTS))
        item |= {
            key: text
            for key, text in described(entry).items()
            if key not in item or "struct" in item
        }
        self.add(
            EdsPart(
                path,
                item,
                self.at,
                0,
                element=bits,
                counter=Counter(length_part),
                entry=entry,
            )
        )

    def header(self) -> packets.PrimaryHeader | None:
        """Return the primary header of a space packet (CCSDS 133.0-B) if the container
        begins with one, else None.
        """
        first_parts = self.parts[: packets.MOST_PARTS]
        plain = [
            part
            for part in first_parts
            if part.field_type is not None and part.field_type.bits == part.bits
        ]
        header = packets.header(
            (part.at, part.bits, part.item.get("const")) for part in plain
        )
        # A length with another calibration is not the packet data length of CCSDS.
        length = next(
            (part for part in first_parts if part.end == packets.HEADER_BITS), None
        )
        if header is None or length is None:
            return None
        is_calibrated = length.entry.find("PolynomialCalibrator") is not None
        return (
            None
            if is_calibrated and eds_parts.line_of(length.entry, self.sheets) != _PACKET
            else header
        )

    def front(self) -> tuple[Hashable, int] | None:
        """Return the key and size in bits of the first part if a header can use it as
        id, else None.
        """
        part = next(iter(self.parts), None)
        if part is None or part.field_type is None or not part.is_message_id:
            return None
        return (part.path, part.entry), part.bits

    def fields(self, start: int) -> list[Item]:
        """Return the ICD fields from the bit ``start`` on.

        Raises `NotSupported` if a variable-length field is not supported.
        """
        parts = [part for part in self.parts if part.at >= start]
        short_names = shortest([_distinct_path(part.path) for part in parts])
        names = {id(part): name for part, name in zip(parts, short_names, strict=True)}
        fields: list[Item] = []
        for part in parts:
            name, at = names[id(part)], part.at - start
            if part.bits:
                fields.append(fixed_field(part, name, at))
                continue
            if part.counter is None and sum(not other.bits for other in parts) == 1:
                part.counter = self._length_of(names)
            behind = self.at - part.at
            behind += bits_of_counted(parts) if part.counter is None else 0
            fields.append(variable_field(part, name, at, names, behind))
        return in_sequence(fields)

    @property
    def is_open(self) -> bool:
        """Whether a part extends to the end of the frame, and no field has the length
        of the container.
        """
        has_length = any(
            part.entry.tag == "LengthEntry"
            and len(part.path) == 1
            and not self.is_behind(part)
            for part in self.parts
        )
        return not has_length and any(
            not part.bits and part.counter is None for part in self.parts
        )

    def add(self, part: EdsPart) -> None:
        """Add a part.

        Raises `NotSupported` if it follows a part of variable length, and does not have
        whole bytes.
        """
        first, width = self.first_variable, int(part.item.get("bits", part.bits))
        if first is not None and (part.bits % 8 or width % 8):
            raise NotSupported(
                f"`{part.path[-1]}` follows `{first.path[-1]}`, whose length is not fixed, "
                "and does not have whole bytes"
            )
        if first is not None and not part.bits and self._has_uncounted(part):
            raise NotSupported(
                f"`{part.path[-1]}` follows `{first.path[-1]}`, and no field counts both"
            )
        super().add(part)

    def _has_uncounted(self, added: EdsPart) -> bool:
        """Return whether ``added`` or another variable-length part has no counter."""
        return any(
            not part.bits and part.counter is None for part in (*self.parts, added)
        )

    def _length_of(self, names: Mapping[int, str]) -> Counter | None:
        """Return the container length field as counter of the variable-length part, or
        None without one.
        """
        counter = None
        for other in self.parts:
            is_length = (
                other.entry.tag == "LengthEntry"
                and len(other.path) == 1
                and id(other) in names
                and not self.is_behind(other)
            )
            if is_length and other.item["type"] == "uint":
                length = eds_parts.line_of(other.entry, self.sheets)
                # The ICD key `plus` adds an integer to a counter. No key scales it.
                if (
                    length is not None
                    and length.factor == 1
                    and length.offset.denominator == 1
                ):
                    # `at` counts the fixed parts alone, so the remaining bytes are
                    # those of the variable part.
                    counter = Counter(other, int(length.offset) - self.at // 8)
        return counter


def _distinct_path(path: tuple[str, ...]) -> tuple[str, ...]:
    """Return a path in which a trailing `value` is joined with the name of its parent."""
    return (
        (*path[:-2], f"{path[-2]} {path[-1]}")
        if len(path) > 1 and path[-1].casefold() == "value"
        else path
    )
