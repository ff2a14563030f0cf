"""Rules about keys without effect, and about roles that a field or row cannot have."""

from __future__ import annotations

import pytest

from tests.icd.rules.marked import findings_of, marked_text, reported

ROW = "{{byte: 0, bytes: 1, name: A, role: {}, type: {}}}"
SECTIONS = {
    "index_file": "index_file: {{entry_bytes: 1, entry: [{}]}}",
    "header": "telemetry_log: {{header: [{}], entry: [{{byte: 0, bytes: 1, name: A, type: uint}}], frames_byte: 9}}",
    "entry": "telemetry_log: {{header: [{{byte: 0, bytes: 1, name: A, type: uint}}], entry: [{}], frames_byte: 9}}",
    "unsolicited_log": "unsolicited_log: {{id: 1, message: [{}], frames_byte: 9}}",
}


@pytest.mark.parametrize("section", SECTIONS)
def test_rows_with_a_role_have_a_type_that_can_be_read(section, tmp_path):
    """The schema check reports types and roles that do not exist."""
    for role, types in (("mask", "bytes"), ("meta", "bytes"), ("id", "uint or enum")):
        for type in ("uint", "enum", "bytes", "int", "float"):
            text = f"protocol:\n  {SECTIONS[section].format(ROW.format(role, type))}\n"
            rows = [
                row
                for row in reported(tmp_path, text, "ICD118")
                if "no part" not in row[1]
            ]
            message = f"the {role} is read as {types}, not as {type}"
            assert rows == [(type, message)] * (type not in types.split(" or "))


def test_a_row_without_a_role_has_any_type(tmp_path):
    row = "{byte: 0, bytes: 1, name: mask, type: float}"
    text = f"protocol:\n  {SECTIONS['header'].format(row)}\n"
    assert reported(tmp_path, text, "ICD118") == []


def index(*roles: str) -> str:
    rows = ", ".join(
        f"{{byte: {n}, bytes: 1, name: {role}{', role: ' + role if n == 0 else ''}, type: {'bytes' if role == 'meta' else 'uint'}}}"
        for n, role in enumerate(roles)
    )
    return f"protocol:\n  {SECTIONS['index_file'].format(rows)}\n"


PARTS = ("type", "counter", "checksum", "size", "time", "meta")


@pytest.mark.parametrize("missing", PARTS)
def test_an_index_has_a_part_for_each_role(missing, tmp_path):
    """A part without `role` has its name as role."""
    roles = [role for role in PARTS if role != missing]
    (finding,) = findings_of(tmp_path, index(*roles), "ICD118")
    message = f"an entry of the index has no part for `{missing}`"
    assert (finding.message, finding.help) == (message, "give the parts their `role`")
    assert reported(tmp_path, index(*PARTS), "ICD118") == []


def test_an_index_without_roles_needs_none(tmp_path):
    text = index("type", "other").replace(", role: type", "")
    assert reported(tmp_path, text, "ICD118") == []


LOG = "protocol:\n  unsolicited_log: {{id: 1, message: [{{byte: 0, bytes: 1, name: A, type: uint}}], frames_byte: 9{}}}\n"


@pytest.mark.parametrize(
    ("keys", "expected"),
    [
        ("", []),
        (", framed: true", []),
        (", framed: false", ["false"]),
        (", buses: [uart]", []),
        (", buses: [i2c, uart, can]", ["i2c", "can"]),
        (", framed: false, buses: [can]", ["false", "can"]),
    ],
)
def test_unsolicited_logs_are_framed_on_the_uart(keys, expected, tmp_path):
    text = LOG.format(keys)
    rows = findings_of(tmp_path, text, "ICD115")
    assert [marked_text(text, f) for f in rows] == expected
    buses = [bus for bus in expected if bus != "false"]
    assert [f.help for f in rows if f.message.endswith("UART only")] == [
        f"remove `{bus}`" for bus in buses
    ]


MESSAGES = """\
messages:
  - name: Log
    set_id: 2
    get_id: 130
    kind: configuration
    length: 9
    fields:
      - {at: 0,  bits: 16, name: Mask,   type: bytes}
      - {at: 16, bits: 16, name: Text,   type: text}
      - {at: 32, bits: 8,  name: Period, type: uint}
      - {at: 40, bits: 7,  name: Short,  type: uint}
      - {at: 48, bits: 8,  name: Number, type: uint}
"""


def fields(**names: str) -> str:
    pairs = ", ".join(f"{key}: {name}" for key, name in names.items())
    return (
        "protocol:\n  unsolicited_log:\n    id: 1\n"
        "    message: [{byte: 0, bytes: 1, name: A, type: uint}]\n    frames_byte: 9\n"
        f"    configured_by: {{message: Log, fields: {{{pairs}}}, period_unit_ms: 1}}\n{MESSAGES}"
    )


@pytest.mark.parametrize(
    ("names", "expected"),
    [
        ({"mask": "Mask", "period": "Period"}, []),
        ({"mask": "Text", "period": "Period"}, []),
        ({"mask": "Period", "period": "Number"}, [
            ("Period", "`Period` cannot be `mask`: it is `uint`, not `bytes` or `text`"),
        ]),
        ({"mask": "Mask", "period": "Short"}, [
            ("Short", "`Short` cannot be `period`: it has 7 bits, but needs 8 at least"),
        ]),
        ({"mask": "Mask", "period": "Mask"}, [
            ("Mask", "`Mask` is `mask` already"),
        ]),
        ({"mask": "Mask", "period": "Nothing"}, []),
    ],
)  # fmt: skip
def test_fields_have_a_type_for_their_role(names, expected, tmp_path):
    assert reported(tmp_path, fields(**names), "ICD116") == expected


@pytest.mark.parametrize(
    ("name", "reason"),
    [
        ("Period", ""),
        ("Mask", "it is `bytes`, not `uint`, `int`, `enum` or `bool`"),
        ("None", ""),
    ],
)
def test_other_roles_are_those_of_integers(name, reason, tmp_path):
    text = f"protocol:\n  boot_status: {{message: Log, field: {name}}}\n{MESSAGES}"
    message = f"`{name}` cannot be `field`: {reason}"
    assert reported(tmp_path, text, "ICD116") == [(name, message)] * bool(reason)
