"""Links in C: rows have the member order of the runtime, and what the types of the
runtime cannot store is left out.
"""

from __future__ import annotations

from types import SimpleNamespace

import pytest

from icdgen.backends.c.links import (
    _LinkTables,
    _storable_messages,
    buffer_sizes,
    received_bytes,
)
from icdgen.describe.links import SentMessage
from icdgen.protocol.exchange import (
    BusExchanges,
    Echo,
    Exchange,
    NumberPlace,
    Response,
    ResponsePoll,
)
from icdgen.protocol.packet_formats import (
    REQUESTED,
    Check,
    Escaping,
    PacketField,
    PacketFormat,
    Stream,
    StreamRow,
    TelemetryRequest,
)
from icdgen.protocol.sections import (
    Can,
    CanPart,
    ChecksumAlgorithm,
    Crc,
    Extended,
    Index,
    IndexField,
    LogBit,
    LogFile,
    LogMask,
    LogMessage,
    TimePart,
)
from tests.limits import assert_limits

SUM = ChecksumAlgorithm("sum", "sum", Crc(8, 7, 1, False, False, 2), {})
BYTE = NumberPlace(at=0, size=1, shift=0, bits=8, little=True)
WORD = NumberPlace(at=2, size=2, shift=4, bits=12, little=False)


class NoAssumptions:
    reason = ""

    def of_part(self, part):
        return []

    def of_section(self, section):
        return [("by", "usual")] if section == "link" else []

    def why(self, section, key):
        return self.reason


def tables_of(assumptions=None, facts=(), **link):
    all_facts = {"node": SimpleNamespace(name="demo"), **dict(facts)}
    of_link = SimpleNamespace(facts=SimpleNamespace(**all_facts), **link)
    return _LinkTables(of_link, assumptions or NoAssumptions())


def rows_by_name(tables):
    return {
        table.name.removeprefix("icdgen_node_demo_"): list(table.rows)
        for table in tables.tables
    }


def a_message(name="Reset", id=26, length=2, **changes):
    plain = {
        "name": name, "length": length, "acknowledge": True, "expects_reset": False,
        "kind": "telecommand", "telecommand_id": id, "telemetry_id": None,
    }  # fmt: skip
    return SimpleNamespace(**{**plain, **changes})


def test_buffers_have_room_for_the_longest_message_and_its_slot():
    facts = {
        "stream": None, "longest": 20, "longest_telecommand": 12, "can": None,
        "mask": SimpleNamespace(size=4), "log_file": None,
    }  # fmt: skip

    def sizes(joined=0, entry=0, **changes):
        link = SimpleNamespace(
            facts=SimpleNamespace(**{**facts, **changes}),
            joined_bytes=joined,
            log_entry_bytes=entry,
        )
        return {name: size for name, size, _ in buffer_sizes(link)}

    assert sizes(joined=99) == {
        "LONGEST": 20,
        "CLIENT_BYTES": 32,
        "REQUEST_BYTES": 12,
    }
    # The id stands in front of the data of all packets.
    assert sizes(joined=20, can=True)["CAN_SLOT_BYTES"] == 21
    assert sizes(joined=20, can=True)["CLIENT_BYTES"] == 12 + 21
    assert sizes(joined=19, can=True)["CLIENT_BYTES"] == 12 + 20
    log = SimpleNamespace(header_bytes=50)
    assert sizes(entry=46, log_file=log)["LOG_BYTES"] == 50
    assert sizes(entry=47, log_file=log)["LOG_BYTES"] == 51
    assert "LOG_BYTES" not in sizes(log_file=log, mask=None)


def test_a_client_receives_messages_of_any_bus():
    def most(joined, longest, can=True):
        facts = SimpleNamespace(can=can, longest=longest)
        return received_bytes(SimpleNamespace(facts=facts, joined_bytes=joined))

    assert [most(9, 9), most(9, 10), most(9, 11)] == [10, 10, 11]
    assert most(99, 9, can=None) == 9


def test_a_table_stores_ids_of_8_bits_and_lengths_of_16():
    def is_stored(id, length):
        sent = SentMessage(id, SimpleNamespace(length=length))
        return _storable_messages([sent]) == [sent]

    assert_limits(lambda id: is_stored(id, 0), most=0xFF)
    assert_limits(lambda length: is_stored(0, length), most=0xFFFF)


@pytest.mark.parametrize(
    ("always", "in_procedures", "condition"),
    [
        (True, False, ""),
        (True, True, ""),
        (False, False, "!defined(DEMO_CHOSEN) || \\\n        defined(DEMO_WITH_RESET)"),
        (
            False,
            True,
            "!defined(DEMO_CHOSEN) || \\\n        defined(DEMO_WITH_RESET) || \\\n"
            "        !defined(ICDGEN_NO_FILES)",
        ),
    ],
)
def test_a_program_can_leave_out_the_messages_that_it_does_not_use(
    always, in_procedures, condition
):
    reset, equal = a_message(), a_message()
    tables = tables_of(
        always_needed=[reset if always else equal],
        in_procedures=[reset] if in_procedures else [equal],
        name_of=lambda message: message.name.lower(),
    )
    row = tables.row_of_message(SentMessage(0, reset), "0u")
    assert (row.value, row.text, row.condition) == ("{0u, 0u, 2u}", "Reset", condition)
    rows = tables.declare_messages("sent", [row])
    assert rows == "icdgen_node_demo_sent"
    assert rows_by_name(tables)["sent[]"][-1] == "{0u, 0u, 0u}, /* the end */"
    assert tables.declare_messages("none", []) == "NULL"


@pytest.mark.parametrize(
    ("changes", "flags"),
    [
        ({"acknowledge": False}, "0u"),
        ({}, "ICD_ACKNOWLEDGED"),
        (
            {"expects_reset": True, "kind": "configuration"},
            "ICD_ACKNOWLEDGED | ICD_EXPECTS_RESET | ICD_SETTING",
        ),
        ({"acknowledge": False, "kind": "configuration"}, "ICD_SETTING"),
    ],
)
def test_a_telecommand_has_flags_and_the_reason_why_its_acknowledge_is_assumed(
    changes, flags
):
    message = a_message(**changes)
    assumed = NoAssumptions()
    tables = tables_of(assumed, always_needed=[message])
    row = tables.row_of_telecommand(SentMessage(255, message))
    assert row.value == f"{{255u, {flags}, 2u}}"
    assumed.reason = "not in */ the manual"
    row = tables.row_of_telecommand(SentMessage(255, message))
    assert row.value == (
        "/* Assumed acknowledge: not in * / the manual */\n"
        f"        {{255u, {flags}, 2u}}"
    )


def test_a_report_has_its_ids_and_the_places_of_its_fields():
    def field(name, at, bits):
        return SimpleNamespace(model=SimpleNamespace(name=name, at=at, bits=bits))

    message = a_message(telecommand_id=None, telemetry_id=0, length=9)
    places = [
        ("node_type", field("Type", 0, 8)),
        ("uptime", field("Up */", 16, 32)),
    ]
    tables = tables_of()
    report = SimpleNamespace(message=message, places=places)
    assert tables.declare_report("identification", None) == "NULL"
    assert tables.declare_report("identification", report) == (
        "&icdgen_node_demo_identification"
    )
    assert rows_by_name(tables) == {
        "identification_places[]": [
            "{ICD_ROLE_NODE_TYPE, 0u, 8u}, /* Type */",
            "{ICD_ROLE_UPTIME, 16u, 32u}, /* Up * / */",
        ],
        "identification": ["-1, 0, 9u, 2u, icdgen_node_demo_identification_places,"],
    }


def can(extended=None):
    parts = {
        role: CanPart(bits, shift)
        for role, bits, shift in (
            ("destination", 8, 0), ("source", 8, 8),
            ("channel", 8, 16), ("type", 5, 24),
        )
    }  # fmt: skip
    return Can(
        node_address=1,
        data_bytes=8,
        parts=parts,
        types={"telecommand": 0, "reply": 4},
        extended_types={"reply": 7},
        extended=extended,
    )


def extended(data_bytes=6):
    return Extended(data_bytes=data_bytes, left_at=0, bytes=6 * 256)


def test_the_parts_of_a_can_identifier_are_in_the_order_of_the_runtime():
    tables = tables_of(can=can(extended()), joined_bytes=12)
    assert tables.declare_can() == "&icdgen_node_demo_can"
    assert rows_by_name(tables)["can"][-7:] == [
        "{5u, 24u}, /* type: bits, shift */",
        "{8u, 16u}, /* channel: bits, shift */",
        "{8u, 8u}, /* source: bits, shift */",
        "{8u, 0u}, /* destination: bits, shift */",
        "{0, -1, -1, -1, 4, -1}, /* types */",
        "{-1, -1, -1, -1, 7, -1}, /* types of messages of several packets */",
        "&icdgen_node_demo_can_extended, /* messages of several packets */",
    ]


def test_messages_on_can_have_as_many_packets_as_a_byte_can_count():
    def is_declared(packets):
        tables = tables_of(can=can(extended(6)), joined_bytes=6 * packets)
        return tables.declare_can() != "NULL"

    assert_limits(is_declared, most=256)
    single = tables_of(can=can(), joined_bytes=6 * 257)
    assert single.declare_can() == "&icdgen_node_demo_can"
    assert rows_by_name(single)["can"][-1].startswith("NULL, ")
    assert tables_of(can=None, joined_bytes=0).declare_can() == "NULL"


def test_logs_times_and_the_index_have_a_row_for_each_part():
    mask = LogMask(
        size=1, msb0=True, slot_bytes=8, fill=0xFF,
        bits={0: LogBit(0, 0, 4, "First */"), 7: LogBit(7, 255, 8, None)},
    )  # fmt: skip
    facts = {"mask": mask, "log_message": LogMessage(0x33, 5, 9)}
    index = Index(
        entry_bytes=16,
        fields={
            role: IndexField(number, 2)
            for number, role in enumerate(
                ("meta", "type", "counter", "checksum", "size", "time")
            )
        },
    )
    time = [("year", TimePart(25, 7, 1, 1980)), ("second", TimePart(0, 5, 2, 0))]
    tables = tables_of(facts=facts, index=index, time=time)
    declared = [
        tables.declare_log_mask(),
        tables.declare_log_message(),
        tables.declare_packed_time(),
        tables.declare_index(),
    ]
    names = ("log_mask", "log_message", "packed_time", "index_entry")
    assert declared == [f"&icdgen_node_demo_{name}" for name in names]
    rows = rows_by_name(tables)
    assert [table.type for table in tables.tables] == [
        "icd_log_bit_t",
        "icd_log_mask_form_t",
        "icd_log_message_form_t",
        "icd_time_form_t",
        "icd_index_form_t",
    ]
    assert rows["log_bits[]"] == [
        "{0, 4u}, /* bit 0: First * / */",
        *(f"{{-1, 8u}}, /* bit {bit} */" for bit in range(1, 7)),
        "{255, 8u}, /* bit 7 */",
    ]
    assert rows["log_mask"] == [
        "1u, /* size */",
        "true, /* msb0 */",
        "8u, /* slot_bytes */",
        "0xffu, /* fill */",
        "icdgen_node_demo_log_bits,",
    ]
    assert rows["log_message"] == [
        "51u, /* id */",
        "5u, /* mask_at */",
        "9u, /* frames_at */",
        "1u, 8u, /* size of the mask, slot_bytes */",
    ]
    assert rows["packed_time"] == [
        "{25u, 7u, 1u, 1980u}, /* year */",
        "{0u, 5u, 2u, 0u}, /* second */",
    ]
    assert rows["index_entry"][-6:] == [
        "{1u, 2u}, /* type */",
        "{2u, 2u}, /* counter */",
        "{3u, 2u}, /* checksum */",
        "{4u, 2u}, /* size */",
        "{5u, 2u}, /* time */",
        "{0u, 2u}, /* meta */",
    ]
    nothing = tables_of(
        facts={"mask": None, "checksum": None, "stream": None}, index=None, time=[]
    )
    assert {
        nothing.declare_log_mask(), nothing.declare_log_message(),
        nothing.declare_packed_time(), nothing.declare_index(),
        nothing.declare_checksum(), nothing.declare_stream(),
    } == {"NULL"}  # fmt: skip
    assert nothing.tables == []


def a_response(telemetry, verdict="ack", **changes):
    plain = {"echoes": (), "status": None, "meanings": (), "reason": None,
             "reasons": ()}  # fmt: skip
    return Response(telemetry, verdict, **{**plain, **changes})


def test_an_exchange_has_its_sources_and_the_responses_that_have_a_row():
    refusal = a_response(
        None,
        "nak",
        packet=0,
        echoes=(Echo(WORD, 1), Echo(BYTE, 0)),
        status=BYTE,
        meanings=((0, "ack"), (255, "nak")),
        reason=WORD,
        detail=BYTE,
    )
    requested = a_response(None, "reply")
    exchange = Exchange(
        (WORD, BYTE), (requested, a_response(0), refusal), 250, in_header=1,
        poll=ResponsePoll(0x80, WORD),
    )  # fmt: skip
    plain = Exchange((), (a_response(255, "reply"),), 0)
    tables = tables_of()
    assert tables.declare_exchanges("exchanges", [exchange, plain]) == {
        exchange: "&icdgen_node_demo_exchanges[0]",
        plain: "&icdgen_node_demo_exchanges[1]",
    }
    rows = rows_by_name(tables)
    node = "icdgen_node_demo_"
    assert rows["exchanges[]"] == [
        f"{{{node}sources_0, {node}responses_0,\n"
        f"            2u, 1u, 2u, true, 250u, &{node}outcome_poll}},",
        f"{{NULL, {node}responses_1,\n            0u, 0u, 1u, false, 0u, NULL}},",
    ]
    assert {table.name.removeprefix(node): table.type for table in tables.tables} == {
        "sources_0[]": "icd_number_place_t",
        "place_0[]": "icd_number_place_t",
        "place_1[]": "icd_number_place_t",
        "echoes_0[]": "icd_echo_t",
        "meanings_0[]": "icd_meaning_t",
        "responses_0[]": "icd_response_t",
        "outcome_poll": "icd_outcome_poll_t",
        "responses_1[]": "icd_response_t",
        "exchanges[]": "icd_exchange_t",
    }
    # Places in the id and the data count the bytes of the id already.
    assert rows["sources_0[]"] == [
        "{2u, 2u, 4u, 12u, false},",
        "{4u, 1u, 0u, 8u, true},",
    ]
    assert rows["outcome_poll"] == ["128u, {6u, 2u, 4u, 12u, false},"]
    assert rows["responses_0[]"] == [
        "{0x0u, ICD_VERDICT_ACK, 0u, false, 0x1u, 0u,\n"
        "            NULL, NULL,\n"
        "            NULL, NULL, NULL},",
        "{0x0u, ICD_VERDICT_NAK, 2u, true, 0x5u, 2u,\n"
        f"            {node}echoes_0, {node}meanings_0,\n"
        f"            {node}place_1, {node}place_0, {node}place_1}},",
    ]
    assert rows["echoes_0[]"] == [
        f"{{{node}place_0, 1u}},",
        f"{{{node}place_1, 0u}},",
    ]
    assert rows["meanings_0[]"] == [
        "{0x0u, ICD_VERDICT_ACK},",
        "{0xffu, ICD_VERDICT_NAK},",
    ]


def test_a_bus_has_the_exchange_of_commands_before_that_of_requests():
    command = Exchange((), (a_response(1),), 10)
    request = Exchange((), (a_response(2, "reply"),), 20)
    tables = tables_of(
        facts={
            "bus_exchanges": {
                "uart": BusExchanges(command, request),
                "can": BusExchanges(None, request),
            }
        }
    )
    assert tables.declare_bus_exchanges() == {
        "uart": "&icdgen_node_demo_on_uart",
        "can": "&icdgen_node_demo_on_can",
    }
    rows = rows_by_name(tables)
    names = "&icdgen_node_demo_uart_exchanges"
    assert rows["on_uart"] == [f"{names}[1], {names}[0],"]
    assert rows["on_can"] == ["NULL, &icdgen_node_demo_can_exchanges[0],"]


def a_format(**changes):
    plain = {
        "name": "order", "directions": ("telecommand", "telemetry"),
        "content": "message", "header_bytes": 3, "trailer_bytes": 1, "reserved": 0,
        "fields": (), "check": None,
    }  # fmt: skip
    return PacketFormat(**{**plain, **changes})


def a_stream(*packets, **changes):
    plain = {
        "delimited_by": "escape", "per_id": True, "packets": packets,
        "telecommands": (StreamRow(0, 0, 9, False, 0, "Zero"),
                         StreamRow(4, 0, 9, False, 0, "Four", packet=1)),
        "telemetry": (StreamRow(255, 0, 9, False, 0, "Last"),),
    }  # fmt: skip
    return Stream(**{**plain, **changes})


ID = PacketField("id", False, 1, 1, 0, 8, True, (0, 0))


def test_a_packet_format_has_the_only_ids_of_its_messages_if_no_field_has_them():
    named = a_format(
        fields=(ID,), check=Check(SUM, 1, 2, True), directions=("telecommand",)
    )
    only = a_format(name="*/", reserved=5, header_bytes=0)
    tables = tables_of(facts={"stream": a_stream(named, only)})
    assert str(tables.row_of_packet(tables.facts.stream, 0)) == (
        "{{0x0u, 0x0u}, icdgen_node_demo_fields_0, &icdgen_node_demo_check_0, "
        "1u, 3u, 1u, ICD_PACKET_MESSAGE, {true, false}, 0u}, /* order */"
    )
    assert str(tables.row_of_packet(tables.facts.stream, 1)) == (
        "{{0x4u, 0x0u}, NULL, NULL, 0u, 0u, 1u, ICD_PACKET_MESSAGE, {true, true}, "
        "5u}, /* * / */"
    )
    assert [table.type for table in tables.tables] == [
        "icd_packet_field_t",
        "icd_check_form_t",
    ]
    assert rows_by_name(tables)["check_0"] == [
        "&icdgen_node_demo_checksum_sum, /* algorithm */",
        "1u, 2u, true, /* covered */",
    ]
    single = tables_of(facts={"stream": a_stream(named)})
    single.row_of_packet(single.facts.stream, 0)
    assert [*rows_by_name(single)] == ["fields[]", "check"]


def test_a_framing_has_its_packets_messages_and_escape_characters():
    request = Exchange((), (a_response(None, "reply"),), 30)
    stream = a_stream(
        a_format(directions=("telecommand",), header_bytes=7),
        a_format(content=REQUESTED, directions=("telecommand",), header_bytes=2),
        request=TelemetryRequest(1, request),
        escaping=Escaping(escape=0x1F, end=0xFF, data=0, start=None,
                          ignores_other=True),
    )  # fmt: skip
    tables = tables_of(facts={"stream": stream})
    assert tables.declare_stream() == "&icdgen_node_demo_stream"
    rows = rows_by_name(tables)
    node = "icdgen_node_demo_"
    assert rows["stream"] == [
        "ICD_DELIMITED_BY_ESCAPE, true, /* a sequence for each id */",
        # No packet has the direction of telemetry.
        f"2u, {{8, -1}}, {node}packets, /* packet formats */",
        f"{{{node}sent, {node}received}}, {{2u, 1u}}, /* messages */",
        "0u, NULL, /* telemetry that only responds */",
        f"&{node}request, /* request of telemetry */",
        f"&{node}escaping, /* escape characters */",
    ]
    assert {table.name.removeprefix(node): table.type for table in tables.tables} == {
        "packets[]": "icd_packet_form_t",
        "exchanges[]": "icd_exchange_t",
        "sent[]": "icd_stream_row_t",
        "received[]": "icd_stream_row_t",
        "request": "icd_telemetry_request_t",
        "escaping": "icd_escaping_t",
        "stream": "icd_stream_form_t",
    }
    assert rows["request"] == [f"&{node}exchanges[0], 1u,"]
    assert rows["escaping"] == ["0x1fu, 0x00u, 0xffu, 0x00u, false, true,"]
    assert tables.tables[-1].comment == "    /** Assumed by: usual */"


def test_telemetry_that_only_responds_is_listed_in_rows_of_eight():
    exchanges = [Exchange((), (a_response(id),), 0) for id in range(9)]
    rows = tuple(
        StreamRow(id, 0, 9, False, 0, "Any", exchange)
        for id, exchange in enumerate(exchanges)
    )
    tables = tables_of(facts={"stream": a_stream(a_format(), telecommands=rows)})
    tables.declare_stream()
    listed = rows_by_name(tables)
    assert listed["confirming[]"] == [
        "0x0u, 0x1u, 0x2u, 0x3u, 0x4u, 0x5u, 0x6u, 0x7u,",
        "0x8u,",
    ]
    assert listed["stream"][3].startswith("9u, icdgen_node_demo_confirming, ")
    (table,) = (each for each in tables.tables if each.name.endswith("confirming[]"))
    assert table.type == "uint32_t"


def test_the_first_byte_of_a_packet_follows_the_escape_byte_if_the_icd_has_one():
    escaping = Escaping(escape=1, end=2, data=3, start=0, ignores_other=False)
    tables = tables_of(
        facts={"stream": a_stream(a_format(), a_format(), escaping=escaping)}
    )
    tables.declare_stream()
    assert rows_by_name(tables)["escaping"] == [
        "0x01u, 0x00u, 0x02u, 0x03u, true, false,"
    ]


def test_unsolicited_telemetry_has_the_id_in_front_of_it():
    facts = {
        "telemetry": {0: a_message("Zero */", length=4), 255: a_message("Last")},
        "unsolicited": {1: 0, 255: 255},
    }
    tables = tables_of(facts=facts)
    assert tables.declare_unsolicited() == "icdgen_node_demo_unsolicited"
    (table,) = tables.tables
    assert table.type == "icd_unsolicited_t"
    assert table.rows == [
        "{1u, 0u, 4u}, /* Zero * / */",
        "{255u, 255u, 2u}, /* Last */",
    ]


def test_each_checksum_has_its_kind_and_parameters():
    crc = ChecksumAlgorithm("CRC-8/X", "crc", Crc(8, 7, 0xFF, False, True, 0, 0x55), {})
    tables = tables_of(facts={"checksums": {"CRC-8/X": crc, "sum": SUM}})
    tables.declare_algorithms()
    rows = rows_by_name(tables)
    assert [table.type for table in tables.tables] == [
        "uint8_t",
        "icd_checksum_algorithm_t",
        "icd_checksum_algorithm_t",
    ]
    comment = (
        "/* width, polynomial, init, reflected in, out, xor out, whether there is one "
        "of no bytes, which, tables */\n        "
    )
    table = "ICDGEN_TABLE(icdgen_node_demo_checksum_crc_8_x_table)"
    assert rows["checksum_crc_8_x"] == [
        "ICD_CHECK_CRC,",
        f"{comment}{{8u, 0x7u, 0xffu, false, true, 0x0u, true, 0x55u,\n"
        f"         {table}, NULL}},",
    ]
    assert rows["checksum_sum"] == [
        "ICD_CHECK_SUM,",
        f"{comment}{{8u, 0x7u, 0x1u, false, false, 0x2u, false, 0x0u,\n"
        "         NULL, NULL},",
    ]


def test_logs_and_files_can_be_left_out_together_with_their_tables():
    facts = {"mask": None, "log_message": None,
             "log_file": LogFile(0, 8, (0, 4), (4, 2), 6, None)}  # fmt: skip
    tables = tables_of(facts=facts)
    tables.declare("other", "t", ["1u"])
    members = list(tables.optional_members("LOGS", tables.log_members()))
    assert [member.value for member in members] == [
        "NULL",
        "ICDGEN_OF_LOGS(&icdgen_node_demo_log_file)",
        "NULL",
    ]
    assert [(table.name, table.unless) for table in tables.tables] == [
        ("icdgen_node_demo_other", ""),
        ("icdgen_node_demo_log_file", "ICDGEN_NO_LOGS"),
    ]
