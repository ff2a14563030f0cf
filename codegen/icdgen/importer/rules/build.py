"""Messages and enumerations from the parts of tables.

The parts that `interpret` has read go in. Consecutive tables of one message are joined,
split fields put together, and enumerations and lookup tables attached (`attach`). The
results are in the order of the tables, as `assemble` expects them.
"""

from __future__ import annotations

from collections import defaultdict

from icdgen.importer.descriptions import Described
from icdgen.importer.model import (
    Extent,
    ReadEnum,
    ReadField,
    ReadMember,
    ReadMessage,
    ReadStruct,
    TableResult,
)
from icdgen.importer.profile import Profile
from icdgen.importer.rules import attach, lists
from icdgen.importer.rules.bit_order import Order
from icdgen.importer.rules.fields import FieldDraft
from icdgen.importer.rules.language import normalised
from icdgen.importer.rules.notes import Notes
from icdgen.importer.rules.parts import TablePart, known_kind
from icdgen.importer.rules.split_fields import joined_parts
from icdgen.importer.words import squeezed
from icdgen.wording import count


class MessageBuilder:
    """Builder of messages; ``order`` has the byte and bit order of the node."""

    def __init__(self, profile: Profile, order: Order, notes: Notes) -> None:
        self.profile, self.order, self.notes = profile, order, notes
        self.enums: dict[str, ReadEnum] = {}
        self.enum_results: list[TableResult] = []

    def build_results(self, parts: list[TablePart]) -> list[TableResult]:
        """Return the messages and enumerations in the order of the tables."""
        messages = [
            part for part in parts if part.rule.what in ("message", "registers")
        ]
        for part in messages:
            self.place_fields(part)
        messages = self.joined_messages(messages)
        attach.attach(parts, messages, self.order, self.notes)
        results = []
        for part in messages:
            message = self.build_message(part)
            results.append(TableResult(message.table, "message", message))
        results += self.enum_results
        results += [
            lists.enumeration_of(part)
            for part in parts
            if part.rule.what == "enumeration" and part.given.get("enumeration")
        ]
        return sorted(results, key=lambda result: result.table.number)

    def place_fields(self, part: TablePart) -> None:
        """Put the pieces of split fields together and bring bits into the node's order."""
        is_register = part.rule.what == "registers"
        length = (
            part.number("length")
            or (max((draft.end for draft in part.drafts), default=0) + 7) // 8
        )
        part.drafts = joined_parts(
            part.drafts, self.order, is_register, length, self.notes, part.rule
        )

    def joined_messages(self, parts: list[TablePart]) -> list[TablePart]:
        """Return the messages, with consecutive tables of one message joined.

        Such tables have one rule, id and kind.
        """
        merged: list[TablePart] = []
        last: TablePart | None = None
        for part in parts:
            # Only consecutive tables are joined. A later table with the same id is a
            # description of its own.
            before, last = last, part
            if before is None or not _is_same_message(before, part):
                merged.append(part)
            elif _overlap(merged[-1].drafts, part.drafts):
                self.notes.error(
                    "IMP105",
                    f"{part.where}: table {before.table.number} describes a message of the same id, and fields of both overlap",
                    part.table.spot,
                    "correct the pattern of the id, or read each by its own rule",
                    part.rule.place,
                )
                merged.append(part)
            else:
                merged[-1].drafts = sorted(
                    [*merged[-1].drafts, *part.drafts], key=lambda draft: draft.at
                )
        return merged

    def build_message(self, part: TablePart) -> ReadMessage:
        """Return the message of a part."""
        table = part.table
        kind = known_kind(
            part.given.get("kind", ""), part.where, table.spot, part.rule, self.notes
        )
        message = ReadMessage(
            normalised(part.name), kind, table, bit_order=self.order.bit_order
        )
        message.summary = part.given.get("message_text", "")
        message.group = part.given.get("section", "")
        for role in ("id", "set_id", "get_id", "length"):
            text = part.given.get(role)
            value = part.number(role)
            if text and value is None:
                self.notes.error(
                    "IMP023",
                    f"{part.where}: its {role} is `{text[:40]}`, which is not a number",
                    part.table.spot,
                    "correct the pattern, or state `base: 16`",
                    part.rule.place,
                )
            setattr(message, role, value)
        # One id for setting and reading, as in protocols with a direction bit.
        if kind == "configuration" and message.id is not None:
            message.set_id = message.get_id = message.id
            message.id = None
        self.add_fields(message, part)
        self.check_announced_formulas(message, part)
        return message

    def check_announced_formulas(self, message: ReadMessage, part: TablePart) -> None:
        """Report formulas that give another value than the words before them announce:
        one finding for a table.
        """
        for announced, given in (("raw", "physical"), ("physical", "raw")):
            names = [
                field.name
                for field in message.fields
                if field.described.formula_for == announced
            ]
            if names:
                subject = f"the formula of `{names[0]}`" + (
                    f" and of {count(len(names) - 1, 'more field')}"
                    if names[1:]
                    else ""
                )
                self.notes.warn(
                    "IMP041",
                    f"{part.where}: {subject} is announced as giving the {announced} value and gives the {given} one",
                    part.table.spot,
                    "taken as printed; `formula_for` has what the words announce: find out which is right",
                    part.rule.place,
                )

    def add_fields(self, message: ReadMessage, part: TablePart) -> None:
        """Give the message its fields, reserved bits and structs."""
        groups: dict[str, list[FieldDraft]] = defaultdict(list)
        seen: set[str] = set()
        for draft in part.drafts:
            if self.profile.is_reserved(draft.name):
                message.reserved.append(
                    Extent(draft.at, draft.end, (draft.order or self.order).bit_order)
                )
            elif draft.roles.get("group"):
                groups[normalised(draft.roles.get("group"))].append(draft)
            else:
                self.check_name(draft, part, seen)
                message.fields.append(self.build_field(draft, part))
        for name, drafts in groups.items():
            self.add_struct(message, name, drafts, part)
        message.fields.sort(key=lambda field: field.at)

    def check_name(self, draft: FieldDraft, part: TablePart, seen: set[str]) -> None:
        """Report names that look like a mistake of a rule."""
        key = squeezed(draft.name)
        if not any(c.isalpha() for c in draft.name) or key in seen:
            what = (
                "two fields have this name" if key in seen else "this cannot be a name"
            )
            self.notes.error(
                "IMP107",
                f"{part.where}, field `{draft.name[:60]}`: {what}",
                draft.spot,
                "correct the pattern of `name`, or correct one with `set:`",
                part.rule.place,
            )
        seen.add(key)

    def build_field(self, draft: FieldDraft, part: TablePart) -> ReadField:
        """Return the field of a draft."""
        field = ReadField(
            draft.name,
            draft.at,
            draft.bits,
            draft.kind,
            draft.described,
            draft.spot,
            draft.count,
        )
        field.facts = dict(draft.facts)
        if draft.order is not None:
            node = self.order
            field.facts |= {
                key: getattr(draft.order, key)
                for key in Order._fields
                if getattr(draft.order, key) != getattr(node, key)
            }
        if draft.kind == "bool" and draft.bits != 1:
            self.notes.warn(
                "IMP026",
                f"{part.where}, field `{draft.name}`: a bool has one bit, this one {draft.bits}",
                draft.spot,
                "represented as uint",
                part.rule.place,
            )
            field.type = "uint"
        if draft.members:
            field.enum = self.enumeration_name(draft, part)
        elif draft.kind == "enum" and (
            draft.described.enum_table is None and not draft.described.enum_title
        ):
            self.notes.error(
                "IMP050",
                f"{part.where}, field `{draft.name}`: its values are not given",
                draft.spot,
                "give them with the role `members`, or with a rule `what: enumeration`",
                part.rule.place,
            )
            field.type = "uint"
        return field

    def enumeration_name(self, draft: FieldDraft, part: TablePart) -> str:
        """Return the name of the enumeration with the members of the field.

        Fields with one name and equal members share an enumeration.
        """
        members = [ReadMember(value, name) for value, name in draft.members]
        stated = [normalised(name)] if (name := draft.roles.get("enumeration")) else []
        for name in (
            *stated,
            draft.name,
            f"{part.name} {draft.name}".strip(),
            f"{part.name} {draft.name} {draft.at}",
        ):
            # The first name that is free, or whose enumeration has equal members.
            own = self.enums.get(name)
            if own is None:
                own = self.enums[name] = ReadEnum(
                    name, members, draft.table or part.table
                )
                self.enum_results.append(TableResult(own.table, "enumeration", own))
            if own.members == members:
                return name
        return draft.name

    def add_struct(
        self, message: ReadMessage, name: str, drafts: list[FieldDraft], part: TablePart
    ) -> None:
        """Add fields of a group as an array of structs.

        The number of elements is fixed, given by a field, or as large as the frame has
        room for.
        """
        strides = {draft.roles.get("stride") for draft in drafts} - {""}
        start = min(draft.at for draft in drafts)
        size = (max(draft.end for draft in drafts) - start + 7) // 8
        if len(strides) > 1 or (strides and strides != {str(size)}):
            self.notes.error(
                "IMP105",
                f"{part.where}: the fields of the group `{name}` need {size} bytes, its elements stand "
                f"{' and '.join(sorted(strides))} bytes apart",
                part.table.spot,
                "check the role `stride`",
                part.rule.place,
            )
            return
        first = drafts[0].roles
        counted = first.get("counter") or (
            "rest" if first.get("rest") else first.get("count")
        )
        bound = first.get("up_to")
        if not counted or (not bound and not counted.isdigit()):
            self.notes.error(
                "IMP105",
                f"{part.where}: the number of repetitions of the group `{name}` is not given",
                part.table.spot,
                "give `count`, or `counter` or `rest` and `up_to`, for instance under `each:`",
                part.rule.place,
            )
            return
        fields = []
        for draft in sorted(drafts, key=lambda draft: draft.at):
            draft.facts = {
                key: value
                for key, value in draft.facts.items()
                # These keys describe the repetition of the group, not its fields.
                if key not in ("count", "size", "up_to")
            }
            field = self.build_field(draft, part)
            field.at -= start
            fields.append(field)
        title = f"{part.name} {name}".strip()
        message.structs.append(ReadStruct(title, size, fields))
        facts = {
            "struct": title,
            "count": int(counted) if counted.isdigit() else counted,
        }
        array = ReadField(
            name,
            start,
            8 * size,
            "struct",
            Described(),  # texts belong to the fields of the struct
            drafts[0].spot,
        )
        array.facts = facts | (
            {"up_to": int(bound)} if bound and not counted.isdigit() else {}
        )
        message.fields.append(array)


def _is_same_message(first: TablePart, second: TablePart) -> bool:
    """Return whether two tables have one rule, and give the same kind and ids."""
    keys = ("kind", "id", "set_id", "get_id")
    same = all(first.given.get(key) == second.given.get(key) for key in keys)
    has_id = any(first.given.get(key) for key in keys[1:])
    return (
        first.rule is second.rule
        and first.table is not second.table
        and same
        and has_id
    )


def _overlap(first: list[FieldDraft], second: list[FieldDraft]) -> bool:
    return any(a.at < b.end and b.at < a.end for a in first for b in second)
