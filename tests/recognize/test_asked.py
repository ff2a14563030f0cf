"""If telecommands and telemetry share ids, the given name or kind of the message
decides how a frame is decoded.
"""

from __future__ import annotations

import re

import pytest
from icdgen_runtime.wire.stream import stream_encode

from icdgen.icd.model import Icd
from icdgen.protocol import facts
from icdgen.recognize import recognize
from icdgen.runtime_objects.links import link_of
from icdgen.values.errors import Ambiguous
from tests.features.outputs import icd_of

PACK = """\
icdgen: 1
node: {name: pack, title: Pack, byte_order: big, bit_order: msb0, id_bits: 16}
protocol:
  link:
    framing: {by: length}
    header:
      - {at: 0, bits: 8, role: sync, value: 0xA5}
      - {at: 8, bits: 16, role: id}
      - {at: 24, bits: 8, role: length}
    trailer:
      - {at: 0, bits: 8, role: checksum, checksum: sum, covers: {from: sync, to: data}}
    checksums:
      sum: {kind: sum, width: 8, init: 0, xor_out: 0}
messages:
  - {name: Set Limit, id: 257, kind: telecommand, length: 2, fields: [{at: 0, bits: 16, name: Limit, type: uint}]}
  - {name: Limit, id: 257, kind: telemetry, length: 2, fields: [{at: 0, bits: 16, name: Limit, type: uint}]}
  - {name: Poll, id: 258, kind: telecommand, length: 0}
  - {name: Rate, set_id: 259, get_id: 259, kind: configuration, length: 1, fields: [{at: 0, bits: 8, name: Rate, type: uint}]}
  - {name: Low, id: 260, shares_id: true, kind: telemetry, length: 1, fields: [{at: 0, bits: 8, name: Page, type: uint, const: 1}]}
  - {name: High, id: 260, shares_id: true, kind: telemetry, length: 1, fields: [{at: 0, bits: 8, name: Page, type: uint, const: 2}]}
  - {name: Log, id: 261, kind: telemetry, length: 0, fields: [{at: 0, name: Words, type: text, size: rest, up_to: 40}]}
"""
LIMIT = "a50101020208b3"


def load_pack(folder) -> Icd:
    return icd_of(PACK, folder)


@pytest.fixture(scope="module")
def icd(tmp_path_factory) -> Icd:
    return load_pack(tmp_path_factory.mktemp("pack"))


def sent(icd: Icd, direction: str, id: int, data: bytes) -> str:
    link = link_of(icd, facts.of(icd, icd.node("pack")))
    return stream_encode(link, id, data, direction).hex()


@pytest.mark.parametrize(
    ("key", "kind", "name"),
    [
        ("Set Limit", None, "Set Limit"),
        ("Limit", None, "Limit"),
        ("257", "telecommand", "Set Limit"),
        ("0x0101", "telemetry", "Limit"),
        (None, "telecommand", "Set Limit"),
        (None, "telemetry", "Limit"),
    ],
)
@pytest.mark.parametrize("frame", [LIMIT, "0101 0208"])
def test_the_message_or_the_kind_decides_with_the_header_and_with_the_id_alone(
    icd, frame, key, kind, name
):
    (frame_,) = recognize(icd, frame, "pack", key, kind)
    assert (frame_.message.name, frame_.what, frame_.data.hex()) == (
        name,
        frame_.message.kind,
        "0208",
    )
    assert not [remark for remark in frame_.remarks if "can also be" in remark]


def test_without_name_and_kind_the_error_suggests_what_to_give(icd):
    with pytest.raises(Ambiguous) as wrong:
        recognize(icd, LIMIT)
    assert "NODE MESSAGE FRAME" in wrong.value.help
    for name, kind in re.findall(r"`([^`]*)` \((\w+) 257\) of pack", str(wrong.value)):
        (frame,) = recognize(icd, LIMIT, "pack", name)
        assert (frame.message.name, frame.what) == (name, kind)


def test_bytes_that_start_with_an_id_of_the_other_kind_are_data_of_the_given_kind(
    icd,
):
    (poll,) = recognize(icd, "0102", kind="telecommand")
    assert poll.message.name == "Poll"
    with pytest.raises(
        Ambiguous, match=r"2 bytes without an id can be `Limit` .*, or `Log`"
    ):
        recognize(icd, "0102", kind="telemetry")


def test_another_message_is_not_read_as_the_one_that_is_named(icd):
    with pytest.raises(
        Ambiguous, match=r"can be `Set Limit` .*, or `Limit` .*, not `Poll`"
    ):
        recognize(icd, LIMIT, "pack", "Poll")


def test_the_named_message_is_found_in_a_stream_of_its_direction(icd):
    line = LIMIT + sent(icd, "telecommand", 258, b"") + LIMIT
    frames = recognize(icd, line, "pack", "Limit")
    assert [(frame.message.name, frame.data.hex()) for frame in frames] == [
        ("Limit", "0208")
    ] * 2
    (poll,) = recognize(icd, line, "pack", "Poll")
    assert poll.message.name == "Poll"


def test_only_the_kind_gives_the_direction_of_a_configuration_message_with_one_id(
    icd,
):
    frame = sent(icd, "telemetry", 259, b"\7")
    with pytest.raises(Ambiguous):
        recognize(icd, frame)
    for kind, what in [
        (None, "configuration"),
        ("telecommand", "telecommand"),
        ("telemetry", "telemetry"),
    ]:
        (decoded,) = recognize(icd, frame, "pack", "Rate", kind)
        assert (decoded.what, decoded.data, decoded.frame.data) == (what, b"\7", b"\7")


@pytest.mark.parametrize(("data", "name"), [(b"\1", "Low"), (b"\2", "High")])
def test_the_id_of_messages_that_share_it_names_the_one_that_the_frame_is(
    icd, data, name
):
    for frame in (sent(icd, "telemetry", 260, data), "0104" + data.hex(), data.hex()):
        (decoded,) = recognize(icd, frame, "pack", "260")
        assert decoded.message.name == name


def test_a_header_that_could_also_be_text_of_the_message_is_removed(icd):
    frame = sent(icd, "telemetry", 261, b"ready")
    (decoded,) = recognize(icd, frame, "pack", "Log")
    assert (
        decoded.data == b"ready" and "header with id 01 05 removed" in decoded.remarks
    )
    (plain,) = recognize(icd, b"ready".hex(), "pack", "Log")
    assert plain.data == b"ready" and plain.remarks == ()
    (other,) = recognize(icd, LIMIT, "pack", "Log")
    assert other.data.hex() == LIMIT
