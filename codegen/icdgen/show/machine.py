"""The stable machine-readable form of ICDs, described by ``show.schema.json``. What does not apply is left out."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

from icdgen.describe.bounds import bounds
from icdgen.icd.model import Enum, Erratum, Field, Icd, Limits, Loggable, Message, Node
from icdgen.icd.wire_ids import DEFAULT_BITS

FORMAT = 1
SCHEMA = Path(__file__).parent.with_name("show.schema.json")

_Object = dict[str, object]


def to_json(icd: Icd) -> _Object:
    """A tree for `json.dumps`. A node lists only its own messages and enumerations; see its ``includes`` for more."""
    loggable = [{"node": node.name} | _loggable(row) for node in icd.nodes for row in node.loggable]
    return {"format": FORMAT, "nodes": [_node(node) for node in icd.nodes], "loggable": loggable}


def _node(node: Node) -> _Object:
    return _present(
        name=node.name,
        title=node.title,
        summary=node.summary,
        node_type=node.node_type,
        interface_version=node.interface_version,
        byte_order=node.byte_order,
        bit_order=node.bit_order,
        id_bits=node.id_bits if node.id_bits != DEFAULT_BITS else None,
        document=dict(node.document),
        vocabulary=list(node.vocabulary),
        units=[_present(**unit._asdict()) for unit in node.units],
        protocol=node.protocol,
        missing=[{"kind": m.kind, "id": m.id, "name": m.name, "why": m.why} for m in node.missing],
        errata=_errata(node, is_note=False),
        notes=_errata(node, is_note=True),
        digest=node.digest,
    ) | {
        "includes": list(node.includes),
        "messages": [_message(m) for m in node.messages],
        "enums": [_enum(e) for e in node.enums],
        "loggable": [_loggable(row) for row in node.loggable],
    }


def _message(message: Message) -> _Object:
    return _present(
        name=message.name,
        identifier=message.identifier,
        kind=message.kind,
        id=message.id,
        set_id=message.set_id,
        get_id=message.get_id,
        length=message.length,
        group=message.group,
        table=message.table,
        page=message.page,
        summary=message.summary,
        acknowledge=None if message.acknowledge else "reset" if message.expects_reset else False,
        hazard=message.hazard,
        contains=[{"message": part.message, "offset": part.at} for part in message.contains],
        **_ids(message.errata),
    ) | {"fields": [_field(f) for f in message.fields]}


def _field(field: Field) -> _Object:
    scale = field.scale
    return _present(
        name=field.name,
        identifier=field.identifier,
        offset=field.at,
        bits=field.bits,
        type=field.type,
        byte_order=field.byte_order,
        bit_order=field.bit_order,
        enum=field.enum.name if field.enum else None,
        unit=field.unit.symbol if field.unit else None,
        scale=str(scale.factor) if scale else None,
        scale_offset=str(scale.offset) if scale and scale.offset else None,
        formula=field.formula if scale else None,
        const=field.const,
        special=[{"value": s.value, "meaning": s.meaning} for s in field.special],
        limits=_limits(field.limits),
        summary=field.summary,
        **_ids(field.errata),
    )


def _enum(enum: Enum) -> _Object:
    return _present(
        name=enum.name,
        identifier=enum.identifier,
        table=enum.table,
        summary=enum.summary,
        **_ids(enum.errata),
    ) | {
        "members": [
            _present(value=m.value, name=m.name, identifier=m.identifier, summary=m.summary, **_ids(m.errata))
            for m in enum.members
        ]
    }


def _loggable(row: Loggable) -> _Object:
    return _present(bit=row.bit, id=row.id, name=row.name, **_ids(row.errata))


def _limits(limits: Limits | None) -> dict[str, str] | None:
    """Bounds as exact numbers, ``p`` or ``p/q``, like ``scale``."""
    return {bound.key: str(bound.value) for bound in bounds(limits)} if limits is not None else None


def _errata(node: Node, is_note: bool) -> list[_Object]:
    places: dict[str, list[_Object]] = {}
    for place, errata in _places(node):
        for erratum in errata:
            places.setdefault(erratum.id, []).append(place)
    return [
        _present(
            id=e.id,
            title=e.title,
            **{"what" if is_note else "why": e.why},
            evidence=e.evidence,
            confidence=e.confidence,
            tables=list(e.tables),
            printed=_plain(dict(e.printed)),
            held=_plain(dict(e.held)),
            places=places.get(e.id, []),
        )
        | ({} if is_note else {"changes": e.changes})
        for e in node.errata
        if e.is_note == is_note
    ]


def _places(node: Node) -> Iterator[tuple[_Object, tuple[Erratum, ...]]]:
    """Every object of the node that errata can concern, with those that do."""
    for message in node.messages:
        yield {"message": message.name}, message.errata
        for field in message.fields:
            yield {"message": message.name, "field": field.name}, field.errata
    for enum in node.enums:
        yield {"enum": enum.name}, enum.errata
        for member in enum.members:
            yield {"enum": enum.name, "member": member.value}, member.errata
    for row in node.loggable:
        yield {"loggable": row.bit}, row.errata


def _ids(errata: tuple[Erratum, ...]) -> dict[str, list[str]]:
    return {
        "errata": [erratum.id for erratum in errata if not erratum.is_note],
        "notes": [erratum.id for erratum in errata if erratum.is_note],
    }


def _plain(value: object) -> object:
    if isinstance(value, dict):
        return {key: _plain(item) for key, item in value.items()}
    return [_plain(item) for item in value] if isinstance(value, list) else value


def _present(**items: object) -> _Object:
    """Without what is None or empty. 0 and False stay."""
    return {key: value for key, value in items.items() if value is not None and value not in ("", [], {})}
