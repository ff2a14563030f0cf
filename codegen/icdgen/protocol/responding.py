"""Reader of the responses of a checked ICD (`icdgen.icd.responses`), into the classes of
`icdgen.protocol.exchange`.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from typing import Any

from icdgen.icd.model import Message, Node
from icdgen.icd.places import NodePlace
from icdgen.icd.responses import (
    ID,
    ID_BYTES,
    MOST_SOURCES,
    NAK,
    STATUS_SETS,
    Section,
    declared_responses,
    echoes_of,
    field_of,
    id_byte_of,
    number_run,
    raw_status,
    reason_of,
)
from icdgen.protocol.exchange import Echo, Exchange, NumberPlace, Response

FindTelemetry = Callable[[str], tuple[int, Message] | None]
"""Function that returns id and message of telemetry with a name."""


def exchange_of(
    node: Node, commands: Section, message: Message, telemetry: FindTelemetry
) -> Exchange | None:
    """Return the exchange of a telecommand; None if nothing responds to it."""
    sources: list[NumberPlace] = []
    responses = []
    for kind, row in declared_responses(commands, message).items():
        declared = telemetry(row["message"])
        if declared is None:
            continue
        id, response = declared
        echoes = []
        for name, repeated in echoes_of(row).items():
            source = _source(node, message, repeated)
            if source not in sources:
                sources.append(source)
            place = _place(node, field_of(response, name))
            assert place is not None, f"rule ICD177 checks {name}"
            echoes.append(Echo(place, sources.index(source)))
        responses.append(
            Response(
                id,
                # A status that no set lists refuses the telecommand.
                NAK if "status" in row else kind,
                tuple(echoes),
                _place(node, field_of(response, row.get("status"))),
                tuple(_meanings(kind, row, response)),
                _place(node, field_of(response, reason_of(row))),
                _names(field_of(response, reason_of(row))),
            )
        )
    # A model from the cache has plain mappings.
    own: Any = message.response
    timeout = own.get("timeout_ms", 0) if isinstance(own, Mapping) else 0
    assert len(sources) <= MOST_SOURCES, "rule ICD177 checks the number"
    return Exchange(tuple(sources), tuple(responses), timeout) if responses else None


def _source(node: Node, message: Message, name: str) -> NumberPlace:
    """Return the place of a number of a telecommand in `Exchange.sources`."""
    if name == ID:
        return NumberPlace(0, ID_BYTES, 0, 8 * ID_BYTES, False)
    byte = id_byte_of(node, name)
    if byte is not None:
        return NumberPlace(byte, 1, 0, 8, False)
    place = _place(node, field_of(message, name), ID_BYTES)
    assert place is not None, f"rule ICD177 checks {name}"
    return place


def _place(node: Node, field: NodePlace | None, offset: int = 0) -> NumberPlace | None:
    """Return the place of a number after ``offset`` bytes; None without a field."""
    run = number_run(field, node) if field else None
    if field is None or run is None:
        return None
    return NumberPlace(offset + run.byte, run.size, run.shift, field.bits, run.little)


def _names(field: NodePlace | None) -> tuple[tuple[int, str], ...]:
    """Return the values of a field with an enumeration, and their names."""
    if field is None or field.scalar.enum is None:
        return ()
    mask = (1 << field.bits) - 1  # clients compare numbers without sign
    return tuple(
        (value & mask, member.name)
        for member in field.scalar.enum.members
        for value in range(member.value, member.last + 1)
    )


def _meanings(kind: str, row: Section, message: Message) -> Iterator[tuple[int, str]]:
    """Yield each listed value of the status, with its verdict."""
    field = field_of(message, row.get("status"))
    for key, verdict in STATUS_SETS.items() if field else ():
        for value in row.get(key, ()):
            raw = raw_status(field, value) if field else None
            if raw is not None:
                yield raw, verdict or kind
