"""The backend of the golden vectors writes a file per node, and one for the protocol."""

from __future__ import annotations

import json

from icdgen.backends.vectors import VectorsBackend
from tests.icd.files import loaded

PLAIN = """\
include: [common.yaml]
messages:
  - {name: Ping, id: 1, kind: telecommand, length: 0}
# common.yaml
icdgen: 1
node: {name: common, title: Common, byte_order: little, bit_order: lsb0}
%smessages:
  - {name: Pong, id: 2, kind: telemetry, length: 1}
"""
UART = "protocol: {link: {buses: {uart: {line: {baud_rate: 9600}}}}}\n"


def files(icd):
    return {
        str(path): json.loads(text) for path, text in VectorsBackend().files(icd, None)
    }


def test_each_node_has_a_file_in_order_and_a_protocol_one_more(tmp_path):
    icd = loaded(tmp_path, PLAIN % "").icd
    written = files(icd)
    assert list(written) == [f"{node.name}.json" for node in icd.nodes]
    assert sorted(written) == ["common.json", "demo.json"]
    names = {
        name: [message["name"] for message in file["messages"]]
        for name, file in written.items()
    }
    assert names == {"demo.json": ["Ping"], "common.json": ["Pong"]}
    written = files(loaded(tmp_path, PLAIN % UART).icd)
    assert list(written)[-1] == "protocol.json" and len(written) == 3
    # The node of the protocol is the one that no other includes.
    assert [node["node"] for node in written["protocol.json"]["nodes"]] == ["demo"]


def identifiers(icd):
    rows = VectorsBackend().identifiers(icd)
    return [(row.scope, row.text, row.owner) for row in rows]


def test_file_names_are_identifiers_and_the_protocol_has_one_if_there_is_one(tmp_path):
    scope = "the files of the vectors"
    icd = loaded(tmp_path, PLAIN % "").icd
    nodes = [(scope, node.name, f"node `{node.name}`") for node in icd.nodes]
    assert identifiers(icd) == nodes
    icd = loaded(tmp_path, PLAIN % UART).icd
    assert identifiers(icd) == [(scope, "protocol", "vectors of the protocol"), *nodes]
    rows = list(VectorsBackend().identifiers(icd))
    assert rows[0].source is None and rows[1].source is icd.nodes[0].source


def test_the_backend_is_selected_by_its_name_and_reserves_no_words():
    backend = VectorsBackend()
    assert (backend.name, backend.reserved) == ("vectors", frozenset())
