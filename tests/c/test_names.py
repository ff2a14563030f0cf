"""Names of generated C: the node's name comes first and once, also for parts of an
included node.
"""

from __future__ import annotations

import pytest

from icdgen.backends.c import names
from icdgen.describe import describe
from tests.icd.files import loaded

BASE = """\
# base.yaml
icdgen: 1
node: {name: base, title: Base, byte_order: little, bit_order: lsb0}
messages:
  - {name: Ping, id: 3, kind: telecommand, length: 0}
  - {name: Base State, id: 200, kind: telemetry, length: 0}
"""
DEMO = """\
icdgen: 1
include: [base.yaml]
node: {name: demo, title: Demo, byte_order: little, bit_order: lsb0}
enums:
  - name: Mode
    members: [{value: 1, name: Idle}]
  - name: Demo Kind
    members: [{value: 1, name: Odd}]
messages:
  - name: Demo State
    id: 130
    kind: telemetry
    length: 2
    fields:
      - {at: 0, bits: 8, name: Mode, type: enum, enum: Mode}
      - {at: 8, bits: 8, name: Kind, type: enum, enum: Demo Kind}
  - {name: Demonstration, id: 131, kind: telemetry, length: 0, shares_id: true}
  - name: Other
    id: 131
    kind: telemetry
    length: 1
    shares_id: true
    fields: [{at: 0, bits: 8, name: Kind, type: uint, const: 7}]
"""


@pytest.fixture
def nodes(tmp_path):
    result = loaded(tmp_path, DEMO + BASE)
    assert result.ok, [finding.message for finding in result.findings]
    return {node.name: node for node in describe(result.icd).nodes}


def test_the_name_of_the_node_is_a_prefix_only_where_a_name_lacks_it(nodes):
    messages = nodes["demo"].messages + nodes["base"].messages
    assert [names.stem(message) for message in messages] == [
        "demo_state",
        "demo_demonstration",
        "demo_other",
        "base_ping",
        "base_state",
    ]
    assert [names.stem(enum) for enum in nodes["demo"].enums] == [
        "demo_mode",
        "demo_kind",
    ]


def test_functions_and_macros_of_a_message_begin_with_its_stem(nodes):
    state = nodes["demo"].messages[0]
    assert (
        names.element_reader(state, "wheels"),
        names.element_writer(state, "wheels"),
        names.received_element_reader(state, "wheels"),
        names.has(state, "rate"),
        names.constant(state, "get_id"),
        names.getter(state, "rate_deg"),
        names.setter(state, "rate_deg"),
        names.part_name(state),
    ) == (
        "demo_state_read_wheels",
        "demo_state_write_wheels",
        "demo_state_wheels_at",
        "demo_state_has_rate",
        "DEMO_STATE_GET_ID",
        "demo_state_rate_deg",
        "demo_state_set_rate_deg",
        "part_demo_state",
    )
    mode = nodes["demo"].enums[0]
    assert names.enumerator(mode, mode.members[0]) == "DEMO_MODE_IDLE"


def test_a_message_is_selected_by_an_enumerator_only_in_a_direction_with_shared_ids(
    nodes,
):
    node = nodes["demo"]
    (ping, state) = nodes["base"].messages
    # The enumerator has the name of the node that includes the message.
    assert names.selector(node, "telemetry", state, "id") == (
        "DEMO_TELEMETRY_IS_BASE_STATE"
    )
    assert names.selector(nodes["base"], "telemetry", state, "id") == "BASE_STATE_ID"
    assert names.selector(node, "telecommand", ping, "set_id") == "BASE_PING_SET_ID"


def test_the_client_of_a_node_names_its_functions_after_the_node(nodes):
    (ping, _) = nodes["base"].messages
    assert names.client_function("demo", "send", ping) == "demo_send_ping"
    assert names.client_verbs(nodes["demo"], "telemetry") == ("request", "receive")


def test_words_of_checksums_and_procedures_are_identifiers(nodes):
    node = nodes["demo"]
    assert names.checksum_word("CRC-16/X.25") == "crc_16_x_25"
    assert names.checksum_function(node, "CRC-16") == "demo_crc_16_checksum"
    assert names.procedure(node, "download") == "demo_download"
    assert names.procedure(node, "download", "size") == "demo_download_size"
    assert names.procedure_size(node, "download", "block_bytes") == (
        "DEMO_DOWNLOAD_BLOCK_BYTES"
    )
    assert names.input_parameters("key", True) == ("key", "key_size")
    assert names.input_parameters("key", False) == ("key",)


@pytest.mark.parametrize(
    "word", ["while", "typename", "noreturn", "uint_fast16_t", "linux", "errno.h"]
)
def test_words_of_c_of_cpp_and_of_headers_are_reserved(word):
    assert word in names.RESERVED
