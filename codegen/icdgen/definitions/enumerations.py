"""Value names as enumeration members with unique names, and enumerations that several
fields share.

Value names of a quantity, such as a number with a formula, do not make an enumeration:
they become its `special` values (`is_enumeration`).
"""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Mapping
from dataclasses import dataclass, field

from icdgen.definitions.model import Definitions, Item
from icdgen.definitions.wording import line
from icdgen.icd.layout import integer_range

SAME_NAME = "IMP073"
BEYOND = "IMP074"
LEFT_OUT = "IMP090"
# special values of a field; each becomes a constant in generated code
MOST_SPECIAL = 1024
_LONGEST = 400
_LIMITS = ("min", "max", "above", "below")
_OF_NUMBERS = ("unit", *_LIMITS)  # keys that an enumeration does not have


def members(
    choices: Mapping[int, str], first: int, last: int, where: str, to: Definitions
) -> list[Item]:
    """Return the enumeration members for values from ``first`` to ``last``.

    Consecutive values of equal name form a range. Other duplicate names are extended by
    their value (IMP073). Names of values out of range are left out (IMP074).
    """
    beyond = [value for value in choices if not first <= value <= last]
    if beyond:
        shown = ", ".join(map(str, beyond[:5])) + (" ..." if len(beyond) > 5 else "")
        to.warn(
            BEYOND,
            f"{where}: it never has the value {shown}, which has a name",
            "the name is left out",
        )
    result: list[Item] = []
    for value, text in sorted(choices.items()):
        name = line(text, _LONGEST)
        if value in beyond or not name:
            continue
        if (
            result
            and result[-1]["name"] == name
            and result[-1].get("to", result[-1]["value"]) == value - 1
        ):
            result[-1]["to"] = value
        else:
            result.append({"value": value, "name": name})
    for name, times in Counter(member["name"] for member in result).items():
        if times > 1:
            duplicates = [member for member in result if member["name"] == name]
            values = ", ".join(str(member["value"]) for member in duplicates)
            text = f"{where}: `{name}` is the name of {values}"
            to.warn(SAME_NAME, text, "each is imported with its value behind the name")
            # The extended name may itself be the name of another value.
            taken = {member["name"] for member in result}
            for member in duplicates:
                extended_name = f"{name} {member['value']}"
                member["name"] = (
                    extended_name
                    if extended_name not in taken
                    else f"{extended_name} of {where}"
                )
    return [
        {key: member[key] for key in ("value", "to", "name") if key in member}
        for member in result
    ]


def is_enumeration(item: Item, bits: int, named: list[Item]) -> bool:
    """Return whether a number with value names is an enumeration.

    Otherwise it is a quantity with special values.

    It is an enumeration if the names cover all values, or if the field has neither unit
    nor limits. A field with a formula is a quantity. A signed number is an enumeration
    only if a named value is negative, because the ICD derives the sign from the
    members.
    """
    if (
        item["type"] not in ("uint", "int")
        or not named
        or item.keys() & {"formula", "points"}
    ):
        return False
    # The type `enum` has no sign of its own: it is signed if a member is negative.
    is_signed = item["type"] == "int"
    if is_signed != any(member["value"] < 0 for member in named):
        return False
    return not item.keys() & set(_OF_NUMBERS) or _covers(
        named, *_value_range(item, bits)
    )


def _value_range(item: Item, bits: int) -> tuple[int, int]:
    """Return the first and last value of a number without a formula, within its limits."""
    first, last = integer_range(bits, item["type"] == "int")
    low, high = item.get("min", first), item.get("max", last)
    if "above" in item:
        low = max(low, math.floor(item["above"]) + 1)
    if "below" in item:
        high = min(high, math.ceil(item["below"]) - 1)
    return max(first, math.ceil(low)), min(last, math.floor(high))


def _covers(named: list[Item], first: int, last: int) -> bool:
    """Return whether each value from ``first`` to ``last`` has a name; ``named`` is in
    ascending order.
    """
    following = first
    for member in named:
        if member["value"] > following:
            break
        following = max(following, _last(member) + 1)
    return following > last


def _last(member: Item) -> int:
    """Return the last value of a member, which may be a range."""
    return int(member["to"] if "to" in member else member["value"])


def special(named: list[Item], where: str, to: Definitions) -> Item:
    """Return the key `special` with a value for each name, and each value of a range.

    Reports names above `MOST_SPECIAL` (IMP090).
    """
    values: list[Item] = []
    for number, member in enumerate(named):
        last = _last(member)
        if len(values) + last - member["value"] >= MOST_SPECIAL:
            text = f"{where}: {len(named) - number} of {len(named)} names are left out, from `{member['name']}` on"
            help = f"a number has at most {MOST_SPECIAL:,} special values: put the names into its `summary`"
            to.warn(LEFT_OUT, text, help)
            break
        for value in range(member["value"], last + 1):
            values.append(
                {
                    "value": value,
                    "meaning": (
                        member["name"]
                        if last == member["value"]
                        else f"{member['name']} {value}"
                    ),
                }
            )
    return {"special": values} if values else {}


@dataclass
class Enumerations:
    """Collection of enumerations.

    Fields of equal name and values share an enumeration.
    """

    uses: list[tuple[Item, str, str, tuple[tuple[int, int, str], ...]]] = field(
        default_factory=list
    )

    def assign_enumeration(
        self, to: Item, name: str, owner: str, named: list[Item]
    ) -> None:
        """Assign an enumeration to a field.

        ``name`` is its preferred name, and ``owner`` a prefix for names in conflict.
        """
        values = tuple(
            (member["value"], _last(member), str(member["name"])) for member in named
        )
        self.uses.append((to, name, owner, values))

    def assign_value_names(
        self,
        to: Item,
        bits: int,
        choices: Mapping[int, str],
        name: str,
        owner: str,
        where: str,
        notes: Definitions,
    ) -> None:
        """Assign value names to a number, as an enumeration or as special values (see
        `is_enumeration`).

        ``to`` already has its formula, unit and limits. ``name`` is the preferred name
        of an enumeration, and ``owner`` a prefix for names in conflict. ``where`` names
        the field in findings.
        """
        if to["type"] not in ("uint", "int"):
            return
        named = members(
            choices, *integer_range(bits, to["type"] == "int"), where, notes
        )
        if is_enumeration(to, bits, named):
            for key in _OF_NUMBERS:
                to.pop(key, None)
            to["type"] = "enum"
            self.assign_enumeration(to, name, owner, named)
        else:
            to |= special(named, where, notes)

    def declared(self) -> list[Item]:
        """Return the enumerations, and set the key `enum` in their fields.

        Enumerations of equal name get the owner as prefix. If an owner has several of
        them, each except the first gets a number as suffix.
        """
        kinds: dict[str, set[object]] = {}
        for _, name, _, values in self.uses:
            kinds.setdefault(name, set()).add(values)
        enums: dict[str, Item] = {}
        for to, name, owner, values in self.uses:
            preferred_name = name if len(kinds[name]) == 1 else f"{owner} {name}"
            enum_members = [_member(*value) for value in values]
            unique_name, number = preferred_name, 1
            while (
                enums.get(unique_name, {"members": enum_members})["members"]
                != enum_members
            ):
                number += 1
                unique_name = f"{preferred_name} {number}"
            to["enum"] = unique_name
            enums.setdefault(
                unique_name, {"name": unique_name, "members": enum_members}
            )
        return list(enums.values())


def _member(first: int, last: int, name: str) -> Item:
    """Return the enumeration member of a value or of a range of values."""
    range_end = {"to": last} if last != first else {}
    return {"value": first, **range_end, "name": name}
