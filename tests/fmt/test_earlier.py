"""ICDs of earlier versions become those of the present one."""

from __future__ import annotations

import pytest
import yaml

from icdgen.icd.fmt import format_text
from icdgen.loading import load
from tests.conftest import ROOT

EARLIER = """\
icdgen: 1
node: {name: pump, title: Pump, byte_order: big, bit_order: msb0}
protocol:
  # once more after a time-out
  client: {retries: 1}  # as the manual says
  uart: {baud_rate: 9600}
  stream:
    delimited_by: none  # one datagram each
    header: [{bits: 8, role: id}]
    packets:
      out:
        from: host
        trailer:
          - {bits: 8, role: checksum, checksum: parity}
      in:
        from: device
        trailer:
          - {bits: 8, role: checksum, checksum: parity, covers: {from: data, to: data}}
  checksums:
    parity: {kind: xor, width: 8, covers: {from: id, to: data}}
messages:
  - {name: Save, id: 8, kind: telecommand, length: 0}
"""


def test_the_link_is_one_section(tmp_path):
    text = format_text(EARLIER, "pump.yaml")
    assert yaml.safe_load(text)["protocol"] == {
        "link": {
            "framing": {"by": "datagram"},
            "line": {"baud_rate": 9600},
            "header": [{"bits": 8, "role": "id"}],
            "packets": {
                "out": {"from": "host", "trailer": [trailer(first="id")]},
                "in": {"from": "device", "trailer": [trailer(first="data")]},
            },
            "checksums": {"parity": {"kind": "xor", "width": 8}},
            "client": {"retries": 1},
        }
    }
    assert [text.count(word) for word in ("# once", "# as the", "# one datagram")] == [
        1,
        1,
        1,
    ]
    (tmp_path / "pump.yaml").write_text(text, encoding="utf-8")
    assert load([tmp_path / "pump.yaml"]).findings == []


def trailer(first):
    covers = {"from": first, "to": "data"}
    return {"bits": 8, "role": "checksum", "checksum": "parity", "covers": covers}


def test_times_of_a_client_alone_are_moved_too():
    text = EARLIER[: EARLIER.index("  uart")] + EARLIER[EARLIER.index("messages") :]
    converted = yaml.safe_load(format_text(text, "pump.yaml"))
    assert converted["protocol"] == {"link": {"client": {"retries": 1}}}


@pytest.mark.parametrize("text", [EARLIER, "icdgen: 1\nprotocol: {client: {}}\n"])
def test_a_second_time_nothing_changes(text):
    once = format_text(text, "pump.yaml")
    assert format_text(once, "pump.yaml") == once


@pytest.mark.parametrize(
    "path", sorted((ROOT / "icd").glob("*.yaml")), ids=lambda path: path.name
)
def test_present_icds_stay_as_they_are(path):
    text = path.read_text(encoding="utf-8")
    assert format_text(text, path.name) == text
