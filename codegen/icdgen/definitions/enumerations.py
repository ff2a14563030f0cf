"""Value names as enumeration members with unique names, and enumerations that several fields share."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Mapping
from dataclasses import dataclass, field

from icdgen.definitions.model import Definitions, Item, raws
from icdgen.definitions.wording import line

SAME_NAME = "IMP073"
BEYOND = "IMP074"
LEFT_OUT = "IMP090"
MOST_SPECIAL = 1024  # special values of a field; each becomes a constant in generated code
_LONGEST = 400
_LIMITS = ("min", "max", "above", "below")
_OF_NUMBERS = ("unit", *_LIMITS)  # keys that an enumeration does not have


def members(choices: Mapping[int, str], first: int, last: int, where: str, to: Definitions) -> list[Item]:
    """Return the enumeration members for values from ``first`` to ``last``.

    Consecutive values of equal name form a range. Other duplicate names are extended by their value (IMP073). Names
    of values out of range are left out (IMP074).
    """
    beyond = [value for value in choices if not first <= value <= last]
    if beyond:
        shown = ", ".join(map(str, beyond[:5])) + (" ..." if len(beyond) > 5 else "")
        to.warn(BEYOND, f"{where}: it never has the value {shown}, which has a name", "the name is left out")
    found: list[Item] = []
    for value, text in sorted(choices.items()):
        name = line(text, _LONGEST)
        if value in beyond or not name:
            continue
        if found and found[-1]["name"] == name and found[-1].get("to", found[-1]["value"]) == value - 1:
            found[-1]["to"] = value
        else:
            found.append({"value": value, "name": name})
    for name, times in Counter(one["name"] for one in found).items():
        if times > 1:
            same = [one for one in found if one["name"] == name]
            values = ", ".join(str(one["value"]) for one in same)
            text = f"{where}: `{name}` is the name of {values}"
            to.warn(SAME_NAME, text, "each is imported with its value behind the name")
            # The extended name may itself be the name of another value.
            taken = {one["name"] for one in found}
            for one in same:
                told = f"{name} {one['value']}"
                one["name"] = told if told not in taken else f"{told} of {where}"
    return [{key: one[key] for key in ("value", "to", "name") if key in one} for one in found]


def is_enumeration(item: Item, bits: int, named: list[Item]) -> bool:
    """Return whether a number with value names is an enumeration. Otherwise it is a quantity with special values.

    It is an enumeration if the names cover all values, or if the field has neither unit nor limits. A field with a
    formula is a quantity. A signed number is an enumeration only if a named value is negative, because the ICD
    derives the sign from the members.
    """
    if item["type"] not in ("uint", "int") or not named or item.keys() & {"formula", "points"}:
        return False
    # The type `enum` has no sign of its own: it is signed if a member is negative.
    is_signed = item["type"] == "int"
    if is_signed != any(one["value"] < 0 for one in named):
        return False
    return not item.keys() & set(_OF_NUMBERS) or _covers(named, *_possible(item, bits))


def _possible(item: Item, bits: int) -> tuple[int, int]:
    """Return the first and last value of a number without a formula, within its limits."""
    first, last = raws(bits, item["type"] == "int")
    low, high = item.get("min", first), item.get("max", last)
    if "above" in item:
        low = max(low, math.floor(item["above"]) + 1)
    if "below" in item:
        high = min(high, math.ceil(item["below"]) - 1)
    return max(first, math.ceil(low)), min(last, math.floor(high))


def _covers(named: list[Item], first: int, last: int) -> bool:
    """Return whether each value from ``first`` to ``last`` has a name; ``named`` is in ascending order."""
    following = first
    for one in named:
        if one["value"] > following:
            break
        following = max(following, _last(one) + 1)
    return following > last


def _last(member: Item) -> int:
    """Return the last value of a member, which may be a range."""
    return int(member["to"] if "to" in member else member["value"])


def special(named: list[Item], where: str, to: Definitions) -> Item:
    """Return the key `special` with a value for each name, and each value of a range.

    Reports names above `MOST_SPECIAL` (IMP090).
    """
    found: list[Item] = []
    for number, one in enumerate(named):
        last = _last(one)
        if len(found) + last - one["value"] >= MOST_SPECIAL:
            text = f"{where}: {len(named) - number} of {len(named)} names are left out, from `{one['name']}` on"
            help = f"a number has at most {MOST_SPECIAL:,} special values: put the names into its `summary`"
            to.warn(LEFT_OUT, text, help)
            break
        for value in range(one["value"], last + 1):
            found.append({"value": value, "meaning": one["name"] if last == one["value"] else f"{one['name']} {value}"})
    return {"special": found} if found else {}


@dataclass
class Enumerations:
    """Collection of enumerations. Fields of equal name and values share an enumeration."""

    uses: list[tuple[Item, str, str, tuple[tuple[int, int, str], ...]]] = field(default_factory=list)

    def give(self, to: Item, name: str, owner: str, named: list[Item]) -> None:
        """Assign an enumeration to a field.

        ``name`` is its preferred name, and ``owner`` a prefix for names in conflict.
        """
        values = tuple((one["value"], one["to"] if "to" in one else one["value"], str(one["name"])) for one in named)
        self.uses.append((to, name, owner, values))

    def hold(
        self, to: Item, bits: int, choices: Mapping[int, str], name: str, owner: str, where: str, notes: Definitions
    ) -> None:
        """Assign value names to a number, as an enumeration or as special values (see `is_enumeration`).

        ``to`` already has its formula, unit and limits. ``name`` is the preferred name of an enumeration, and
        ``owner`` a prefix for names in conflict. ``where`` names the field in findings.
        """
        if to["type"] not in ("uint", "int"):
            return
        named = members(choices, *raws(bits, to["type"] == "int"), where, notes)
        if is_enumeration(to, bits, named):
            for key in _OF_NUMBERS:
                to.pop(key, None)
            to["type"] = "enum"
            self.give(to, name, owner, named)
        else:
            to |= special(named, where, notes)

    def declared(self) -> list[Item]:
        """Return the enumerations, and set the key `enum` in their fields."""
        kinds: dict[str, set[object]] = {}
        for _, name, _, values in self.uses:
            kinds.setdefault(name, set()).add(values)
        made: dict[str, Item] = {}
        for to, name, owner, values in self.uses:
            called = name if len(kinds[name]) == 1 else f"{owner} {name}"
            to["enum"] = called
            held = [{"value": one, **({"to": last} if last != one else {}), "name": text} for one, last, text in values]
            made.setdefault(called, {"name": called, "members": held})
        return list(made.values())
