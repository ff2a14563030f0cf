"""Recognition of all frames in a text or in received bytes: the entry of the package.

`recognize` tries framings from the most to the least certain: packets of a link, CAN
identifiers, an id in front of the data, and the length of the data alone.
"""

from __future__ import annotations

from collections.abc import Sequence
from contextlib import suppress
from dataclasses import replace
from functools import partial

from icdgen_runtime.wire.uart import UartDecoder, UartEvent

from icdgen.describe.numbers import byte_count
from icdgen.icd.model import Icd
from icdgen.recognize import bus, faults, framed, match
from icdgen.recognize.framed import DIRECTIONS
from icdgen.recognize.pasted import Pasted, read_pasted
from icdgen.recognize.reading import Endpoint, FrameReading, all_endpoints, endpoint_of
from icdgen.recognize.selected import selected_message
from icdgen.recognize.selection import Selection, selection_of
from icdgen.values.errors import Ambiguous, BadHex, BadLength, NotFound
from icdgen.values.find import KINDS, find_node
from icdgen.values.frame import decoded_frame


def recognize(
    icd: Icd,
    text: str | bytes,
    node: str | None = None,
    key: str | None = None,
    kind: str | None = None,
) -> list[FrameReading]:
    """Return the frames in a text, or in bytes as received.

    ``node``, ``key`` and ``kind`` restrict the messages, as for
    `icdgen.values.find_message`; ``key`` only together with ``node``. If each line is a
    complete frame, the lines are recognized separately. Raise `BadHex`, `BadLength`,
    `NotFound` or `Ambiguous`.
    """
    owner = find_node(icd, node) if node is not None else None
    selection = selection_of(icd, owner, key, kind)
    endpoints = [endpoint_of(icd, owner)] if owner else all_endpoints(icd)
    if isinstance(text, bytes):
        return _readings(icd, endpoints, Pasted(text), selection)
    lines = [line for line in text.splitlines() if line.strip()]
    by_line = _line_by_line(icd, endpoints, lines, selection)
    # Without ids, several lines are more likely pieces of one frame. Try that first.
    if (
        by_line
        and not selection.messages
        and all(reading.id is not None for reading in by_line)
    ):
        return by_line
    try:
        return _readings(icd, endpoints, read_pasted(text), selection)
    except (Ambiguous, BadHex, BadLength, NotFound):
        if by_line:
            return by_line
        raise


def _line_by_line(
    icd: Icd, endpoints: Sequence[Endpoint], lines: Sequence[str], selection: Selection
) -> list[FrameReading]:
    """Return the frames if there are several lines and each is a complete frame."""
    if len(lines) < 2:
        return []
    with suppress(Ambiguous, BadHex, BadLength, NotFound):
        pasted = [read_pasted(line) for line in lines]
        # A log of CAN packets, a dump or base64 is one input on several lines.
        if any(pasted_line.packets or pasted_line.form for pasted_line in pasted):
            return []
        readings: list[FrameReading] = []
        for pasted_line in pasted:
            readings += _readings(icd, endpoints, pasted_line, selection)
        return readings
    return []


def _readings(
    icd: Icd, endpoints: Sequence[Endpoint], pasted: Pasted, selection: Selection
) -> list[FrameReading]:
    if pasted.packets and any(endpoint.facts.can for endpoint in endpoints):
        results = bus.readings(endpoints, pasted.packets, selection)
    else:
        results = _framed(endpoints, pasted.whole, selection) or _unframed(
            icd, endpoints, pasted, selection
        )
    left_out = [text for reading in results for text in reading.left_out]
    results = selection.matching_or_all(results)
    if selection.messages and not any(map(selection.is_of, results)):
        text = f"the frame is not {selection.names} but {results[0].title}"
        raise NotFound(text, "leave the message out, or name that one")
    if selection.messages:
        results = [reading for reading in results if selection.is_of(reading)]
    # The first reading has the reports. Restore them if the selection dropped it.
    if not results[0].left_out:
        results[0] = results[0].with_left_out(*left_out)
    note = (f"read as {pasted.form}",) if pasted.form else ()
    return [_decoded(icd, reading.with_remarks(*note)) for reading in results]


def _framed(
    endpoints: Sequence[Endpoint], data: bytes, selection: Selection
) -> list[FrameReading]:
    """Return the messages in a stream with framing.

    Return no messages if there is no framing, or if a named message has exactly these
    bytes.
    """
    if selection.can_have_length(data):
        if readings := _framed_with_checksum(endpoints, data, selection):
            return readings
        if (fault := framed.begun(endpoints, data)) and fault.is_certain:
            raise fault.error
        return []
    if readings := framed.readings(endpoints, data, selection):
        return readings
    for framing in dict.fromkeys(
        endpoint.link.framing for endpoint in endpoints if endpoint.link.framing
    ):
        if bytes((framing.escape, framing.start)) not in data:
            continue
        with_framing = [
            endpoint for endpoint in endpoints if endpoint.link.framing == framing
        ]
        # The limit is that of the data and not that of the link, so that a message
        # which is too long gets a report with its id.
        decoder = UartDecoder(with_framing[0].link, max(len(data), 1))
        events = decoder.feed(data)
        bodies = [event.message for event in events if event.event == "message"]
        if not bodies:
            if data[:2] == bytes((framing.escape, framing.start)):
                raise BadLength(
                    _framing_error(events),
                    0,
                    len(data),
                    "the frame is cut off, or a byte of it is damaged",
                )
            continue
        matches, failures = match.read_each(
            bodies, partial(_of_body, with_framing, selection=selection)
        )
        errors = [event.event for event in events if event.event != "message"]
        reports = [str(error) for error in failures] + [
            f"the stream has an error: {error_name.replace('_', ' ')}"
            for error_name in errors
        ]
        # A single byte is an escape byte at the end of the data, which need not begin a
        # message.
        if decoder.pending > 1:
            reports.append(_framing_error([]))
        remarks = match.stream_remarks(decoder.discarded + decoder.pending, ())
        return [matches[0].with_left_out(*reports).with_remarks(*remarks), *matches[1:]]
    return []


def _check_not_cut(endpoints: Sequence[Endpoint], data: bytes) -> None:
    """Raise `BadLength` for a frame that is cut off: its first byte, or its end only."""
    for framing in dict.fromkeys(
        endpoint.link.framing for endpoint in endpoints if endpoint.link.framing
    ):
        if data == bytes((framing.escape,)):
            raise BadLength(_framing_error([]), 0, len(data), "the frame is cut off")
        if len(data) > 2 and data.endswith(bytes((framing.escape, framing.end))):
            raise BadLength(
                "the framing ends, but the start of the message is missing",
                0,
                len(data),
                "the frame is cut off",
            )


def _framed_with_checksum(
    endpoints: Sequence[Endpoint], data: bytes, selection: Selection
) -> list[FrameReading]:
    """Return messages with header and trailer whose checksum is right.

    A message of variable length can be as long as another one with header and trailer.
    The checksum distinguishes them.
    """
    with suppress(Ambiguous, BadLength):
        return [
            reading
            for reading in framed.readings(endpoints, data, selection)
            if reading.checked and selection.is_of(reading)
        ]
    return []


def _framing_error(events: list[UartEvent]) -> str:
    """Return the error of a stream with framing but without a message."""
    if any(event.event == "protocol_error" for event in events):
        return "the framing is broken: the escape byte is followed by neither itself nor an end of message"
    if events:
        return "the framing is empty"
    return "the framing begins, but the end of the message is missing"


def _of_body(
    endpoints: Sequence[Endpoint], body: bytes, selection: Selection
) -> FrameReading:
    """Return the message of an id and data from which the framing was removed."""
    candidates = match.by_id(endpoints, body)
    if not candidates:
        raise match.no_match_error(endpoints, body)
    reading = match.most_likely(candidates, f"a frame with id {body[0]}", selection)
    return replace(
        reading, remarks=(f"framing with id {body[0]} removed", *reading.remarks)
    )


def _unframed(
    icd: Icd, endpoints: Sequence[Endpoint], pasted: Pasted, selection: Selection
) -> list[FrameReading]:
    """Return the messages of CAN packets by their identifiers, or the message of bytes.

    If no identifier matches, the bytes belong to the message that the user has named.
    """
    if not pasted.packets:
        return [_message_of_bytes(icd, endpoints, pasted.data, selection)]
    try:
        return bus.by_identifier(endpoints, pasted.packets, selection)
    except NotFound as error:
        if not selection.messages:
            raise
        return [
            _message_of_bytes(icd, endpoints, pasted.whole, selection).with_remarks(
                str(error)
            )
        ]


def _message_of_bytes(
    icd: Icd, endpoints: Sequence[Endpoint], data: bytes, selection: Selection
) -> FrameReading:
    """Return the message of bytes without framing.

    Raise `BadLength`, `NotFound` or `Ambiguous`.
    """
    if not data and not selection.messages:
        raise BadLength("there are no bytes", 1, 0, "give a frame")
    fault = framed.begun(endpoints, data)
    if selection.messages:
        reading = selected_message(icd, endpoints[0], selection.messages, data)
        if fault:
            remark = f"the data begin like a packet: {fault.text}"
            reading = reading.with_remarks(remark)
        return reading
    if fault:
        raise fault.error
    _check_not_cut(endpoints, data)
    # Without constant first bytes, any data may be a piece of a packet.
    unframed_endpoints = []
    for endpoint in endpoints:
        form = endpoint.link.stream
        if form is None or (
            selection.kind
            and all(faults.has_sync(form, direction) for direction in DIRECTIONS)
        ):
            unframed_endpoints.append(endpoint)
    if not unframed_endpoints:
        raise _no_packet_error(endpoints, data, selection)
    return _by_id_or_length(unframed_endpoints, data, selection)


def _no_packet_error(
    endpoints: Sequence[Endpoint], data: bytes, selection: Selection
) -> Ambiguous | NotFound:
    """Return the error for bytes without the framing that all messages of the node
    have.
    """
    nodes = match.nodes_of(endpoints)
    syncs = list(filter(None, dict.fromkeys(map(framed.sync_of, endpoints))))
    begin = f", which begin with {' or '.join(syncs)}" if syncs else ""
    text = f"{byte_count(len(data))} are no packet of {nodes}{begin}"
    candidates = selection.matching_or_all(
        [*match.by_id(endpoints, data), *match.by_length(endpoints, data)]
    )
    if candidates:
        return Ambiguous(
            f"{text}; as data alone they can be {match.titles_text(candidates)}",
            match.HELP,
        )
    return NotFound(
        text,
        f"check that the capture is complete; {match.HELP} reads the data of a message alone",
    )


def _by_id_or_length(
    endpoints: Sequence[Endpoint], data: bytes, selection: Selection
) -> FrameReading:
    """Return a message without framing, by its id or its length.

    Raise `Ambiguous`, `BadLength` or `NotFound`.
    """
    given = byte_count(len(data))
    with_id, plain = match.by_id(endpoints, data), match.by_length(endpoints, data)
    if any(map(selection.fits, plain)) and not any(map(selection.fits, with_id)):
        with_id = []
    if with_id:
        reading = match.most_likely(
            with_id, f"{given} beginning with the id {with_id[0].id}", selection
        )
        remarks = [f"id {reading.id} removed"]
        alternatives = [other for other in plain if other.key != reading.key]
        if alternatives:
            titles = match.titles_text(alternatives)
            remarks.append(f"without an id in front it could be {titles}")
        return reading.with_remarks(*remarks)
    if plain:
        reading = match.most_likely(plain, f"{given} without an id", selection)
        return replace(reading, id=None).with_remarks("found by its length alone")
    raise match.no_match_error(endpoints, data)


def _decoded(icd: Icd, reading: FrameReading) -> FrameReading:
    """Return a reading with its decoded frame, if it has data."""
    if reading.what not in KINDS:
        return reading
    decoded = decoded_frame(icd, reading.endpoint.node, reading.message, reading.data)
    return replace(
        reading, frame=replace(decoded, remarks=(*reading.remarks, *decoded.remarks))
    )
