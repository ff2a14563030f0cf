"""Bytes of a message that the user names: its id and its checksum are recognized."""

from __future__ import annotations

import pytest
from icdgen_runtime.wire.i2c import i2c_write

from icdgen.recognize import recognize
from icdgen.values.errors import BadLength
from tests.features.outputs import icd_of
from tests.links import link

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
