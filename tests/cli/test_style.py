"""Style of a node for the first ICD of another device: the parts that are copied."""

from __future__ import annotations

import pytest

from icdgen.errors import UserError
from icdgen.starter import style
from icdgen.starter.style import (
    _checksums_in,
    _ranges,
    _seeded,
    _strings,
    _without_listed_messages,
    style_of,
)
from tests.icd.files import loaded

RELAY = """\
icdgen: 1
node: {name: relay, title: Relay, byte_order: big, bit_order: msb0}
units: [{symbol: clicks, identifier: clicks, quantity: count}, {symbol: turns, identifier: turns, quantity: count}]
protocol:
  link:
    ids:
      direction_bit: 5
      telecommand: {direction: 0, first: 10, last: 0x14}
      telemetry: {direction: 1, first: 32, last: 40}
  identification: {source: {table: 3}, message: Identification, fields: {node_type: Model, interface_version: Clicks}}
  boot: {bootloader_s: 5, stop_request: Identification}
enums:
  - name: Mode
    members: [{value: 0, name: Safe}]
  - name: Kind
    members: [{value: 0, name: One}, {value: 0x1F, name: Two}]
messages:
  - name: Identification
    source: {table: 4}
    id: 32
    kind: telemetry
    length: 2
    fields:
      - {at: 0, bits: 8, name: Model,  type: enum, enum: Kind}
      - {at: 8, bits: 8, name: Clicks, type: uint, unit: clicks}
  - name: Set Mode
    id: 10
    kind: telecommand
    length: 1
    fields:
      - {at: 0, bits: 8, name: Mode, type: enum, enum: Mode}
"""


def style_of_text(folder, text: str) -> style.Style:
    result = loaded(folder, text)
    assert result.ok, result.findings
    return style_of(result.icd, result.icd.nodes[0], result.texts)


def test_a_style_has_the_link_and_what_it_names(tmp_path):
    result = style_of_text(tmp_path, RELAY)
    assert result.node == {"byte_order": "big", "bit_order": "msb0"}
    assert result.protocol == {
        "identification": {
            "message": "Identification",
            "fields": {"node_type": "Model", "interface_version": "Clicks"},
        },
        "link": {
            "ids": {
                "direction_bit": 5,
                "telecommand": {"direction": 0, "first": 10, "last": 20},
                "telemetry": {"direction": 1, "first": 32, "last": 40},
            }
        },
    }
    assert [*result.protocol] == ["identification", "link"]
    assert [unit["symbol"] for unit in result.units] == ["clicks"]
    assert result.enums == [
        {
            "name": "Kind",
            "members": [{"value": 0, "name": "One"}, {"value": 31, "name": "Two"}],
        }
    ]
    # Hexadecimal numbers keep their spelling.
    last = result.protocol["link"]["ids"]["telecommand"]["last"]
    assert last.spelling == "0x14"
    assert result.enums[0]["members"][1]["value"].spelling == "0x1F"
    assert not hasattr(result.enums[0]["members"][0]["value"], "spelling")
    (message,) = result.messages
    assert [*message] == ["name", "id", "kind", "length", "fields"]
    assert result.lacks_responses is False


def test_a_node_without_a_link_has_no_style(tmp_path):
    text = RELAY[: RELAY.index("protocol:")] + RELAY[RELAY.index("enums:") :]
    with pytest.raises(UserError) as error:
        style_of_text(tmp_path, text)
    assert str(error.value) == "relay does not say how its messages travel"
    assert error.value.help == "take the style of another node"


PACKETS = {
    "all": {"header": 1},
    "listed": {"messages": ["A"]},
    "request": {},
    "refused": {},
    "ack": {},
    "shared": {},
}


def test_packets_of_single_messages_and_of_responses_are_not_copied():
    link = {
        "framing": {"by": "cobs"},
        "requests": {"packet": "x", "nak": {"packet": "refused"}, "ack": {"packet": "shared"}},
        "commands": {
            "ack": {"packet": "ack"},
            "nak": {"packet": "shared"},
            "echo": "none",
        },
        "packets": PACKETS,
    }  # fmt: skip
    copied = _without_listed_messages(link)
    assert [*copied["packets"]] == ["all", "request", "refused", "shared"]
    assert {key: copied[key] for key in copied if key != "packets"} == {
        key: link[key] for key in link if key != "packets"
    }
    alone = _without_listed_messages({"packets": PACKETS})
    assert [*alone["packets"]] == ["all", "request", "refused", "ack", "shared"]


def test_only_checksums_of_the_link_are_copied_and_seeds_are_those_of_own_messages():
    link = {
        "trailer": [{"checksum": "crc8"}, {"rows": {"checksum": "seeded"}}],
        "header": {"checksum": {"is": "no name"}},
        "checksums": {
            "crc8": {"kind": "crc"},
            "seeded": {"kind": "sum", "seeds": {"Old": 7}},
            "of_files": {"kind": "crc"},
        },
    }
    assert _checksums_in(link["trailer"]) == {"crc8", "seeded"}
    assert _checksums_in("crc8") == _checksums_in({"name": "crc8"}) == set()
    seeded = _seeded({"link": link, "identification": 1}, ["A", "B"])
    assert seeded["link"]["checksums"] == {
        "crc8": {"kind": "crc"},
        "seeded": {"kind": "sum", "seeds": {"A": 0, "B": 0}},
    }
    assert seeded["identification"] == 1
    assert "of_files" in link["checksums"]  # the style itself stays as it is
    without = _seeded({"link": {"checksums": {"x": {}}, "ids": {}}}, [])
    assert without == {"link": {"ids": {}}}
    assert _seeded({"identification": 1}, []) == {"identification": 1}


@pytest.mark.parametrize(
    ("bits", "most"), [(None, 255), (4, 15), (8, 255), (16, 255), (7, 127)]
)
def test_ids_are_small_numbers_that_the_link_can_carry(bits, most):
    header = [] if bits is None else [{"bits": bits, "role": "id"}]
    link = {"framing": {"by": "length"}, "header": header}
    assert _ranges({"link": link}) == {
        "telecommand": (0, most),
        "telemetry": (0, most),
    }
    ids = {"telecommand": {"first": 3, "last": 9}}
    assert _ranges({"link": link | {"ids": ids}}) == {
        "telecommand": (3, 9),
        "telemetry": (0, most),
    }
    assert _ranges({}) == {"telecommand": (0, 255), "telemetry": (0, 255)}


def test_texts_of_keys_are_found_at_any_depth():
    tree = {
        "message": "A",
        "rows": [
            {"message": ["B", 7, "C"]},
            {"other": "D", "message": {"message": "E"}},
        ],
        "number": 5,
    }
    assert list(_strings(tree, ("message",))) == ["A", "B", "C", "E"]
    assert sorted(_strings(tree, None)) == ["A", "B", "C", "D", "E"]
    assert list(_strings("A", None)) == []
