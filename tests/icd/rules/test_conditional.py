"""Optional fields: fields, links and composite messages that do not support them."""

from __future__ import annotations

import pytest

from icdgen.icd.rules import conditional  # noqa: F401
from tests.icd.rules.rows import messages, rows

ONE = "{at: 0, bits: 8, name: Mode, type: uint}"
OPTIONAL = "{at: 8, bits: 8, name: Rate, type: uint, when: {Mode: 0}}"
ALWAYS = "{at: 8, bits: 8, name: Rate, type: uint}"


def telemetry(name: str, id: int, second: str, contains: str = "") -> str:
    parts = f"contains: [{contains}], " if contains else ""
    return (
        f"  - {{name: {name}, id: {id}, kind: telemetry, length: 2, {parts}"
        f"fields: [{ONE}, {second}]}}\n"
    )


@pytest.mark.parametrize(
    ("part", "composite", "text"),
    [
        (OPTIONAL, ALWAYS, "`Part` has optional fields, so `All` cannot repeat `Part`"),
        (ALWAYS, OPTIONAL, "`All` has optional fields, so `All` cannot repeat `Part`"),
        (
            OPTIONAL,
            OPTIONAL,
            "`Part` has optional fields, so `All` cannot repeat `Part`",
        ),
        (ALWAYS, ALWAYS, ""),
    ],
)
def test_composite_messages_support_no_optional_fields(tmp_path, part, composite, text):
    other = telemetry("Other", 3, OPTIONAL)
    all_of = telemetry("All", 2, composite, "{message: Part, at: 0}")
    icd = f"messages:\n{telemetry('Part', 1, part)}{other}{all_of}"
    expected = [f"6:73 {text}"] if text else []
    assert rows(tmp_path, icd, "ICD163") == expected


def test_each_part_with_optional_fields_is_reported(tmp_path):
    """Also a part of an included file."""
    parts = "{message: Part, at: 0}, {message: Plain, at: 0}, {message: Base, at: 0}"
    head = "icdgen: 1\nnode: {name: base, title: Base, byte_order: little, bit_order: lsb0}\n"
    text = (
        "include: [base.yaml]\nmessages:\n"
        + telemetry("Part", 1, OPTIONAL)
        + telemetry("Plain", 2, ALWAYS)
        + telemetry("All", 3, ALWAYS, parts)
        + f"# base.yaml\n{head}messages:\n{telemetry('Base', 4, OPTIONAL)}"
    )
    assert rows(tmp_path, text, "ICD163") == [
        "7:73 `Part` has optional fields, so `All` cannot repeat `Part`",
        "7:122 `Base` has optional fields, so `All` cannot repeat `Base`",
    ]


LINK = "protocol: {link: {buses: {uart: {line: {baud_rate: 9600}}}}}\n"
FRAMED = "protocol: {link: {framing: {by: slip}, header: [{bits: 8, role: id}]}}\n"


@pytest.mark.parametrize(
    ("link", "is_wrong"), [(LINK, True), (FRAMED, False), ("", False)]
)
def test_links_without_framing_support_no_optional_fields(tmp_path, link, is_wrong):
    text = f"{link}messages:\n{telemetry('Plain', 1, ALWAYS)}{telemetry('Part', 2, OPTIONAL)}"
    expected = (
        "6:12 `Part` has optional fields, which the links in `protocol` do not support"
    )
    assert rows(tmp_path, text, "ICD163") == [expected] * is_wrong


def test_a_message_of_an_included_file_is_reported_once(tmp_path):
    head = "icdgen: 1\nnode: {{name: {0}, title: {0}, byte_order: little, bit_order: lsb0}}\n"
    base = f"{head.format('base')}messages:\n{telemetry('Part', 2, OPTIONAL)}"
    middle = f"{head.format('middle')}include: [base.yaml]\n{LINK}"
    text = f"include: [middle.yaml]\n# middle.yaml\n{middle}# base.yaml\n{base}"
    assert rows(tmp_path, text, "ICD163") == [
        "base.yaml:4:12 `Part` has optional fields, which the links in `protocol` do not "
        "support"
    ]


STRUCT = """\
structs:
  - name: Pair
    length: 2
    fields: [{at: 0, bits: 8, name: Mode, type: uint}, {at: 8, bits: 8, count: 1, name: Rate, type: uint, when: {Mode: 0}}]
"""


def test_only_one_reason_against_an_optional_field_is_reported(tmp_path):
    """A field of a struct first, then the key in the order array, variable length,
    split field, overlay, and the type last.
    """
    assert messages(tmp_path, STRUCT, "ICD162") == [
        "`Rate` is a field of a struct, and optional fields in structs are not supported"
    ]
    only = "but only a number, a flag or an enumeration value can be optional"
    when = "when: {Mode: 0}"
    parts = "bitfields: [{at: 0, bits: 8, name: Low}]"
    reasons = {
        f"bits: 8, count: 1, type: bytes, view: true, {when}": "an array",
        f"at: 16, size: rest, up_to: 4, type: bytes, {when}": "of variable length",
        f"bits: 8, type: uint, view: true, {parts}, {when}": "a split field",
        f"bits: 8, type: bytes, view: true, {when}": "an overlay field",
        f"bits: 8, type: bytes, view: false, {when}": "`bytes`",
        f"bits: 8, type: uint, view: false, {when}": "",
    }
    for field, reason in reasons.items():
        at = "" if field.startswith("at") else "at: 8, "
        icd = f"messages:\n{telemetry('Part', 1, f'{{{at}name: X, {field}}}')}"
        expected = [f"`X` is {reason}, {only}"] if reason else []
        assert messages(tmp_path, icd, "ICD162") == expected


def test_fields_beside_a_variable_length_field_cannot_be_optional(tmp_path):
    rest = "{at: 16, bits: 8, name: Rest, type: uint, count: rest, up_to: 4}"
    text = (
        f"messages:\n{telemetry('Open', 1, f'{OPTIONAL}, {rest}')}"
        f"{telemetry('Closed', 2, OPTIONAL)}"
    )
    assert rows(tmp_path, text, "ICD162") == [
        "4:151 `Open` has a variable-length field, so its other fields cannot be optional"
    ]
