"""Layout of XTCE containers: their own, inherited and included entries, and the values
that restrict them.

An `XtceLayout` reads one container or command and returns its fields with `laid_out`.
`xtce_types` has the fields of types, `xtce_parts` entries of variable length.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass, field
from itertools import takewhile
from xml.etree.ElementTree import Element

from icdgen.definitions.containers import (
    MOST_FIELDS,
    Container,
    check_only_value,
    fixed_field,
)
from icdgen.definitions.frames import LITTLE, FrameBits, laid_out
from icdgen.definitions.model import Definitions, Item, NotSupported, replace_keys
from icdgen.definitions.reading import TooMuch
from icdgen.definitions.wording import line
from icdgen.definitions.xtce_calibration import fixed, number
from icdgen.definitions.xtce_names import XtceNames, ancillary_data, name_of
from icdgen.definitions.xtce_parts import (
    Reference,
    XtcePart,
    names_of_parts,
    sequence_fields,
)
from icdgen.definitions.xtce_types import (
    XtceFieldType,
    XtceTypes,
    described,
    repeated,
    special_values,
)
from icdgen.frozen import NamedTuple
from icdgen.icd.variable_length import MOST_BYTES, MOST_ELEMENTS

MOST_PLACED = 500  # fields of a message with explicit positions
_DEEPEST = 50  # levels of inheritance and inclusion
_REFERENCES = {"ParameterRefEntry": "parameterRef", "ArgumentRefEntry": "argumentRef",
               "ArrayParameterRefEntry": "parameterRef", "ArrayArgumentRefEntry": "argumentRef"}  # fmt: skip


class RequiredValue(NamedTuple):
    """Parameter, argument or member that has a constant value in a message."""

    reference: Reference
    value: str
    is_raw: bool


@dataclass
class XtceLayout(Container[XtcePart]):
    """Parts of a container, its own and inherited ones, with the values that restrict
    it.
    """

    names: XtceNames
    types: XtceTypes
    arguments: dict[str, Element] = field(default_factory=dict)  # of a command
    required_values: list[RequiredValue] = field(default_factory=list)
    jumps: bool = False  # whether a part has an explicit position
    behind: str = ""  # the previous entry, if it is optional
    size: int = 0  # bits of every frame if the container states a size, else 0

    def read(
        self,
        container: Element,
        within: tuple[Element, ...] = (),
        is_included: bool = False,
    ) -> None:
        """Add the inherited entries of a container, then its own ones.

        ``within`` are the enclosing containers. Positions of an included container are
        relative to its own start. Raises `NotSupported` if an entry is not supported
        and the frame cannot end there.
        """
        if any(container is element for element in within):
            circle = " -> ".join(
                element.get("name", "") for element in (*within, container)
            )
            raise NotSupported(
                f"containers contain or inherit each other in a circle: {line(circle, 200)}"
            )
        if len(within) >= _DEEPEST:
            raise NotSupported(
                f"more than {_DEEPEST} containers inherit or contain each other"
            )
        self.types.step()
        start = self.at if is_included else 0
        within = (*within, container)
        if (extended := self.names.base_of(container)) is not None:
            self.read(extended, within, is_included)
        if (base := container.find("BaseContainer")) is not None:
            if (criteria := base.find("RestrictionCriteria")) is not None:
                self.required_values += self._required_values(criteria, container)
        if not is_included and (
            size := fixed(container.find("BinaryEncoding/SizeInBits"))
        ):
            self.size = size
        entries = container.find("EntryList")
        for entry in () if entries is None else entries:
            if self.lost is not None:
                break
            before, at = len(self.parts), self.at
            try:
                self._move(entry, start)
                self._entry(entry, container, within)
                if (condition := entry.find("IncludeCondition")) is not None:
                    conditions = self._conditions(
                        condition, container, _named(entry), before
                    )
                    self._conditional(entry, conditions, before)
            except TooMuch:
                raise
            except NotSupported as why:
                if self.behind:
                    raise
                item: Item = {}
                self.lose(
                    XtcePart(
                        (_named(entry),), item, at, 0, field_type=XtceFieldType(item, 0)
                    ),
                    why,
                    before,
                )
            if len(self.parts) > MOST_FIELDS:
                raise NotSupported(f"it has more than {MOST_FIELDS} fields")

    def _conditional(
        self, entry: Element, conditions: list[tuple[XtcePart, object]], before: int
    ) -> None:
        """Make the parts behind the first ``before`` optional.

        Raises `NotSupported` if their conditions are nested.
        """
        # Alternatives share their bits, so all fields need explicit positions.
        self.jumps, self.behind = True, _named(entry)
        for part in self.parts[before:]:
            if "when" in part.item:
                raise NotSupported(
                    f"`{_named(entry)}` is present only on nested conditions"
                )
            part.conditions = conditions
            part.item["when"] = {of.path[-1]: values for of, values in conditions}

    def _move(self, entry: Element, start: int) -> None:
        """Move to the position of an entry in a container that begins at bit ``start``.

        Raises `NotSupported`.
        """
        location = entry.find("LocationInContainerInBits")
        origin = (
            "previousEntry"
            if location is None
            else location.get("referenceLocation", "previousEntry")
        )
        if self.behind and origin == "previousEntry":
            raise NotSupported(
                f"`{_named(entry)}` follows `{self.behind}`, which is present only on a condition"
            )
        self.behind = ""
        if location is None:
            return
        bits = fixed(location)
        if bits is None or origin not in ("previousEntry", "containerStart"):
            raise NotSupported(
                f"where `{_named(entry)}` is located is not a number of bits from the previous entry"
            )
        self.at = (self.at if origin == "previousEntry" else start) + bits
        self.jumps = True
        if self.at < 0:
            raise NotSupported(
                f"`{_named(entry)}` is located in front of its container"
            )

    def _entry(
        self, entry: Element, container: Element, within: tuple[Element, ...]
    ) -> None:
        """Add the parts of an entry of a container.

        Raises `NotSupported` if the entry is not supported.
        """
        count = _repeats(entry)
        if entry.tag == "ContainerRefEntry":
            inner = self.names.container(entry.get("containerRef", ""), container)
            for _ in range(count):
                self.read(inner, within, is_included=True)
            return
        if entry.tag == "FixedValueEntry":
            self._fixed(entry)
            return
        if entry.tag not in _REFERENCES:
            raise NotSupported(f"it has a `{line(entry.tag, 60)}`")
        reference = self._parameter(
            _reference(entry), container, "argument" in entry.tag.lower()
        )
        of, where = reference.of, f"`{reference.name}`"
        type_ = self.names.type_of(
            of.get("parameterTypeRef", "") or of.get("argumentTypeRef", ""), of
        )
        for member in reference.path:
            type_ = self.types.member(type_, member, where)
        dimensions = entry.find("DimensionList")
        if type_.tag.startswith("Array") and dimensions is not None:
            field_type = self.types.array(type_, dimensions, where)
        else:
            field_type = self.types.field_type(type_, where)
        keys = {**special_values(of), **described(of, type_)}
        keys |= {"view": True} if "view" in ancillary_data(of) else {}
        keys |= (
            {"const": number(constant, "a constant")}
            if (constant := ancillary_data(of).get("constant"))
            else {}
        )
        name = " ".join((name_of(of), *reference.path))
        self._place(reference, name, repeated(field_type, count, where), keys)

    def _place(
        self, reference: Reference, name: str, field_type: XtceFieldType, keys: Item
    ) -> None:
        """Add a field at the current position, or the members of an aggregate in their
        order.

        Raises `NotSupported`.
        """
        of, path = reference
        if len(path) > _DEEPEST:
            raise NotSupported(f"`{name}` has members nested without end")
        for member, type_ in field_type.members:
            of_member = self.types.field_type(type_, f"`{name} {member}`")
            self._place(
                Reference(of, (*path, member)),
                f"{name} {member}",
                of_member,
                described(type_),
            )
            if len(self.parts) > MOST_FIELDS:
                raise NotSupported(f"it has more than {MOST_FIELDS} fields")
        if field_type.members:
            return
        if field_type.order == LITTLE and (self.at % 8 or field_type.bits % 8):
            if self.at // 8 == (self.at + field_type.bits - 1) // 8:
                raise NotSupported(
                    f"the least significant byte of the {field_type.bits} bits of `{name}` is sent first"
                )
            # Little-endian within a byte: bits are counted from the least significant
            # one, as in Yamcs.
            self.jumps = True
        item = replace_keys(field_type.item, {**field_type.item, **keys})
        part = XtcePart(
            (name,),
            item,
            self.at,
            field_type.bits,
            field_type.order,
            item.get("bits", 8),
            field_type=field_type,
        )
        # The XTCE that icdgen writes marks its padding, so that an import gives the
        # same ICD.
        part.reference, part.is_reserved = reference, "reserved" in ancillary_data(of)
        self._add(part)

    def _fixed(self, entry: Element) -> None:
        """Add a fixed value: the least significant `sizeInBits` bits of a hexadecimal
        number.

        Raises `NotSupported`.
        """
        bits, text = (
            number(entry.get("sizeInBits", ""), "a size"),
            entry.get("binaryValue", ""),
        )
        if not 1 <= bits <= 8 * MOST_BYTES:
            raise NotSupported(f"a fixed value has {bits} bits")
        try:
            value = int(text, 16) & (1 << bits) - 1
        except ValueError:
            raise NotSupported(f"a fixed value is `{line(text, 60)}`") from None
        name = entry.get("name", "")
        if bits > 64 and value:
            raise NotSupported(f"a fixed value has {bits} bits")
        item: Item = {"type": "uint", "const": value}
        part = XtcePart(
            (name or f"Fixed {self.at}",),
            item,
            self.at,
            bits,
            field_type=XtceFieldType(item, bits),
        )
        part.is_reserved = not (name and bits <= 64) and not value
        self._add(part)

    def _add(self, part: XtcePart) -> None:
        """Add a part.

        Raises `NotSupported` if it follows a part of variable length, and does not have
        whole bytes directly behind the previous part.
        """
        first = self.first_variable
        if first is not None and (
            part.bits % 8 or part.width % 8 or part.at != self.parts[-1].end
        ):
            raise NotSupported(
                f"`{part.path[-1]}` follows `{first.path[-1]}`, whose size is not fixed, "
                "and does not have whole bytes directly behind the entry in front of it"
            )
        self.add(part)

    def _parameter(self, name: str, seen_from: Element, is_argument: bool) -> Reference:
        """Return the parameter or argument that an element refers to.

        Raises `NotSupported` if it does not exist.
        """
        return (
            self.argument(name)
            if is_argument
            else Reference(*self.names.parameter(name, seen_from))
        )

    def argument(self, name: str) -> Reference:
        """Return an argument of the command, or a member of it.

        Raises `NotSupported` if it does not exist.
        """
        first, *path = [name] if name in self.arguments else name.split("/")
        if first not in self.arguments:
            raise NotSupported(f"there is no argument `{line(name, 100)}`")
        return Reference(self.arguments[first], tuple(path))

    def _required_values(
        self, criteria: Element, seen_from: Element
    ) -> Iterator[RequiredValue]:
        """Yield the equalities of a conjunction.

        Raises `NotSupported` for any other condition.
        """
        for alternatives in self._all_of(criteria, seen_from, "it depends on"):
            if len(alternatives) > 1:
                raise NotSupported(
                    "it depends on more than equalities that must all be true"
                )
            yield alternatives[0]

    def _conditions(
        self, condition: Element, seen_from: Element, named: str, before: int
    ) -> list[tuple[XtcePart, object]]:
        """Return the parts in front of an entry on which it depends, with the values
        that they must have.

        Raises `NotSupported`.
        """
        conditions: list[tuple[XtcePart, object]] = []
        for alternatives in self._all_of(
            condition, seen_from, f"`{named}` is present only if there is"
        ):
            part, *other_parts = [
                self._part(equality, before) for equality in alternatives
            ]
            if any(other is not part for other in other_parts) or any(
                of is part for of, _ in conditions
            ):
                raise NotSupported(
                    f"`{named}` is present on a condition of several fields"
                )
            raws = [self._raw(part, equality) for equality in alternatives]
            conditions.append((part, raws if len(raws) > 1 else raws[0]))
        if not conditions:
            raise NotSupported(
                f"`{named}` is present only on a condition that is empty"
            )
        return conditions

    def _all_of(
        self, criteria: Iterable[Element], seen_from: Element, prefix: str
    ) -> Iterator[list[RequiredValue]]:
        """Yield the terms of a conjunction, each a list of alternative equalities.

        Raises `NotSupported` for any other condition, with a message that begins with
        ``prefix``.
        """
        for criterion in criteria:
            if criterion.tag == "Comparison":
                yield [
                    self._compared(
                        criterion,
                        criterion.get("comparisonOperator", "=="),
                        criterion.get("value", ""),
                        seen_from,
                        prefix,
                    )
                ]
            elif criterion.tag in (
                "ComparisonList",
                "BooleanExpression",
                "ANDedConditions",
            ):
                yield from self._all_of(criterion, seen_from, prefix)
            elif criterion.tag == "ORedConditions":
                each = [
                    list(self._all_of([inner], seen_from, prefix))
                    for inner in criterion
                ]
                if any(len(alternative) != 1 for alternative in each):
                    raise NotSupported(
                        f"{prefix} one of several things that must hold together"
                    )
                yield [equality for (alternative,) in each for equality in alternative]
            elif criterion.tag == "Condition":
                if (
                    len(
                        [
                            inner
                            for inner in criterion
                            if inner.tag.endswith("InstanceRef")
                        ]
                    )
                    != 1
                ):
                    raise NotSupported(f"{prefix} a comparison of two parameters")
                operator, value = (
                    criterion.findtext("ComparisonOperator", ""),
                    criterion.findtext("Value", ""),
                )
                yield [self._compared(criterion, operator, value, seen_from, prefix)]
            else:
                raise NotSupported(f"{prefix} a `{line(criterion.tag, 60)}`")

    def _compared(
        self,
        comparison: Element,
        operator: str,
        value: str,
        seen_from: Element,
        prefix: str,
    ) -> RequiredValue:
        """Return an equality of a parameter or argument and a value.

        Raises `NotSupported` for other operators.
        """
        of = next(
            (inner for inner in comparison if inner.tag.endswith("InstanceRef")),
            comparison,
        )
        is_argument = "argumentRef" in of.attrib
        name = of.get("argumentRef" if is_argument else "parameterRef", "")
        if operator.strip() != "==":
            compared = f"`{line(name, 60)} {line(operator, 5)} {line(value, 60)}`"
            raise NotSupported(f"{prefix} {compared}, which is not an equality")
        reference = self._parameter(name, seen_from, is_argument)
        return RequiredValue(reference, value, of.get("useCalibratedValue") == "false")

    def fix_value(self, required: RequiredValue) -> int:
        """Make the value of a parameter or argument constant, and return its raw value.

        Raises `NotSupported`.
        """
        part = self._part(required)
        raw = self._raw(part, required)
        check_only_value(part.item, raw, required.reference.name)
        part.item["const"] = raw
        return raw

    def _part(self, required: RequiredValue, end: int | None = None) -> XtcePart:
        """Return the last of the first ``end`` parts that an equality refers to.

        Raises `NotSupported` if it does not exist.
        """
        part = next(
            (
                candidate
                for candidate in reversed(self.parts[:end])
                if candidate.reference == required.reference
            ),
            None,
        )
        if part is None:
            raise self.missing(required.reference.name)
        return part

    def _raw(self, part: XtcePart, required: RequiredValue) -> int:
        """Return the raw value of an equality.

        Raises `NotSupported` if the part is calibrated, not an integer, or too narrow.
        """
        item, text, name = part.item, required.value.strip(), required.reference.name
        if part.field_type.is_raw:
            raise NotSupported(
                f"it depends on `{name}`, of which only the raw bits are imported"
            )
        if "count" in item or item["type"] not in ("uint", "int", "enum", "bool"):
            raise NotSupported(
                f"it depends on `{name}`, which is of the type {item['type']}"
            )
        if item.keys() & {"formula", "points"} and not required.is_raw:
            raise NotSupported(f"it depends on the calibrated value of `{name}`")
        if text in part.field_type.values and not required.is_raw:
            return part.field_type.values[text]
        try:
            raw = int(text, 0) if text.lower().startswith(("0x", "-0x")) else int(text)
        except ValueError:
            raise NotSupported(
                f"it depends on `{name}`, which is never `{line(text, 60)}`"
            ) from None
        if raw.bit_length() > part.bits or (
            raw < 0 and item["type"] in ("uint", "bool")
        ):
            raise NotSupported(f"it depends on `{name}`, which is never {raw}")
        return raw

    def laid_out(self, message: Item, start: int, order: str, to: Definitions) -> Item:
        """Return the message with its length and the fields from bit ``start`` on.

        Raises `NotSupported`.
        """
        first = self.first_variable
        front = list(takewhile(lambda part: part is not first, self.parts))
        sequence = self.parts[len(front) :]
        always = max(
            (part.end for part in front if "when" not in part.item), default=start
        )
        always = max(always, self.size)
        late = next(
            (part for part in self.parts if "when" in part.item and part.end > always),
            None,
        )
        if late is not None:
            raise NotSupported(
                f"frames end before `{late.path[-1]}` where it is not there"
            )
        end = always - start
        if (
            max((part.end for part in self.parts), default=0) - start > 8 * MOST_BYTES
            or end > 8 * MOST_BYTES
        ):
            raise NotSupported(f"its frames have more than {MOST_BYTES:,} bytes")
        closed = [part for part in front if part.at >= start and not part.is_reserved]
        parts = [*closed, *sequence]
        names = names_of_parts(parts)
        for part in parts:
            if part.conditions:  # conditions refer to the final, numbered names
                part.item["when"] = {
                    names.get(id(of), of.path[-1]): values
                    for of, values in part.conditions
                }
        message["length"] = -(-end // 8)
        fields: list[Item] = []
        if self.jumps:
            if len(parts) > MOST_PLACED:
                raise NotSupported(
                    f"more than {MOST_PLACED} fields say where they stand"
                )
            placed = [
                (
                    replace_keys(part.item, {"name": names[id(part)], **part.item}),
                    FrameBits(part.at - start, part.bits, part.order),
                )
                for part in closed
            ]
            message = laid_out(message, placed, order, to)
            fields = message.pop("fields", [])
        else:
            fields = [
                fixed_field(part, names[id(part)], part.at - start) for part in closed
            ]
            last = max((part.end for part in closed), default=start) - start
            message |= (
                {"reserved": padding}
                if (padding := message["length"] - -(-last // 8))
                else {}
            )
        if first is not None:
            if end % 8:
                raise NotSupported(
                    f"`{names[id(first)]}`, whose size is not fixed, begins within a byte"
                )
            # The unnamed bytes in front of the field are part of the length.
            message.pop("reserved", 0)
            fields += sequence_fields(sequence, closed, names, message, order, to)
        return {**message, "fields": fields} if fields else message


def _reference(entry: Element) -> str:
    """Return the reference of an entry.

    XTCE 1.1 (2006) allows ``parameterRef`` for arrays of arguments.
    """
    return next(
        (
            entry.attrib[key]
            for key in ("argumentRef", "parameterRef")
            if key in entry.attrib
        ),
        "",
    )


def _named(entry: Element) -> str:
    """Return the name of an entry for messages."""
    keys = (*_REFERENCES.values(), "containerRef", "name")
    return line(
        next((entry.attrib[key] for key in keys if key in entry.attrib), entry.tag), 100
    )


def _repeats(entry: Element) -> int:
    """Return the number of repetitions of an entry.

    Raises `NotSupported` if it is not fixed, or there are gaps between.
    """
    repeat = entry.find("RepeatEntry")
    if repeat is None:
        return 1
    count = fixed(repeat.find("Count"))
    if count is None or repeat.find("Offset") is not None:
        raise NotSupported(
            f"how often `{_named(entry)}` is repeated, or the gap between, is not a number"
        )
    if not 0 <= count <= MOST_ELEMENTS:
        raise NotSupported(f"`{_named(entry)}` is repeated {count} times")
    return count
