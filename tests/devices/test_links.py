"""Streams of generated code are decoded by the protocol's own library, and vice versa.

The links come from `examples/links`. Each language runs as a testee of the conformance
run, over a pipe.
"""

from __future__ import annotations

import io
import json
import random
import re
import zlib
from collections.abc import Callable, Iterator
from importlib import import_module
from typing import Any, NamedTuple

import pytest

from tests.conformance.build import build
from tests.conformance.driver import Testee
from tests.conformance.icds import icd_of
from tests.conformance.languages import all_languages
from tests.conftest import ROOT

LINKS = ROOT / "examples" / "links"
MESSAGES = 40  # of each link and direction
Sent = tuple[int, bytes]  # id and data


class Peer(NamedTuple):
    """A protocol's own library.

    ``encode`` returns the bytes that the library sends for a message, ``decode`` the
    messages that it receives from a stream.
    """

    node: str
    encode: Callable[[str, int, bytes, int], bytes]
    decode: Callable[[str, bytes], list[Sent]]
    sequence: str = ""


def ubx_encode(direction: str, id: int, data: bytes, _: int) -> bytes:
    import pyubx2

    mode = pyubx2.GET
    if direction == "telecommand":
        mode = pyubx2.SET if data else pyubx2.POLL
    return bytes(
        pyubx2.UBXMessage(
            bytes([id >> 8]), bytes([id & 0xFF]), mode, payload=data
        ).serialize()
    )


def ubx_decode(direction: str, line: bytes) -> list[Sent]:
    import pyubx2

    mode = pyubx2.GET if direction == "telemetry" else pyubx2.SETPOLL
    reader = pyubx2.UBXReader(
        io.BytesIO(line), protfilter=pyubx2.UBX_PROTOCOL, msgmode=mode, quitonerror=2
    )
    messages = []
    for raw, message in reader:
        assert message is not None
        messages.append((int.from_bytes(raw[2:4], "big"), raw[6:-2]))
    return messages


def sbp_encode(direction: str, id: int, data: bytes, _: int) -> bytes:
    from sbp.msg import SBP

    return bytes(SBP(id, sender=0x42, payload=data).to_binary())


def sbp_decode(direction: str, line: bytes) -> list[Sent]:
    from sbp.client.framer import Framer
    from sbp.msg import SBP

    stream = io.BytesIO(line)
    framer = Framer(
        lambda size: stream.read(size) or None, None, dispatcher=lambda message: message
    )
    messages: list[Sent] = []
    while stream.tell() < len(line):
        message = framer._receive()
        if isinstance(message, SBP):
            assert message.sender == 0x42
            messages.append((message.msg_type, message.payload))
    return messages


def _dialect(version: int) -> Any:
    return import_module(f"pymavlink.dialects.v{version}0.common")


def mavlink_encode(
    direction: str, id: int, data: bytes, number: int, version: int = 2
) -> bytes:
    common = _dialect(version)
    kind = common.mavlink_map[id]
    values = dict(zip(kind.ordered_fieldnames, kind.unpacker.unpack(data), strict=True))
    link = common.MAVLink(None, *((255, 190) if direction == "telecommand" else (1, 1)))
    # A new link object would start at 0.
    link.seq = number & 0xFF
    return bytes(kind(**values).pack(link))


def mavlink_decode(direction: str, line: bytes, version: int = 2) -> list[Sent]:
    common = _dialect(version)
    parser, messages = common.MAVLink(None), []
    parser.robust_parsing = True
    for message in parser.parse_buffer(line) or []:
        if message.get_type() != "BAD_DATA":
            values = [getattr(message, name) for name in message.ordered_fieldnames]
            messages.append((message.get_msgId(), type(message).unpacker.pack(*values)))
    return messages


def mavlink1_encode(direction: str, id: int, data: bytes, number: int) -> bytes:
    return mavlink_encode(direction, id, data, number, 1)


def mavlink1_decode(direction: str, line: bytes) -> list[Sent]:
    return mavlink_decode(direction, line, 1)


def ccsds_encode(direction: str, id: int, data: bytes, number: int) -> bytes:
    from spacepackets.ccsds.spacepacket import PacketType, SpHeader

    kind = PacketType.TC if direction == "telecommand" else PacketType.TM
    return bytes(SpHeader(kind, id, number % 0x4000, len(data) - 1).pack()) + data


def ccsds_decode(direction: str, line: bytes) -> list[Sent]:
    from spacepackets.ccsds.spacepacket import PacketType, SpHeader

    messages, at = [], 0
    while at < len(line):
        header = SpHeader.unpack(line[at:])
        assert header.packet_type == (
            PacketType.TC if direction == "telecommand" else PacketType.TM
        )
        messages.append((header.apid, line[at + 6 : at + header.packet_len]))
        at += header.packet_len
    return messages


def slip_encode(direction: str, id: int, data: bytes, _: int) -> bytes:
    import sliplib

    return bytes(sliplib.encode(bytes([id]) + data)) + b"\xc0"


def slip_decode(direction: str, line: bytes) -> list[Sent]:
    import sliplib

    driver, messages = sliplib.Driver(), []
    driver.receive(line)
    while message := driver.get(block=False):
        messages.append((message[0], message[1:]))
    return messages


def kiss_encode(direction: str, id: int, data: bytes, _: int) -> bytes:
    import sliplib

    # Command 0 of KISS: a data frame on port 0.
    return bytes(sliplib.encode(bytes([0, id]) + data)) + b"\xc0"


def kiss_decode(direction: str, line: bytes) -> list[Sent]:
    return [
        (data[0], data[1:])
        for command, data in slip_decode(direction, line)
        if command == 0
    ]


def _crc32c(data: bytes) -> int:
    register = 0xFFFFFFFF
    for byte in data:
        register ^= byte
        for _ in range(8):
            register = register >> 1 ^ (0x82F63B78 if register & 1 else 0)
    return register ^ 0xFFFFFFFF


def _csp_head(direction: str, id: int) -> bytes:
    # Priority, source, destination, destination port, source port, and the flag for a
    # CRC.
    source, destination = (10, 2) if direction == "telecommand" else (2, 10)
    return (
        2 << 30 | source << 25 | destination << 20 | id << 14 | 33 << 8 | 1
    ).to_bytes(4, "big")


def csp_encode(direction: str, id: int, data: bytes, _: int) -> bytes:
    import sliplib

    # CSP 1: the CRC-32C covers only the data.
    packet = _csp_head(direction, id) + data + _crc32c(data).to_bytes(4, "big")
    return bytes(sliplib.encode(b"\0" + packet)) + b"\xc0"


def csp_decode(direction: str, line: bytes) -> list[Sent]:
    messages = []
    for command, packet in slip_decode(direction, line):
        id, data = packet[1] << 8 | packet[2], packet[4:-4]
        id = id >> 6 & 0x3F
        assert command == 0 and packet[:4] == _csp_head(direction, id)
        assert int.from_bytes(packet[-4:], "big") == _crc32c(data)
        messages.append((id, data))
    return messages


def _fcs(data: bytes) -> bytes:
    from pymavlink.generator.mavcrc import x25crc

    # The FCS of HDLC is the complement of the CRC of MAVLink.
    return int(x25crc(data).crc ^ 0xFFFF).to_bytes(2, "little")


def hdlc_encode(direction: str, id: int, data: bytes, _: int) -> bytes:
    # RFC 1662: address FF and control 03, then the protocol number.
    frame = b"\xff\x03" + id.to_bytes(2, "big") + data
    escaped = b"".join(
        bytes([0x7D, byte ^ 0x20]) if byte in b"\x7d\x7e" else bytes([byte])
        for byte in frame + _fcs(frame)
    )
    return b"\x7e" + escaped + b"\x7e"


def hdlc_decode(direction: str, line: bytes) -> list[Sent]:
    messages = []
    for part in filter(None, line.split(b"\x7e")):
        first, *escaped = part.split(b"\x7d")
        frame = first + b"".join(
            bytes([chunk[0] ^ 0x20]) + chunk[1:] for chunk in escaped
        )
        assert frame[:2] == b"\xff\x03" and frame[-2:] == _fcs(frame[:-2])
        messages.append((int.from_bytes(frame[2:4], "big"), frame[4:-2]))
    return messages


def cobs_encode(direction: str, id: int, data: bytes, number: int) -> bytes:
    from cobs import cobs

    frame = id.to_bytes(2, "little") + bytes([number & 0xFF]) + data
    return bytes(cobs.encode(frame + zlib.crc32(frame).to_bytes(4, "little"))) + b"\0"


def cobs_decode(direction: str, line: bytes) -> list[Sent]:
    from cobs import cobs

    messages = []
    for part in line.split(b"\0")[:-1]:
        frame = cobs.decode(part)
        assert zlib.crc32(frame[:-4]) == int.from_bytes(frame[-4:], "little")
        messages.append((int.from_bytes(frame[:2], "little"), frame[3:-4]))
    return messages


def tsip_encode(direction: str, id: int, data: bytes, _: int) -> bytes:
    # Superpackets have the first byte 8F before their id. DLE is doubled in data.
    head = b"\x8f" if id == 0xAB else b""
    packet = head + bytes([id]) + data
    return b"\x10" + packet.replace(b"\x10", b"\x10\x10") + b"\x10\x03"


def tsip_decode(direction: str, line: bytes) -> list[Sent]:
    messages = []
    while line:
        # The end of a packet is ETX after an odd number of DLE.
        end = next(
            match.end()
            for match in re.finditer(rb"(\x10*)\x03", line)
            if len(match[1]) % 2 and match.start() > 0
        )
        packet = line[1 : end - 2].replace(b"\x10\x10", b"\x10")
        packet = packet.removeprefix(b"\x8f")
        messages.append((packet[0], packet[1:]))
        line = line[end:]
    return messages


PEERS = {
    "UBX, pyubx2": Peer("receiver", ubx_encode, ubx_decode),
    "SBP, sbp": Peer("positioner", sbp_encode, sbp_decode),
    "MAVLink 2, pymavlink": Peer(
        "autopilot", mavlink_encode, mavlink_decode, "sequence"
    ),
    "space packets, spacepackets": Peer(
        "payload", ccsds_encode, ccsds_decode, "sequence"
    ),
    "SLIP, sliplib": Peer("logger", slip_encode, slip_decode),
    "MAVLink 1, pymavlink": Peer("rover", mavlink1_encode, mavlink1_decode, "sequence"),
    "KISS, sliplib": Peer("tnc", kiss_encode, kiss_decode),
    "CSP over KISS, sliplib": Peer("power", csp_encode, csp_decode),
    "HDLC, the FCS of pymavlink": Peer("modem", hdlc_encode, hdlc_decode),
    "TSIP, by its manual": Peer("clock", tsip_encode, tsip_decode),
    "COBS and CRC-32, cobs and zlib": Peer(
        "probe", cobs_encode, cobs_decode, "sequence"
    ),
}


ENDS = {
    "logger": b"\xc0",
    "tnc": b"\xc0",
    "power": b"\xc0",
    "modem": b"\x7e",
    "probe": b"\0",
}
"""Delimiters of the links whose messages have no length, by node."""


@pytest.fixture(scope="module")
def links():
    return icd_of([LINKS])


@pytest.fixture(scope="module", params=["python", "c", "rust-debug"])
def testee(request, links, tmp_path_factory) -> Iterator[Testee]:
    built = Testee(
        build(all_languages()[request.param], links, tmp_path_factory.mktemp("links"))
    )
    yield built
    built.close()


def ask_testee(testee: Testee, **request: object) -> dict[str, Any]:
    (line,) = testee.ask([json.dumps(request).encode()])
    response: dict[str, Any] = json.loads(line or b"{}")
    assert response["ok"], (request, response)
    return response


def received(events: list[dict[str, Any]], sent: list[Sent]) -> list[Sent]:
    """Return the received messages, with the zeros that MAVLink 2 cuts off.

    The decoder of a message restores these zeros.
    """
    sizes = [len(data) for _, data in sent]
    return [
        (event["id"], bytes.fromhex(event["bytes"]).ljust(size, b"\0"))
        for event, size in zip(events, sizes, strict=True)
    ]


def data_of(message: Any, source: random.Random) -> bytes:
    """Return random data that the library accepts.

    Floats are never NaN, because a NaN does not survive pymavlink.
    """
    if any(field.type == "float" for field in message.fields):
        return b"".join(
            source.randrange(1 << 30).to_bytes(4, "little")
            for _ in range(message.length // 4)
        ).ljust(message.length, b"\0")
    return bytes(source.choices(range(256), weights=[40, *[1] * 255], k=message.length))


def messages_of(
    links: Any, node: str, direction: str, source: random.Random
) -> list[Sent]:
    by_id = {
        getattr(message, f"{direction}_id"): message
        for message in links.messages_of(links.node(node))
    }
    ids = sorted(id for id in by_id if id is not None)
    return [(id, data_of(by_id[id], source)) for id in source.choices(ids, k=MESSAGES)]


@pytest.mark.parametrize("direction", ["telemetry", "telecommand"])
@pytest.mark.parametrize("name", PEERS)
def test_the_library_decodes_the_messages_of_generated_code(
    name, direction, testee, links
):
    peer, source = PEERS[name], random.Random(name)
    sent = messages_of(links, peer.node, direction, source)
    line = b""
    for number, (id, data) in enumerate(sent):
        values = {peer.sequence: number} if peer.sequence else {}
        about = {
            "node": peer.node,
            "direction": direction,
            "id": id,
            "bytes": data.hex(),
            "values": values,
        }
        encoded = bytes.fromhex(
            ask_testee(testee, op="stream_encode", **about)["bytes"]
        )
        assert encoded.strip(b"\xc0") == peer.encode(direction, id, data, number).strip(
            b"\xc0"
        )  # SLIP may begin with its end
        line += encoded
    assert peer.decode(direction, line) == sent


@pytest.mark.parametrize("direction", ["telemetry", "telecommand"])
@pytest.mark.parametrize("name", PEERS)
def test_messages_of_the_library_are_decoded_after_noise_and_in_pieces(
    name, direction, testee, links
):
    peer, source = PEERS[name], random.Random(name)
    sent = messages_of(links, peer.node, direction, source)
    line = b"".join(
        peer.encode(direction, id, data, number)
        for number, (id, data) in enumerate(sent)
    )
    # Space packets have no sync pattern: their noise is FF, which is no valid header.
    noise = (
        source.randbytes(50) + ENDS.get(peer.node, b"")
        if peer.node != "payload"
        else b"\xff" * 50
    )
    if ENDS.get(peer.node) == b"\xc0":
        # An escape byte at the end of the noise would change the first message.
        noise = noise.replace(b"\xdb", b"") + b"\xc0"
    cuts = sorted(source.sample(range(len(noise + line)), 30))
    pieces = [
        (noise + line)[a:b].hex()
        for a, b in zip([0, *cuts], [*cuts, None], strict=True)
    ]
    response = ask_testee(
        testee, op="stream_events", node=peer.node, direction=direction, chunks=pieces
    )
    events = [event for event in response["events"] if event["event"] == "message"]
    assert received(events, sent) == sent
    if peer.sequence == "sequence" and peer.node != "payload":
        assert [event["sequence"] for event in events] == [
            number & 0xFF for number in range(len(sent))
        ]
        assert not [event for event in response["events"] if event["event"] == "gap"]


@pytest.mark.parametrize(
    "name",
    [
        name
        for name in PEERS
        if not any(each in name for each in ("space", "SLIP", "KISS, s", "TSIP"))
    ],
)
def test_a_damaged_message_is_reported_and_the_others_are_decoded(name, testee, links):
    peer, source = PEERS[name], random.Random(name)
    sent = messages_of(links, peer.node, "telemetry", source)[:9]
    lines = [
        peer.encode("telemetry", id, data, number)
        for number, (id, data) in enumerate(sent)
    ]
    damaged = bytearray(lines[4])
    # The damaged byte must not become 0, the delimiter of COBS.
    damaged[-3 if peer.node != "probe" else -4] ^= (
        0x01 if damaged[-3 if peer.node != "probe" else -4] > 1 else 0x02
    )
    lines[4] = bytes(damaged)
    response = ask_testee(
        testee,
        op="stream_events",
        node=peer.node,
        direction="telemetry",
        chunks=[b"".join(lines).hex()],
    )
    events = [event for event in response["events"] if event["event"] == "message"]
    undamaged = [*sent[:4], *sent[5:]]
    assert received(events, undamaged) == undamaged
    dropped = {event["event"] for event in response["events"]} - {"message", "gap"}
    assert dropped and dropped <= {"checksum", "length", "unknown_id", "framing"}
    if peer.sequence:
        assert [
            event["missing"] for event in response["events"] if event["event"] == "gap"
        ] == [1]
