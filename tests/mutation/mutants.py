"""All single changes of an ICD's numbers.

Each mutant is the tree of a small ICD that holds one changed message (or enumeration).

So many mutants fit into one build: each is a node of its own, and the vectors of the
unchanged message are run on that node.
"""

from __future__ import annotations

import copy
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from itertools import product

from icdgen.backends.assurance.changes import OTHER_TYPES, formulas, tables
from icdgen.icd.build import plain
from icdgen.icd.curve import OUTSIDE
from icdgen.icd.model import Enum, Icd, Message, Node
from icdgen.icd.places import NodePlace, places_in
from icdgen.icd.variable_length import count_key, is_variable

Change = Callable[[dict], object]

_HEAD = (
    "title",
    "byte_order",
    "bit_order",
    "id_bits",
    "node_type",
    "interface_version",
)
_NUMBER_KEYS = (
    "formula", "formula_for", "points", "outside", "unit", "special", "min", "max", "above", "below", "const",
)  # fmt: skip


@dataclass(frozen=True)
class Mutant:
    """One change, in words, and the ICD that has it.

    ``message`` or ``enum`` names whose vectors must notice; neither: the node.
    """

    kind: str  # "offset", "width", "type" ...
    about: str
    node: str  # node whose vectors are run
    message: str | None
    enum: str | None
    tree: dict  # the small ICD; its node has no name yet


def mutants(icd: Icd) -> Iterator[Mutant]:
    """Every mutant, in the order of the ICDs."""
    for node in icd.nodes:
        home = _Home(icd, node)
        for message in node.messages:
            yield from _message(home, message)
        for enum in node.enums:
            yield from _enum(home, enum)
        yield from _node(home)


def unchanged(icd: Icd) -> Iterator[Mutant]:
    """The small ICDs without any change."""
    for node in icd.nodes:
        home = _Home(icd, node)
        for message in node.messages:
            yield Mutant(
                "none",
                repr(message.name),
                node.name,
                message.name,
                None,
                home.tree(message, []),
            )
        for enum in node.enums:
            user = next(
                (m for m in node.messages if any(f.enum is enum for f in m.fields)),
                None,
            )
            yield Mutant(
                "none",
                repr(enum.name),
                node.name,
                None,
                enum.name,
                home.tree(user, [enum.name]),
            )


class _Home:
    """What a small ICD takes over from the node that it is cut out of."""

    def __init__(self, icd: Icd, node: Node) -> None:
        self.node = node
        scope = (*icd.included(node), node)
        self.enums = {enum.name: enum for one in scope for enum in one.enums}
        self.structs = {
            struct.name: plain(struct.source) for one in scope for struct in one.structs
        }
        self.units = {
            unit["symbol"]: unit
            for one in scope
            for unit in plain(one.source.get("units") or [])
        }

    def tree(self, message: Message | None, enums: list[str]) -> dict:
        """A small ICD with one message and some enumerations."""
        node, head = self.node, plain(self.node.source["node"])
        tree: dict = {
            "icdgen": 1,
            "node": {key: head[key] for key in _HEAD if key in head},
            "vocabulary": list(node.vocabulary),
        }
        if message is not None:
            one = plain(message.source)
            one.pop("contains", None)
            one.pop("listed", None)
            if message.fields:  # what the manual divides in words is its parts
                one["fields"] = [
                    _line(one)
                    for one in places_in(message.layout)
                    if not one.is_count and one.derived is None
                ]
            tree["messages"] = [one]
            tree["structs"] = structs = list(self._used(one))
            rows = [row for part in (one, *structs) for row in part.get("fields") or ()]
            fields = [*rows, *one.get("derived", ())]
            used = {field.get("unit") for field in fields}
            tree["units"] = [
                unit for symbol, unit in self.units.items() if symbol in used
            ]
            enums = list(
                dict.fromkeys([*(f["enum"] for f in fields if "enum" in f), *enums])
            )
        tree["enums"] = [plain(self.enums[name].source) for name in enums]
        return {key: value for key, value in tree.items() if value}

    def _used(self, part: dict) -> Iterator[dict]:
        """The structs that stand in a message or a struct, each once, and those in
        them.
        """
        names = dict.fromkeys(
            field["struct"] for field in part.get("fields") or () if "struct" in field
        )
        found = {name: copy.deepcopy(self.structs[name]) for name in names}
        for one in list(found.values()):
            found |= {inner["name"]: inner for inner in self._used(one)}
        yield from found.values()


def _line(field: NodePlace) -> dict:
    source = plain(field.source)
    return (
        {**source, "at": field.at}
        if "struct" in source
        else {"type": "uint", **source, "at": field.at}
    )


def _message(home: _Home, message: Message) -> Iterator[Mutant]:
    base = home.tree(message, [])
    name = message.name

    def mutant(kind: str, about: str, change: Change) -> Mutant:
        tree = copy.deepcopy(base)
        change(tree)
        parts = (tree["messages"][0], *tree.get("structs", ()))
        used = {
            field.get("enum") for part in parts for field in part.get("fields") or ()
        }
        if "enums" in tree:
            tree["enums"] = [enum for enum in tree["enums"] if enum["name"] in used]
        return Mutant(kind, f"{name!r}: {about}", home.node.name, name, None, tree)

    def on_message(kind: str, about: str, **values: object) -> Mutant:
        return mutant(kind, about, lambda tree: tree["messages"][0].update(values))

    for key in ("id", "set_id", "get_id"):
        number = getattr(message, key)
        if number is not None:
            for step in (-1, 1):
                yield on_message(
                    "id", f"{key} {number} -> {number + step}", **{key: number + step}
                )
    for step in (
        (-1, 1) if not message.layout.parts else ()
    ):  # an open end begins where it ends
        yield on_message(
            "length",
            f"length {message.length} -> {message.length + step}",
            length=message.length + step,
        )
    for step in (-1, 1) if message.source.get("reserved") else ():
        reserved, length = base["messages"][0]["reserved"] + step, message.length + step
        yield on_message(
            "reserved",
            f"reserved {reserved - step} -> {reserved}",
            reserved=reserved,
            length=length,
        )
    if message.may_end_early:
        yield mutant(
            "end",
            "never ends early",
            lambda tree: tree["messages"][0].pop("may_end_early"),
        )
    for key, values in (
        ("byte_order", ("little", "big")),
        ("bit_order", ("lsb0", "msb0")),
    ):
        own = key in base["messages"][0]
        other = values[(base["messages"][0] if own else base["node"])[key] == values[0]]
        yield mutant(
            key.replace("_", " "),
            f"{key} {other}",
            lambda t, k=key, o=other, own=own: (
                t["messages"][0] if own else t["node"]
            ).update({k: o}),
        )
    for key, parts in (
        ("messages", base["messages"]),
        ("structs", base.get("structs", ())),
    ):
        for number, part in enumerate(parts):
            for kind, about, change in _part(part):
                yield mutant(
                    kind, about, lambda t, k=key, n=number, c=change: c(t[k][n])
                )


def _part(part: dict) -> Iterator[tuple[str, str, Change]]:
    """Changes of the fields of a message or a struct, and of the length of the latter."""
    fields = part.get("fields") or []
    for about, change in _swaps(fields):
        yield "swap", about, change
    for index, field in enumerate(fields):
        for kind, about, change in _field(field):
            yield (
                kind,
                f"{field['name']!r}: {about}",
                lambda p, i=index, c=change: c(p["fields"][i]),
            )
    for index, one in enumerate(part.get("derived") or ()):
        for text in formulas(one["formula"]):
            about = f"{one['name']!r}: {one['formula']} -> {text}"
            yield (
                "derived",
                about,
                lambda p, i=index, t=text: p["derived"][i].update(formula=t),
            )
    for step in (-1, 1) if "kind" not in part else ():
        length = part["length"] + step
        yield (
            "length",
            f"{part['name']!r}: length {length - step} -> {length}",
            lambda p, v=length: p.update(length=v),
        )


def _swaps(fields: list[dict]) -> Iterator[tuple[str, Change]]:
    """Two neighbours of the same width and type in each other's place."""
    for index in range(1, len(fields)):
        one, other = fields[index - 1], fields[index]
        if (
            is_variable(one)
            or is_variable(other)
            or "struct" in one
            or "struct" in other
        ):
            continue
        if (one["bits"], one["type"]) == (other["bits"], other["type"]):
            about = f"{one['name']!r} and {other['name']!r} in each other's place"
            places = {index - 1: other["at"], index: one["at"]}
            yield (
                about,
                lambda t, p=places: [
                    t["fields"][i].update(at=at) for i, at in p.items()
                ],
            )


def _open(field: dict) -> Iterator[tuple[str, str, Change]]:
    """How many elements, or bytes, an open end has."""
    for step in (-1, 1):
        yield _number("up to", field, "up_to", step)
    key = count_key(field)
    said = field[key]
    if said != "rest":
        yield "counter", "up to the end", lambda f: f.update({key: "rest"})
    if isinstance(said, str) and said != "rest":
        yield (
            "counter",
            "one more than it says",
            lambda f: f.update({key: {"field": said, "plus": 1}}),
        )
    for step in (-1, 1) if isinstance(said, dict) else ():
        plus = said["plus"] + step
        about = f"plus {said['plus']} -> {plus}"
        yield (
            "counter",
            about,
            lambda f, v=plus: f.update({key: {"field": said["field"], "plus": v}}),
        )


def _field(field: dict) -> Iterator[tuple[str, str, Change]]:
    if "struct" in field and is_variable(field):
        yield from _open(field)
        return
    if "struct" in field:
        for key, steps in (
            ("at", (-8, 8)),
            ("count", (-1, 1) if "count" in field else ()),
        ):
            for step in steps:
                yield _number("offset" if key == "at" else "count", field, key, step)
        return
    if is_variable(field):
        yield from _open(field)
        for step in (-8, 8) if "bits" in field else ():
            yield _number("width", field, "bits", step)
    for step in (-8, -1, 1, 8) if not is_variable(field) else ():
        yield _number("offset", field, "at", step)
    for step in (-1, 1) if field["type"] not in ("bytes", "text") else (-8, 8):
        if not is_variable(field):
            yield _number("width", field, "bits", step)
    for step in (-1, 1) if type(field.get("count")) is int else ():
        yield _number("count", field, "count", step)
    for name, said in (field.get("when") or {}).items():
        for index, value in enumerate(said if isinstance(said, list) else [said]):
            for step in (-1, 1) if type(value) is int else ():
                values = (
                    [*said[:index], value + step, *said[index + 1 :]]
                    if isinstance(said, list)
                    else value + step
                )
                yield (
                    "condition",
                    f"{name} {said} -> {values}",
                    lambda f, n=name, v=values: f["when"].update({n: v}),
                )
    if field.get("when"):
        yield "condition", "always there", lambda f: f.pop("when")
    if field.get("view"):
        yield "view", "no view", lambda f: f.pop("view")
    for other in OTHER_TYPES[field["type"]]:
        if (other == "bytes" and field.get("view")) or (
            is_variable(field) and ("size" in field or other in ("bytes", "bool"))
        ):
            continue
        yield "type", f"{field['type']} -> {other}", lambda f, o=other: _retype(f, o)
    for key, values in (
        ("byte_order", ("little", "big")),
        ("bit_order", ("lsb0", "msb0")),
    ):
        if key in field:
            other = values[field[key] == values[0]]
            yield (
                key.replace("_", " "),
                f"{key} {other}",
                lambda f, k=key, o=other: f.update({k: o}),
            )
    if "formula" in field:
        for text in formulas(field["formula"]):
            yield (
                "formula",
                f"{field['formula']} -> {text}",
                lambda f, t=text: f.update(formula=t),
            )
        yield "formula", f"{field['formula']} -> none", lambda f: f.pop("formula")
    yield from _points(field) if "points" in field else ()
    if "const" in field:
        for step in (-1, 1):
            yield _number("const", field, "const", step)
    for key in ("min", "max", "above", "below"):
        if key in field:
            for step in (-1, 1):
                yield _number("limit", field, key, step)
    for index, special in enumerate(field.get("special") or ()):
        named = {
            "nan": ("inf", "-inf"),
            "inf": ("nan", "-inf"),
            "-inf": ("nan", "inf"),
        }.get(special["value"])
        for value in named or (special["value"] - 1, special["value"] + 1):
            about = f"special {special['value']} -> {value}"
            yield (
                "special",
                about,
                lambda f, i=index, v=value: f["special"][i].update(value=v),
            )


def _points(field: dict) -> Iterator[tuple[str, str, Change]]:
    """Each number of a table one more and one less, and what is so outside of it."""
    for points in tables(field["points"]):
        yield (
            "points",
            f"{field['points']} -> {points}",
            lambda f, p=points: f.update(points=p),
        )
    for outside in OUTSIDE:
        if outside != field.get("outside"):
            yield (
                "outside",
                f"outside {outside}",
                lambda f, o=outside: f.update(outside=o),
            )


def _number(kind: str, field: dict, key: str, step: int) -> tuple[str, str, Change]:
    value = field[key] + step
    return kind, f"{key} {field[key]} -> {value}", lambda f: f.update({key: value})


def _retype(field: dict, type_: str) -> None:
    if field["type"] == "float":
        field.pop("special", None)
    field["type"] = type_
    field.pop("enum", None)
    if type_ not in ("uint", "int"):
        for key in _NUMBER_KEYS:
            field.pop(key, None)


def _node(home: _Home) -> Iterator[Mutant]:
    for key in ("node_type", "interface_version"):
        number = getattr(home.node, key)
        for step in (-1, 1) if number is not None else ():
            tree = copy.deepcopy(home.tree(None, []))
            tree["node"][key] = number + step
            yield Mutant(
                "node",
                f"{key} {number} -> {number + step}",
                home.node.name,
                None,
                None,
                tree,
            )


def _enum(home: _Home, enum: Enum) -> Iterator[Mutant]:
    user = next(
        (m for m in home.node.messages if any(f.enum is enum for f in m.fields)), None
    )
    for index, member in enumerate(enum.members):
        for key, step in product(("value", "to"), (-1, 1)):
            if (value := getattr(member, key)) is None:
                continue
            tree = copy.deepcopy(home.tree(user, [enum.name]))
            changed = next(e for e in tree["enums"] if e["name"] == enum.name)
            changed["members"][index][key] = value + step
            about = f"{enum.name!r}: {member.name!r} {value} -> {value + step}"
            yield Mutant("enum value", about, home.node.name, None, enum.name, tree)
