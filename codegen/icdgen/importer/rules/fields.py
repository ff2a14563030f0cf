"""Roles of a row -> a field with its place, type, scale and limits.

Nothing has a default: what no rule states is a finding.
"""

from __future__ import annotations

import re
from dataclasses import dataclass, field, replace
from decimal import Decimal
from typing import Any

from icdgen.import_results.findings import SourcePlace
from icdgen.importer import descriptions, formulas
from icdgen.importer.descriptions import Described
from icdgen.importer.document import SourceTable
from icdgen.importer.profile import Profile
from icdgen.importer.rules import places, positions
from icdgen.importer.rules.bit_order import Bit, Order
from icdgen.importer.rules.cells import Roles
from icdgen.importer.rules.language import (
    NUMBERS,
    TypeName,
    decimal,
    type_of,
    whole_number,
)
from icdgen.importer.rules.notes import Notes
from icdgen.importer.rules.rule import TableRule
from icdgen.importer.words import tidy_unit

MOST_BITS = 64  # of a number
_EMPTY = ("", "n/a", "none")
# `(V)`, but not `(N)·(m)`.
_IN_PARENTHESES = re.compile(r"\A\(([^()]*(?:\([^()]*\)[^()]*)*)\)\Z")
_VALUE = r"(?:0x[0-9a-f]+|0b[01]+|-?[0-9]+)"
# A comma separates members only in front of a value: names may contain one.
_MEMBER = re.compile(
    rf"(?P<value>{_VALUE})\s*[:=–-]?\s*(?P<name>[^;\n]*?[^\s;,])\s*(?:[;\n]|,(?=\s*{_VALUE})|\Z)",
    re.I,
)


@dataclass
class FieldDraft:
    """Field before references are resolved. ``bits`` is the size of one element."""

    name: str
    at: int
    bits: int
    kind: str
    described: Described
    spot: SourcePlace
    roles: Roles
    count: int = 0
    members: list[tuple[int, str]] = field(default_factory=list)
    # Further keys of the field in the ICD.
    facts: dict[str, Any] = field(default_factory=dict)
    # bit numbers of the whole field that this piece has
    part: tuple[int, int] | None = None
    order: Order | None = None  # where it is not the node's
    # The table of bits that gives the field; None for the table of its message.
    table: SourceTable | None = None
    # From the least significant one, if `at` does not state them.
    frame_bits: list[Bit] = field(default_factory=list)

    @property
    def size(self) -> int:
        """Number of bits of the field in the frame; 0 if the end of the frame
        determines it.
        """
        return (
            0
            if self.facts.get("count") == "rest" or "size" in self.facts
            else self.bits * (self.count or 1)
        )

    @property
    def end(self) -> int:
        """Bit after the field."""
        return self.at + self.size


class FieldReader:
    """Makes the fields of a table's rows; ``order`` is the node's."""

    def __init__(
        self,
        rule: TableRule,
        table: SourceTable,
        profile: Profile,
        order: Order,
        notes: Notes,
    ) -> None:
        self.rule, self.table, self.profile, self.order, self.notes = (
            rule,
            table,
            profile,
            order,
            notes,
        )
        self.places = places.PlaceReader(rule, order, self.error)
        self.next = 0  # where a field without a position stands
        self.subject = ""  # name of the field, or text of the row, that is being read

    def read(self, roles: Roles) -> list[FieldDraft]:
        """Return the field of a row; several for padding in several places; none, with
        a finding, if it cannot be read.
        """
        for role, last in (("bit", "last_bit"), ("byte", "last_byte")):
            printed = roles.get(role)
            if not positions.is_list(printed):
                continue
            runs = positions.runs_of(printed)
            if len(runs) > 1 and not self.profile.is_reserved(roles.get("name")):
                self.subject = roles.get("name")
                self.error(
                    "IMP105",
                    f"{self.table.title}, field `{self.subject}`: its {role}s `{printed[:40]}` are not consecutive",
                    self.table.spot_of(roles.row.source),
                    "write a row for each part in the table file (--tables), and number the parts by the role `part`",
                )
                return []
            each = [
                roles.given | {role: str(first), last: str(final)}
                for first, final in runs
            ]
            return [
                draft
                for given in each
                for draft in self.read(replace(roles, given=given))
            ]
        draft = self.read_field(roles)
        return [draft] if draft is not None else []

    def read_field(self, roles: Roles) -> FieldDraft | None:
        """Return the field; None, with a finding, if something that it needs is
        missing.
        """
        name, spot = roles.get("name"), self.table.spot_of(roles.row.source)
        where = f"{self.table.title}, field `{name}`"
        self.subject = name or roles.row.text
        if not name:
            self.error(
                "IMP025",
                f"{self.table.title}: the row `{roles.row.text[:80]}` gives no name",
                spot,
                "give a column the role `name`, or drop the row with `skip`",
            )
            return None
        numbers = self.numbers(roles, where, spot)
        printed = self.type_of(roles, where, spot)
        if numbers is None or printed is None:
            return None
        # In a group, `count` is the number of elements of the group. The field itself
        # is no array.
        if roles.get("group") and not roles.get("counter") and not roles.get("rest"):
            numbers.pop("count", None)
        sized = self.size(numbers, printed, roles, where, spot)
        if sized is None:
            return None
        bits, count = sized
        if "end_bit" in numbers and not self.places.is_range_clear(
            numbers, bits * (count or 1), where, spot
        ):
            return None
        place = self.places.place(numbers, roles.byte_shift, bits * (count or 1))
        at, range_size = place if place is not None else (self.next, 0)
        if bits == 0 and range_size:
            bits = range_size // (count or 1)
        if at < 0:
            self.error("IMP105", f"{where}: it begins before the message, at bit {at}", spot,
                       "`origin` is the byte of the table at which the message begins")  # fmt: skip
            return None
        if range_size and bits * (count or 1) != range_size:
            self.error(
                "IMP105",
                f"{where}: its position covers {range_size} bits, its size is {bits * (count or 1)}",
                spot,
                "check the roles of position, size, type and count",
            )
            return None
        # `width: unit`: a position without a size is one bit or one byte.
        if bits == 0 and self.rule.is_unit_wide and place is not None:
            bits = 1 if "bit" in numbers else 8
        if (
            bits == 0
            and (roles.get("rest") or roles.get("counter"))
            and not roles.get("group")
        ):
            bits = 8
        if bits == 0:
            self.error(
                "IMP105",
                f"{where}: its size is not given",
                spot,
                "give a role for `bits`, `bytes`, `last_byte` or `last_bit`, "
                "or a type with a width; `width: unit` makes a single position one bit or byte",
            )
            return None
        frame_bits = self.places.frame_bits(
            numbers, at, bits * (count or 1), where, spot
        )
        if frame_bits is None:
            return None
        kind = printed.kind
        # Manuals print an array of bytes as one range, too; integers of these sizes are
        # rare.
        if (
            kind in ("uint", "int")
            and bits in (40, 48, 56)
            and range_size
            and not printed.bits
            and not count
        ):
            self.warn(
                "IMP105",
                f"{where}: a number of {bits // 8} bytes is unusual, and only its range of bytes gives this size",
                spot,
                "is it an array? `set: [{where: {name: ...}, bits: 8, count: N}]`",
            )
        if kind in ("uint", "int", "enum") and bits > MOST_BITS:
            self.error(
                "IMP105",
                f"{where}: a number has at most {MOST_BITS} bits, this one {bits}",
                spot,
                "is it an array? `set: [{where: {name: ...}, bits: 16, count: 3}]`, or `type: bytes`",
            )
            return None
        draft = FieldDraft(
            name,
            at,
            bits,
            kind,
            self.described(roles, kind, where, spot),
            spot,
            roles,
            count,
        )
        draft.frame_bits = frame_bits
        self.facts(draft, numbers, where, spot)
        self.next = draft.end
        return draft

    def error(self, code: str, message: str, spot: SourcePlace, help: str) -> None:
        self.notes.error(code, message, spot, help, self.rule.place, self.subject)

    def warn(self, code: str, message: str, spot: SourcePlace, help: str) -> None:
        self.notes.warn(code, message, spot, help, self.rule.place, self.subject)

    def numbers(
        self, roles: Roles, where: str, spot: SourcePlace
    ) -> dict[str, int] | None:
        """Return the roles that are whole numbers; None, with a finding, if a text is
        not a number.
        """
        numbers = {}
        for role in (
            "byte",
            "last_byte",
            "bit",
            "last_bit",
            "end_bit",
            "bytes",
            "bits",
            "count",
            "stride",
            "up_to",
        ):
            text = roles.get(role)
            if not text:
                continue
            value = whole_number(
                text, self.rule.base if role in ("byte", "last_byte") else 10
            )
            if value is None or value < 0:
                is_range = re.fullmatch(r"\d+\s*[-–:~]\s*\d+", text) and role in (
                    "byte",
                    "bit",
                )
                self.error(
                    "IMP023",
                    f"{where}: `{role}` is `{text[:40]}`, which is not a number",
                    spot,
                    (
                        f"take both ends of the range: `'^{{{role}}}(?:[-–:~]{{last_{role}}})?$'`"
                        if is_range
                        else "correct the pattern or the table file"
                    ),
                )
                return None
            numbers[role] = value
        return numbers

    def type_of(self, roles: Roles, where: str, spot: SourcePlace) -> TypeName | None:
        """Return the type that the rule, the row or the `types` of the profile state."""
        name = roles.get("type")
        if not name and roles.members:
            return TypeName("enum")
        own = self.profile.types_of_profile.get("".join(name.casefold().split()))
        type_name = own or (type_of(name) if name else None)
        if type_name is None and self.profile.is_reserved(roles.get("name")):
            return TypeName("reserved")  # tables print a dash as its type, or nothing
        if not name:
            self.error(
                "IMP026",
                f"{where}: its type is not stated",
                spot,
                "give a column the role `type`, or state one for all: `each: {type: uint}`",
            )
            return None
        if type_name is None:
            self.error(
                "IMP026",
                f"{where}: the type `{name[:40]}` is unknown",
                spot,
                f"explain it in the profile: `types: {{{name[:30]}: {{type: uint, bits: 16}}}}`",
            )
        return type_name

    def size(
        self,
        numbers: dict[str, int],
        printed: TypeName,
        roles: Roles,
        where: str,
        spot: SourcePlace,
    ) -> tuple[int, int] | None:
        """Bits of an element, 0 if only a range can tell, and number of elements, 0 for
        no array.

        The role `bits` is the size of one element, `bytes` that of the whole field.
        """
        count = numbers.get("count", 0)
        total = 8 * numbers.get("bytes", 0)
        if printed.kind in ("text", "bytes") and count and total in (0, 8 * count):
            return 8 * count, 0  # so many characters
        # A column of counts has 1 for fields that are no arrays.
        count = 0 if count == 1 else count
        element = numbers.get("bits") or (
            total // count if count and total % count == 0 else total
        )
        if printed.bits and printed.kind != "bool":
            # Some tables print the size of one element.
            if element in (0, printed.bits) or total == printed.bits:
                return printed.bits, count
            self.error(
                "IMP105",
                f"{where}: its type `{roles.get('type')}` has {printed.bits} bits"
                f"{f' times {count}' if count else ''}, its size is {numbers.get('bits') or total}",
                spot,
                "check the columns of type, size and count",
            )
            return None
        if count and total % count:
            self.error(
                "IMP105",
                f"{where}: {count} elements do not fit into {total // 8} bytes",
                spot,
                "check the columns of size and count",
            )
            return None
        return element or printed.bits, count

    def described(
        self, roles: Roles, kind: str, where: str, spot: SourcePlace
    ) -> Described:
        """Unit, formula and description."""
        text = roles.get("text")
        described = Described(prose=text)
        if self.profile.reads_descriptions:
            described = descriptions.read_description(
                text, self.profile, is_enum=kind == "enum"
            )
        for problem in described.problems:
            self.warn(
                "IMP040", f"{where}: {problem}: `{text[-160:]}`", spot, "read the page"
            )
        unit = _IN_PARENTHESES.sub(r"\1", tidy_unit(roles.get("unit")))
        if unit.casefold() not in _EMPTY:
            described.unit = unit
        if const := roles.get("const"):
            raw = whole_number(const)
            if raw is None:
                self.error(
                    "IMP023",
                    f"{where}: `const` is `{const[:40]}`, which is not a number",
                    spot,
                    "correct the pattern or the table file",
                )
            else:
                # Hexadecimal constants stay so: magic numbers are recognized by it.
                described.const = (
                    const if re.fullmatch(r"0[xX][0-9A-Fa-f]+", const) else str(raw)
                )
        formula = roles.get("formula")
        if formula.casefold() not in _EMPTY:
            scaled = formulas.formula_of_step(
                formula, descriptions.value_names(self.profile)
            )
            if scaled is None:
                self.error(
                    "IMP040",
                    f"{where}: the formula `{formula[:60]}` cannot be read",
                    spot,
                    "take its numbers with `{scale}`, `{offset}` and `{bias}`",
                )
            else:
                described.formula, described.unit = (
                    scaled.formula,
                    scaled.unit or described.unit,
                )
        values = {}
        for role in NUMBERS:
            given = roles.get(role)
            if given.casefold() in _EMPTY:
                continue
            value = decimal(given)
            if value is None:
                self.error(
                    "IMP023",
                    f"{where}: `{role}` is `{given[:40]}`, which is not a number",
                    spot,
                    "correct the pattern or the table file",
                )
            else:
                values[role] = value
        roles.given = {
            role: text for role, text in roles.given.items() if role not in NUMBERS
        } | values
        described.formula = (
            scale_formula(values.get("scale"), values.get("offset"), values.get("bias"))
            or described.formula
        )
        return described

    def facts(
        self, draft: FieldDraft, numbers: dict[str, int], where: str, spot: SourcePlace
    ) -> None:
        """Limits, members, arrays of open length, parts."""
        roles = draft.roles
        for role in ("min", "max"):
            if role in roles.given and roles.get(role):
                value = float(roles.get(role))
                # An ICD has `3`, not `3.0`.
                draft.facts[role] = int(value) if value == int(value) else value
        self.check_range(draft, where, spot)
        if (roles.get("rest") or roles.get("counter")) and not roles.get("group"):
            counted: Any = roles.get("counter") or "rest"
            key = "size" if draft.kind in ("text", "bytes") else "count"
            draft.facts[key] = counted
            if "up_to" in numbers:
                draft.facts["up_to"] = numbers["up_to"]
            else:
                self.error(
                    "IMP105",
                    f"{where}: its greatest length is not stated",
                    spot,
                    "state it: `each: {up_to: 255}`, or under `set:`",
                )
        draft.members = self.members(roles, where, spot)
        enumeration = roles.get("enumeration")
        if (
            (draft.members or enumeration)
            and draft.kind in ("uint", "int")
            and not draft.described.formula
        ):
            draft.kind = "enum"
        if enumeration and not draft.members:
            draft.described.enum_title = enumeration
            if draft.kind != "enum":
                self.error(
                    "IMP050",
                    f"{where}: a field of the type {draft.kind}{' with a formula' if draft.described.formula else ''} "
                    f"cannot have the enumeration `{enumeration[:40]}`",
                    spot,
                    "correct the roles `type` and `enumeration`",
                )
        text = roles.get("part")
        if text:
            # `L` and `H` name the low and the high part.
            first = {"l": 0, "h": 1}.get(text.lower())
            if first is None:
                first = int(text)
            draft.part = first, int(roles.get("last_part") or first)

    def members(
        self, roles: Roles, where: str, spot: SourcePlace
    ) -> list[tuple[int, str]]:
        printed = roles.members + [
            (m["value"], m["name"]) for m in _MEMBER.finditer(roles.get("members"))
        ]
        left = _MEMBER.sub("", roles.get("members")).strip(" ;,\n")
        if left:
            self.error(
                "IMP104",
                f"{where}: `members` leaves `{left[:60]}`, which is no value with a name",
                spot,
                "write `0: off; 1: on`, or take values and names with patterns under `lines`",
            )
        members = []
        for text, name in printed:
            value = whole_number(text, self.rule.base)
            if value is None:
                self.error(
                    "IMP023",
                    f"{where}: the value `{text[:40]}` of `{name[:40]}` is no number",
                    spot,
                    "correct the pattern",
                )
            else:
                members.append((value, name))
        return members

    def check_range(self, draft: FieldDraft, where: str, spot: SourcePlace) -> None:
        """Report a range that the raw values of an unsigned number do not reach: an
        offset taken for a bias shows there.
        """
        # Limits are printed as decimals, and a double holds integers of at most 53 bits
        # exactly.
        if (
            draft.kind != "uint"
            or draft.bits > 53
            or not {"min", "max"} & set(draft.facts)
        ):
            return
        scale, offset, bias = (
            Decimal(draft.roles.get(r) or d)
            for r, d in (("scale", "1"), ("offset", "0"), ("bias", "0"))
        )
        low, high = sorted(
            scale * (raw - bias) + offset
            for raw in (Decimal(0), Decimal(2**draft.bits - 1))
        )
        for role, reaches in (
            ("min", low <= Decimal(str(draft.facts.get("min", low)))),
            ("max", high >= Decimal(str(draft.facts.get("max", high)))),
        ):
            if not reaches:
                self.notes.warn(
                    "IMP106",
                    f"{where}: its range has the {role} {draft.facts[role]}, its raw values give {low:f} to {high:f}",
                    spot,
                    "`offset` is added after scaling, `bias` is subtracted before: is one the other?",
                )


def scale_formula(scale: str | None, offset: str | None, bias: str | None) -> str:
    """Return the formula as an ICD writes it; empty if physical and raw value are the
    same.
    """
    # As texts, so that the formula has the digits of the manual: 0.10 does not become
    # 0.1.
    factor = scale if scale is not None and Decimal(scale) != 1 else ""
    raw = "raw"
    if bias is not None and Decimal(bias) != 0:
        raw = f"raw {'+' if bias.startswith('-') else '-'} {bias.lstrip('-')}"
        raw = f"({raw})" if factor else raw
    formula = f"{raw}*{factor}" if factor else raw
    if offset is not None and Decimal(offset) != 0:
        formula = (
            f"{formula} {'-' if offset.startswith('-') else '+'} {offset.lstrip('-')}"
        )
    return "" if formula == "raw" else formula
