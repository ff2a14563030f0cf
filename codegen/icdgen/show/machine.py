"""JSON form of ICDs.

``show.schema.json`` defines it; attributes that do not apply are omitted.
`icdgen.diff.inputs.shown` reads it back into ICDs.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import fields
from functools import cache
from pathlib import Path
from typing import Any

from icdgen.describe.bounds import bounds_of_limits
from icdgen.icd.annex import Loggable
from icdgen.icd.erratum import Erratum
from icdgen.icd.layout import VariablePart
from icdgen.icd.located import plain
from icdgen.icd.model import Enum, Icd, Member, Message, Node, Struct
from icdgen.icd.places import NodePlace, places_in

FORMAT = 1
SCHEMA = Path(__file__).parent.with_name("show.schema.json")

_Object = dict[str, object]

# Annotations of attributes that are shown unchanged.
_PLAIN = ("str", "int", "str | None", "int | None")
# Attributes with these annotations that are not shown, or shown in another form.
_EXCEPTIONS = {
    Node: ("file",),
    Message: ("node",),
    Enum: ("node",),
    Struct: ("node",),
    Erratum: ("why",),
}


def to_json(icd: Icd) -> _Object:
    """Return ICDs as values for JSON.

    A node has only its own messages and enumerations, and ``includes``.
    """
    # A second list of all loggable frames spares programs the search in nodes.
    loggable = [
        {"node": node.name} | _row(row) for node in icd.nodes for row in node.loggable
    ]
    return {
        "format": FORMAT,
        "nodes": [_node(node) for node in icd.nodes],
        "loggable": loggable,
    }


@cache
def plain_attributes(kind: Any) -> tuple[str, ...]:
    """Return the attributes of a class of the model that are shown unchanged, under
    their own names.
    """
    names = (attribute.name for attribute in fields(kind) if attribute.type in _PLAIN)
    return tuple(name for name in names if name not in _EXCEPTIONS.get(kind, ()))


def _attributes(thing: Any) -> _Object:
    """Return the plain attributes of an object that differ from their default."""
    kind: Any = type(thing)
    values = {name: getattr(thing, name) for name in plain_attributes(kind)}
    return {
        name: value
        for name, value in values.items()
        if value != _defaults(kind).get(name)
    }


@cache
def _defaults(kind: Any) -> dict[str, object]:
    """Return the defaults of the attributes of a class."""
    # Attributes that have a default are left out if they have it: a new attribute does
    # not change the output of older ICDs.
    return {attribute.name: attribute.default for attribute in fields(kind)}


def _node(node: Node) -> _Object:
    return _present(
        **_attributes(node),
        document=dict(node.document),
        vocabulary=list(node.vocabulary),
        units=[_present(**unit._asdict()) for unit in node.units],
        protocol=node.protocol,
        missing=[_attributes(entry) for entry in node.missing],
        errata=_errata(node, is_note=False),
        notes=_errata(node, is_note=True),
    ) | {
        "includes": list(node.includes),
        **({"structs": list(map(_struct, node.structs))} if node.structs else {}),
        "messages": [_message(message) for message in node.messages],
        "enums": [
            _row(enum) | {"members": list(map(_row, enum.members))}
            for enum in node.enums
        ],
        "loggable": [_row(row) for row in node.loggable],
    }


def _message(message: Message) -> _Object:
    """Return a message with its fields and derived values."""
    # The last variable-length part is `tail`, those before it are `inner`: see
    # ``show.schema.json``.
    parts = list(map(_variable_part, message.layout.parts))
    places = [place for place in places_in(message.layout) if not place.is_count]
    acknowledge: object = None  # the default: it is acknowledged
    if not message.acknowledge:
        acknowledge = "reset" if message.expects_reset else False
    return _present(
        **{"name": message.name, "kind": message.kind, "length": message.length}
        | _attributes(message),
        acknowledge=acknowledge,
        response=message.response,
        repeat=message.repeat or None,
        requested=None if message.requested else False,
        aliases=list(message.aliases),
        contains=[
            {"message": part.message, "offset": part.at} for part in message.contains
        ],
        tail=parts[-1] if parts else None,
        inner=parts[:-1],
        **_ids(message.errata),
    ) | {
        "fields": [_field(place) for place in places if place.derived is None],
        **_present(
            derived=[_derived(place) for place in places if place.derived is not None]
        ),
    }


def _variable_part(part: VariablePart) -> _Object:
    """Return a variable-length part; without a counter if the length of the frame gives
    the number of elements.
    """
    return _present(
        part=part.name,
        counter=None if part.is_rest else part.counter,
        least=part.begin,
        step=part.step,
        most=part.most,
        plus=part.plus or None,
        behind=part.behind or None,
    )


def _field(field: NodePlace) -> _Object:
    """Return a field."""
    scale = field.scale
    return _present(
        name=field.name,
        bits=field.bits,
        type=field.type,
        identifier=field.identifier,
        const=field.const,
        summary=field.summary,
        byte_order=field.byte_order,
        bit_order=field.bit_order,
        count=field.count or None,
        aliases=list(field.aliases),
        offset=field.at,
        enum=field.enum.name if field.enum else None,
        struct=field.struct.name if field.struct else None,
        unit=field.unit_symbol or None,
        scale=str(scale.factor) if scale else None,
        scale_offset=str(scale.offset) if scale and scale.offset else None,
        **(field.curve.plain if field.curve else {}),
        formula=field.formula if field.has_formula else None,
        special=[_attributes(special) for special in field.special],
        display=field.display.plain if field.display else None,
        # Exact, like `scale`.
        limits={
            bound.key: str(bound.value) for bound in bounds_of_limits(field.limits)
        },
        view=True if field.is_read_only else None,
        when={
            condition.field: list(condition.values) for condition in field.conditions
        },
        **_ids(field.errata),
    )


def _struct(struct: Struct) -> _Object:
    """Return a struct with its fields."""
    counts = {
        id(part.node): {"counter": part.counter, "plus": part.plus or None}
        for part in struct.layout.inner_parts
    }
    fields = [
        _field(place) | _present(**counts.get(id(place.node), {}))
        for place in places_in(struct.layout)
    ]
    return (
        {"name": struct.name, "length": struct.length}
        | _row(struct)
        | {"fields": fields}
    )


def _derived(field: NodePlace) -> _Object:
    """Return a derived value."""
    attributes = {
        key: getattr(field, key) for key in ("name", "identifier", "formula", "summary")
    }
    display = field.display.plain if field.display else None
    return _present(
        **attributes,
        aliases=list(field.aliases),
        unit=field.unit_symbol or None,
        display=display,
    )


def _row(thing: Enum | Member | Loggable | Struct) -> _Object:
    """Return the plain attributes, aliases and errata of an object."""
    aliases = list(thing.aliases) if isinstance(thing, (Enum, Member, Struct)) else []
    return _present(**_attributes(thing), aliases=aliases, **_ids(thing.errata))


def _errata(node: Node, is_note: bool) -> list[_Object]:
    """Return the errata or the notes of a node, with the places that they are about."""
    places: dict[str, list[_Object]] = {}
    for place, errata in _places(node):
        for erratum in errata:
            places.setdefault(erratum.id, []).append(place)
    return [
        _erratum(erratum, places.get(erratum.id, []))
        for erratum in node.errata
        if erratum.is_note == is_note
    ]


def _erratum(erratum: Erratum, places: list[_Object]) -> _Object:
    """Return an erratum or a note, with the places that it is about."""
    return _present(
        **_attributes(erratum),
        **{"what" if erratum.is_note else "why": erratum.why},
        tables=list(erratum.tables),
        printed=plain(dict(erratum.printed)),
        held=plain(dict(erratum.held)),
        places=places,
    ) | ({} if erratum.is_note else {"changes": erratum.changes})


def _places(node: Node) -> Iterator[tuple[_Object, tuple[Erratum, ...]]]:
    """Yield each object of a node that errata can be about, with its errata."""
    for what, owners in (("struct", node.structs), ("message", node.messages)):
        for owner in owners:
            yield {what: owner.name}, owner.errata
            for line in owner.layout.nodes:
                yield {what: owner.name, "field": line.name}, line.errata
    for enum in node.enums:
        yield {"enum": enum.name}, enum.errata
        for member in enum.members:
            yield {"enum": enum.name, "member": member.value}, member.errata
    for row in node.loggable:
        yield {"loggable": row.bit}, row.errata


def _ids(errata: tuple[Erratum, ...]) -> dict[str, list[str]]:
    """Return the ids of errata and of notes."""
    return {
        "errata": [erratum.id for erratum in errata if not erratum.is_note],
        "notes": [erratum.id for erratum in errata if erratum.is_note],
    }


def _present(**items: object) -> _Object:
    """Return the items that have a value: not None, and not an empty text, list or
    mapping.
    """
    # 0 and False stay: they are values.
    return {
        key: value
        for key, value in items.items()
        if value is not None and value not in ("", [], {})
    }
