"""Home page, and page of a node.

`home` and `values` return what the templates ``home.html.j2`` and ``node.html.j2``
need; `brief` what every page shows of each node.
"""

from __future__ import annotations

from icdgen.backends.html import examples, protocol, texts, wire
from icdgen.backends.html.relations import PageLink, Relations, document, manual
from icdgen.describe.errata import errata_of_message
from icdgen.icd.lines import lines
from icdgen.icd.model import CONFIGURATION, TELECOMMAND, TELEMETRY, Message, Node
from icdgen.icd.wire_ids import DEFAULT_BITS

_KINDS = {
    TELECOMMAND: "Telecommands",
    TELEMETRY: "Telemetry",
    CONFIGURATION: "Configuration",
}
_CONFIDENCE = ("certain", "likely", "open")


def brief(relations: Relations, node: Node) -> dict[str, object]:
    """Return the values of a node that every page shows."""
    return {
        "name": node.name,
        "title": texts.clip(node.title, 80),
        "url": relations.links.node(node.name),
    }


def home(relations: Relations) -> dict[str, object]:
    """Return the values of the home page."""
    icd = relations.icd
    messages = [message for node in icd.nodes for message in node.messages]
    errata = [
        erratum for node in icd.nodes for erratum in node.errata if not erratum.is_note
    ]
    notes = sum(erratum.is_note for node in icd.nodes for erratum in node.errata)
    totals = [
        (f"{len(icd.nodes):,}", "nodes"),
        (f"{len(messages):,}", "messages"),
        (f"{sum(m.field_count for m in messages):,}", "fields"),
        (f"{sum(len(n.enums) for n in icd.nodes):,}", "enumerations"),
        (f"{len(errata):,}", "known errata"),
        (f"{notes:,}", "notes"),
    ]
    # Telemetry with a scale shows raw and physical values.
    example = next(
        (
            m
            for m in messages
            if m.telemetry_id is not None
            and any(f.has_formula for f in lines(m.layout))
        ),
        None,
    )
    return {
        "totals": totals,
        "cards": [_card(relations, node) for node in icd.nodes],
        "confidence": [
            (level, sum(e.confidence == level for e in errata)) for level in _CONFIDENCE
        ],
        "documents": list(
            dict.fromkeys(manual(node) for node in icd.nodes if node.document)
        ),
        "example": relations.place(example) if example else None,
        "paste_example": _paste_example(relations, example),
    }


def _paste_example(relations: Relations, example: Message | None) -> str:
    """Return a transmitted frame, as an example of input for the decoder."""
    if example is None:
        return ""
    frame = examples.example_frames(example, relations.icd.node(example.node))[0].frame
    buses = wire.buses(example, relations.wire(example), frame)
    lines = buses[0].lines if buses else []
    return " ".join(chunk.text for chunk in lines[-1].chunks) if lines else ""


def _card(relations: Relations, node: Node) -> dict[str, object]:
    return {
        **brief(relations, node),
        "summary": node.summary,
        "document": document(node),
        "facts": _facts(node),
        "includes": [relations.icd.node(name).title for name in node.includes],
        "counts": [
            (
                sum(m.kind == kind for m in node.messages),
                title.lower() if kind != CONFIGURATION else "configuration",
            )
            for kind, title in _KINDS.items()
        ],
        **_decisions(node),
    }


def _decisions(node: Node) -> dict[str, int]:
    """Return the number of errata and notes."""
    notes = sum(erratum.is_note for erratum in node.errata)
    return {"errata": len(node.errata) - notes, "notes": notes}


def _facts(node: Node) -> list[tuple[str, str]]:
    facts = (
        ("Node type", node.node_type),
        ("Interface version", node.interface_version),
        ("Ids", f"{node.id_bits} bits" if node.id_bits != DEFAULT_BITS else None),
        ("Firmware", dict(node.document).get("version") or None),
    )
    return [(label, str(value)) for label, value in facts if value is not None]


def values(relations: Relations, node: Node) -> dict[str, object]:
    """Return the values of the page of a node, and of the page with all its messages."""
    # Own messages first. The sort is stable, so each group keeps its order.
    used_messages = sorted(
        relations.icd.messages_of(node), key=lambda m: m.node != node.name
    )
    rows = [_row(relations, node, message) for message in used_messages]
    # `reversed`: the first message of a shared id has precedence.
    received = {
        m.telemetry_id: relations.place(m)
        for m in reversed(relations.icd.messages_of(node))
    }
    numbering = (
        f"bit 0 is the {'least' if node.bit_order == 'lsb0' else 'most'} significant"
    )
    return {
        "node": node,
        "document": document(node),
        "facts": [
            *_facts(node),
            ("Byte order", f"{node.byte_order}-endian"),
            ("Bit numbering", numbering),
        ],
        "rows": rows,
        "has_hex": any(
            id.hexadecimal for message in used_messages for id in relations.ids(message)
        ),
        "kinds": [
            (kind, title, count)
            for kind, title in _KINDS.items()
            if (count := sum(m.kind == kind for m in used_messages))
        ],
        "groups": sorted({message.group for message in used_messages if message.group}),
        "loggable": [(row, received.get(row.id)) for row in node.loggable],
        "enums": [
            (
                PageLink(enum.name, relations.links.enum(enum)),
                len(enum.members),
                enum.summary,
            )
            for enum in node.enums
        ],
        "included": [
            PageLink(included_node.title, relations.links.node(included_node.name))
            for included_node in relations.icd.included(node)
        ],
        "speakers": [
            PageLink(speaker.title, relations.links.node(speaker.name))
            for speaker in relations.speakers[node.name]
            if speaker is not node
        ],
        "protocol": protocol.has_page(relations, node),
        "printed": relations.links.printed(node.name),
        **_decisions(node),
        "own": len(node.messages),
        "fields_count": sum(m.field_count for m in node.messages),
    }


def _row(relations: Relations, node: Node, message: Message) -> dict[str, object]:
    own = message.node == node.name
    ids = relations.ids(message)
    mask = [
        row.bit
        for owner, row in relations.logged[message.node, message.name]
        if owner is node
    ]
    return {
        "message": message,
        "url": relations.links.message(message),
        "ids": ids,
        "anchors": [
            f"{'telemetry' if id.purpose == 'get' or message.kind == TELEMETRY else 'telecommand'}-{id.value}"
            for id in ids
        ],
        "bytes": (
            message.length
            if len(message.layout.lengths) == 1
            else f"{message.layout.shortest}\u2013{message.length}"
        ),
        "mask": mask,
        "of": "" if own else relations.icd.node(message.node).title,
        "errata": len(errata_of_message(message)),
    }
