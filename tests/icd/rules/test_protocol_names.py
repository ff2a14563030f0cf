"""Rules about names in the protocol section: of messages, members, fields and nodes."""

from __future__ import annotations

import pytest

from tests.icd.files import loaded
from tests.icd.rules.marked import findings_of, marked_text, reported

MESSAGES = """\
enums:
  - {name: Cause, members: [{value: 1, name: Power}, {value: 2, name: Reset}, {value: 3, name: Fault}]}
messages:
  - {name: Start, id: 1, kind: telecommand, length: 0}
  - name: Boot
    id: 130
    kind: telemetry
    length: 6
    fields:
      - {at: 0,  bits: 16, name: Cause,   type: uint}
      - {at: 16, bits: 16, name: Version, type: uint}
      - {at: 16, bits: 8,  name: Minor,   type: uint, view: true}
      - {at: 32, bits: 16, name: Serial,  type: bytes}
"""
NO_MESSAGE = "there is no message `{}`"


def icd(protocol: str) -> str:
    return f"protocol:\n{protocol}{MESSAGES}"


@pytest.mark.parametrize(
    ("section", "names"),
    [
        ("boot: {stop_request: Stat}", ["Stat"]),
        ("boot: {stop_request: Start}", []),
        ("boot: {identify_after: {seconds: 1, message: Bot}}", ["Bot"]),
        ("boot_status: {message: Boots, field: Cause}", ["Boots"]),
        ("boot_status: {message: Boot, field: Cause, reset_by: Stop}", ["Stop"]),
        ("log_mask: {bytes: 1, frame_bytes: 1, set_by: [Start, One, Boot, Two]}", ["One", "Two"]),
        ("program_start: {message: Strt, if_not_started: [Boot, None, Boots]}", ["Strt", "None", "Boots"]),
    ],
)  # fmt: skip
def test_messages_that_a_section_names_exist(section, names, tmp_path):
    rows = reported(tmp_path, icd(f"  {section}\n"), "ICD093")
    assert rows == [(name, NO_MESSAGE.format(name)) for name in names]


def test_a_misspelt_message_is_corrected(tmp_path):
    text = icd("  boot: {stop_request: Strat}\n")
    (finding,) = findings_of(tmp_path, text, "ICD093")
    assert (finding.help, finding.fix.text) == ("did you mean `Start`?", "Start")


@pytest.mark.parametrize(
    ("keys", "values"),
    [
        ("selected: 4", ["4"]),
        ("success: 5", ["5"]),
        ("selected: 1, success: 2, failed: [3]", []),
        ("failed: [1, 0, 3, 9]", ["0", "9"]),
        ("selected: 7, success: 8, failed: [9]", ["7", "8", "9"]),
    ],
)
def test_members_that_a_section_names_exist(keys, values, tmp_path):
    section = f"  boot_status: {{message: Boot, field: Cause, enum: Cause, {keys}}}\n"
    rows = reported(tmp_path, icd(section), "ICD093")
    text = "the enumeration `Cause` has no member {}"
    assert rows == [(value, text.format(value)) for value in values]
    if values:
        findings = findings_of(tmp_path, icd(section), "ICD093")
        key = keys.partition(":")[0]
        assert findings[0].help == f"correct `{key}` or `enum`"
    without = icd(section.replace("enum: Cause, ", "enum: Other, "))
    assert reported(tmp_path, without, "ICD093") == []


def test_the_type_of_a_file_is_a_member(tmp_path):
    entry = (
        "entry_bytes: 1, entry: [{byte: 0, bytes: 1, name: T, role: type, type: uint}]"
    )
    section = f"  index_file: {{file_type: {{enum: Cause, value: {{}}}}, {entry}}}\n"
    for value, is_member in ((1, True), (3, True), (4, False), (0, False)):
        text = icd(section.replace("{}", str(value)))
        rows = reported(tmp_path, text, "ICD093")
        message = f"the enumeration `Cause` has no member {value}"
        assert rows == [(str(value), message)] * (not is_member)


def test_values_of_an_input_are_members_of_its_enumeration(tmp_path):
    section = (
        "  procedures:\n    one:\n      limits: {time_s: 1, requests: 1}\n"
        "      inputs: {cause: {enum: Cause, values: [1, 4, 3, 0]}}\n"
        "      steps: [{send: Start}]\n"
    )
    message = "the enumeration `Cause` has no member {}"
    rows = reported(tmp_path, icd(section), "ICD093")
    assert rows == [(value, message.format(value)) for value in ("4", "0")]


def test_fields_that_a_section_names_own_bits_of_the_message(tmp_path):
    fields = "{node_type: Caus, interface_version: Minor}"
    text = icd(
        "  boot_status: {message: Boot, field: Version}\n"
        f"  identification: {{message: Boot, fields: {fields}}}\n"
    )
    rows = findings_of(tmp_path, text, "ICD094")
    assert [(marked_text(text, f), f.message, f.help) for f in rows] == [
        ("Caus", "`Boot` has no field `Caus`", "did you mean `Cause`?"),
        (
            "Minor",
            "`Minor` of `Boot` is an overlay field, but links read fields with bits",
            "name the field that has the bits",
        ),
    ]
    for name, fix in (("Versoin", "Version"), ("Minro", None)):
        text = icd(f"  boot_status: {{message: Boot, field: {name}}}\n")
        (finding,) = findings_of(tmp_path, text, "ICD094")
        assert (finding.fix and finding.fix.text) == fix


@pytest.mark.parametrize(
    ("orders", "own"),
    [
        ("byte_order: big", "big lsb0"),
        ("bit_order: msb0", "little msb0"),
        ("byte_order: big, bit_order: msb0", "big msb0"),
        ("byte_order: little, bit_order: lsb0", ""),
    ],
)
@pytest.mark.parametrize("is_of_message", [False, True])
def test_links_read_fields_in_the_orders_of_the_node(
    orders, own, is_of_message, tmp_path
):
    """Bytes have no order. The orders of the message are those of its fields."""
    fields = "{node_type: Cause, interface_version: Serial}"
    text = icd(f"  identification: {{message: Boot, fields: {fields}}}\n")
    if is_of_message:
        keys = "".join(f"    {pair}\n" for pair in orders.split(", "))
        text = text.replace("    length: 6\n", f"    length: 6\n{keys}")
    else:
        for name in ("Cause,  ", "Serial, "):
            text = text.replace(f"name: {name}", f"{orders}, name: {name}")
    rows = findings_of(tmp_path, text, "ICD113")
    message = f"`Cause` is {own}, the links of `demo` read fields as little lsb0"
    help = "give it the orders of the node, or leave `node_type` out"
    assert [(f.message, f.help) for f in rows] == [(message, help)] * bool(own)


def test_nodes_are_loaded_or_have_a_file_next_to_the_icd(tmp_path):
    procedure = (
        "  procedures:\n    one:\n      nodes: [demo, pump, pumps, valve]\n"
        "      limits: {time_s: 1, requests: 1}\n      steps: [{send: Start}]\n"
    )
    text = icd(procedure)
    rows = reported(tmp_path, text, "ICD109")
    message = "there is no node `{}`"
    assert rows == [(name, message.format(name)) for name in ("pump", "pumps", "valve")]
    (tmp_path / "valve.yaml").write_text("")
    other = "# other.yaml\nicdgen: 1\nnode: {name: pump, title: P, byte_order: big, bit_order: msb0}\n"
    findings = [
        f for f in loaded(tmp_path, text + other).findings if f.code == "ICD109"
    ]
    assert [(f.message, f.help, f.fix.text) for f in findings] == [
        (message.format("pumps"), "did you mean `pump`?", "pump")
    ]
