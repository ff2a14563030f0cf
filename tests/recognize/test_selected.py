"""Bytes of a message that the user names: its id and its checksum are recognized."""

from __future__ import annotations

import pytest
from icdgen_runtime.wire.i2c import i2c_write

from icdgen.recognize import recognize
from icdgen.recognize.reading import endpoint_of
from icdgen.recognize.selected import selected_message
from icdgen.values.errors import BadLength, NotFound
from tests.features.outputs import icd_of
from tests.links import link
from tests.recognize.test_asked import PACK

HEATER = """\
icdgen: 1
node: {name: heater, title: Heater, byte_order: little, bit_order: lsb0}
protocol:
  link:
    buses: {i2c: {}}
    packets:
      telecommand:
        from: host
        buses: [i2c]
        trailer:
          - {bits: 8, role: checksum, checksum: crc8, covers: {from: COVERS, to: data}, optional: true}
      telemetry:
        from: device
        buses: [i2c]
        trailer:
          - {bits: 8, role: checksum, checksum: crc8, covers: {from: COVERS, to: data}, optional: true}
    checksums:
      crc8: {kind: crc, width: 8, polynomial: 7, init: 0, reflect_in: false, reflect_out: false, xor_out: 0}
messages:
  - {name: Limit, set_id: 21, get_id: 136, kind: configuration, length: 2, fields: [{at: 0, bits: 16, name: Limit, type: uint}]}
"""
NAMES = ("heater", "Limit")


@pytest.mark.parametrize("covers", ["id", "data"])
@pytest.mark.parametrize(("id", "what"), [(21, "telecommand"), (136, "telemetry")])
def test_the_checksum_of_a_configuration_is_that_of_the_id_in_front(
    id, what, covers, tmp_path
):
    icd = icd_of(HEATER.replace("COVERS", covers), tmp_path)
    frame = i2c_write(link(icd, "heater"), id, b"\1\2", crc=True)
    assert (frame[:3], len(frame)) == (bytes((id, 1, 2)), 4)
    (decoded,) = recognize(icd, frame.hex(), *NAMES)
    assert (decoded.what, decoded.id, decoded.data) == (what, id, b"\1\2")
    assert decoded.frame.remarks == (f"id {id} removed", "CRC is right")
    with pytest.raises(BadLength):
        recognize(icd, (frame[:-1] + bytes((frame[-1] ^ 1,))).hex(), *NAMES)


def test_data_without_an_id_may_have_the_checksum_of_the_telecommand(tmp_path):
    icd = icd_of(HEATER.replace("COVERS", "id"), tmp_path)
    frame = i2c_write(link(icd, "heater"), 21, b"\1\2", crc=True)
    (decoded,) = recognize(icd, frame[1:].hex(), *NAMES)
    assert (decoded.what, decoded.id, decoded.data) == ("configuration", None, b"\1\2")
    assert decoded.frame.remarks == ("CRC is right",)


def selected(folder, data: bytes, *names: str, text: str = HEATER):
    """Return the reading of bytes as one of these messages."""
    icd = icd_of(text.replace("COVERS", "id"), folder)
    endpoint = endpoint_of(icd, icd.nodes[0])
    by_name = {message.name: message for message in icd.nodes[0].messages}
    return selected_message(icd, endpoint, [by_name[name] for name in names], data)


def test_bytes_of_the_length_of_the_message_are_its_data_even_after_its_id(tmp_path):
    plain = selected(tmp_path, b"\x15\x01", "Limit")
    assert (plain.what, plain.id, plain.data, plain.remarks) == (
        "configuration",
        None,
        b"\x15\x01",
        (),
    )
    for id, what in ((21, "telecommand"), (136, "telemetry")):
        reading = selected(tmp_path, bytes((id, 1, 2)), "Limit")
        assert (reading.what, reading.id, reading.data) == (what, id, b"\1\2")
        assert reading.remarks == (f"id {id} removed",)


def test_bytes_of_another_length_or_with_a_wrong_checksum_are_errors(tmp_path):
    with pytest.raises(BadLength) as error:
        selected(tmp_path, b"\x16\1\2\3\4", "Limit")
    assert (str(error.value), error.value.expected, error.value.actual) == (
        "Limit has 2 bytes, 5 given",
        2,
        5,
    )
    assert error.value.help == "`icdgen show heater Limit` shows what it holds"
    with pytest.raises(BadLength) as error:
        selected(tmp_path, b"\1\2\3", "Limit")
    assert str(error.value).startswith("`Limit` has 2 bytes; as CRC after them ")
    assert str(error.value).endswith(" would be right, not 03")


@pytest.mark.parametrize(
    ("data", "name", "id"),
    [
        (b"\1", "Low", None),
        (b"\2", "High", None),
        (b"\1\4\1", "Low", 260),
        (b"\1\4\2", "High", 260),
    ],
)
def test_the_data_select_one_of_the_messages_that_share_an_id(tmp_path, data, name, id):
    reading = selected(tmp_path, data, "Low", "High", text=PACK)
    assert (reading.message.name, reading.id, reading.data) == (name, id, data[-1:])


@pytest.mark.parametrize("data", [b"\3", b"\1\4\3", b"\1\5\1", b"", b"\1\4"])
def test_data_like_none_of_the_messages_that_share_an_id_are_an_error(tmp_path, data):
    with pytest.raises(NotFound) as error:
        selected(tmp_path, data, "Low", "High", text=PACK)
    count = "1 byte" if len(data) == 1 else f"{len(data)} bytes"
    assert str(error.value) == (
        f"{count} are like none of `Low` (telemetry 260, 1 byte), "
        "`High` (telemetry 260, 1 byte), by length and constants"
    )
