"""Overlaps, bytes without a field, and ends of fields: texts and places of the findings
of `icdgen.icd.rules.layout`.
"""

from __future__ import annotations

import re
import tempfile
from pathlib import Path

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from tests.icd.files import codes, findings, status

OVERLAP = re.compile(
    r"`F(\d+)` overlaps `F(\d+)` \(line \d+\) in (\d+) bits?(?: of byte (\d+))?$"
)
FIELDS = st.lists(
    st.tuples(st.integers(0, 31), st.integers(1, 18), st.booleans()),
    min_size=1,
    max_size=4,
)


def bits_in_frame(at: int, bits: int, is_msb0: bool) -> set[tuple[int, int]]:
    """Return byte and weight of each bit of a field, by counting."""
    return {
        (bit // 8, 7 - bit % 8 if is_msb0 else bit % 8) for bit in range(at, at + bits)
    }


@settings(max_examples=80, deadline=None)
@given(FIELDS, st.tuples(st.integers(0, 31), st.integers(1, 18)))
def test_fields_of_two_bit_orders_overlap_if_they_have_a_bit_in_common(rows, last):
    fields = [*rows, (*last, True)]
    text = status(
        *(
            f"at: {at}, bits: {bits}, name: F{n}, type: uint"
            + (", bit_order: msb0" if is_msb0 else "")
            for n, (at, bits, is_msb0) in enumerate(fields)
        ),
        length=4,
    )
    expected = set()
    sets = [bits_in_frame(*field) for field in fields]
    inside = [n for n, (at, bits, _) in enumerate(fields) if at + bits <= 32]
    for n in inside:
        first = next((m for m in inside if m < n and sets[m] & sets[n]), None)
        if first is not None:
            shared = sets[first] & sets[n]
            touched = {byte for byte, _ in shared}
            byte = str(touched.pop()) if len(touched) == 1 else None
            expected.add((str(n), str(first), str(len(shared)), byte))
    with tempfile.TemporaryDirectory() as folder:
        reported = findings(Path(folder), text)
    assert {
        OVERLAP.match(finding.message).groups()
        for finding in reported
        if finding.code == "ICD021"
    } == expected


PRESENT = ", and both can be present"
OR_VIEW = "; if `B` reads the same bits in another way, give it `view: true`"
HELP = f"correct `at` or `bits`{OR_VIEW}"
SELECTOR = "at: 0, bits: 8, name: Kind, type: uint"


@pytest.mark.parametrize(
    ("first", "second", "text", "help"),
    [
        ("at: 8, bits: 9", "at: 16, bits: 8", "in bit 16", HELP),
        ("at: 8, bits: 10", "at: 16, bits: 8", "in bits 16 to 17", HELP),
        ("at: 8, bits: 16", "at: 15, bits: 3", "in bits 15 to 17", HELP),
        (
            "at: 8, bits: 8, count: 2",
            "at: 16, bits: 8",
            "in bits 16 to 23",
            "correct `at` or `bits`, or the `count` of `A`" + OR_VIEW,
        ),
        ("at: 8, bits: 8, count: 2", "at: 8, bits: 8", "in bits 8 to 15", HELP),
        (
            "at: 8, bits: 8, when: {Kind: 1}",
            "at: 8, bits: 8",
            f"in 8 bits of byte 1{PRESENT}",
            HELP,
        ),
        (
            "at: 8, bits: 8",
            "at: 15, bits: 8, when: {Kind: 1}",
            f"in 1 bit of byte 1{PRESENT}",
            HELP,
        ),
        (
            "at: 8, bits: 8, when: {Kind: 1}",
            "at: 8, bits: 8, when: {Kind: [1, 2]}",
            f"in 8 bits of byte 1{PRESENT}",
            "let them depend on different values of the same field, or correct `at` or "
            "`bits`",
        ),
    ],
)
def test_an_overlap_names_its_bits_and_what_to_correct(
    first, second, text, help, tmp_path
):
    one, other = f"{first}, name: A, type: uint", f"{second}, name: B, type: uint"
    reported = findings(tmp_path, status(SELECTOR, one, other, length=4))
    (finding,) = (finding for finding in reported if finding.code == "ICD021")
    name = "A" if "count" not in first else f"A[{int('at: 16' in second)}]"
    assert finding.message == f"`B` overlaps `{name}` (line 10) {text}"
    assert finding.help == help
    assert (finding.place.line, finding.place.column) == (11, 14)


def test_fields_that_exclude_each_other_can_have_the_same_bits(tmp_path):
    for second, expected in (("[2, 3]", []), ("[1, 2]", ["ICD021"])):
        fields = (
            f"at: 8, bits: 8, name: {name}, type: uint, when: {{Kind: {value}}}"
            for name, value in (("A", "1"), ("B", second))
        )
        assert codes(tmp_path, status(SELECTOR, *fields)) == expected


UNDESCRIBED = "describe {}, or correct `length`; write `reserved: {}`{} if the manual calls {} reserved"
BESIDE, ALL = " beside `length`", ", which counts all reserved bytes at the end,"


@pytest.mark.parametrize(
    ("bits", "length", "reserved", "text", "help"),
    [
        (0, 1, 0, "no field describes them", ("the last byte", 1, BESIDE, "it")),
        (0, 3, 0, "no field describes them", ("the last 3 bytes", 3, BESIDE, "them")),
        (8, 2, 0, "its fields describe 1", ("the last byte", 1, BESIDE, "it")),
        (9, 4, 0, "its fields describe 2", ("the last 2 bytes", 2, BESIDE, "them")),
        (16, 4, 0, "its fields describe 2", ("the last 2 bytes", 2, BESIDE, "them")),
        (
            8,
            3,
            1,
            "its fields describe 1 and `reserved` 1",
            ("1 byte more", 2, ALL, "them"),
        ),
        (
            8,
            5,
            2,
            "its fields describe 1 and `reserved` 2",
            ("2 bytes more", 4, ALL, "them"),
        ),
    ],
)
def test_bytes_without_a_field_are_counted(
    bits, length, reserved, text, help, tmp_path
):
    field = [f"at: 0, bits: {bits}, name: A, type: uint"] * (bits > 0)
    message = status(*field, length=length)
    if reserved:
        message = message.replace(
            "    fields:", f"    reserved: {reserved}\n    fields:"
        )
    (finding,) = findings(tmp_path, message)
    size = f"{length} byte{'s' * (length > 1)}"
    assert finding.code == "ICD024"
    assert finding.message == f"`Status` has {size}, but {text}"
    assert finding.help == UNDESCRIBED.format(*help)


def test_reserved_bytes_are_those_behind_the_last_field(tmp_path):
    """At 3 all bytes are counted; more would be bytes of the field."""
    for reserved in range(1, 6):
        message = status("at: 0, bits: 9, name: A, type: uint", length=5)
        message = message.replace(
            "    fields:", f"    reserved: {reserved}\n    fields:"
        )
        expected = "ICD024" if reserved < 3 else "ICD027"
        assert codes(tmp_path, message) == [expected] * (reserved != 3)
    (finding,) = findings(tmp_path, message)
    free = "`Status` has 3 bytes after its last field, but `reserved` is 5"
    assert finding.message == free


@pytest.mark.parametrize(
    ("at", "bits", "key", "end"),
    [(0, 17, "bits", 17), (15, 2, "bits", 17), (16, 1, "at", 17), (17, 8, "at", 25)],
)
def test_a_field_behind_the_end_is_marked_at_the_key_that_is_wrong(
    at, bits, key, end, tmp_path
):
    text = status(SELECTOR, f"at: {at}, bits: {bits}, name: A, type: uint")
    finding = next(f for f in findings(tmp_path, text) if f.code == "ICD020")
    line = (tmp_path / "demo.yaml").read_text().splitlines()[finding.place.line - 1]
    assert line[: finding.place.column - 1].endswith(f"{key}: ")
    assert finding.message == (
        f"`A` ends at bit {end}, but `Status` has 16 bits (2 bytes)"
    )


@pytest.mark.parametrize(
    ("at", "before", "behind"), [(1, 0, 8), (7, 0, 8), (9, 8, 16), (15, 8, 16)]
)
def test_the_help_names_the_bytes_next_to_bytes_that_begin_in_a_byte(
    at, before, behind, tmp_path
):
    text = status(f"at: {at}, bits: 8, name: Data, type: bytes", length=3)
    finding = next(f for f in findings(tmp_path, text) if f.code == "ICD023")
    assert finding.message == (
        f"`Data` is `bytes`, but bit {at} is not the beginning of a byte"
    )
    assert finding.help.endswith(f"begin at bits {before} and {behind}")


@pytest.mark.parametrize(
    ("at", "bits", "when", "free"),
    [
        (0, 8, "", ""),
        (7, 1, "", ""),
        (7, 2, "", "1 bit of byte 1 that no field"),
        (8, 4, "", "4 bits of byte 1 that no field"),
        (4, 12, "", "4 bits of byte 1 that no field"),
        (12, 12, "", ""),
        (10, 20, "", "8 bits that no field"),
        (12, 12, ", when: {A: 1}", "12 bits that no field always"),
        (12, 4, ", when: {A: 1}", "4 bits of byte 1 that no field always"),
    ],
)
def test_an_overlay_field_has_only_bits_of_other_fields(at, bits, when, free, tmp_path):
    """`A` has the bits 0 to 7, `B` the bits 12 to 23."""
    text = status(
        "at: 0, bits: 8, name: A, type: uint",
        f"at: 12, bits: 12, name: B, type: uint{when}",
        f"at: {at}, bits: {bits}, name: Low, type: uint, view: true",
        length=4 if at + bits > 24 else 3,
    ).replace(
        "    fields:", f"{'    reserved: 1' if at + bits > 24 else ''}\n    fields:"
    )
    messages = [f.message for f in findings(tmp_path, text) if f.code == "ICD029"]
    assert messages == ([f"`Low` is an overlay of {free} has"] if free else [])
