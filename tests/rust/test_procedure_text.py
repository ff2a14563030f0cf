"""Steps, inputs and outputs of procedures in generated Rust."""

from __future__ import annotations

from dataclasses import replace
from types import SimpleNamespace

import pytest

from icdgen.backends.literals import written
from icdgen.backends.rust import procedures
from icdgen.describe import describe
from icdgen.describe.links import links_of
from icdgen.loading import load
from tests.conftest import ROOT
from tests.icd.files import loaded


@pytest.fixture(scope="module")
def store():
    icd = load([ROOT / "tests" / "procedures" / "other_steps.yaml"]).icd
    description = describe(icd)
    (link,) = links_of(description).values()
    return link, description


@pytest.fixture(scope="module")
def texts(store):
    node = procedures.NodeProcedures(*store, {}, "some_crate")
    assert (node.node, node.included, node.uses_link) == ("store", {}, True)
    return {text.type: text for text in node.own}


READ = """\
    /// Create the procedure.
    ///
    /// - `number`: 0 to 255.
    /// - `size`: 0 to 60000. None: unknown.
    /// - `memory`: [`READ_MEMORY`] bytes; with fewer, blocks are smaller.
    /// - `on_block`: gets the offset and the bytes of each block.
    ///
    /// # Errors
    ///
    /// [`Error::Range`] if an input has a value that the ICD does not allow, [`Error::Length`] if
    /// the memory is too small for a packet.
    pub fn new(
        number: u8,
        size: Option<u16>,
        memory: &'a mut [u8],
        on_block: F,
    ) -> Result<Self, Error> {"""
WRITE = """\
    /// Create the procedure.
    ///
    /// - `number`: 0 to 255.
    /// - `data`: At most 2000 bytes.
    /// - `memory`: [`WRITE_MEMORY`] bytes; with fewer, blocks are smaller.
    ///
    /// # Errors
    ///
    /// [`Error::Range`] if an input has a value that the ICD does not allow, [`Error::TooLong`] if
    /// there are too many bytes, [`Error::Length`] if the memory is too small for a packet.
    pub fn new(number: u8, data: &'a [u8], memory: &'a mut [u8]) -> Result<Self, Error> {"""
LIST = """\
    /// Create the procedure.
    ///
    /// - `on_entry`: gets each entry.
    ///
    /// # Errors
    ///
    /// None: it has no inputs.
    pub fn new(on_entry: F) -> Result<Self, Error> {"""


def test_a_constructor_has_the_inputs_and_their_errors(texts):
    assert list(texts) == ["Read", "Write", "List", "Copy"]
    assert texts["Read"].new == READ
    assert texts["Write"].new == WRITE
    assert texts["List"].new == LIST


def test_a_type_borrows_its_memory_and_has_a_sink(texts):
    def parameters(text):
        return text.lifetime, text.generics, text.bounds, text.elided

    assert parameters(texts["Read"]) == (
        "'a",
        "<'a, F>",
        "<'a, F: FnMut(u32, &[u8])>",
        ("<F>", "<'_, F>"),
    )
    assert parameters(texts["Write"]) == ("'a", "<'a>", "<'a>", ("", "<'_>"))
    assert parameters(texts["List"]) == (
        "'static",
        "<F>",
        "<F: FnMut(crate::store::Entry)>",
        ("<F>", "<F>"),
    )
    assert parameters(texts["Copy"]) == ("'static", "", "", ("", ""))
    assert {name: (text.sink, text.into_sink) for name, text in texts.items()} == {
        "Read": ("procedure::Received<F>", "procedure::Received(on_block)"),
        "Write": ("()", ""),
        "List": (
            "procedure::Entries<crate::store::Entry, F>",
            "procedure::Entries::new(on_entry)",
        ),
        "Copy": ("()", ""),
    }


def test_memory_has_the_received_bytes_and_a_bit_for_each_packet(texts):
    # Blocks of 160 bytes are 20 packets of 8.
    assert {
        name: (text.memory, text.memory_constant, text.memory_bytes)
        for name, text in texts.items()
    } == {
        "Read": ("memory", "READ_MEMORY", "163"),
        "Write": ("memory", "WRITE_MEMORY", "3"),
        "List": ("&mut []", "", ""),
        "Copy": ("&mut []", "", ""),
    }


def test_inputs_become_optional_numbers_and_bytes(texts):
    assert {name: (text.numbers, text.data) for name, text in texts.items()} == {
        "Read": ("Some(u32::from(number)), size.map(u32::from)", "&[]"),
        "Write": ("Some(u32::from(number))", "data"),
        "List": ("", "&[]"),
        "Copy": ("Some(u32::from(number))", "&[]"),
    }


EXAMPLES = {
    "Read": [
        "use some_crate::store::procedures::{Read, READ_MEMORY};",
        "let mut memory = [0; READ_MEMORY];",
        "let mut procedure = Read::new(0, None, &mut memory, |_offset, _bytes| {})?;",
    ],
    "Write": [
        "use some_crate::store::procedures::{Write, WRITE_MEMORY};",
        "let mut memory = [0; WRITE_MEMORY];",
        "let mut procedure = Write::new(0, &[1, 2, 3], &mut memory)?;",
    ],
    "List": [
        "use some_crate::store::procedures::List;",
        "let mut procedure = List::new(|_entry| {})?;",
    ],
    "Copy": [
        "use some_crate::store::procedures::Copy;",
        "let mut procedure = Copy::new(0)?;",
    ],
}


@pytest.mark.parametrize("name", EXAMPLES)
def test_the_comment_of_a_procedure_has_an_example(texts, name):
    use, *statements = EXAMPLES[name]
    assert texts[name].about.splitlines() == [
        f"/// Procedure `{name.lower()}`.",
        "///",
        "/// ```",
        f"/// {use}",
        "///",
        *(f"/// {statement}" for statement in statements),
        "/// assert!(procedure.next(0).is_some()); // `run` of a session does the rest",
        "/// # Ok::<(), some_crate::wire::Error>(())",
        "/// ```",
    ]


def steps(text):
    """Return the rows of the steps of a procedure, without paths of modules."""
    rows = text.table.partition("    steps: &[\n")[2].splitlines()[:-2]
    return [
        row.strip(" ,").replace("procedure::", "").replace("link::", "") for row in rows
    ]


def place(at, size, shift, bits):
    return (
        f"NumberPlace {{ at: {at}, size: {size}, shift: {shift}, bits: {bits},"
        " little: false }"
    )


def put(value, *at):
    return f"Put {{ place: {place(*at)}, value: Value::Register({value}) }}"


def take(register, *at):
    return f"Take {{ place: {place(*at)}, register: {register} }}"


SELECT = ", ".join([put(5, 0, 1, 0, 8), put(0, 1, 4, 0, 32), put(1, 5, 2, 0, 16)])
STATE = ", ".join(
    [
        take(7, 0, 1, 5, 2),
        take(8, 5, 1, 0, 8),
        take(9, 1, 2, 0, 16),
        take(10, 3, 2, 0, 16),
    ]
)
CRC = (
    "ChecksumAlgorithm { kind: CheckKind::Crc, crc: CrcForm { width: 16, polynomial:"
    " 0x1021, init: 0xffff, reflect_in: false, reflect_out: false, xor_out: 0x0000,"
    " empty: None } }"
)


def test_each_step_is_a_row_with_its_messages_places_and_times(texts):
    assert steps(texts["Read"]) == [
        "Step::NextBlock { to: 12 }",
        "Step::Get { id: 129, takes: &[] }",
        f"Step::Send {{ id: 1, data: &[0; 7], puts: &[{SELECT}], packet_at: None,"
        " repeats: true, ignores_timeout: false }",
        f"Step::Poll {{ id: 129, takes: &[{STATE}],"
        " until: &[Test { register: 7, value: Value::Constant(2) },"
        " Test { register: 8, value: Value::Register(5) }],"
        " fails: &[Test { register: 7, value: Value::Constant(3) }],"
        " interval_ms: 10, timeout_ms: 1_000 }",
        "Step::SetLength(Value::Register(9))",
        "Step::NextRound { to: 10 }",
        "Step::SendMap",
        "Step::Send { id: 2, data: &[], puts: &[], packet_at: None, repeats: true,"
        " ignores_timeout: false }",
        f"Step::Receive {{ id: 130, number: &{place(1, 2, 0, 16)}, data_at: 3,"
        " silence_ms: 20,"
        " requested_on: PerBus { uart: false, i2c: false, can: false } }",
        "Step::Jump { to: 5 }",
        f"Step::VerifyChecksum {{ algorithm: &{CRC}, of_block: true, covers_fill: true,"
        " value: Value::Register(10), again: true }",
        "Step::Jump { to: 0 }",
    ]
    assert (
        f"Step::Send {{ id: 7, data: &[0; 10], puts: &[{put(3, 0, 2, 0, 16)}],"
        " packet_at: Some(2), repeats: false, ignores_timeout: true }"
    ) in steps(texts["Write"])


def test_the_table_of_a_procedure_has_its_inputs_blocks_and_limits(texts):
    head = texts["Read"].table.partition("    steps: &[\n")[0]
    assert head == (
        "procedure::Form {\n"
        '    name: "read",\n'
        "    inputs: &[\n"
        '        procedure::Input { name: "number", most: 255, values: &[],'
        ' allowed: "0 to 255", is_optional: false },\n'
        '        procedure::Input { name: "size", most: 60_000, values: &[],'
        ' allowed: "0 to 60000", is_optional: true },\n'
        "    ],\n"
        "    most_bytes: 0,\n"
        "    outputs: &[],\n"
        "    entry: None,\n"
        "    most_entries: 0,\n"
        "    blocks: Some(procedure::Blocks {\n"
        "        sends: false,\n"
        "        total: Some(6),\n"
        "        size: 160,\n"
        "        begin: 1,\n"
        "        packet_bytes: 8,\n"
        "        first_packet: 1,\n"
        "        fill: 0,\n"
        "        rounds: 30,\n"
        "        most: 60_000,\n"
        "        map: Some(procedure::PacketMap { length: 3,"
        " messages: &[(5, 133), (6, 134)], at: 1, bytes: 2, msb0: true,"
        " received: false, beyond_end: true }),\n"
        "    }),\n"
        "    time_ms: 600_000,\n"
        "    requests: 100_000,\n"
        "    retries: 9,\n"
    )
    assert (
        "    entry: Some(132),\n    most_entries: 20,\n    blocks: None,\n"
        in texts["List"].table
    )
    assert "    most_bytes: 2_000,\n" in texts["Write"].table


def test_buffers_have_the_longest_telecommand_and_entry(store):
    link, _ = store
    assert procedures.buffer_sizes([link]) == {"telecommand": 10, "entry": 5}
    assert procedures.buffer_sizes([]) == {"telecommand": 1, "entry": 1}


@pytest.mark.parametrize(
    ("data", "text"),
    [
        (b"", "&[]"),
        (b"\0", "&[0]"),
        (b"\0\0", "&[0; 2]"),
        (b"\0\1", "&[0, 1]"),
        (b"\xff", "&[255]"),
    ],
)
def test_bytes_of_zeros_are_repeated(data, text):
    assert written(procedures._bytes_literal(data), None) == text


def given(**keys):
    keys = {
        "name": "rate",
        "is_bytes": False,
        "is_flag": False,
        "is_optional": False,
    } | keys
    keys = {"values": (), "enum": None, "most": 255} | keys
    return SimpleNamespace(**keys)


@pytest.mark.parametrize(
    ("keys", "argument"),
    [
        ({}, "0"),
        ({"values": (7, 9)}, "7"),
        ({"is_flag": True}, "false"),
        ({"is_bytes": True}, "&[1, 2, 3]"),
        ({"is_optional": True}, "None"),
        ({"enum": object(), "values": (3,)}, "3.into()"),
    ],
)
def test_an_example_has_an_allowed_value_for_each_input(keys, argument):
    assert procedures._example_argument(given(**keys)) == argument


@pytest.mark.parametrize(
    ("keys", "text"),
    [
        ({}, "0 to 255"),
        ({"values": (1, 4)}, "one of 1, 4"),
        ({"values": (0,)}, "one of 0"),
    ],
)
def test_the_allowed_numbers_of_an_input_are_words(keys, text):
    assert procedures._allowed(given(**keys)) == text


@pytest.mark.parametrize(
    ("name", "parameter"),
    [
        ("rate", "rate"),
        ("type", "r#type"),
        ("memory", "memory_"),
        ("on_block", "on_block_"),
        ("on_entry", "on_entry_"),
        ("self", "self_"),
        ("super", "super_"),
        ("crate", "crate_"),
    ],
)
def test_the_parameter_of_an_input_is_no_keyword_and_no_other_parameter(
    name, parameter
):
    assert procedures._parameter(given(name=name)) == parameter


def test_parameters_of_types_are_in_angle_brackets():
    assert procedures._angle([]) == ""
    assert procedures._angle(["'a", "F"]) == "<'a, F>"


OUTPUTS = """\
protocol:
  link:
    framing: {by: length}
    header: [{bits: 8, role: sync, value: [0x5A]}, {bits: 8, role: id}, {bits: 8, role: length}]
  procedures:
    copy_all:
      limits: {time_s: 600, requests: 100}
      inputs: {mode: {enum: Mode}, wide: {type: uint}, flag: {type: bool}}
      outputs: {new_state: state.State, is_busy: state.Busy, last_mode: state.Mode}
      steps:
        - {send: Copy, with: {Mode: mode, Wide: wide, Flag: flag}}
        - {get: State, as: state}
enums:
  - {name: Mode, members: [{value: 0, name: Idle}]}
messages:
  - {name: Copy, id: 1, kind: telecommand, length: 6, fields: [
      {at: 0, bits: 8, name: Mode, type: enum, enum: Mode},
      {at: 8, bits: 17, name: Wide, type: uint},
      {at: 40, bits: 1, name: Flag, type: bool}]}
  - {name: Get State, id: 2, kind: telecommand, length: 0, response: {reply: State}}
  - {name: State, id: 129, kind: telemetry, length: 3, fields: [
      {at: 0, bits: 8, name: State, type: uint},
      {at: 8, bits: 1, name: Busy, type: bool},
      {at: 16, bits: 8, name: Mode, type: enum, enum: Mode}]}
"""


def procedures_of(icd, included=()):
    description = describe(icd)
    (link,) = links_of(description).values()
    return procedures.NodeProcedures(link, description, dict(included), "some_crate")


def test_outputs_are_methods_with_the_type_of_their_field(tmp_path):
    result = loaded(tmp_path, OUTPUTS)
    assert result.ok, [finding.message for finding in result.findings]
    node = procedures_of(result.icd)
    (text,) = node.all
    assert (node.own, node.included) == ([text], {})
    mode = "crate::demo::enums::Mode"
    assert [(output.name, output.type, output.value) for output in text.outputs] == [
        ("new_state", "u32", "self.0.output(8)"),
        ("is_busy", "bool", "self.0.output(9).map(|flag| flag != 0)"),
        (
            "last_mode",
            mode,
            f"self.0.output(10).map(|code| {mode}::from("
            "u8::try_from(code).unwrap_or(u8::MAX)))",
        ),
    ]
    assert text.outputs[0].about == (
        "    /// Return the new state; None until the procedure succeeded."
    )


def test_inputs_have_the_smallest_type(tmp_path):
    (text,) = procedures_of(loaded(tmp_path, OUTPUTS).icd).own
    assert text.numbers == (
        "Some(u32::from(mode.raw())), Some(wide), Some(u32::from(flag))"
    )
    assert text.new.splitlines()[2:5] == [
        "    /// - `mode`: 0 to 255.",
        "    /// - `wide`: 0 to 131071.",
        "    /// - `flag`",
    ]
    assert text.new.splitlines()[-1] == (
        "    pub fn new(mode: crate::demo::enums::Mode, wide: u32, flag: bool)"
        " -> Result<Self, Error> {"
    )


class Including:
    """A description in which all nodes include two others."""

    def __init__(self, description):
        self.description = description

    def node(self, name):
        return SimpleNamespace(included=("other", "base"))

    def __getattr__(self, name):
        return getattr(self.description, name)


def test_the_same_code_is_generated_once_in_the_included_node(store, texts):
    link, description = store
    read, write, *_ = texts.values()
    other = replace(write, table=write.table.replace("retries: 9", "retries: 8"))
    table = {
        "base": SimpleNamespace(own=[read]),
        "other": SimpleNamespace(own=[other]),
    }
    node = procedures.NodeProcedures(link, Including(description), table, "some_crate")
    assert node.included == {"base": [read]}
    assert [text.type for text in node.own] == ["Write", "List", "Copy"]
    assert [text.type for text in node.all] == ["Read", "Write", "List", "Copy"]


def test_an_enumeration_of_64_bits_is_converted():
    path = ROOT / "tests" / "procedures" / "wide_enumeration.yaml"
    (text,) = procedures_of(load([path]).icd).own
    assert text.numbers == "u32::try_from(mode.raw()).ok()"
