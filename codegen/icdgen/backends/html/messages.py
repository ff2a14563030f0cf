"""Page of a message.

`values` collects what the template ``message.html.j2`` shows, from the other modules of
this package: drawing, field table, bytes on each bus, examples, snippets, and the data
of the decoder.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING, Any

from icdgen import codec
from icdgen.backends.html import drawing, fields, plan, responses, sections, texts, wire
from icdgen.backends.html.examples import example_frames, page_vectors
from icdgen.backends.html.relations import Relations
from icdgen.backends.html.usage import snippets, type_names
from icdgen.describe import describe
from icdgen.describe.errata import errata_of_message
from icdgen.describe.numbers import count_text, length_text
from icdgen.describe.shared_ids import sharing_sentence
from icdgen.icd import wire_ids
from icdgen.icd.lines import lines
from icdgen.icd.model import Message, Node, framed_link
from icdgen.wording import count

if TYPE_CHECKING:
    from icdgen.render import Renderer


def values(
    relations: Relations, node: Node, message: Message, render: Renderer
) -> dict[str, Any]:
    """Return the values of the page of a message that ``node`` declares."""
    described, in_c = describe(relations.icd).message(message), relations.in_c(message)
    repeats = relations.links.repeats(message)
    parts = sections.part_sections(relations, message)
    shares = parts or sections.field_sections(message, repeats)
    # A message with sections has a drawing for each of them.
    pictures = [
        drawing.draw_frame(message, node, relations.links, part.first, part.end)
        for part in parts
    ] or [drawing.draw_frame(message, node, relations.links)]
    drawings = [picture for picture in pictures if picture is not None]
    rows = fields.rows(message, relations.links)
    rows_by_share = fields.split(rows, shares)
    shown = example_frames(message, node)
    is_received = message.telemetry_id is not None
    # A telecommand shows its initial values.
    data = (
        shown[0].frame if shown and is_received else codec.initial_frame(node, message)
    )
    return {
        "message": message,
        "node": node,
        "url": relations.links.message(message),
        "ids": relations.ids(message),
        "names": type_names(described, in_c),
        "facts": _facts(relations, node, message),
        "drawings": drawings,
        "keyed": any(picture.keyed for picture in drawings),
        "rows": rows,
        "columns": fields.columns_of(rows),
        # Without parts, `pictures` has the drawing of the complete message, which
        # belongs to no band.
        "bands": list(zip(parts, rows_by_share, pictures, strict=False)),
        "shares": list(zip(shares, rows_by_share, strict=True)),
        "buses": wire.buses(message, relations.wire(message), data),
        "example_data": is_received and bool(data),
        "examples": shown,
        "frames": page_vectors(message, node),
        "snippets": snippets(described, in_c, relations.packages, render),
        "contains": relations.contains[message.node, message.name],
        "contained_in": relations.contained_in[message.node, message.name],
        "errata": errata_of_message(message),
        "plan": texts.script_json(_plan(relations, node, message, drawings, shares)),
    }


def _facts(
    relations: Relations, node: Node, message: Message
) -> list[tuple[str, str, str]]:
    """Return label, text and link of each fact."""
    protocol = relations.icd.protocol_of(node) or {}
    # Packet formats have responses instead of acknowledges.
    acknowledged = ""
    if message.telecommand_id is not None and not framed_link(protocol):
        acknowledged = "yes" if message.acknowledge else "no"
    source = [
        f"{word} {number}"
        for word, number in (("table", message.table), ("page", message.page))
        if number
    ]
    facts = [
        ("Length", length_text(message), ""),
        (
            "Fields",
            str(
                sum(not field.is_count for _, field in relations.shown_fields(message))
            ),
            "",
        ),
        *_variable_parts(message),
        ("End", "trailing zeros may be omitted" if message.may_end_early else "", ""),
        (
            "Reserved",
            f"last {count(message.reserved, 'byte')}" if message.reserved else "",
            "",
        ),
        (
            "Id",
            sharing_sentence(
                describe(relations.icd).node(node).messages_by_id, message
            ),
            "",
        ),
        ("Group", message.group, ""),
        ("Period", f"{message.period_ms} ms" if message.period_ms else "", ""),
        *responses.of_message(relations, node, message),
        ("Acknowledged", acknowledged, ""),
        *(
            (
                "Log mask",
                f"bit {row.bit}",
                relations.links.node(owner.name) + "#log-mask",
            )
            for owner, row in relations.logged[message.node, message.name]
        ),
        ("Manual", ", ".join(source), ""),
        (
            "Used by",
            ", ".join(
                speaker.title
                for speaker in relations.speakers[node.name]
                if speaker is not node
            ),
            "",
        ),
    ]
    return [(label, text, url) for label, text, url in facts if text]


def _variable_parts(message: Message) -> Iterator[tuple[str, str, str]]:
    """Yield the limits of each variable-length part."""
    parts = message.layout.parts
    for part in parts:
        if not part.is_rest:
            until = f"as many as {count_text(part.counter, part.plus)} says"
        elif part.behind:
            until = "up to the fields behind it"
        else:
            until = "up to the end"
        most = count(part.most, "element" if part.is_array else "byte")
        is_end = part is parts[-1] and not part.behind
        yield (
            ("Variable end" if is_end else "Variable part"),
            f"{part.name}: up to {most}, {until}",
            "",
        )
        for inner in part.inner:
            until = f"as many as {count_text(inner.counter, inner.plus)} says"
            text = f"{inner.name} in each of {part.name}: up to {count(inner.most, 'element')}, {until}"
            yield "Variable part", text, ""


def _plan(
    relations: Relations,
    node: Node,
    message: Message,
    drawings: list[drawing.FrameDrawing],
    shares: list[sections.MessageSection],
) -> dict[str, object]:
    repeats = relations.links.repeats(message)
    enums = {
        field.enum.name: plan.enum_plan(field.enum)
        for field in lines(message.layout)
        if field.enum is not None
    }
    sections_of_fields = [
        {"title": f"{s.title}, {s.about}", "keys": s.keys, "open": s.open}
        for s in shares
        if s.keys
    ]
    return {
        **plan.message_plan(message, node, repeats.names),
        "enums": enums,
        "drawings": [picture.plan for picture in drawings],
        # Of represented arrays, the decoder makes a section for each element.
        **({} if repeats.arrays else {"sections": sections_of_fields}),
        "wire": {
            **wire.page_facts(message, relations.wire(message)),
            "id_bytes": wire_ids.size(node.id_bits),
        },
    }
