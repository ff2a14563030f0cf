"""Changes every key of the protocol section and reports the effect.

`outcomes` gives a key of an ICD each of a few other values that the format allows, and
compares the golden vectors and the findings. `python -m tests.protocol.walk` does this
for all keys, and writes `keys/table.yaml`.
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
COMMON_KEYS = (
    "source",
    "assumptions",
    "summary",
)  # keys of every section: reference to the manual, reasons of assumptions, prose
STEP = "#/$defs/step"
NESTED = "[**]"
Path_ = tuple[str | int, ...]

KEYS = ROOT / "tests" / "protocol" / "keys"
TABLE = KEYS / "table.yaml"
_HEAD = """\
# Effect of each key of the protocol section; `python -m tests.protocol.walk` writes wire and finding.
#
# wire: another value changes the golden vectors      port: the port is opened or used with it
# finding: another value is an error                  simulator: the simulated device uses it
# only: there is one value                            documented: it is only shown by the site and the diff
"""


class Key(NamedTuple):
    """A key of the format: its path and its schema.

    In the path, `[]` is an entry of a list, `[**]` an entry of a list of steps or a
    step within it, and `*` any name.
    """

    path: tuple[str, ...]
    form: dict[str, Any]

    def __str__(self) -> str:
        return ".".join(self.path)


def all_keys() -> list[Key]:
    """Return all keys of the protocol section that have a value, by the JSON Schema."""
    return list(_keys(schema.protocol_schema(), ()))


def _keys(form: dict[str, Any], path: tuple[str, ...]) -> Iterator[Key]:
    form = (
        schema._follow(form)
        | {key: value for key, value in form.items() if key != "$ref"}
        if "$ref" in form
        else form
    )
    kinds = form.get("type", ())
    # A response is a mapping, or the name of its message.
    is_mapping = kinds == "object" or "message" in form.get("properties", ())
    if is_mapping:
        for key, inner in form.get("properties", {}).items():
            if key not in COMMON_KEYS:
                yield from _keys(inner, (*path, key))
        if isinstance(form.get("additionalProperties"), dict):
            yield from _keys(form["additionalProperties"], (*path, "*"))
    elif kinds == "array" and schema_of_entries(form).get("type") == "object":
        is_steps = form["items"].get("$ref") == STEP
        if NESTED not in path:  # otherwise it stands for the steps in a step as well
            yield from _keys(form["items"], (*path, NESTED if is_steps else "[]"))
    else:
        yield Key(path, form)


def schema_of_entries(form: dict[str, Any]) -> dict[str, Any]:
    """Return the schema of the entries of a list."""
    entries = form["items"]
    resolved: dict[str, Any] = schema._follow(entries) if "$ref" in entries else entries
    return resolved


def places(section: Any, path: tuple[str, ...], before: Path_ = ()) -> Iterator[Path_]:
    """Yield the positions of a key in the section of an ICD."""
    if not path:
        yield before
    elif path[0] == "[]" and isinstance(section, list):
        for index, entry in enumerate(section):
            yield from places(entry, path[1:], (*before, index))
    elif path[0] == NESTED and isinstance(section, list):
        for index, entry in enumerate(section):
            yield from places(entry, path[1:], (*before, index))
            yield from _places_in_step(entry, path, (*before, index))
    elif path[0] == "*" and isinstance(section, dict):
        for name, entry in section.items():
            yield from places(entry, path[1:], (*before, name))
    elif isinstance(section, dict) and path[0] in section:
        yield from places(section[path[0]], path[1:], (*before, path[0]))


def _places_in_step(
    step: dict[str, Any], path: tuple[str, ...], before: Path_
) -> Iterator[Path_]:
    """Yield the positions of a key in the steps of a step."""
    for key, value in step.items():
        if isinstance(value, dict):
            yield from _places_in_step(value, path, (*before, key))
        elif isinstance(value, list) and value and isinstance(value[0], dict):
            yield from places(value, path, (*before, key))


class Source:
    """A folder of ICDs; the first node with a protocol section of its own is changed."""

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
            message["name"]: message for message in self.texts[self.changed]["messages"]
        }
        self.enums = [
            enum["name"] for enum in self.texts[self.changed].get("enums", ())
        ]
        icd = self.load(self.section)
        assert icd is not None, "the unchanged ICDs have findings"
        self.icd = icd
        self.facts = {node.name: facts.of(icd, node) for node in icd.nodes}
        self._cases: dict[str, list[str]] = {}

    def cases(self, node: str) -> list[str]:
        """Return the vectors of a node of the unchanged ICDs."""
        if node not in self._cases:
            self._cases[node] = list(cases(self.icd, self.facts[node]))
        return self._cases[node]

    def load(self, section: dict[str, Any]) -> Icd | None:
        """Return the ICDs with another section; None if there are findings."""
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
        """Return the section with another value at a position."""
        section: dict[str, Any] = copy.deepcopy(self.section)
        *before, last = place
        inside: Any = section
        for step in before:
            inside = inside[step]
        inside[last] = value
        return section

    def value(self, place: Path_) -> Any:
        inner: Any = self.section
        for step in place:
            inner = inner[step]
        return inner

    def other_values(self, key: Key, place: Path_) -> list[Any]:
        """Return other values that the format allows for a key."""
        value, form = self.value(place), key.form
        if "enum" in form:
            return [other for other in form["enum"] if other != value]
        if isinstance(value, bool):
            return [not value]
        if isinstance(value, int):
            near = (value + 1, value * 2 or 16, value - 1)
            least, most = form.get("minimum", 0), form.get("maximum", 1 << 32)
            return [number for number in near if least <= number <= most][:3]
        if isinstance(value, list):
            return self._other_lists(value, form)
        if isinstance(value, dict):
            if all(isinstance(entry, str) for entry in value.values()):
                (first, repeated), *_ = value.items()
                return [{first: repeated}, {first: "another"}]
            return [{name: number + 1 for name, number in value.items()}]
        return self._other_texts(key, place, value)

    def _other_lists(self, value: list[Any], form: dict[str, Any]) -> list[Any]:
        choices = form.get("items", {}).get("enum", ())
        if choices:
            return [
                [entry for entry in choices if entry != first] for first in value
            ] + [list(choices)] * (value != list(choices))
        if all(isinstance(entry, int) for entry in value):
            return [[*value[:-1], value[-1] + 1], value[:-1] or [value[0] + 1]]
        if all(entry in self.messages for entry in value):
            return [[*value[:-1], name] for name in self.messages if name not in value][
                :1
            ] + [value[::-1]] * (len(value) > 1)
        nodes = [content["node"]["name"] for content in self.texts.values()]
        if all(entry in nodes for entry in value):
            return [[entry] for entry in nodes if [entry] != value]
        return [[*value, "another"]]

    def _other_texts(self, key: Key, place: Path_, value: str) -> list[Any]:
        if value in self.messages:
            alike = [
                name
                for name, candidate in self.messages.items()
                if candidate["kind"] == self.messages[value]["kind"]
            ]
            return [name for name in (*alike, *self.messages) if name != value][:12]
        if value in self.enums:
            return [name for name in self.enums if name != value]
        nodes = [content["node"]["name"] for content in self.texts.values()]
        if value in nodes and key.path[0] == "program_start":
            return [name for name in nodes if name != value]
        message = next(
            (
                self.messages[name]
                for name in self._named(place)
                if name in self.messages
            ),
            None,
        )
        if message:
            names = [field["name"] for field in message.get("fields", ())]
            return [name for name in names if name != value] or [f"{value} other"]
        types = [
            type_["name"]
            for type_ in buses_of(self.section)
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
        """Yield the messages that are named next to a key, or next to the mapping that
        has it.
        """
        for depth in (1, 2):
            neighbours = self.value(place[:-depth])
            if isinstance(neighbours, dict):
                yield from (
                    name
                    for name in [
                        neighbours.get("message"),
                        *neighbours.get("names", ()),
                    ]
                    if isinstance(name, str)
                )


def plain(thing: Any) -> Any:
    """Return facts as plain values. A message is represented by its name."""
    if isinstance(thing, Message | Node):
        return thing.name
    if is_dataclass(thing):
        values = {
            field.name: plain(getattr(thing, field.name)) for field in fields(thing)
        }
        return {"": type(thing).__name__, **values}
    if isinstance(thing, dict):
        return {key: plain(value) for key, value in thing.items()}
    if isinstance(thing, list | tuple):
        return [plain(entry) for entry in thing]
    return thing


def outcome(source: Source, section: dict[str, Any], with_vectors: bool) -> str:
    """Return the effect of a change: other vectors, findings, or none.

    Vectors are generated from the facts. Without ``with_vectors`` only the facts are
    compared.
    """
    icd = source.load(section)
    if icd is None:
        return FINDING
    changed_facts = {node.name: facts.of(icd, node) for node in icd.nodes}
    differ = [
        name
        for name, node_facts in changed_facts.items()
        if plain(node_facts) != plain(source.facts[name])
    ]
    if not with_vectors:
        return WIRE if differ else NOTHING
    return (
        WIRE
        if any(_differs(source, icd, changed_facts[name]) for name in differ)
        else NOTHING
    )


def _differs(source: Source, changed: Icd, other: Facts) -> bool:
    """Return whether any golden vector of the node differs."""
    pairs = zip_longest(source.cases(other.node.name), cases(changed, other))
    return any(old != new for old, new in pairs)


def cases(icd: Icd, node_facts: Facts) -> Iterator[str]:
    """Yield the vectors of a node."""
    for _, request in vectors._requests(icd, node_facts):
        complete = {"op": request["op"], "node": node_facts.node.name, **request}
        yield json.dumps([complete, reference.answer(icd, complete)])


def outcomes(
    source: Source, key: Key, with_vectors: bool
) -> Iterator[tuple[Path_, Any, str]]:
    """Yield each position, other value and its effect.

    Without ``with_vectors`` it stops at the first effect.
    """
    for place in places(source.section, key.path):
        for other in source.other_values(key, place):
            effect = outcome(source, source.at(place, other), with_vectors)
            yield place, other, effect
            if not with_vectors and effect != NOTHING:
                return


def sources(work: Path) -> Iterator[Source]:
    """Yield ICDs that together have all keys."""
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


def effects_of_keys(work: Path, with_vectors: bool) -> dict[str, set[str]]:
    """Return the effects of the changes of each key, in any of the ICDs.

    A key has no effects if no ICD has it, or if it has only one value. Without
    ``with_vectors``, a key with an effect in one ICD is not changed in others.
    """
    effects: dict[str, set[str]] = {str(key): set() for key in all_keys()}
    for source in sources(work):
        for key in all_keys():
            if not with_vectors and effects[str(key)] - {NOTHING}:
                continue
            for _, _, effect in outcomes(source, key, with_vectors):
                effects[str(key)].add(effect)
    return effects


def main() -> None:
    with TemporaryDirectory() as folder:
        effects = effects_of_keys(Path(folder), True)
    table = yaml.safe_load(TABLE.read_text(encoding="utf-8")) if TABLE.exists() else {}
    lines = []
    for key, outcome_ in effects.items():
        measured = [kind for kind in (WIRE, FINDING) if kind in outcome_]
        lines.append(f"{key}: {measured[0] if measured else table.get(key, NOTHING)}\n")
    TABLE.write_text(_HEAD + "".join(lines), encoding="utf-8")


if __name__ == "__main__":
    main()
