"""Values with names: as members of an enumeration, each name once, and enumerations that many fields share."""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping
from dataclasses import dataclass, field

from icdgen.definitions.model import Definitions, Item, raws
from icdgen.definitions.wording import line

SAME_NAME = "IMP073"
BEYOND = "IMP074"
MOST_SPECIAL = 16  # names that a field may have as special values
_LONGEST = 400


def members(choices: Mapping[int, str], first: int, last: int, where: str, to: Definitions) -> list[Item]:
    """The members of values from ``first`` to ``last``. Neighbours of one name are a range, others get their value behind it."""
    beyond = [value for value in choices if not first <= value <= last]
    if beyond:
        shown = ", ".join(map(str, beyond[:5])) + (" ..." if len(beyond) > 5 else "")
        to.warn(BEYOND, f"{where}: it never has the value {shown}, which has a name", "the name is left out")
    found: list[Item] = []
    for value, text in sorted(choices.items()):
        name = line(text, _LONGEST) or f"{value}"
        if value in beyond:
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
            to.warn(SAME_NAME, text, "each is held with its value behind the name")
            taken = {one["name"] for one in found}
            for one in same:
                told = f"{name} {one['value']}"
                one["name"] = told if told not in taken else f"{told} of {where}"
    return [{key: one[key] for key in ("value", "to", "name") if key in one} for one in found]


def special(named: list[Item]) -> Item:
    """The key of special values with these names; of ranges each value."""
    found = []
    for one in named:
        last = one.get("to", one["value"])
        for value in range(one["value"], min(last, one["value"] + 63) + 1):
            found.append({"value": value, "meaning": one["name"] if last == one["value"] else f"{one['name']} {value}"})
    return {"special": found} if found else {}


@dataclass
class Enumerations:
    """Enumerations by what their fields are called: fields of one name that have the same values share one."""

    uses: list[tuple[Item, str, str, tuple[tuple[int, int, str], ...]]] = field(default_factory=list)

    def give(self, to: Item, name: str, owner: str, named: list[Item]) -> None:
        """Makes a field one of an enumeration. ``name`` is what it would be called, ``owner`` tells it from others of the name."""
        values = tuple((one["value"], one["to"] if "to" in one else one["value"], str(one["name"])) for one in named)
        self.uses.append((to, name, owner, values))

    def hold(
        self, to: Item, bits: int, choices: Mapping[int, str], name: str, owner: str, notes: Definitions
    ) -> list[Item]:
        """Makes an integer one of an enumeration if a value has a sign as it has. Else it stays a number; its named values."""
        is_signed = to["type"] == "int"
        named = members(choices, *raws(bits, is_signed), f"`{name}`", notes)
        if not named or is_signed != (min(choices) < 0):
            return named
        to["type"] = "enum"
        self.give(to, name, owner, named)
        return []

    def declared(self) -> list[Item]:
        """The enumerations; their fields say `enum` from now on."""
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
