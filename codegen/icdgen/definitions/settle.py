"""Change a network until `icdgen check` accepts it, with as few losses as possible.

Names that are not valid identifiers get an `identifier`. Content that a rule rejects is
reduced in steps. A field first loses formula, limits and names, and keeps its raw
value. If that is not enough, the field is left out, and then its message. A rejected
unit is left out. A rejected enumeration becomes plain numbers.
"""

from __future__ import annotations

import json
import re
import tempfile
from collections.abc import Iterable, Iterator
from pathlib import Path

from icdgen import naming
from icdgen.definitions.model import (
    NOT_HELD,
    RAW_ONLY,
    Definitions,
    Item,
    Network,
    unreadable,
)
from icdgen.diagnostics import Finding
from icdgen.frozen import NamedTuple
from icdgen.loading import load

ROUNDS = 60  # some rules apply only after others are satisfied
_INVALID, _RESERVED, _CLASH = "ICD072", "ICD070", "ICD071"
_NAME_RULES = frozenset({_INVALID, _RESERVED, _CLASH})
_TRIES = 6  # attempts to find an identifier for a name
_MEANING = (
    "formula",
    "points",
    "outside",
    "unit",
    "special",
    "min",
    "max",
    "above",
    "below",
    "enum",
)
# Findings name lines of the temporary file, which the user does not see.
_LINES = re.compile(r" \(line [0-9]+\)|,( first)? in line [0-9]+")
_FIELD, _MEMBER, _UNIT = "field", "value", "unit"


class _Line(NamedTuple):
    """Named item in a line of the temporary file.

    ``owner`` is the containing item, and ``number`` distinguishes items of equal name.
    """

    item: Item
    owner: Item
    what: str
    number: object


def settle(network: Network, to: Definitions) -> list[str]:
    """Change the network until `icdgen check` reports nothing, and note losses in
    ``to``.

    Returns the names that got identifiers, as text for reports. Raises `Findings` if
    the errors cannot be assigned to an item.
    """
    tries: dict[int, int] = {}
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder, f"{network.name}.yaml")
        for _ in range(ROUNDS):
            lines = _write(file, network)
            findings = [
                finding
                for finding in load([file]).findings
                if finding.severity == "error" or finding.code in _NAME_RULES
            ]
            if not findings:
                break
            refused: dict[int, tuple[_Line, Finding]] = {}
            taken = _Taken(lines.values())
            renamed: set[int] = set()
            has_changed = False
            for finding in findings:
                line = lines.get(finding.place.line)
                # A finding without an item concerns the header (`protocol`), if there
                # is one.
                if line is None and network.protocol is not None:
                    to.warn(
                        NOT_HELD,
                        f"the header is not imported: {finding.message}",
                        finding.help,
                        "error",
                    )
                    network.protocol, has_changed = None, True
                    network.seeds.clear()
                    break
                if line is None:
                    raise unreadable(
                        to.file,
                        f"what it defines makes no ICD: {finding.message}",
                        finding.help,
                    )
                tried = tries.get(id(line.item), 0)
                # Several rules may reject one name; the next round checks the new one.
                if finding.code in _NAME_RULES and id(line.item) in renamed:
                    continue
                if finding.code in _NAME_RULES and tried < _TRIES:
                    renamed.add(id(line.item))
                    tries[id(line.item)] = tried + 1
                    line.item["identifier"] = taken.add(
                        line, _identifier(line, finding.code, tried)
                    )
                    has_changed = True
                elif finding.severity == "error":
                    refused.setdefault(id(line.item), (line, finding))
            for line, finding in refused.values():
                _degrade(network, line, finding, to)
            if not refused and not has_changed:
                break
    _remove_unused_structs(network)
    named = {
        id(line.item): line
        for line in lines.values()
        if id(line.item) in tries and "identifier" in line.item
    }
    return [
        f"{line.what} `{line.item['name']}`: `{line.item['identifier']}`"
        for line in named.values()
    ]


class _Taken:
    """Words of the identifiers in each scope, to keep identifiers unique."""

    def __init__(self, lines: Iterable[_Line]) -> None:
        self.words: dict[object, set[tuple[str, ...]]] = {}
        for line in lines:
            if line.what != _UNIT:
                self._scope(line).add(
                    naming.words(line.item.get("identifier", line.item["name"]))
                )

    def _scope(self, line: _Line) -> set[tuple[str, ...]]:
        is_part = line.what in (_FIELD, _MEMBER)
        return self.words.setdefault(
            (line.what, id(line.owner) if is_part else None), set()
        )

    def add(self, line: _Line, wanted: str) -> str:
        """Reserve and return an identifier, with a number as suffix if its words are
        taken.
        """
        among, number, text = self._scope(line), 1, wanted
        while naming.words(text) in among:
            number += 1
            text = f"{wanted} {number}"
        among.add(naming.words(text))
        return text


def _identifier(line: _Line, code: str, attempt: int) -> str:
    """Return the words of an identifier, by the rule of
    docs/guides/import-definitions.md.
    """
    name, number = line.item["name"], str(line.number).replace("-", "minus ")
    if not naming.words(name) or attempt == 1:
        return f"{line.what} {number}"
    plain = name if name.isascii() else " ".join(naming.words(name))
    if attempt > 1:
        return f"{plain} {line.what} {number} {attempt}"
    if code == _CLASH:
        return f"{plain} values" if line.what == "enumeration" else f"{plain} {number}"
    return f"{line.what} {plain}" if code == _INVALID else f"{plain} {line.what}"


def _degrade(network: Network, line: _Line, finding: Finding, to: Definitions) -> None:
    """Remove as little content as possible for a finding."""
    reason = f"{_LINES.sub('', finding.message)} ({finding.code})"
    if line.what == _UNIT:
        for field in network.fields:
            if field.get("unit") == line.item["symbol"]:
                del field["unit"]
        to.warn(
            RAW_ONLY,
            f"unit `{line.item['symbol']}` is left out: {reason}",
            "its fields have no unit",
            "error",
        )
    elif line.what in (_FIELD, _MEMBER) and line.item is not line.owner:
        _degrade_part(network, line, reason, to)
    elif any(line.owner is enum for enum in network.enums):
        _drop_enumeration(network, line.owner, reason, to)
    else:
        _remove_owner(network, line.owner, reason, to)


def _degrade_part(network: Network, line: _Line, reason: str, to: Definitions) -> None:
    """Reduce a field to its raw value or remove it, or remove a member of an
    enumeration.
    """
    owner, item = line.owner["name"], line.item
    if line.what == _MEMBER:
        _remove(line.owner["members"], item)
        text = f"enumeration `{owner}`: the name `{item['name']}` of {item['value']} is left out: {reason}"
        to.warn(RAW_ONLY, text, "its value stays a number", "error")
        if not line.owner["members"]:
            _drop_enumeration(network, line.owner, "no name of it can be imported", to)
        return
    kind = (
        "message"
        if any(line.owner is message for message in network.messages)
        else "struct"
    )
    if item.keys() & set(_MEANING) and "count" not in item:
        _make_raw(network, item)
        text = f"{kind} `{owner}`, `{item['name']}`: {reason}"
        to.warn(
            RAW_ONLY,
            text,
            "its raw value is imported, without formula, unit, limits and names",
            "error",
        )
        return
    fields = line.owner["fields"]
    _remove(fields, item)
    if fields and not _is_open(fields) and "length" in line.owner:
        to.without_field(owner, item["name"], reason)
        if kind == "message":
            _reserve(network, line.owner)
    else:
        _remove_owner(network, line.owner, reason, to)


def _make_raw(network: Network, item: Item) -> None:
    if (enum := item.get("enum")) is not None:
        members: list[Item] = next(
            (
                candidate["members"]
                for candidate in network.enums
                if candidate["name"] == enum
            ),
            [],
        )
        item["type"] = (
            "int" if any(member["value"] < 0 for member in members) else "uint"
        )
    for key in _MEANING:
        item.pop(key, None)


def _drop_enumeration(
    network: Network, enum: Item, reason: str, to: Definitions
) -> None:
    to.warn(
        RAW_ONLY,
        f"enumeration `{enum['name']}` is left out: {reason}",
        "its fields are numbers",
        "error",
    )
    for field in network.fields:
        if field.get("enum") == enum["name"]:
            _make_raw(network, field)
    _remove(network.enums, enum)


def _is_open(fields: list[Item]) -> bool:
    return any("up_to" in field or "after" in field for field in fields)


def _reserve(network: Network, message: Item) -> None:
    """Set `reserved` to the bytes at the end of a message that no field uses."""
    lengths = {
        struct["name"]: 8 * struct["length"]
        for struct in network.structs
        if "length" in struct
    }
    end = 0
    for field in message["fields"]:
        bits = lengths.get(field.get("struct"), field.get("bits", 0))
        end = max(end, -(-(field["at"] + bits * field.get("count", 1)) // 8))
    message.pop("reserved", None)
    if message["length"] > end:
        message["reserved"] = message["length"] - end


def _remove_owner(network: Network, owner: Item, reason: str, to: Definitions) -> None:
    """Remove a message or struct.

    Fields that use the struct fail the next check and are removed then.
    """
    if any(owner is message for message in network.messages):
        network.seeds.pop(owner["name"], None)
        to.left_out(owner["name"], reason)
        _remove(network.messages, owner)
    else:
        to.warn(
            RAW_ONLY,
            f"struct `{owner['name']}` is left out: {reason}",
            "so are the fields that have it",
            "error",
        )
        _remove(network.structs, owner)


def _remove(items: list[Item], item: Item) -> None:
    items[:] = [other for other in items if other is not item]


def _remove_unused_structs(network: Network) -> None:
    """Remove structs and enumerations that no message uses."""
    by_name = {struct["name"]: struct for struct in network.structs}
    needed: set[str] = set()
    waiting = list(_structs_in(network.messages))
    while waiting:
        name = waiting.pop()
        if name in by_name and name not in needed:
            needed.add(name)
            waiting += _structs_in([by_name[name]])
    network.structs = [struct for struct in network.structs if struct["name"] in needed]
    network.declare(network.enums)


def _structs_in(owners: Iterable[Item]) -> Iterator[str]:
    return (
        field["struct"]
        for owner in owners
        for field in owner.get("fields", ())
        if "struct" in field
    )


def _write(file: Path, network: Network) -> dict[int, _Line]:
    """Write the ICD with one line for each named item.

    Returns the items by line number.
    """
    tree = network.tree()
    # JSON is valid YAML, and keeps each item in a line of its own.
    lines, items = ["{"], {}

    def add(text: str, line: _Line | None = None) -> None:
        lines.append(text)
        if line is not None:
            items[len(lines)] = line

    for key in [
        key for key in tree if key not in ("units", "enums", "structs", "messages")
    ]:
        add(f"{json.dumps(key)}: {json.dumps(tree[key])},")
    add('"units": [')
    for unit in tree.get("units", ()):
        add(json.dumps(unit) + ",", _Line(unit, unit, _UNIT, unit["symbol"]))
    add("],")
    for section, inner, what, part in (
        ("enums", "members", "enumeration", _MEMBER),
        ("structs", "fields", "struct", _FIELD),
        ("messages", "fields", "message", _FIELD),
    ):
        add(f'"{section}": [')
        for number, item in enumerate(tree.get(section, ())):
            head = json.dumps(
                {key: value for key, value in item.items() if key != inner}
            )
            add(f"{head[:-1]}", _Line(item, item, what, item.get("id", number)))
            if inner in item:
                add(f', "{inner}": [', _Line(item, item, what, item.get("id", number)))
                for inner_item in item[inner]:
                    add(
                        json.dumps(inner_item) + ",",
                        _Line(
                            inner_item,
                            item,
                            part,
                            inner_item.get("at", inner_item.get("value")),
                        ),
                    )
                add("]")
            add("},")
        add("],")
    add("}")
    file.write_text("\n".join(lines) + "\n", encoding="utf-8")
    return items
