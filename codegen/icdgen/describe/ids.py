"""Ids in the notation of their protocol.

Protocols with class and number, such as UBX, write ids as bytes (``01 35``); all others
as a decimal number.
"""

from __future__ import annotations

from icdgen.protocol.packet_formats import Stream


def pair_bytes(form: Stream | None) -> int:
    """Return the number of bytes as which an id is written, ``01 35``; 0 if it is
    written as a number.

    Protocols whose header has the id as several bytes, the most significant first,
    write these apart (class and number, say). Ids in little-endian order are numbers.
    """
    for packet in form.packets if form else ():
        fields = [field for field in packet.fields if field.role == "id"]
        is_bytes = all(
            not field.shift and field.bits == 8 * field.size for field in fields
        )
        size = sum(field.size for field in fields)
        # The first packet format with an id decides for all of them.
        if fields:
            is_number = len(fields) == 1 and fields[0].little
            return size if is_bytes and size > 1 and not is_number else 0
    return 0


def id_text(form: Stream | None, id: int) -> str:
    """Return an id as text: ``01 35`` if packets have ids of several bytes, else
    ``309``.
    """
    size = pair_bytes(form)
    return id.to_bytes(size, "big").hex(" ").upper() if size else str(id)
