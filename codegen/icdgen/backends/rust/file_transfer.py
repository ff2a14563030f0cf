"""File transfer: the facts of a node -> the part ``files`` of its link."""

from __future__ import annotations

from icdgen.backends.rust.facts import struct
from icdgen.backends.rust.literals import Optional, Part, Rows, Struct, flat
from icdgen.backends.rust.wire_steps import field_of
from icdgen.protocol.facts import Facts
from icdgen.protocol.sections import BUSES, PROCEDURES


def files(known: Facts) -> Struct | None:
    """File transfer, with the procedures that the ICD describes completely."""
    form = known.files
    if form is None:
        return None
    ids = (Part(bus, Optional(form.packet_ids.get(bus)), f"file_transfer.download.{bus}") for bus in BUSES)
    procedures = (
        Part(name, Optional(struct(known, form.procedures.get(name), f"file_transfer.{name}"))) for name in PROCEDURES
    )
    return struct(
        known,
        form,
        "file_transfer",
        Part("packet_ids", Struct("PerBus", tuple(ids))),
        Part("hole_map", Optional(_hole_map(known))),
        *procedures,
    )


def _hole_map(known: Facts) -> Struct | None:
    form = known.hole_map
    if form is None:
        return None
    messages = []
    for message in form.messages:
        field = field_of(message, form.field)
        if field is None or message.telecommand_id is None or message.telemetry_id is None:
            return None
        piece = flat("Span", at=field.at // 8, bytes=field.bits // 8)
        messages.append(
            flat(
                "MapMessage",
                set_id=message.telecommand_id,
                get_id=message.telemetry_id,
                length=message.length,
                piece=piece,
            )
        )
    return struct(known, form, "file_transfer.hole_map", Part("messages", Rows(messages)))
