"""Until `icdgen check` is content: identifiers for names that are none, and messages that the format refuses left out."""

from __future__ import annotations

import json
import tempfile
from pathlib import Path
from typing import NamedTuple

from icdgen import naming
from icdgen.definitions.model import NOT_HELD, Definitions, Item, Network, unreadable
from icdgen.diagnostics import Finding
from icdgen.loading import load

ROUNDS = 30  # a rule may speak only after another is satisfied
_NONE, _RESERVED, _CLASH, _LONG = "ICD072", "ICD070", "ICD071", "ICD073"
_OF_NAMES = frozenset({_NONE, _RESERVED, _CLASH, _LONG})
_SHORT = {"message": 24}  # characters that are left of a name that is too long
_SHORTER = 16  # of all others
_TRIES = 2  # identifiers for one name


class _Line(NamedTuple):
    """What stands in a line: a thing with a name, the whole that goes if it cannot be held, and what tells it from others."""

    item: Item
    whole: Item
    what: str
    number: object


def settle(network: Network, to: Definitions) -> list[str]:
    """Changes the network until nothing is found; what had to go is noted in ``to``. Names with the identifiers that they got.

    Raises `Findings` if it is too large.
    """
    tries: dict[int, int] = {}
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder, f"{network.name}.yaml")
        for _ in range(ROUNDS):
            lines = _write(file, network)
            findings = [one for one in load([file]).findings if one.severity == "error" or one.code in _OF_NAMES]
            if not findings:
                break
            gone: dict[int, tuple[_Line, Finding]] = {}
            renamed = False
            for finding in findings:
                line = lines.get(finding.place.line)
                if line is None and network.protocol is not None:
                    to.warn(NOT_HELD, f"the header is not held: {finding.message}", finding.help, "error")
                    network.protocol, renamed = None, True
                    network.seeds.clear()
                    break
                if line is None:
                    raise unreadable(to.file, f"what it defines makes no ICD: {finding.message}", finding.help)
                tried = tries.get(id(line.item), 0)
                if finding.code in _OF_NAMES and tried < (1 if finding.code == _LONG else _TRIES):
                    tries[id(line.item)] = tried + 1
                    line.item["identifier"] = _identifier(line, finding.code, tried)
                    renamed = True
                elif finding.severity == "error":
                    gone.setdefault(id(line.whole), (line, finding))
            for line, finding in gone.values():
                _take_out(network, line, finding, to)
            if not gone and not renamed:
                break
    named = {id(line.item): line for line in lines.values() if id(line.item) in tries}
    return [f"{one.what} `{one.item['name']}`: `{one.item['identifier']}`" for one in named.values()]


def _identifier(line: _Line, code: str, attempt: int) -> str:
    """Words for a name, by the rule of docs/guides/import-definitions.md."""
    name, number = line.item["name"], str(line.number).replace("-", "minus ")
    if not naming.words(name) or attempt:
        return f"{line.what} {number}"
    plain = name if name.isascii() else " ".join(naming.words(name))
    if code == _CLASH:
        return f"{plain} values" if line.what == "enumeration" else f"{plain} {number}"
    if code == _LONG:
        kept = ""
        for word in naming.words(name):
            if kept and len(kept) + len(word) >= _SHORT.get(line.what, _SHORTER):
                break
            kept += f"{word} "
        return f"{kept}{number}"
    return f"{line.what} {plain}" if code == _NONE else f"{plain} {line.what}"


def _take_out(network: Network, line: _Line, finding: Finding, to: Definitions) -> None:
    reason = f"{finding.message} ({finding.code})"
    for items in (network.messages, network.enums, network.structs):
        for index, item in enumerate(items):
            if item is line.whole:
                del items[index]
                if items is network.messages:
                    network.seeds.pop(item["name"], None)
                    to.left_out(item["name"], reason)
                return


def _write(file: Path, network: Network) -> dict[int, _Line]:
    """The ICD with a line for each thing that has a name; which stands where."""
    tree = network.tree()
    lines, found = ["{"], {}

    def add(text: str, line: _Line | None = None) -> None:
        lines.append(text)
        if line is not None:
            found[len(lines)] = line

    for key in [key for key in tree if key not in ("enums", "structs", "messages")]:
        add(f"{json.dumps(key)}: {json.dumps(tree[key])},")
    for section, inner, what, part in (
        ("enums", "members", "enumeration", "value"),
        ("structs", "fields", "struct", "field"),
        ("messages", "fields", "message", "field"),
    ):
        add(f'"{section}": [')
        for number, item in enumerate(tree.get(section, ())):
            head = json.dumps({key: value for key, value in item.items() if key != inner})
            add(f"{head[:-1]}", _Line(item, item, what, item.get("id", number)))
            if inner in item:
                add(f', "{inner}": [', _Line(item, item, what, item.get("id", number)))
                for one in item[inner]:
                    add(json.dumps(one) + ",", _Line(one, item, part, one.get("at", one.get("value"))))
                add("]")
            add("},")
        add("],")
    add("}")
    file.write_text("\n".join(lines) + "\n", encoding="utf-8")
    return found
