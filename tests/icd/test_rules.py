"""Rules that calculate are compared with a slower calculation."""

from __future__ import annotations

import binascii
import re
import tempfile
import zlib
from fractions import Fraction
from pathlib import Path

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from icdgen.icd.checksum import crc
from tests.icd.files import codes, findings, status

FEW = settings(max_examples=60, deadline=None)
RUNS = st.lists(
    st.tuples(st.integers(0, 40), st.integers(1, 16)), min_size=1, max_size=6
)


def codes_of(text: str) -> list[str]:
    with tempfile.TemporaryDirectory() as folder:
        return codes(Path(folder), text)


@FEW
@given(RUNS, st.integers(1, 6))
def test_overlaps_and_ends_agree_with_counting_bits(runs, length):
    fields = [
        f"at: {at}, bits: {bits}, name: F{n}, type: uint"
        for n, (at, bits) in enumerate(runs)
    ]
    reported = codes_of(status(*fields, length=length))
    covered = [bit for at, bits in runs for bit in range(at, at + bits)]
    past = sum(at + bits > length * 8 for at, bits in runs)
    assert reported.count("ICD020") == past
    assert ("ICD021" in reported) == (len(set(covered)) < len(covered))
    assert ("ICD024" in reported) == (max(covered) // 8 + 1 < length)
    assert set(reported) <= {"ICD020", "ICD021", "ICD024"}


SCALES = [
    ("raw", 1, 0),
    ("raw*0.5", Fraction(1, 2), 0),
    ("10-raw", -1, 10),
    ("raw*-0.3+1", Fraction(-3, 10), 1),
]


@FEW
@given(
    st.sampled_from(["uint", "int"]),
    st.sampled_from(SCALES),
    st.dictionaries(
        st.sampled_from(["min", "max", "above", "below"]),
        st.integers(-150, 150),
        min_size=1,
        max_size=2,
    ),
)
def test_limits_are_unreachable_if_no_raw_value_is_within(kind, scale, limits):
    formula, factor, offset = scale
    tenths = {key: Fraction(value, 10) for key, value in limits.items()}
    written = "".join(
        f", {key}: {limits[key] // 10}.{limits[key] % 10}"
        for key in limits
        if limits[key] >= 0
    )
    written += "".join(
        f", {key}: -{-limits[key] // 10}.{-limits[key] % 10}"
        for key in limits
        if limits[key] < 0
    )
    field = f"at: 0, bits: 6, name: Angle, type: {kind}, formula: {formula}{written}"
    within = {
        "min": Fraction.__ge__,
        "max": Fraction.__le__,
        "above": Fraction.__gt__,
        "below": Fraction.__lt__,
    }
    physical = [
        raw * factor + Fraction(offset)
        for raw in (range(64) if kind == "uint" else range(-32, 32))
    ]
    reached = any(
        all(within[key](value, limit) for key, limit in tenths.items())
        for value in physical
    )
    reported = codes_of(status(field, length=1))
    assert (reported == []) == reached
    assert set(reported) <= {"ICD033", "ICD034"}


def test_crc_parameters_have_the_meaning_of_the_catalogues():
    data = b"123456789"
    assert crc(data, 32, 0x04C11DB7, 0xFFFFFFFF, True, True, 0xFFFFFFFF) == zlib.crc32(
        data
    )
    assert crc(data, 16, 0x1021, 0, False, False, 0) == binascii.crc_hqx(data, 0)
    assert crc(data, 16, 0x8005, 0xFFFF, True, True, 0) == 0x4B37  # MODBUS
    assert crc(data, 5, 0x05, 0x1F, True, True, 0x1F) == 0x19  # USB
    assert (
        crc(data, 64, 0x42F0E1EBA9EA3693, 0, False, False, 0) == 0x6C40DF5F0B497347
    )  # ECMA-182


@given(st.binary(max_size=50), st.integers(0, 0xFFFF))
def test_the_crc_of_any_data_agrees_with_bitwise_division(data, init):
    assert crc(data, 16, 0x1021, init, False, False, 0) == binascii.crc_hqx(data, init)
    assert crc(data, 32, 0x04C11DB7, 0xFFFFFFFF, True, True, 0xFFFFFFFF) == zlib.crc32(
        data
    )


@pytest.mark.parametrize(
    ("kind", "bits", "const", "fits"),
    [
        ("uint", 8, 255, True),
        ("uint", 8, 256, False),
        ("uint", 64, 2**64 - 1, True),
        ("uint", 64, 2**64, False),
        ("uint", 1, -1, False),
        ("int", 8, -128, True),
        ("int", 8, -129, False),
        ("int", 8, 128, False),
        ("int", 1, 0, True),
        ("int", 1, 1, False),
        ("int", 64, -(2**63), True),
    ],
)
def test_constants_at_the_end_of_the_range_are_accepted(
    tmp_path, kind, bits, const, fits
):
    field = f"at: 0, bits: {bits}, name: Magic, type: {kind}, const: {const}"
    reported = codes(tmp_path, status(field, length=(bits + 7) // 8))
    assert reported == ([] if fits else ["ICD031"])


def test_the_place_of_a_finding_is_the_wrong_value(tmp_path):
    text = status("at: 0, bits:  24 , name: Voltage, type: uint")
    (finding,) = findings(tmp_path, text)
    line = (
        (tmp_path / "demo.yaml")
        .read_text(encoding="utf-8")
        .splitlines()[finding.place.line - 1]
    )
    assert line[finding.place.column - 1 :][: finding.place.length] == "24"


def test_a_field_named_by_an_overlay_is_found_in_the_overlay(tmp_path):
    overlay = """
# errata/demo.yaml
errata: 1
node: demo
entries:
  - id: DEMO-001
    title: Width
    where: {message: Status, field: Voltage}
    printed: {bits: 16}
    held: {bits: 24}
    why: It is printed wrongly.
    evidence: Table 7.
    confidence: likely
"""
    (finding,) = findings(
        tmp_path, status("at: 0, bits: 16, name: Voltage, type: uint") + overlay
    )
    assert (finding.code, Path(finding.place.file).name, finding.place.line) == (
        "ICD020",
        "demo.yaml",
        8,
    )
    assert Path(finding.place.file).parent.name == "errata"


CRC = "kind: crc, width: 8, polynomial: 7, init: {init}, reflect_in: false, reflect_out: false, xor_out: {xor_out}"


@pytest.mark.parametrize(
    ("init", "xor_out", "check", "is_right"),
    [(0, 0, 0xF4, True), (0, 0, 0, False), (0, 0xF4, 0, True), (0, 0xF4, 255, False)],
)
def test_a_check_value_of_zero_is_compared_as_any_other(
    tmp_path, init, xor_out, check, is_right
):
    checksum = CRC.format(init=init, xor_out=xor_out)
    text = (
        f"protocol: {{link: {{checksums: {{crc: {{{checksum}, check: {check}}}}}}}}}\n"
    )
    assert ("ICD091" not in codes(tmp_path, text)) == is_right


RANGES = st.lists(
    st.tuples(st.integers(0, 20), st.integers(0, 6)), min_size=2, max_size=6
)


@FEW
@given(RANGES)
def test_every_member_that_shares_a_value_with_another_is_named(ranges):
    """The member that is named second is the later in the file."""
    values = [set(range(first, first + more + 1)) for first, more in ranges]
    members = "".join(
        f"      - {{value: {first}{f', to: {first + more}' if more else ''}, name: M{n}}}\n"
        for n, (first, more) in enumerate(ranges)
    )
    enum = f"enums:\n  - name: Mode\n    members:\n{members}"
    mode = "at: 0, bits: 16, name: Mode, type: enum, enum: Mode"
    with tempfile.TemporaryDirectory() as folder:
        reported = findings(Path(folder), enum + status(mode))
    pattern = r"`M(\d+)` \(line (\d+)\) already has the value (\d+)"
    named = set()
    for finding in reported:
        first, line, value = map(int, re.fullmatch(pattern, finding.message).groups())
        second = first + finding.place.line - line
        assert first < second and value in values[first] & values[second]
        named |= {first, second}
    assert named == {
        n
        for n, own in enumerate(values)
        if any(own & other for m, other in enumerate(values) if m != n)
    }
    assert {finding.code for finding in reported} <= {"ICD053"}


@pytest.mark.parametrize("value", range(3))
def test_a_field_that_depends_on_another_constant_is_never_present(value, tmp_path):
    for needed in range(3):
        text = status(
            f"at: 0, bits: 8, name: Fixed, type: uint, const: {value}",
            f"at: 8, bits: 8, name: Extra, type: uint, when: {{Fixed: {needed}}}",
        )
        assert codes(tmp_path, text) == ["ICD161"] * (needed != value)


# Parts of the protocol section that consist of rows with roles.
PARTS_OF_ROWS = {
    "index_file: {{entry_bytes: 4, entry: [{}]}}": "size",
    "telemetry_log: {{header: [{}]}}": "mask",
    "telemetry_log: {{entry: [{}]}}": "time",
    "unsolicited_log: {{id: 255, message: [{}], frames_byte: 4}}": "id",
}


@pytest.mark.parametrize("part", PARTS_OF_ROWS)
def test_a_row_with_a_type_that_cannot_be_read_is_reported(part, tmp_path):
    row = f"{{byte: 0, bytes: 4, name: Row, role: {PARTS_OF_ROWS[part]}, type: float}}"
    text = "protocol:\n  " + part.format(row) + "\n"
    messages = [f.message for f in findings(tmp_path, text) if f.code == "ICD118"]
    assert any("not as float" in message for message in messages)


@pytest.mark.parametrize("width", [8, 16, 24, 32])
def test_values_of_a_checksum_have_at_most_its_bits(width, tmp_path):
    """At all widths, up to the largest."""
    for value, codes_of_value in ((1 << width) - 1, []), (1 << width, ["ICD173"]):
        text = f"""\
protocol:
  link:
    framing: {{by: slip}}
    header: [{{at: 0, bits: 8, role: id}}]
    trailer:
      - {{at: 0, bits: {width}, role: checksum, checksum: crc, covers: {{from: id, to: data}}}}
    checksums:
      crc: {{kind: crc, width: {width}, polynomial: 7, init: {value}, reflect_in: false, reflect_out: false, xor_out: 0}}
{status("at: 0, bits: 16, name: Speed, type: uint")}"""
        assert codes(tmp_path, text) == codes_of_value
