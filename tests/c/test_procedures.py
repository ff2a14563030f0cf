"""Procedures in C: each step is a row that refers to a row of its kind. The function
has typed parameters and enough memory.
"""

from __future__ import annotations

from types import SimpleNamespace

import pytest

from icdgen.backends.c.names import PROCEDURE_PARAMETERS
from icdgen.backends.c.procedures import (
    ProcedureCode,
    _ProcedureTables,
    procedure_sizes,
    value_initialiser,
)
from icdgen.describe import describe
from icdgen.icd.procedures import FIXED_NAMES
from icdgen.protocol.exchange import NumberPlace
from icdgen.protocol.procedures import (
    Blocks,
    Collect,
    EndIfZeros,
    Get,
    GetMap,
    Input,
    Jump,
    NextBlock,
    NextPacket,
    NextRound,
    Output,
    PacketDone,
    PacketMap,
    Poll,
    Put,
    Receive,
    Send,
    SendMap,
    SetLength,
    SkipUnless,
    Take,
    Test,
    Value,
    Verify,
    VerifyChecksum,
)
from tests.icd.files import loaded

Test.__test__ = False  # no tests, although its name says so

RESET = SimpleNamespace(name="Reset */", telecommand_id=0, telemetry_id=None, length=2)
STATE = SimpleNamespace(name="State", telecommand_id=255, telemetry_id=0x80, length=9)
BYTE = NumberPlace(at=0, size=1, shift=0, bits=8, little=True)
WORD = NumberPlace(at=2, size=2, shift=4, bits=12, little=False)
ONE, REGISTER = Value(1, False), Value(6, True)


class Assumptions:
    def of_section_tree(self, start: str) -> list[tuple[str, str]]:
        return [("steps size", f"of {start}")]


def link(stream=None):
    facts = SimpleNamespace(node=SimpleNamespace(name="demo"), stream=stream)
    return SimpleNamespace(facts=facts, description=None)


def a_procedure(*steps, **changes):
    plain = {
        "name": "read_out", "summary": "", "source": {}, "steps": steps, "numbers": (),
        "inputs": (), "outputs": (), "content": None, "blocks": None, "entry": None,
        "most_entries": 0, "time": 60000, "requests": 99, "registers": 5,
        "messages": (),
    }  # fmt: skip
    return SimpleNamespace(**{**plain, **changes})


def tables_of(*steps, **changes):
    tables = _ProcedureTables(link(), Assumptions())
    return {
        table.name: table
        for table in tables.declare_procedure(a_procedure(*steps, **changes))
    }


def rows_of(name, *steps, **changes):
    return list(tables_of(*steps, **changes)[f"{name}[]"].rows)


def send(data=b"\1\0", puts=(), **changes):
    plain = {"message": RESET, "packet_at": None, "repeats": False,
             "ignores_timeout": False}  # fmt: skip
    return Send(data=data, puts=puts, **{**plain, **changes})


def poll(until=(), fails=(), takes=(), interval=20, timeout=500):
    return Poll(STATE, takes, until, fails, interval, timeout)


def test_each_kind_of_step_is_a_row_with_its_index_and_where_it_continues():
    algorithm = SimpleNamespace(name="crc16")
    other, test = Test(5, Value(2, False)), Test(5, ONE)
    steps = [
        NextBlock(17),
        send(b"\0"),
        Get(STATE, ()),
        poll(until=(test,)),
        SetLength(REGISTER),
        NextRound(12),
        NextPacket(9),
        Receive(STATE, WORD, 4, 250, ("uart", "can")),
        PacketDone(),
        SendMap(),
        GetMap(),
        VerifyChecksum(algorithm, True, False, REGISTER, True),
        Verify(test, True),
        Verify(other, False),
        SkipUnless(test, 16),
        Collect(),
        EndIfZeros(),
        Jump(0),
        send(b"\0"),
    ]
    assert rows_of("steps", *steps) == [
        "{ICD_STEP_NEXT_BLOCK, 0u, false, 17u},",
        "{ICD_STEP_SEND, 0u, false, 0u}, /* Reset * / */",
        "{ICD_STEP_POLL, 0u, false, 0u}, /* State */",
        "{ICD_STEP_POLL, 1u, false, 0u}, /* State */",
        "{ICD_STEP_SET_LENGTH, 0u, false, 0u},",
        "{ICD_STEP_NEXT_ROUND, 0u, false, 12u},",
        "{ICD_STEP_NEXT_PACKET, 0u, false, 9u},",
        "{ICD_STEP_RECEIVE, 0u, false, 0u}, /* State */",
        "{ICD_STEP_PACKET_DONE, 0u, false, 0u},",
        "{ICD_STEP_SEND_MAP, 0u, false, 0u},",
        "{ICD_STEP_GET_MAP, 0u, false, 0u},",
        "{ICD_STEP_VERIFY_CRC, 0u, true, 0u},",
        # Tests share a table with the values of lengths, and equal ones a row.
        "{ICD_STEP_VERIFY, 1u, true, 0u},",
        "{ICD_STEP_VERIFY, 2u, false, 0u},",
        "{ICD_STEP_SKIP_UNLESS, 1u, false, 16u},",
        "{ICD_STEP_COLLECT, 0u, false, 0u},",
        "{ICD_STEP_END_IF_ZEROS, 0u, false, 0u},",
        "{ICD_STEP_JUMP, 0u, false, 0u},",
        "{ICD_STEP_SEND, 0u, false, 0u}, /* Reset * / */",
    ]
    assert {
        name.removesuffix("[]"): table.type
        for name, table in tables_of(*steps).items()
        if name[:-2] in ("tests", "receives", "checksums")
    } == {
        "tests": "icd_test_t",
        "receives": "icd_receive_form_t",
        "checksums": "icd_checksum_test_t",
    }
    assert rows_of("tests", *steps) == [
        "{0u, {6u, true}},",
        "{5u, {1u, false}},",
        "{5u, {2u, false}},",
    ]
    assert rows_of("receives", *steps) == [
        "{0x80u, {6u, 2u, 4u, 12u, false}, 4u, 250u, 5u},"
    ]
    assert rows_of("checksums", *steps) == [
        "{&icdgen_node_demo_checksum_crc16, true, false, {6u, true}},"
    ]


def test_a_telecommand_has_its_bytes_and_the_fields_that_get_values():
    steps = [
        send(b"\0\0"),
        send(b"\0\xff" * 9, (Put(BYTE, ONE), Put(WORD, REGISTER)), packet_at=0),
        send(b"\1\0", (Put(BYTE, ONE), Put(WORD, REGISTER)), repeats=True),
        send(b"\1\0", (Put(WORD, ONE),), ignores_timeout=True, packet_at=3),
    ]
    tables = tables_of(*steps)
    assert tables["sends[]"].rows == [
        "{0x0u, 2u, NULL, NULL, 0u, -1, false, false},",
        "{0x0u, 18u, data_1, puts_0, 2u, 0, false, false},",
        "{0x0u, 2u, data_2, puts_0, 2u, -1, true, false},",
        "{0x0u, 2u, data_3, puts_1, 1u, 3, false, true},",
    ]
    assert tables["data_1[]"].rows == [
        ", ".join(["0x00u", "0xffu"] * 8) + ",",
        "0x00u, 0xffu,",
    ]
    assert {name: table.type for name, table in tables.items()} == {
        "data_1[]": "uint8_t",
        "puts_0[]": "icd_put_t",
        "data_2[]": "uint8_t",
        "data_3[]": "uint8_t",
        "puts_1[]": "icd_put_t",
        "sends[]": "icd_send_form_t",
        "steps[]": "icd_step_form_t",
        "form": "icd_procedure_form_t",
    }
    # The id is in front of the data, as four bytes.
    assert tables["puts_0[]"].rows == [
        "{{4u, 1u, 0u, 8u, true}, {1u, false}},",
        "{{6u, 2u, 4u, 12u, false}, {6u, true}},",
    ]


def test_a_poll_has_tests_of_its_end_before_tests_of_failure():
    test, failed = Test(5, ONE), Test(5, REGISTER)
    steps = [
        Get(STATE, (Take(WORD, 7),)),
        poll((test,), (failed,), (Take(BYTE, 6), Take(WORD, 7))),
        poll(fails=(failed, test), interval=0),
    ]
    tables = tables_of(*steps)
    assert tables["polls[]"].rows == [
        "{0x80u, takes_0, NULL, 1u, 0u, 0u, 0u, 0u},",
        "{0x80u, takes_1, conditions_0, 2u, 1u, 1u, 20u, 500u},",
        "{0x80u, NULL, conditions_1, 0u, 0u, 2u, 0u, 500u},",
    ]
    types = {name: table.type for name, table in tables.items()}
    assert types["takes_0[]"] == types["takes_1[]"] == "icd_take_t"
    assert types["conditions_0[]"] == "icd_test_t"
    assert types["polls[]"] == "icd_poll_form_t"
    assert tables["takes_0[]"].rows == ["{{6u, 2u, 4u, 12u, false}, 7u},"]
    assert tables["conditions_0[]"].rows == [
        "{5u, {1u, false}},",
        "{5u, {6u, true}},",
    ]


def an_input(name="page", **changes):
    plain = {
        "is_bytes": False, "is_flag": False, "enum": None, "most": 9, "values": (),
        "is_optional": False, "summary": "",
    }  # fmt: skip
    return Input(name=name, **{**plain, **changes})


def test_the_form_of_a_procedure_has_its_tables_and_limits():
    inputs = (an_input(), an_input("kind", values=(1, 4), is_optional=True))
    tables = tables_of(
        send(b"\0"),
        numbers=inputs,
        content=an_input("data", is_bytes=True, most=4096),
        most_entries=7,
    )
    assert [*tables] == ["sends[]", "steps[]", "values_0[]", "inputs[]", "form"]
    assert tables["form"].rows == [
        "steps, 1u, /* steps */",
        "sends, NULL, NULL, NULL, NULL, /* sends, polls, receives, checksums, tests */",
        "inputs, /* inputs */",
        "2u, 0u, /* how many inputs, receives */",
        "NULL, /* blocks */",
        "4096u, /* largest number of bytes to send */",
        "7u, /* largest number of entries */",
        "60000u, /* longest duration in ms */",
        "99u, /* largest number of requests */",
    ]
    assert tables["form"].comment == (
        "    /** Assumed steps size: of procedures.read_out */"
    )
    assert tables["inputs[]"].rows == [
        "{9u, NULL, 0u, false}, /* page */",
        "{9u, values_0, 2u, true}, /* kind */",
    ]
    assert tables["values_0[]"].rows == ["1u,", "4u,"]


def blocks(map=None, **changes):
    plain = {
        "sends": True, "total": None, "size": 100, "begin": 2, "packet_bytes": 16,
        "first_packet": 1, "fill": 5, "rounds": 3, "most": 1000,
    }  # fmt: skip
    return Blocks(map=map, **{**plain, **changes})


def test_blocks_have_their_sizes_and_their_map():
    map = PacketMap((RESET, STATE), at=1, bytes=2, msb0=True, received=False,
                    beyond_end=True)  # fmt: skip
    tables = tables_of(blocks=blocks(map, sends=False, total=6))
    assert tables["blocks"].rows == [
        "false, /* sends */",
        "6u, /* register with the number of bytes */",
        "2u, 100u, /* first step, bytes of a block */",
        "16u, 1u, 0x05u, /* bytes of a packet, first number, fill */",
        "3u, 1000u, /* rounds, bytes in all */",
        "&map, /* map */",
    ]
    assert tables["map"].rows == [
        "map_messages, 2u, /* messages */",
        "2u, 1u, 2u, /* length of a message, offset and bytes of the map */",
        "true, false, true, /* bit 0 is the most significant one, received, beyond "
        "the end */",
    ]
    assert tables["map_messages[]"].rows == [
        "{0x0u, 0x0u}, /* Reset * / */",
        "{0xffu, 0x80u}, /* State */",
    ]
    assert "0u, /* largest number of bytes to send */" in tables["form"].rows
    plain = tables_of(blocks=blocks())["blocks"].rows
    assert plain[0] == "true, /* sends */"
    assert plain[1].startswith("0u, ") and plain[-1].startswith("NULL, ")


def test_the_memory_of_all_procedures_is_that_of_the_largest():
    def sizes(*procedures):
        return procedure_sizes(
            SimpleNamespace(facts=SimpleNamespace(procedures=each))
            for each in procedures
        )

    first = a_procedure(messages=(RESET, STATE), registers=7)
    second = a_procedure(messages=(RESET,), registers=9)
    assert tuple(sizes([first], [second])) == (9, 9)
    # C has no arrays without elements.
    assert tuple(sizes([])) == (1, len(FIXED_NAMES))


ENUMS = """\
enums:
  - name: Result
    members:
      - {value: 1, name: Good}
  - name: Wide
    members:
      - {value: 0x100000000, name: Far}
messages:
  - name: Entry
    id: 130
    kind: telemetry
    length: 12
    fields:
      - {at: 0, bits: 64, name: Wide, type: enum, enum: Wide}
      - {at: 64, bits: 32, name: Narrow, type: enum, enum: Result}
"""


@pytest.fixture
def description(tmp_path):
    return describe(loaded(tmp_path, ENUMS).icd)


def code(description, *steps, stream=None, **changes):
    node = description.nodes[0]
    of_link = link(stream)
    of_link.description = description
    return ProcedureCode(node, of_link, a_procedure(*steps, **changes), Assumptions())


def test_parameters_have_the_smallest_type_of_their_numbers(description):
    result, wide = description.icd.nodes[0].enums
    inputs = (
        an_input("page", most=255),
        an_input("address", most=256),
        an_input("size", most=65536),
        an_input("offset", most=9, is_optional=True),
        an_input("verify", is_flag=True),
        an_input("result", enum=result),
        an_input("far", enum=wide),
        an_input("data", is_bytes=True),
    )
    read_out = code(description, inputs=inputs, numbers=inputs[:-1])
    assert (read_out.name, read_out.form) == ("demo_read_out", "demo_read_out_form")
    assert read_out.parameters == [
        "icd_procedure_t *procedure",
        "uint8_t page",
        "uint16_t address",
        "uint32_t size",
        "uint32_t offset",
        "bool verify",
        "demo_result_t result",
        "demo_wide_t far",
        "const uint8_t *data",
        "size_t data_size",
    ]
    assert read_out.numbers == [
        "ICDGEN_U32(page)",
        "ICDGEN_U32(address)",
        "ICDGEN_U32(size)",
        "ICDGEN_U32(offset)",
        "verify ? 1u : 0u",
        "ICDGEN_U32(result)",
        "ICDGEN_U32(far)",
    ]
    assert read_out.wide_numbers == ["far"]


@pytest.mark.parametrize(
    ("form", "has_entry", "names", "sizes"),
    [
        (None, False, [], {}),
        (None, True, ["on_entry", "context"], {}),
        (
            True,
            False,
            ["block_size", "bitmap", "bitmap_size"],
            {"DEMO_READ_OUT_BITMAP_BYTES": 1},
        ),
        (
            False,
            True,
            ["block_size", "buffer", "buffer_size", "bitmap", "bitmap_size",
             "on_block", "on_entry", "context"],
            {"DEMO_READ_OUT_BLOCK_BYTES": 112, "DEMO_READ_OUT_BITMAP_BYTES": 1},
        ),
    ],
)  # fmt: skip
def test_memory_and_callbacks_are_parameters_of_the_procedures_that_need_them(
    description, form, has_entry, names, sizes
):
    entry = description.icd.nodes[0].messages[0] if has_entry else None
    read_out = code(
        description,
        blocks=None if form is None else blocks(sends=form),
        entry=entry,
    )
    assert read_out.memory_names == names
    assert read_out.parameters[1:] == [PROCEDURE_PARAMETERS[n] + n for n in names]
    assert {name: size for name, size, _ in read_out.sizes} == sizes
    assert read_out.members == [
        ("block" if name == "block_size" else name, name) for name in names
    ]
    text = " ".join(read_out.paragraphs)
    assert ("largest number of bytes of a block; 0: 100." in text) == (form is not None)
    assert ("`buffer` needs DEMO_READ_OUT_BLOCK_BYTES bytes" in text) == (form is False)
    assert ("`bitmap` needs DEMO_READ_OUT_BITMAP_BYTES bytes" in text) == (
        form is not None
    )
    assert ("each entry, which demo_entry_decode() decodes." in text) == has_entry
    assert text.startswith("Initialize the procedure `read_out`. ")
    assert text.endswith("Errors: see icd_procedure_init().")


def test_bitmaps_have_a_bit_for_each_packet(description):
    def bytes_of(packets):
        form = blocks(size=16 * packets - 15)
        ((_, size, _),) = code(description, blocks=form).sizes
        return size

    assert [bytes_of(packets) for packets in (1, 8, 9, 16, 17)] == [1, 1, 2, 2, 3]


def test_bytes_to_send_are_members_in_front_of_the_memory(description):
    content = an_input("data", is_bytes=True)
    read_out = code(
        description, content=content, inputs=(content,), blocks=blocks(sends=True)
    )
    assert read_out.members[:3] == [
        ("bytes", "data"),
        ("byte_count", "data_size"),
        ("block", "block_size"),
    ]


@pytest.mark.parametrize(
    ("buses", "stream", "needs_bus"),
    [(("uart",), None, True), ((), None, False), (("uart",), object(), False)],
)
def test_the_bus_is_a_parameter_if_packets_are_requested_on_some(
    description, buses, stream, needs_bus
):
    step = Receive(STATE, WORD, 4, 250, buses)
    read_out = code(description, step, stream=stream)
    assert read_out.needs_bus == needs_bus
    assert ("icd_bus_t bus" in read_out.parameters) == needs_bus


def test_comments_have_the_range_of_inputs_and_what_is_unknown(description):
    inputs = (an_input(), an_input("offset", is_optional=True, summary="Start"))
    paragraphs = code(description, inputs=inputs, summary="Read it").paragraphs
    assert paragraphs[0] == "Initialize the procedure `read_out`. Read it."
    assert paragraphs[1:3] == [
        "`page`: 0 to 9.",
        "`offset`: Start. 0 to 9. ICD_UNKNOWN if it is not known.",
    ]


def test_outputs_are_registers_in_their_type(description):
    result, _ = description.icd.nodes[0].enums
    outputs = [
        Output("count", 5, None, False),
        Output("done", 0, None, True),
        Output("result", 6, result, False),
    ]
    functions = code(description, outputs=outputs).outputs
    assert [each[:3] for each in functions] == [
        ("demo_read_out_count", "uint32_t", "procedure->registers[5]"),
        ("demo_read_out_done", "bool", "procedure->registers[0] != 0u"),
        (
            "demo_read_out_result",
            "demo_result_t",
            "ICDGEN_CAST(demo_result_t, procedure->registers[6])",
        ),
    ]
    assert functions[0].about == (
        "Return `count`. It is valid if the procedure ended with ICD_DONE."
    )


def test_values_are_constants_or_registers():
    assert value_initialiser(Value(0, False)) == "{0u, false}"
    assert value_initialiser(Value(0, True)) == "{0u, true}"
