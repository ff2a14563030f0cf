"""Checksums of framed links: their parameters, what they cover, who uses them, and
messages that share an id.
"""

from __future__ import annotations

import pytest

from icdgen.icd.rules import frame_checksums  # noqa: F401
from tests.icd.rules.rows import messages, rows
from tests.limits import assert_limits

HEAD = (
    "icdgen: 1\nnode: {{name: {}, title: Demo, byte_order: little, bit_order: lsb0}}\n"
)
CRC = "kind: crc, width: 8, polynomial: 7, init: 0, reflect_in: false, reflect_out: false, xor_out: 0"
ONE = "messages:\n  - {name: One, id: 1, kind: telemetry, length: 1}\n"


def link(header: str, trailer: str, *checksums: str, order: str = "") -> str:
    declared = "".join(f"      {each}\n" for each in checksums)
    return (
        "protocol:\n  link:\n    framing: {by: slip}\n"
        f"    header: [{header}]\n    trailer: [{trailer}]\n"
        + (f"    checksums:\n{declared}" if checksums else "")
    )


def parameters(text: str, width: int = 8) -> str:
    """Return a link with a checksum that has these parameters."""
    field = f"{{bits: {width}, role: checksum, checksum: own, covers: {{from: data, to: data}}}}"
    return link("{bits: 8, role: id}", field, f"own: {{{text}}}") + ONE


@pytest.mark.parametrize("kind", ["fletcher", "fletcher_255", "xor", "sum", "crc"])
@pytest.mark.parametrize("width", [8, 16, 24])
def test_the_algorithm_can_fix_the_width(tmp_path, kind, width):
    text = f"kind: {kind}, width: {width}"
    if kind == "crc":
        text = CRC.replace("width: 8", f"width: {width}")
    required = {"fletcher": 16, "fletcher_255": 16, "xor": 8}.get(kind, width)
    expected = f"a checksum of kind `{kind}` has {required} bits, not {width}"
    reported = messages(tmp_path, parameters(text, width), "ICD173")
    assert reported == [expected] * (width != required)


@pytest.mark.parametrize("key", ["polynomial", "init", "xor_out", "empty", "check"])
def test_each_value_fits_the_width(tmp_path, key):
    def is_accepted(value: int) -> bool:
        text = ", ".join(
            part for part in CRC.split(", ") if not part.startswith(f"{key}:")
        )
        text = parameters(f"{text}, {key}: {value}")
        return f"`{key}` does not fit 8 bits" not in messages(tmp_path, text, "ICD173")

    assert_limits(is_accepted, most=255)


def test_values_are_compared_with_the_width_that_the_kind_requires(tmp_path):
    text = parameters("kind: fletcher, width: 8, init: 0xFFFF, xor_out: 0x10000", 16)
    assert messages(tmp_path, text, "ICD173") == [
        "a checksum of kind `fletcher` has 16 bits, not 8",
        "`xor_out` does not fit 16 bits",
    ]


@pytest.mark.parametrize("kind", ["sum", "xor", "fletcher"])
def test_each_key_of_a_crc_is_reported_with_other_kinds(tmp_path, kind):
    width = 16 if kind == "fletcher" else 8
    keys = "polynomial: 7, reflect_in: true, reflect_out: true, empty: 0"
    text = parameters(
        f"kind: {kind}, width: {width}, init: 1, xor_out: 1, {keys}", width
    )
    assert messages(tmp_path, text, "ICD173") == [
        f"`{key}` applies to a CRC, not to a checksum of kind `{kind}`"
        for key in ("polynomial", "reflect_in", "reflect_out", "empty")
    ]


@pytest.mark.parametrize(
    ("polynomial", "width", "fix"),
    [("0x107", 8, "0x07"), ("0x11021", 16, "0x1021"), ("0x1021", 12, "0x021")],
)
def test_a_polynomial_with_its_highest_term_is_shown_without(
    tmp_path, polynomial, width, fix
):
    from tests.icd.files import findings

    text = CRC.replace("width: 8", f"width: {width}").replace(
        "polynomial: 7", f"polynomial: {polynomial}"
    )
    (finding,) = (
        f for f in findings(tmp_path, parameters(text, width)) if f.code == "ICD173"
    )
    assert finding.help == f"write it without its highest term: {fix}"
    assert finding.fix.text == fix


@pytest.mark.parametrize(
    ("names", "expected"),
    [
        ("A, B, C, D", []),
        ("A, B, C", ["`D` has no seed"]),
        ("A, B", ["`C` has no seed, nor has 1 other"]),
        ("A", ["`B` has no seed, nor have 2 others"]),
        ("A, B, C, D, E", ["there is no message `E`"]),
        (
            "A, B, C, E, F",
            ["`D` has no seed", "there is no message `E`", "there is no message `F`"],
        ),
    ],
)
def test_every_message_has_a_seed(tmp_path, names, expected):
    seeds = ", ".join(f"{name}: 1" for name in names.split(", "))
    text = parameters(f"kind: sum, width: 8, seeds: {{{seeds}}}").replace(
        ONE,
        "messages:\n"
        + "".join(
            f"  - {{name: {n}, id: {i}, kind: telemetry, length: 1}}\n"
            for i, n in enumerate("ABCD")
        ),
    )
    assert messages(tmp_path, text, "ICD173") == expected


def test_checksums_that_a_field_can_name_are_listed(tmp_path):
    field = "{bits: 8, role: checksum, checksum: nope, covers: {from: data, to: data}}"
    none = link("{bits: 8, role: id}", field)
    assert messages(tmp_path, none + ONE, "ICD173") == ["no checksum is called `nope`"]
    from tests.icd.files import findings

    def helps(text: str) -> list[str]:
        return [f.help for f in findings(tmp_path, text) if f.code == "ICD173"]

    assert helps(none) == ["name one of `checksums` in `checksum:`: there are none"]
    both = link(
        "{bits: 8, role: id}",
        field,
        "a: {kind: sum, width: 8}",
        "b: {kind: xor, width: 8}",
        "c: {kind: xor, width: 8}",
    )
    assert helps(both)[0] == "name one of `checksums` in `checksum:`: `a`, `b` and `c`"
    nameless = link("{bits: 8, role: id}", field.replace(" checksum: nope,", ""))
    assert messages(tmp_path, nameless, "ICD173") == ["the field names no checksum"]


SUM = "sum: {kind: sum, width: 8}"
ID, FLAGS = "{bits: 8, role: id}", "{bits: 8, role: flags}"
CONSTANT, HALF = "{bits: 8, role: constant}", "{bits: 4, role: constant}"
BIT = "{bits: 1, role: constant}"
BEGINS = "it begins within a byte"
ITSELF = "the checksum covers itself"
OF_TRAILER = (
    "a checksum covers the data, but `from: flags` names a field of the trailer"
)
OF_HEADER = "a checksum covers the data, but `to: id` names a field of the header"


def covers(first: str, last: str, bits: int = 8) -> str:
    """Return a field with a checksum."""
    range = f"covers: {{from: {first}, to: {last}}}"
    return f"{{bits: {bits}, role: checksum, checksum: sum, {range}}}"


@pytest.mark.parametrize(
    ("header", "trailer", "expected"),
    [
        # In the trailer, a checksum begins after the last byte that it covers.
        ([ID], [FLAGS, covers("id", "flags")], []),
        ([ID], [FLAGS.replace("8", "7"), BIT, covers("id", "flags")], []),
        ([ID], [FLAGS.replace("8", "4"), covers("id", "flags", 4)], [ITSELF]),
        ([ID], [covers("id", "data")], []),
        ([ID], [covers("id", "checksum")], [ITSELF]),
        ([ID], [covers("id", "flags"), FLAGS], [ITSELF]),
        # In the header, it ends before the first byte that it covers.
        ([covers("id", "data"), ID], [], []),
        ([covers("data", "data"), ID], [], []),
        ([covers("checksum", "data"), ID], [], [ITSELF]),
        ([ID, covers("id", "data")], [], [ITSELF]),
        ([covers("id", "data", 4), ID], [], [BEGINS, ITSELF]),
        ([FLAGS.replace("8", "4"), ID], [covers("id", "data")], [BEGINS]),
        ([FLAGS, covers("id", "data"), ID], [], []),
        ([BIT, covers("flags", "data"), FLAGS.replace("8", "7"), ID], [], [BEGINS, ITSELF]),
        # The first of several fields of a role, and the last in the trailer.
        ([HALF, HALF, ID], [covers("constant", "data")], []),
        ([ID], [CONSTANT, covers("id", "constant"), CONSTANT], [ITSELF]),
        # A field of the right part, although the other part has one of its role, too.
        ([CONSTANT, ID], [CONSTANT, covers("data", "constant")], []),
        ([CONSTANT, ID], [CONSTANT, covers("constant", "data")], []),
        ([ID], [FLAGS, covers("flags", "data")], [OF_TRAILER]),
        ([ID], [covers("id", "id")], [OF_HEADER]),
        # A name instead of a role.
        ([ID.replace("id", "id, name: First")], [covers("First", "data")], []),
        ([ID], [covers("Last", "data")], ["no field has the role or name `Last`"]),
    ],
)  # fmt: skip
def test_the_covered_range_does_not_contain_the_checksum(
    tmp_path, header, trailer, expected
):
    fields = ", ".join(header), ", ".join(trailer)
    bits = 4 if "bits: 4, role: checksum" in "".join(fields) else 8
    text = link(*fields, SUM.replace("8", str(bits))) + ONE
    assert messages(tmp_path, text, "ICD173") == expected


def test_a_wrong_range_of_a_packet_is_reported_with_its_name(tmp_path):
    text = (
        "protocol:\n  link:\n    framing: {by: slip}\n    packets:\n"
        f"      a: {{from: device, header: [{{bits: 8, role: id}}], trailer: [{covers('first', 'data')}]}}\n"
        f"    checksums:\n      {SUM}\n{ONE}"
    )
    assert rows(tmp_path, text, "ICD173") == [
        "7:122 no field of the packet `a` has the role or name `first`"
    ]


@pytest.mark.parametrize(
    ("user", "is_used"),
    [
        ("", False),
        (
            "trailer: [{bits: 8, role: checksum, checksum: sum, covers: {from: data, to: data}}]",
            True,
        ),
        (
            "trailer: [{bits: 8, role: checksum, checksum: other, covers: {from: data, to: data}}]",
            False,
        ),
    ],
)
def test_a_checksum_can_be_used_by_a_file_that_includes_it(tmp_path, user, is_used):
    base = f"{HEAD.format('base')}protocol: {{link: {{checksums: {{{SUM}}}}}}}\n"
    text = (
        "include: [base.yaml]\nprotocol:\n  link:\n    framing: {by: slip}\n"
        f"    header: [{{bits: 8, role: id}}]\n    {user}\n{ONE}# base.yaml\n{base}"
    )
    unused = "base.yaml:3:31 no field of a packet has the checksum `sum`"
    reported = [row for row in rows(tmp_path, text, "ICD173") if row.startswith("base")]
    assert reported == [unused] * (not is_used)


def shared(*messages: str, packets: str = "    header: [{bits: 8, role: id}]\n") -> str:
    head = "shares_id: true, kind: telemetry, length: 2"
    field = "at: 0, bits: 16, name: V, type: uint, const"
    lines = "".join(
        f"  - {{{each}, {head}, fields: [{{{field}: {n}}}]}}\n"
        for n, each in enumerate(messages)
    )
    return f"protocol:\n  link:\n    framing: {{by: slip}}\n{packets}messages:\n{lines}"


def test_messages_of_one_id_all_end_early_or_none(tmp_path):
    early = "may_end_early: zeros"
    text = shared(
        "name: A, id: 1",
        f"name: B, id: 1, {early}",
        f"name: C, id: 2, {early}",
        "name: D, id: 2",
        f"name: E, id: 2, {early}",
    )
    assert rows(tmp_path, text, "ICD174") == [
        "9:37 zeros of `B` may be omitted, but not the zeros of another message with its id",
        "10:37 zeros of `C` may be omitted, but not the zeros of another message with its id",
    ]
