"""Layout of a .ksy: its attributes as consecutive parts, for one combination of its
conditional branches.

A `KaitaiLayout` gets the root type of the file and the values that select branches. If
the layout depends on a further value, it raises `Undecided` with the values to try;
`kaitai` repeats the layout with each of them. `kaitai_types` has the fields of types,
`kaitai_parts` the parts and the names that expressions can use.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import Any

from icdgen.definitions.accounting import settle
from icdgen.definitions.containers import AS_BYTES, Container, Counter
from icdgen.definitions.kaitai_expressions import (
    Masked,
    counted,
    equalities,
    linear_function,
    masked,
    number,
)
from icdgen.definitions.kaitai_parts import (
    BranchLabel,
    Ended,
    File,
    KaitaiPart,
    Key,
    TypeScope,
    Undecided,
    apply_valid,
    placed,
)
from icdgen.definitions.kaitai_types import (
    KaitaiFieldType,
    KaitaiType,
    add_enumeration,
    built_in_type,
    stated_contents,
    stated_size,
)
from icdgen.definitions.kaitai_yaml import integer
from icdgen.definitions.model import Item, NotSupported
from icdgen.definitions.reading import TooMuch
from icdgen.definitions.wording import line, summary, unit
from icdgen.icd.located import Map
from icdgen.icd.variable_length import MOST_BYTES, MOST_ELEMENTS, REST

RAW_ONLY = "IMP078"
_DEEPEST = 50  # nested types
_WORD = 8  # bytes of the largest integer


@dataclass
class KaitaiLayout(Container[KaitaiPart]):
    """Parts of a root type.

    ``decided`` are the values of the fields that select branches.
    """

    file: File
    decided: dict[Key, int | None]
    is_struct: bool = False
    labels: list[BranchLabel] = field(default_factory=list)
    # Bit behind each enclosing part that states its `size`.
    ends: list[int] = field(default_factory=list)

    @property
    def is_open(self) -> bool:
        """Whether the last part extends to the end of the frame."""
        return super().is_open and self.parts[-1].counter is None

    def read(self, root: KaitaiType) -> None:
        """Add the parts of the root type.

        Raises `NotSupported` if it is not supported, `Undecided` if a branch depends on
        a value that is not in ``decided``.
        """
        try:
            self.add_type(root, TypeScope(root), (), (root,))
        except Ended:
            return

    def add_type(
        self,
        type_: KaitaiType,
        scope: TypeScope,
        path: tuple[str, ...],
        within: tuple[KaitaiType, ...],
    ) -> None:
        """Add the attributes of a type (`seq`), and the formulas of its `instances`."""
        try:
            self._sequence(type_, scope, path, within)
        except Ended:
            self._instances(type_, scope, path)
            raise
        self._instances(type_, scope, path)

    def _sequence(
        self,
        type_: KaitaiType,
        scope: TypeScope,
        path: tuple[str, ...],
        within: tuple[KaitaiType, ...],
    ) -> None:
        """Add the attributes of `seq`.

        Attributes that are not supported become bytes.
        """
        for index, attribute in enumerate(type_.seq):
            self.file.step()
            self.check_size()
            name = str(attribute.get("id") or f"unnamed{index}")
            where = (*path, name)
            is_present = False
            try:
                if self.is_open:
                    raise NotSupported("it follows a part up to the end of the frame")
                if "if" in attribute and not self._is_present(attribute, name, scope):
                    continue
                is_present = True
                self._attribute(attribute, name, where, scope, within)
            except TooMuch:
                raise
            except NotSupported as why:
                self._as_bytes(attribute, where, why, is_present)

    def _attribute(
        self,
        attribute: Map,
        name: str,
        where: tuple[str, ...],
        scope: TypeScope,
        within: tuple[KaitaiType, ...],
    ) -> None:
        """Add the parts of an attribute.

        ``where`` is its path, ``within`` the enclosing types. Raises `NotSupported`.
        """
        if "process" in attribute:
            raise NotSupported(
                f"its bytes are processed by `{line(str(attribute['process']), 60)}` before they are read"
            )
        if stated_size(attribute) == 0:
            return  # `size: 0`: the attribute has no bytes, whatever its type
        if (always := stated_contents(attribute)) is not None:
            self._constant(where, always, attribute)
            return
        name_of_type = attribute.get("type", "")
        if isinstance(name_of_type, Map):
            chosen = self._switched(name_of_type, scope)
            if chosen is None:
                return
            name_of_type = chosen
        field_type = built_in_type(str(name_of_type or ""), attribute, scope.type)
        count = self._count(attribute, scope)
        if field_type is not None:
            part = self._place(where, field_type, count, attribute, scope)
            scope.names[name] = part
            return
        if "(" in str(name_of_type):
            raise NotSupported(
                f"the type `{line(str(name_of_type), 60)}` has parameters"
            )
        inner = scope.type.find_type(str(name_of_type))
        if any(inner is other for other in within):
            circle = " -> ".join(other.name for other in (*within, inner))
            raise NotSupported(
                f"types contain each other in a circle: {line(circle, 200)}"
            )
        if len(within) >= _DEEPEST:
            raise NotSupported(f"more than {_DEEPEST} types contain each other")
        if count is not None:
            self._structs(where, inner, count, attribute, within)
            return
        below = TypeScope(inner, scope)
        scope.names[name] = below
        self._within(attribute, inner, below, where, within)

    def _within(
        self,
        attribute: Map,
        inner: KaitaiType,
        below: TypeScope,
        where: tuple[str, ...],
        within: tuple[KaitaiType, ...],
    ) -> None:
        """Add the fields of a type that is not repeated.

        If the attribute states a `size`, the next part begins behind it.
        """
        if "size" in attribute and stated_size(attribute) is None:
            raise NotSupported(f"its size is `{line(str(attribute['size']), 80)}`")
        size = stated_size(attribute)
        if size is None:
            self.add_type(inner, below, where, (*within, inner))
            return
        self._align()
        end = self.at + 8 * size
        if self.ends and end > self.ends[-1]:
            raise NotSupported(f"its {size} bytes are more than there are around it")
        self.ends.append(end)
        try:
            self.add_type(inner, below, where, (*within, inner))
        except Ended:
            pass
        finally:
            self.ends.pop()
        if self.at > end:
            raise NotSupported(
                f"it has more than the {size} bytes that are there for it"
            )
        self.at = end

    def _count(self, attribute: Map, scope: TypeScope) -> int | Counter | str | None:
        """Return the number of repetitions: None without `repeat`, a number, a counter,
        or `rest` for `repeat: eos`.

        Raises `NotSupported` for any other expression.
        """
        repeat = attribute.get("repeat")
        if repeat is None:
            return None
        if repeat == "eos":
            if self.ends:
                raise NotSupported("it is repeated to the end of what is around it")
            return REST
        expression = attribute.get("repeat-expr")
        count = integer(expression) if isinstance(expression, str) else expression
        if repeat != "expr" or not isinstance(count, int):
            why = f"it is repeated as often as `{line(str(expression or attribute.get('repeat-until')), 80)}` says"
            return self._counter(expression if repeat == "expr" else None, scope, why)
        if not 1 <= count <= MOST_ELEMENTS:
            raise NotSupported(f"it is repeated {count} times")
        return count

    def _counter(self, expression: object, scope: TypeScope, why: str) -> Counter:
        """Return the preceding integer that an expression refers to.

        Raises `NotSupported` with ``why`` for other expressions.
        """
        linear = counted(expression)
        if linear is None:
            raise NotSupported(why)
        of = scope.find_part(linear[0])
        if (
            of.item.get("type") != "uint"
            or "count" in of.item
            or of.mask
            or self.is_behind(of)
            or not any(of is part for part in self.parts)
        ):
            raise NotSupported(f"{why}, which is not a number in front of it")
        counter = Counter(of, linear[1])
        if self.ends:
            raise NotSupported(f"{why}, within a part that has a size of its own")
        if counter.most < 1:
            raise NotSupported(f"{why}, which is never positive")
        return counter

    def _align(self) -> None:
        """Move to the next byte: Kaitai Struct aligns after bit-sized integers."""
        self.at = -(-self.at // 8) * 8

    def _place(
        self,
        where: tuple[str, ...],
        field_type: KaitaiFieldType,
        count: int | Counter | str | None,
        attribute: Map,
        scope: TypeScope,
    ) -> KaitaiPart:
        """Add a number, a text or bytes behind the last part. Raises `NotSupported`."""
        counter = count if isinstance(count, Counter) else None
        if not field_type.bits and "size" in attribute:
            counter = self._counter(
                attribute["size"],
                scope,
                f"its size is `{line(str(attribute['size']), 80)}`",
            )
        if not field_type.is_bits:
            self._align()
        elif (
            self.at % 8
            and self.parts
            and self.parts[-1].field_type.is_bits
            and self.parts[-1].field_type.order != field_type.order
        ):
            raise NotSupported(
                "its bits are counted from the other end of a byte than the bits in front of it"
            )
        if not field_type.bits and self.ends:
            field_type.bits = self.ends[-1] - self.at
            if field_type.bits <= 0:
                raise NotSupported("no byte is left for it")
        if "enum" in attribute:
            reference = str(attribute["enum"])
            add_enumeration(
                field_type.item,
                field_type.bits,
                reference,
                scope.type,
                self.file.enums,
                self.file.heard(reference),
            )
        if count is not None:
            if field_type.item["type"] == "bytes" or not field_type.bits:
                raise NotSupported("its elements are not numbers")
            field_type.item |= {
                "bits": field_type.bits,
                "count": REST if isinstance(count, Counter) else count,
            }
        field_type.item |= summary(str(attribute.get("doc") or "")) | unit(
            _unit(attribute)
        )
        part = placed(where, field_type, self.at, counter)
        apply_valid(part, attribute.get("valid"), scope)
        self._fit(part)
        return part

    def _fit(self, part: KaitaiPart) -> None:
        """Add a part.

        Raises `NotSupported` if it does not fit into the enclosing part.
        """
        self._check_end(part.bits)
        if self.first_variable is not None and part.bits % 8:
            raise NotSupported(
                "it follows a part of variable size, and does not have whole bytes"
            )
        self.add(part)

    def _check_end(self, bits: int) -> None:
        """Raise `NotSupported` if the next ``bits`` do not fit into the enclosing part."""
        if self.ends and self.at + bits > self.ends[-1]:
            raise NotSupported("it is longer than the part that contains it")

    def _constant(self, where: tuple[str, ...], always: bytes, attribute: Map) -> None:
        """Add the bytes of `contents` as constant integers of up to 8 bytes.

        Raises `NotSupported` if they do not fit into the enclosing part.
        """
        self._align()
        self._check_end(8 * len(always))
        for start in range(0, len(always), _WORD):
            data = always[start : start + _WORD]
            name = where if len(always) <= _WORD else (*where, str(start // _WORD + 1))
            item = {
                "type": "uint",
                **(summary(str(attribute.get("doc") or "")) if not start else {}),
            }
            bits = 8 * len(data)
            part = placed(name, KaitaiFieldType(item, bits), self.at)
            part.mask, part.value = (1 << bits) - 1, int.from_bytes(data, "big")
            self.add(part)

    def _structs(
        self,
        where: tuple[str, ...],
        inner: KaitaiType,
        count: int | Counter | str,
        attribute: Map,
        within: tuple[KaitaiType, ...],
    ) -> None:
        """Add an array of structs.

        Raises `NotSupported` if the layout of the type depends on values or varies in
        size.
        """
        self._align()
        layout = KaitaiLayout(self.file, {}, is_struct=True)
        try:
            layout._within(
                attribute,
                inner,
                TypeScope(inner),
                (),
                (*within, inner) if stated_size(attribute) is None else within,
            )
        except Undecided as error:
            raise NotSupported(
                f"what each of them has depends on `{error.key[0][-1]}`"
            ) from None
        if not layout.parts and not layout.at:
            return  # a type without bytes, such as an empty `seq`
        if layout.first_variable is not None or layout.at % 8:
            raise NotSupported("they are not of a fixed number of bytes")
        counter = count if isinstance(count, Counter) else None
        item: Item = {
            "struct": inner.name,
            "count": REST if counter else count,
            **summary(str(attribute.get("doc") or "")),
        }
        struct = self.file.structs.setdefault(
            id(inner), {"name": inner.name, "length": layout.at // 8, "parts": layout}
        )
        if struct["length"] != layout.at // 8:
            raise NotSupported("they are not as long as elsewhere")
        self._fit(placed(where, KaitaiFieldType(item, layout.at), self.at, counter))

    def _as_bytes(
        self,
        attribute: Map,
        where: tuple[str, ...],
        why: NotSupported,
        is_present: bool,
    ) -> None:
        """Add an attribute that is not supported as bytes, and report it (IMP081).

        An attribute without a fixed size takes all remaining bytes; then `Ended` is
        raised. Raises ``why`` in a struct.
        """
        if self.is_struct:
            raise why
        try:
            size = (
                stated_size(attribute)
                if is_present and "repeat" not in attribute
                else None
            )
            if size is not None:
                self._align()
                self._check_end(8 * size)
        except NotSupported:
            size = None
        # Bytes up to the end of the frame could be more than a frame can have.
        is_lost = self.is_open or (size is None and self.first_variable is not None)
        is_end = is_lost or size is None
        if is_lost:
            effect = "no part of it is imported"
        elif size is not None:
            effect = "its bytes are imported"
            self._bytes(where, 8 * size)
        elif self.ends:
            effect = "its bytes and all bytes behind it are imported"
            self._align()
            if self.ends[-1] > self.at:
                self._bytes(where, self.ends[-1] - self.at)
            self.at = self.ends[-1]
        else:
            effect = "the bytes up to the end of the frame are imported"
            self._bytes(where, 0)
        settle(attribute)
        self.file.note(
            AS_BYTES,
            f"`{' '.join(where)}` is not imported: {why}",
            effect,
            "error",
            attribute.place.line,
        )
        if is_end:
            raise Ended

    def _bytes(self, where: tuple[str, ...], bits: int) -> None:
        """Add bytes without a meaning. 0 ``bits`` stand for all bytes up to the end of
        the frame.
        """
        self._align()
        item: Item = {"type": "bytes"}
        part = placed(where, KaitaiFieldType(item, bits), self.at)
        part.is_whole = False
        self.add(part)

    # Branches: `if` and `switch-on`.

    def _is_present(self, attribute: Map, name: str, scope: TypeScope) -> bool:
        """Return whether this message contains an attribute with `if`.

        Raises `NotSupported` if the condition is not supported.
        """
        conditions = equalities(attribute["if"])
        if len(conditions) > 1 and any(
            condition.is_negated for condition in conditions
        ):
            raise NotSupported(
                f"it depends on `{line(str(attribute['if']), 80)}`, which is more than equalities of fields"
            )
        for condition in conditions:
            value = number(condition.value, scope.type.members)
            chosen, is_new = self._choose(condition.of, [value], scope, is_else=True)
            is_met = (chosen is not None) != condition.is_negated
            if is_new:
                self.labels.append(
                    BranchLabel(
                        f"with {name}" if is_met else "",
                        "" if chosen is None else f"{value}",
                    )
                )
            if not is_met:
                return False
        return True

    def _switched(self, switch: Map, scope: TypeScope) -> str | None:
        """Return the type that a `switch-on` selects in this message, None if no case
        applies.

        Raises `NotSupported`.
        """
        cases = switch.get("cases")
        if not isinstance(cases, Map):
            raise NotSupported("a switch has no cases")
        types = {
            number(key, scope.type.members): str(of)
            for key, of in cases.items()
            if key != "_"
        }
        of = masked(switch.get("switch-on"))
        value, is_new = self._choose(of, list(types), scope, is_else="_" in cases)
        chosen = str(cases["_"]) if "_" in cases else None
        if value is not None:
            chosen = types[value]
        if is_new and chosen is not None:
            self.labels.append(
                BranchLabel(chosen, "other" if value is None else f"{value}")
            )
        return chosen

    def _choose(
        self, of: Masked, options: list[int], scope: TypeScope, is_else: bool
    ) -> tuple[int | None, bool]:
        """Return which of ``options`` the bits of a field have in this message, and
        whether a new decision was needed.

        Returns None as the value if the bits differ from all options. ``is_else``:
        other values have their own branch. Raises `Undecided` if the value is not in
        ``decided``, `NotSupported` if the field is not an integer.
        """
        part = scope.find_part(of.path)
        item = part.item
        if "count" in item or item["type"] not in ("uint", "int", "enum", "bool"):
            raise NotSupported(f"it depends on `{of.path}`, which is not an integer")
        all_bits = (1 << part.bits) - 1
        mask = all_bits if of.mask is None else of.mask & all_bits
        raw = {
            option & mask: option
            for option in options
            # Options that the field cannot have are left out: their bits give another
            # number, both unsigned and as two's complement.
            if option in (option & mask, (option & mask) - all_bits - 1)
        }
        if part.mask & mask == mask:
            return raw.get(part.value & mask), False
        if self.is_behind(part):
            raise NotSupported(
                f"it depends on `{of.path}`, which follows a part of variable size"
            )
        common = part.mask & mask
        possible = [
            value
            for value in raw
            if not (value ^ part.value) & common and (mask, value) not in part.excluded
        ]
        key = (part.path, mask, tuple(possible))
        free = mask & ~part.mask
        is_all = len(possible) == 1 << free.bit_count()
        if not possible:
            return None, False
        if key not in self.decided:
            raise Undecided(
                key, [*possible, *([None] if is_else and not is_all else [])]
            )
        chosen = self.decided[key]
        if chosen is None and free.bit_count() == 1 and len(possible) == 1:
            # A single bit that differs from the only option has the other value.
            part.mask, part.value = (
                part.mask | mask,
                part.value & ~mask | (possible[0] ^ free),
            )
        elif chosen is None:
            part.excluded |= {(mask, value) for value in possible}
        else:
            part.mask, part.value = part.mask | mask, part.value & ~mask | chosen
        return (None if chosen is None else raw[chosen]), True

    def _instances(
        self, type_: KaitaiType, scope: TypeScope, path: tuple[str, ...]
    ) -> None:
        """Add the formulas of `instances`, and the fields of instances at a fixed
        `pos`.

        Reports instances not imported.
        """
        instances = type_.instances.items()
        for name, instance in (
            instances if type_.seq else sorted(instances, key=_position)
        ):
            if not isinstance(instance, Map) or self._add_positioned(
                name, instance, type_, scope
            ):
                continue
            where = " ".join((*path, name))
            if "value" not in instance:
                settle(instance)
                text = f"`{where}` is not imported: an expression gives its position"
                self.file.note(
                    AS_BYTES,
                    text,
                    "the fields of the sequence are imported",
                    "error",
                    instance.place.line,
                )
                continue
            if not self._formula(instance, scope):
                settle(instance)
                expression = line(str(instance["value"]), 80)
                text = (
                    f"`{where}`: `{expression}` is not a linear function of one field"
                )
                self.file.note(
                    RAW_ONLY,
                    text,
                    "the fields that it is computed from are imported",
                    "warning",
                    instance.place.line,
                )

    def _add_positioned(
        self, name: str, instance: Map, type_: KaitaiType, scope: TypeScope
    ) -> bool:
        """Add an instance with a fixed `pos` as a field, and return whether it is one.

        This is supported for the root type of a format without `seq`.
        """
        at = instance.get("pos")
        if (
            not isinstance(at, int)
            or "io" in instance
            or type_.outer is not None
            or type_.seq
        ):
            return False
        if self.first_variable is not None or 8 * at < self.at or at > MOST_BYTES:
            return False
        self.at = 8 * at
        try:
            self._attribute(instance, name, (name,), scope, (type_,))
        except TooMuch:
            raise
        except NotSupported as why:
            self._as_bytes(instance, (name,), why, is_present=True)
        return True

    def _formula(self, instance: Map, scope: TypeScope) -> bool:
        """Add the formula of an instance to the field it depends on, and return whether
        that is possible.
        """
        if isinstance(instance["value"], (int, float)):
            return True  # a constant of the definition; the frame does not contain it
        linear = linear_function(instance["value"], is_integer=False)
        if linear is None:
            return False
        try:
            part = scope.find_part(linear[0])
        except NotSupported:
            return False
        item = part.item
        if (
            item.get("type") not in ("uint", "int", "float")
            or "formula" in item
            or "view" in item
        ):
            return False
        if any(
            other.counter is not None and other.counter.part is part
            for other in self.parts
        ):
            return False  # a counter cannot have a formula
        if (
            item["type"] != "float"
            and linear_function(instance["value"], is_integer=True) is None
        ):
            return False
        if linear[1] != "raw":
            for raw in ("min", "max"):  # in an ICD, limits apply to the physical value
                item.pop(raw, None)
            item |= {"formula": linear[1], **unit(_unit(instance))}
            if "summary" not in item:
                item |= summary(str(instance.get("doc") or ""))
        return True


def _position(instance: tuple[str, Any]) -> float:
    """Sort key of an instance: its `pos` in bytes. Computed instances come last."""
    at = instance[1].get("pos") if isinstance(instance[1], Map) else None
    return at if isinstance(at, int) else math.inf


def _unit(attribute: Map) -> str:
    """Return the unit from the key `-unit`, a convention of Kaitai Struct files; the
    language itself has no units.
    """
    return str(attribute.get("-unit") or "")
