"""Every key of the protocol section, changed: what of it is heeded, and how.

`outcomes` changes a key of an ICD to each of a few other values that the format allows,
and tells what that makes of the golden vectors or of the findings. `python -m
tests.protocol.walk` does so with all keys, and writes `keys/table.yaml`.
"""

from __future__ import annotations

import copy
import json
from collections.abc import Iterator
from dataclasses import fields, is_dataclass
from itertools import zip_longest
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any, NamedTuple

import yaml

from icdgen.icd import schema
from icdgen.icd.model import Icd, Message, Node, buses_of
from icdgen.loading import load
from icdgen.protocol import facts
from icdgen.protocol.facts import Facts
from icdgen.runtime_objects import reference
from icdgen.vectors import protocol as vectors
from tests.conftest import ROOT

WIRE, FINDING, NOTHING = "wire", "finding", "nothing"
BESIDES = (
    "source",
    "assumptions",
    "summary",
)  # of every section: where it stands, why it is assumed, prose
STEP = "#/$defs/step"
NESTED = "[**]"
Path_ = tuple[str | int, ...]

KEYS = ROOT / "tests" / "protocol" / "keys"
TABLE = KEYS / "table.yaml"
_HEAD = """\
# What each key of the protocol section makes a difference to; `python -m tests.protocol.walk` writes wire and finding.
#
# wire: another value makes other golden vectors      port: the port is opened or used with it
# finding: another value is refused                   simulator: the simulated device does it
# only: there is one value                            told: nothing is done by it; the site and the diff tell
"""


class Key(NamedTuple):
    """A key of the format: its path, `[]` for an entry of a list, `[**]` for an entry of
    a list of steps or a step in it, and `*` for any name, and what it can be.
    """

    path: tuple[str, ...]
    form: dict[str, Any]

    def __str__(self) -> str:
        return ".".join(self.path)


def all_keys() -> list[Key]:
    """All keys of the protocol section that hold a value, by the JSON Schema."""
    return list(_keys(schema.protocol_schema(), ()))


def _keys(form: dict[str, Any], path: tuple[str, ...]) -> Iterator[Key]:
    form = (
        schema._follow(form) | {key: one for key, one in form.items() if key != "$ref"}
        if "$ref" in form
        else form
    )
    kinds = form.get("type", ())
    # A response is a mapping, or the name of its message.
    is_mapping = kinds == "object" or "message" in form.get("properties", ())
    if is_mapping:
        for key, one in form.get("properties", {}).items():
            if key not in BESIDES:
                yield from _keys(one, (*path, key))
        if isinstance(form.get("additionalProperties"), dict):
            yield from _keys(form["additionalProperties"], (*path, "*"))
    elif kinds == "array" and schema_of_entries(form).get("type") == "object":
        is_steps = form["items"].get("$ref") == STEP
        if NESTED not in path:  # otherwise it stands for the steps in a step as well
            yield from _keys(form["items"], (*path, NESTED if is_steps else "[]"))
    else:
        yield Key(path, form)


def schema_of_entries(form: dict[str, Any]) -> dict[str, Any]:
    """What the entries of a list are."""
    entries = form["items"]
    found: dict[str, Any] = schema._follow(entries) if "$ref" in entries else entries
    return found


def places(section: Any, path: tuple[str, ...], before: Path_ = ()) -> Iterator[Path_]:
    """Where a key stands in the section of an ICD."""
    if not path:
        yield before
    elif path[0] == "[]" and isinstance(section, list):
        for index, one in enumerate(section):
            yield from places(one, path[1:], (*before, index))
    elif path[0] == NESTED and isinstance(section, list):
        for index, one in enumerate(section):
            yield from places(one, path[1:], (*before, index))
            yield from _places_in_step(one, path, (*before, index))
    elif path[0] == "*" and isinstance(section, dict):
        for name, one in section.items():
            yield from places(one, path[1:], (*before, name))
    elif isinstance(section, dict) and path[0] in section:
        yield from places(section[path[0]], path[1:], (*before, path[0]))


def _places_in_step(
    step: dict[str, Any], path: tuple[str, ...], before: Path_
) -> Iterator[Path_]:
    """Where a key stands in the steps of a step."""
    for key, value in step.items():
        if isinstance(value, dict):
            yield from _places_in_step(value, path, (*before, key))
        elif isinstance(value, list) and value and isinstance(value[0], dict):
            yield from places(value, path, (*before, key))


class Source:
    """A folder of ICDs, of which the first node that has a protocol section of its own
    is changed.
    """

    def __init__(self, files: list[Path], work: Path) -> None:
        self.work = work
        self.texts = {
            path.name: yaml.load(path.read_text(encoding="utf-8"), yaml.CSafeLoader)
            for path in files
        }
        self.changed = next(
            name for name, content in self.texts.items() if "protocol" in content
        )
        self.section = self.texts[self.changed]["protocol"]
        self.messages = {
            one["name"]: one for one in self.texts[self.changed]["messages"]
        }
        self.enums = [one["name"] for one in self.texts[self.changed].get("enums", ())]
        icd = self.load(self.section)
        assert icd is not None, "it has findings as it is"
        self.icd = icd
        self.facts = {node.name: facts.of(icd, node) for node in icd.nodes}
        self._cases: dict[str, list[str]] = {}

    def cases(self, node: str) -> list[str]:
        """The vectors of a node as it is."""
        if node not in self._cases:
            self._cases[node] = list(cases(self.icd, self.facts[node]))
        return self._cases[node]

    def load(self, section: dict[str, Any]) -> Icd | None:
        """The ICDs with another section; None if there are findings."""
        for name, content in self.texts.items():
            given = (
                {**content, "protocol": section} if name == self.changed else content
            )
            (self.work / name).write_text(
                yaml.dump(given, Dumper=yaml.CSafeDumper, sort_keys=False),
                encoding="utf-8",
            )
        loaded = load([self.work])
        return None if loaded.findings else loaded.icd

    def at(self, place: Path_, value: object) -> dict[str, Any]:
        """The section with another value at a place."""
        section: dict[str, Any] = copy.deepcopy(self.section)
        *before, last = place
        inside: Any = section
        for step in before:
            inside = inside[step]
        inside[last] = value
        return section

    def value(self, place: Path_) -> Any:
        found: Any = self.section
        for step in place:
            found = found[step]
        return found

    def others(self, key: Key, place: Path_) -> list[Any]:
        """Other values that the format allows for a key."""
        value, form = self.value(place), key.form
        if "enum" in form:
            return [one for one in form["enum"] if one != value]
        if isinstance(value, bool):
            return [not value]
        if isinstance(value, int):
            near = (value + 1, value * 2 or 16, value - 1)
            least, most = form.get("minimum", 0), form.get("maximum", 1 << 32)
            return [one for one in near if least <= one <= most][:3]
        if isinstance(value, list):
            return self._other_lists(value, form)
        if isinstance(value, dict):
            if all(isinstance(one, str) for one in value.values()):
                (first, repeated), *_ = value.items()
                return [{first: repeated}, {first: "another"}]
            return [{name: number + 1 for name, number in value.items()}]
        return self._other_texts(key, place, value)

    def _other_lists(self, value: list[Any], form: dict[str, Any]) -> list[Any]:
        choices = form.get("items", {}).get("enum", ())
        if choices:
            return [[one for one in choices if one != first] for first in value] + [
                list(choices)
            ] * (value != list(choices))
        if all(isinstance(one, int) for one in value):
            return [[*value[:-1], value[-1] + 1], value[:-1] or [value[0] + 1]]
        if all(one in self.messages for one in value):
            return [[*value[:-1], name] for name in self.messages if name not in value][
                :1
            ] + [value[::-1]] * (len(value) > 1)
        nodes = [content["node"]["name"] for content in self.texts.values()]
        if all(one in nodes for one in value):
            return [[one] for one in nodes if [one] != value]
        return [[*value, "another"]]

    def _other_texts(self, key: Key, place: Path_, value: str) -> list[Any]:
        if value in self.messages:
            alike = [
                name
                for name, one in self.messages.items()
                if one["kind"] == self.messages[value]["kind"]
            ]
            return [name for name in (*alike, *self.messages) if name != value][:12]
        if value in self.enums:
            return [name for name in self.enums if name != value]
        nodes = [content["node"]["name"] for content in self.texts.values()]
        if value in nodes and key.path[0] == "program_start":
            return [name for name in nodes if name != value]
        message = next(
            (self.messages[one] for one in self._named(place) if one in self.messages),
            None,
        )
        if message:
            others = [
                one["name"] for one in message.get("fields", ()) if one["name"] != value
            ]
            return others or [f"{value} other"]
        types = [
            one["name"]
            for one in buses_of(self.section)
            .get("can", {})
            .get("message_types", {})
            .get("values", ())
        ]
        if value in types and key.path[-1] != "name":
            return [name for name in types if name != value]
        link = self.section.get("link", {})
        roles = [
            row["role"]
            for form in (link, *link.get("packets", {}).values())
            for part in ("header", "trailer")
            for row in form.get(part, ())
        ]
        if value in (*roles, "data") and "covers" in key.path:
            return [role for role in (*roles, "data") if role != value]
        return [f"{value} other"]

    def _named(self, place: Path_) -> Iterator[str]:
        """The messages that stand beside a key, or beside the mapping that it is in."""
        for depth in (1, 2):
            beside = self.value(place[:-depth])
            if isinstance(beside, dict):
                yield from (
                    one
                    for one in [beside.get("message"), *beside.get("names", ())]
                    if isinstance(one, str)
                )


def told(thing: Any) -> Any:
    """Facts as plain values; a message, which is not of the protocol section, by its
    name.
    """
    if isinstance(thing, Message | Node):
        return thing.name
    if is_dataclass(thing):
        values = {one.name: told(getattr(thing, one.name)) for one in fields(thing)}
        return {"": type(thing).__name__, **values}
    if isinstance(thing, dict):
        return {key: told(one) for key, one in thing.items()}
    return [told(one) for one in thing] if isinstance(thing, list | tuple) else thing


def outcome(source: Source, section: dict[str, Any], whole: bool) -> str:
    """What a change makes of the vectors, or of the findings.

    Vectors are made of facts; not ``whole``: only these are compared.
    """
    icd = source.load(section)
    if icd is None:
        return FINDING
    others = {node.name: facts.of(icd, node) for node in icd.nodes}
    differ = [
        name
        for name, known in others.items()
        if told(known) != told(source.facts[name])
    ]
    if not whole:
        return WIRE if differ else NOTHING
    return (
        WIRE if any(_differs(source, icd, others[name]) for name in differ) else NOTHING
    )


def _differs(source: Source, changed: Icd, other: Facts) -> bool:
    """Whether any golden vector of the node differs."""
    found = zip_longest(source.cases(other.node.name), cases(changed, other))
    return any(one != two for one, two in found)


def cases(icd: Icd, known: Facts) -> Iterator[str]:
    """The vectors of a node, one by one."""
    for _, request in vectors._requests(icd, known):
        asked = {"op": request["op"], "node": known.node.name, **request}
        yield json.dumps([asked, reference.answer(icd, asked)])


def outcomes(source: Source, key: Key, whole: bool) -> Iterator[tuple[Path_, Any, str]]:
    """Each place and other value, and what became of it; not ``whole``: until something
    did.
    """
    for place in places(source.section, key.path):
        for other in source.others(key, place):
            found = outcome(source, source.at(place, other), whole)
            yield place, other, found
            if not whole and found != NOTHING:
                return


def sources(work: Path) -> Iterator[Source]:
    """ICDs that have all keys between them."""
    groups = [[KEYS / "board.yaml", KEYS / "app.yaml"], [KEYS / "link.yaml"]]
    groups += [[KEYS / f"{name}.yaml"] for name in ("packets", "frames")]
    groups += [
        [path]
        for folder in ("examples/links", "tests/conformance/links")
        for path in sorted((ROOT / folder).glob("*.yaml"))
    ]
    for number, files in enumerate(groups):
        folder = work / str(number)
        folder.mkdir()
        yield Source(files, folder)


def walked(work: Path, whole: bool) -> dict[str, set[str]]:
    """What came of the changes of each key, in any of the ICDs; nothing, where it does
    not stand or has but one value.

    Not ``whole``: a key that is heeded in one of the ICDs is not changed in others.
    """
    found: dict[str, set[str]] = {str(key): set() for key in all_keys()}
    for source in sources(work):
        for key in all_keys():
            if not whole and found[str(key)] - {NOTHING}:
                continue
            for _, _, what in outcomes(source, key, whole):
                found[str(key)].add(what)
    return found


def main() -> None:
    with TemporaryDirectory() as folder:
        found = walked(Path(folder), True)
    table = yaml.safe_load(TABLE.read_text(encoding="utf-8")) if TABLE.exists() else {}
    lines = []
    for key, outcome_ in found.items():
        heeded = [one for one in (WIRE, FINDING) if one in outcome_]
        lines.append(f"{key}: {heeded[0] if heeded else table.get(key, NOTHING)}\n")
    TABLE.write_text(_HEAD + "".join(lines), encoding="utf-8")


if __name__ == "__main__":
    main()
