"""All single changes of the numbers of an ICD.

Each mutant is the tree of a small ICD with one changed message or enumeration. Many
mutants fit into one build, because each is a node of its own. The vectors of the
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

    ``message`` or ``enum`` names the message or enumeration whose vectors must fail. If
    neither is given, these are the vectors of the node.
    """

    kind: str  # "offset", "width", "type" ...
    about: str
    node: str  # node whose vectors are run
    message: str | None
    enum: str | None
    tree: dict  # the small ICD; its node has no name yet


def mutants(icd: Icd) -> Iterator[Mutant]:
    """Yield every mutant, in the order of the ICDs."""
    for node in icd.nodes:
        origin = _Origin(icd, node)
        for message in node.messages:
            yield from _message(origin, message)
        for enum in node.enums:
            yield from _enum(origin, enum)
        yield from _node(origin)


def unchanged(icd: Icd) -> Iterator[Mutant]:
    """Yield the small ICDs without any change."""
    for node in icd.nodes:
        origin = _Origin(icd, node)
        for message in node.messages:
            yield Mutant(
                "none",
                repr(message.name),
                node.name,
                message.name,
                None,
                origin.tree(message, []),
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
                origin.tree(user, [enum.name]),
            )


class _Origin:
    """The parts that a small ICD takes over from its node."""

    def __init__(self, icd: Icd, node: Node) -> None:
        self.node = node
        scope = (*icd.included(node), node)
        self.enums = {enum.name: enum for owner in scope for enum in owner.enums}
        self.structs = {
            struct.name: plain(struct.source)
            for owner in scope
            for struct in owner.structs
        }
        self.units = {
            unit["symbol"]: unit
            for owner in scope
            for unit in plain(owner.source.get("units") or [])
        }

    def tree(self, message: Message | None, enums: list[str]) -> dict:
        """Return a small ICD with one message and some enumerations."""
        node, head = self.node, plain(self.node.source["node"])
        tree: dict = {
            "icdgen": 1,
            "node": {key: head[key] for key in _HEAD if key in head},
            "vocabulary": list(node.vocabulary),
        }
        if message is not None:
            own = plain(message.source)
            # The other messages, to which these keys refer, are not in the small ICD.
            own.pop("contains", None)
            own.pop("listed", None)
            if message.fields:  # of a split field its parts
                own["fields"] = [
                    _line(place)
                    for place in places_in(message.layout)
                    if not place.is_count and place.derived is None
                ]
            tree["messages"] = [own]
            tree["structs"] = structs = list(self._used(own))
            rows = [row for part in (own, *structs) for row in part.get("fields") or ()]
            fields = [*rows, *own.get("derived", ())]
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
        """Yield the structs of a message or a struct, each once, including nested ones."""
        names = dict.fromkeys(
            field["struct"] for field in part.get("fields") or () if "struct" in field
        )
        structs = {name: copy.deepcopy(self.structs[name]) for name in names}
        for struct in list(structs.values()):
            structs |= {inner["name"]: inner for inner in self._used(struct)}
        yield from structs.values()


def _line(field: NodePlace) -> dict:
    source = plain(field.source)
    return (
        {**source, "at": field.at}
        if "struct" in source
        else {"type": "uint", **source, "at": field.at}
    )


def _message(origin: _Origin, message: Message) -> Iterator[Mutant]:
    base = origin.tree(message, [])
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
        return Mutant(kind, f"{name!r}: {about}", origin.node.name, name, None, tree)

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
    ):  # a variable-length field begins where the fixed length ends
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
    """Yield changes of the fields of a message or a struct, and of the length of a
    struct.
    """
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
    for index, derived in enumerate(part.get("derived") or ()):
        for text in formulas(derived["formula"]):
            about = f"{derived['name']!r}: {derived['formula']} -> {text}"
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
    """Yield changes in which two neighbours of the same width and type exchange their
    positions.
    """
    for index in range(1, len(fields)):
        first, second = fields[index - 1], fields[index]
        if any(is_variable(each) or "struct" in each for each in (first, second)):
            continue
        if (first["bits"], first["type"]) == (second["bits"], second["type"]):
            about = f"{first['name']!r} and {second['name']!r} exchanged"
            places = {index - 1: second["at"], index: first["at"]}
            yield (
                about,
                lambda t, p=places: [
                    t["fields"][i].update(at=at) for i, at in p.items()
                ],
            )


def _variable_length(field: dict) -> Iterator[tuple[str, str, Change]]:
    """Yield changes of the number of elements, or bytes, of a variable-length field."""
    for step in (-1, 1):
        yield _number("up to", field, "up_to", step)
    key = count_key(field)
    counter = field[key]
    if counter != "rest":
        yield "counter", "up to the end", lambda f: f.update({key: "rest"})
    if isinstance(counter, str) and counter != "rest":
        yield (
            "counter",
            "one more than it counts",
            lambda f: f.update({key: {"field": counter, "plus": 1}}),
        )
    for step in (-1, 1) if isinstance(counter, dict) else ():
        plus = counter["plus"] + step
        about = f"plus {counter['plus']} -> {plus}"
        yield (
            "counter",
            about,
            lambda f, v=plus: f.update({key: {"field": counter["field"], "plus": v}}),
        )


def _field(field: dict) -> Iterator[tuple[str, str, Change]]:
    if "struct" in field and is_variable(field):
        yield from _variable_length(field)
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
        yield from _variable_length(field)
        for step in (-8, 8) if "bits" in field else ():
            yield _number("width", field, "bits", step)
    for step in (-8, -1, 1, 8) if not is_variable(field) else ():
        yield _number("offset", field, "at", step)
    for step in (-1, 1) if field["type"] not in ("bytes", "text") else (-8, 8):
        if not is_variable(field):
            yield _number("width", field, "bits", step)
    for step in (-1, 1) if type(field.get("count")) is int else ():
        yield _number("count", field, "count", step)
    for name, condition in (field.get("when") or {}).items():
        for index, value in enumerate(
            condition if isinstance(condition, list) else [condition]
        ):
            for step in (-1, 1) if type(value) is int else ():
                values = (
                    [*condition[:index], value + step, *condition[index + 1 :]]
                    if isinstance(condition, list)
                    else value + step
                )
                yield (
                    "condition",
                    f"{name} {condition} -> {values}",
                    lambda f, n=name, v=values: f["when"].update({n: v}),
                )
    if field.get("when"):
        yield "condition", "always present", lambda f: f.pop("when")
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
    """Yield lookup tables with one number changed by one, and with other behaviour
    outside.
    """
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
    # Special values of a float, such as NaN, are invalid for other types.
    if field["type"] == "float":
        field.pop("special", None)
    field["type"] = type_
    field.pop("enum", None)
    if type_ not in ("uint", "int"):
        for key in _NUMBER_KEYS:
            field.pop(key, None)


def _node(origin: _Origin) -> Iterator[Mutant]:
    for key in ("node_type", "interface_version"):
        number = getattr(origin.node, key)
        for step in (-1, 1) if number is not None else ():
            tree = copy.deepcopy(origin.tree(None, []))
            tree["node"][key] = number + step
            yield Mutant(
                "node",
                f"{key} {number} -> {number + step}",
                origin.node.name,
                None,
                None,
                tree,
            )


def _enum(origin: _Origin, enum: Enum) -> Iterator[Mutant]:
    user = next(
        (m for m in origin.node.messages if any(f.enum is enum for f in m.fields)), None
    )
    for index, member in enumerate(enum.members):
        for key, step in product(("value", "to"), (-1, 1)):
            if (value := getattr(member, key)) is None:
                continue
            tree = copy.deepcopy(origin.tree(user, [enum.name]))
            changed = next(e for e in tree["enums"] if e["name"] == enum.name)
            changed["members"][index][key] = value + step
            about = f"{enum.name!r}: {member.name!r} {value} -> {value + step}"
            yield Mutant("enum value", about, origin.node.name, None, enum.name, tree)
