"""What C, Python and Rust put on a link, the protocol's own library takes; and what
that sends, they find.

The links are those of `examples/links`. Each language is asked by pipe, as in the
conformance run.
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

    ``made`` are a message's bytes as it sends them, ``read`` what it finds in a stream.
    """

    node: str
    made: Callable[[str, int, bytes, int], bytes]
    read: Callable[[str, bytes], list[Sent]]
    sequence: str = ""


def ubx_made(direction: str, id: int, data: bytes, _: int) -> bytes:
    import pyubx2

    mode = (
        pyubx2.GET if direction == "telemetry" else pyubx2.SET if data else pyubx2.POLL
    )
    return bytes(
        pyubx2.UBXMessage(
            bytes([id >> 8]), bytes([id & 0xFF]), mode, payload=data
        ).serialize()
    )


def ubx_read(direction: str, line: bytes) -> list[Sent]:
    import pyubx2

    mode = pyubx2.GET if direction == "telemetry" else pyubx2.SETPOLL
    reader = pyubx2.UBXReader(
        io.BytesIO(line), protfilter=pyubx2.UBX_PROTOCOL, msgmode=mode, quitonerror=2
    )
    found = []
    for raw, one in reader:
        assert one is not None
        found.append((int.from_bytes(raw[2:4], "big"), raw[6:-2]))
    return found


def sbp_made(direction: str, id: int, data: bytes, _: int) -> bytes:
    from sbp.msg import SBP

    return bytes(SBP(id, sender=0x42, payload=data).to_binary())


def sbp_read(direction: str, line: bytes) -> list[Sent]:
    from sbp.client.framer import Framer
    from sbp.msg import SBP

    stream = io.BytesIO(line)
    framer = Framer(
        lambda size: stream.read(size) or None, None, dispatcher=lambda message: message
    )
    found: list[Sent] = []
    while stream.tell() < len(line):
        message = framer._receive()
        if isinstance(message, SBP):
            assert message.sender == 0x42
            found.append((message.msg_type, message.payload))
    return found


def _dialect(version: int) -> Any:
    return import_module(f"pymavlink.dialects.v{version}0.common")


def mavlink_made(
    direction: str, id: int, data: bytes, number: int, version: int = 2
) -> bytes:
    common = _dialect(version)
    kind = common.mavlink_map[id]
    values = dict(zip(kind.ordered_fieldnames, kind.unpacker.unpack(data), strict=True))
    link = common.MAVLink(None, *((255, 190) if direction == "telecommand" else (1, 1)))
    link.seq = number & 0xFF
    return bytes(kind(**values).pack(link))


def mavlink_read(direction: str, line: bytes, version: int = 2) -> list[Sent]:
    common = _dialect(version)
    parser, found = common.MAVLink(None), []
    parser.robust_parsing = True
    for message in parser.parse_buffer(line) or []:
        if message.get_type() != "BAD_DATA":
            values = [getattr(message, name) for name in message.ordered_fieldnames]
            found.append((message.get_msgId(), type(message).unpacker.pack(*values)))
    return found


def mavlink1_made(direction: str, id: int, data: bytes, number: int) -> bytes:
    return mavlink_made(direction, id, data, number, 1)


def mavlink1_read(direction: str, line: bytes) -> list[Sent]:
    return mavlink_read(direction, line, 1)


def ccsds_made(direction: str, id: int, data: bytes, number: int) -> bytes:
    from spacepackets.ccsds.spacepacket import PacketType, SpHeader

    kind = PacketType.TC if direction == "telecommand" else PacketType.TM
    return bytes(SpHeader(kind, id, number % 0x4000, len(data) - 1).pack()) + data


def ccsds_read(direction: str, line: bytes) -> list[Sent]:
    from spacepackets.ccsds.spacepacket import PacketType, SpHeader

    found, at = [], 0
    while at < len(line):
        header = SpHeader.unpack(line[at:])
        assert header.packet_type == (
            PacketType.TC if direction == "telecommand" else PacketType.TM
        )
        found.append((header.apid, line[at + 6 : at + header.packet_len]))
        at += header.packet_len
    return found


def slip_made(direction: str, id: int, data: bytes, _: int) -> bytes:
    import sliplib

    return bytes(sliplib.encode(bytes([id]) + data)) + b"\xc0"


def slip_read(direction: str, line: bytes) -> list[Sent]:
    import sliplib

    driver, found = sliplib.Driver(), []
    driver.receive(line)
    while message := driver.get(block=False):
        found.append((message[0], message[1:]))
    return found


def kiss_made(direction: str, id: int, data: bytes, _: int) -> bytes:
    import sliplib

    return bytes(sliplib.encode(bytes([0, id]) + data)) + b"\xc0"


def kiss_read(direction: str, line: bytes) -> list[Sent]:
    return [
        (data[0], data[1:])
        for command, data in slip_read(direction, line)
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
    source, destination = (10, 2) if direction == "telecommand" else (2, 10)
    return (
        2 << 30 | source << 25 | destination << 20 | id << 14 | 33 << 8 | 1
    ).to_bytes(4, "big")


def csp_made(direction: str, id: int, data: bytes, _: int) -> bytes:
    import sliplib

    packet = _csp_head(direction, id) + data + _crc32c(data).to_bytes(4, "big")
    return bytes(sliplib.encode(b"\0" + packet)) + b"\xc0"


def csp_read(direction: str, line: bytes) -> list[Sent]:
    found = []
    for command, packet in slip_read(direction, line):
        id, data = packet[1] << 8 | packet[2], packet[4:-4]
        id = id >> 6 & 0x3F
        assert command == 0 and packet[:4] == _csp_head(direction, id)
        assert int.from_bytes(packet[-4:], "big") == _crc32c(data)
        found.append((id, data))
    return found


def _fcs(data: bytes) -> bytes:
    from pymavlink.generator.mavcrc import x25crc

    return int(x25crc(data).crc ^ 0xFFFF).to_bytes(2, "little")


def hdlc_made(direction: str, id: int, data: bytes, _: int) -> bytes:
    frame = b"\xff\x03" + id.to_bytes(2, "big") + data
    escaped = b"".join(
        bytes([0x7D, one ^ 0x20]) if one in b"\x7d\x7e" else bytes([one])
        for one in frame + _fcs(frame)
    )
    return b"\x7e" + escaped + b"\x7e"


def hdlc_read(direction: str, line: bytes) -> list[Sent]:
    found = []
    for part in filter(None, line.split(b"\x7e")):
        first, *others = part.split(b"\x7d")
        frame = first + b"".join(bytes([one[0] ^ 0x20]) + one[1:] for one in others)
        assert frame[:2] == b"\xff\x03" and frame[-2:] == _fcs(frame[:-2])
        found.append((int.from_bytes(frame[2:4], "big"), frame[4:-2]))
    return found


def cobs_made(direction: str, id: int, data: bytes, number: int) -> bytes:
    from cobs import cobs

    frame = id.to_bytes(2, "little") + bytes([number & 0xFF]) + data
    return bytes(cobs.encode(frame + zlib.crc32(frame).to_bytes(4, "little"))) + b"\0"


def cobs_read(direction: str, line: bytes) -> list[Sent]:
    from cobs import cobs

    found = []
    for part in line.split(b"\0")[:-1]:
        frame = cobs.decode(part)
        assert zlib.crc32(frame[:-4]) == int.from_bytes(frame[-4:], "little")
        found.append((int.from_bytes(frame[:2], "little"), frame[3:-4]))
    return found


def tsip_made(direction: str, id: int, data: bytes, _: int) -> bytes:
    head = b"\x8f" if id == 0xAB else b""
    packet = head + bytes([id]) + data
    return b"\x10" + packet.replace(b"\x10", b"\x10\x10") + b"\x10\x03"


def tsip_read(direction: str, line: bytes) -> list[Sent]:
    found = []
    while line:
        # The end of a packet is ETX after an odd number of DLE.
        end = next(
            one.end()
            for one in re.finditer(rb"(\x10*)\x03", line)
            if len(one[1]) % 2 and one.start() > 0
        )
        packet = line[1 : end - 2].replace(b"\x10\x10", b"\x10")
        packet = packet.removeprefix(b"\x8f")
        found.append((packet[0], packet[1:]))
        line = line[end:]
    return found


PEERS = {
    "UBX, pyubx2": Peer("receiver", ubx_made, ubx_read),
    "SBP, sbp": Peer("positioner", sbp_made, sbp_read),
    "MAVLink 2, pymavlink": Peer("autopilot", mavlink_made, mavlink_read, "sequence"),
    "space packets, spacepackets": Peer("payload", ccsds_made, ccsds_read, "sequence"),
    "SLIP, sliplib": Peer("logger", slip_made, slip_read),
    "MAVLink 1, pymavlink": Peer("rover", mavlink1_made, mavlink1_read, "sequence"),
    "KISS, sliplib": Peer("tnc", kiss_made, kiss_read),
    "CSP over KISS, sliplib": Peer("power", csp_made, csp_read),
    "HDLC, the FCS of pymavlink": Peer("modem", hdlc_made, hdlc_read),
    "TSIP, by its manual": Peer("clock", tsip_made, tsip_read),
    "COBS and CRC-32, cobs and zlib": Peer("probe", cobs_made, cobs_read, "sequence"),
}


ENDS = {
    "logger": b"\xc0",
    "tnc": b"\xc0",
    "power": b"\xc0",
    "modem": b"\x7e",
    "probe": b"\0",
}
"""What ends a message on links that are not delimited by a length."""


@pytest.fixture(scope="module")
def links():
    return icd_of([LINKS])


@pytest.fixture(scope="module", params=["python", "c", "rust-debug"])
def testee(request, links, tmp_path_factory) -> Iterator[Testee]:
    one = Testee(
        build(all_languages()[request.param], links, tmp_path_factory.mktemp("links"))
    )
    yield one
    one.close()


def answer(testee: Testee, **request: object) -> dict[str, Any]:
    (told,) = testee.ask([json.dumps(request).encode()])
    found: dict[str, Any] = json.loads(told or b"{}")
    assert found["ok"], (request, found)
    return found


def received(events: list[dict[str, Any]], sent: list[Sent]) -> list[Sent]:
    """What came, with the zeros that MAVLink 2 cuts off: whoever decodes the message
    fills them in.
    """
    sizes = [len(data) for _, data in sent]
    return [
        (one["id"], bytes.fromhex(one["bytes"]).ljust(size, b"\0"))
        for one, size in zip(events, sizes, strict=True)
    ]


def data_of(message: Any, source: random.Random) -> bytes:
    """Data that a library takes too: a number that is not one does not survive
    pymavlink.
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
    known = {
        getattr(one, f"{direction}_id"): one
        for one in links.messages_of(links.node(node))
    }
    ids = sorted(id for id in known if id is not None)
    return [(id, data_of(known[id], source)) for id in source.choices(ids, k=MESSAGES)]


@pytest.mark.parametrize("direction", ["telemetry", "telecommand"])
@pytest.mark.parametrize("name", PEERS)
def test_the_library_takes_what_is_sent(name, direction, testee, links):
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
        made = bytes.fromhex(answer(testee, op="stream_encode", **about)["bytes"])
        assert made.strip(b"\xc0") == peer.made(direction, id, data, number).strip(
            b"\xc0"
        )  # SLIP may begin with its end
        line += made
    assert peer.read(direction, line) == sent


@pytest.mark.parametrize("direction", ["telemetry", "telecommand"])
@pytest.mark.parametrize("name", PEERS)
def test_what_the_library_sends_is_found_after_noise_and_in_pieces(
    name, direction, testee, links
):
    peer, source = PEERS[name], random.Random(name)
    sent = messages_of(links, peer.node, direction, source)
    line = b"".join(
        peer.made(direction, id, data, number) for number, (id, data) in enumerate(sent)
    )
    noise = (
        source.randbytes(50) + ENDS.get(peer.node, b"")
        if peer.node != "payload"
        else b"\xff" * 50
    )
    if ENDS.get(peer.node) == b"\xc0":
        noise = noise.replace(b"\xdb", b"") + b"\xc0"
    cuts = sorted(source.sample(range(len(noise + line)), 30))
    pieces = [
        (noise + line)[a:b].hex()
        for a, b in zip([0, *cuts], [*cuts, None], strict=True)
    ]
    found = answer(
        testee, op="stream_events", node=peer.node, direction=direction, chunks=pieces
    )
    events = [one for one in found["events"] if one["event"] == "message"]
    assert received(events, sent) == sent
    if peer.sequence == "sequence" and peer.node != "payload":
        assert [one["sequence"] for one in events] == [
            number & 0xFF for number in range(len(sent))
        ]
        assert not [one for one in found["events"] if one["event"] == "gap"]


@pytest.mark.parametrize(
    "name",
    [
        name
        for name in PEERS
        if not any(each in name for each in ("space", "SLIP", "KISS, s", "TSIP"))
    ],
)
def test_a_message_that_was_damaged_on_the_way_is_told_of_and_the_others_are_found(
    name, testee, links
):
    peer, source = PEERS[name], random.Random(name)
    sent = messages_of(links, peer.node, "telemetry", source)[:9]
    lines = [
        peer.made("telemetry", id, data, number)
        for number, (id, data) in enumerate(sent)
    ]
    damaged = bytearray(lines[4])
    damaged[-3 if peer.node != "probe" else -4] ^= (
        0x01 if damaged[-3 if peer.node != "probe" else -4] > 1 else 0x02
    )
    lines[4] = bytes(damaged)
    found = answer(
        testee,
        op="stream_events",
        node=peer.node,
        direction="telemetry",
        chunks=[b"".join(lines).hex()],
    )
    events = [one for one in found["events"] if one["event"] == "message"]
    taken = [*sent[:4], *sent[5:]]
    assert received(events, taken) == taken
    dropped = {one["event"] for one in found["events"]} - {"message", "gap"}
    assert dropped and dropped <= {"checksum", "length", "unknown_id", "framing"}
    if peer.sequence:
        assert [one["missing"] for one in found["events"] if one["event"] == "gap"] == [
            1
        ]
