"""Ids in the notation of their protocol."""

from __future__ import annotations

from icdgen.protocol.envelope import Stream


def pair_bytes(form: Stream | None) -> int:
    """Return the number of bytes as which an id is written, ``01 35``; 0 if it is
    written as a number.

    Protocols whose header has the id as several bytes, the most significant first,
    write these apart (class and number, say). Ids in little-endian order are numbers.
    """
    field = form.of("id") if form else None
    if (
        field is None
        or field.little
        or field.shift
        or field.bits != 8 * field.size
        or field.size < 2
    ):
        return 0
    return field.size


def id_text(form: Stream | None, id: int) -> str:
    """Return an id as text: ``01 35`` if packets have ids of several bytes, else
    ``309``.
    """
    size = pair_bytes(form)
    return id.to_bytes(size, "big").hex(" ").upper() if size else str(id)
