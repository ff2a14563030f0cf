"""Rules about addresses on I2C, check values of checksums, and rows of layouts."""

from __future__ import annotations

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from icdgen.icd import checksum
from icdgen.icd.rules.protocol import sections
from icdgen.loading import load
from tests.icd.files import write
from tests.icd.rules.marked import findings_of, marked_text, reported, reported_by_line

I2C = "protocol:\n  link:\n    buses:\n      i2c:\n"


def addresses(write: str = "", read: str = "") -> str:
    rows = [("write", write), ("read", read)]
    return I2C + "".join(f"        {key}: {{{row}}}\n" for key, row in rows if row)


@pytest.mark.parametrize(
    ("write", "read", "expected"),
    [
        ("address_8bit: 0xAE", "address_8bit: 0xAF", []),
        ("address_8bit: 0", "address_8bit: 1", []),
        ("address_8bit: 254", "address_8bit: 255", []),
        ("address_8bit: 0xAE", "address_8bit: 0xB1", [
            ("0xB1", "the read address 0xB1 does not follow the write address 0xAE"),
        ]),
        ("address_8bit: 0x02", "address_8bit: 0x02", [
            ("0x02", "the read address 0x02 does not follow the write address 0x02"),
            ("0x02", "0x02 cannot be a read address"),
        ]),
        ("address_8bit: 0x03", "address_8bit: 0x05", [
            ("0x03", "0x03 cannot be a write address"),
        ]),
        ("address_8bit: 0xAE, address_7bit: 0x57", "address_8bit: 0xAF, address_7bit: 0x57", []),
        ("", "address_8bit: 0xAF, address_7bit: 0x58", [
            ("0x58", "the 7-bit address 0x58 gives the read address 0xB1, not 0xAF"),
        ]),
        ("address_8bit: 0xAE, address_7bit: 3", "", [
            ("3", "the 7-bit address 0x03 gives the write address 0x06, not 0xAE"),
        ]),
        ("address_8bit: 0x03, address_7bit: 7", "", [
            ("0x03", "0x03 cannot be a write address"),
        ]),
        ("address_7bit: 3", "address_7bit: 4, binary: '1'", []),
        ("address_8bit: 6, binary: '0b0000 0110'", "address_8bit: 7, binary: '111'", []),
        ("address_8bit: 6, binary: '101'", "", [
            ("'101'", "the binary form `101` states 0x05, but the address is 0x06"),
        ]),
        ("address_8bit: 0, binary: '0b'", "", [
            ("'0b'", "the binary form `0b` is not a binary number, but the address is 0x00"),
        ]),
        ("address_8bit: 2, binary: '102'", "", [
            ("'102'", "the binary form `102` is not a binary number, but the address is 0x02"),
        ]),
    ],
)  # fmt: skip
def test_the_forms_of_an_address_agree(write, read, expected, tmp_path):
    rows = reported(tmp_path, addresses(write, read), "ICD090")
    assert sorted(rows) == sorted(expected)


def test_a_wrong_address_is_corrected_from_its_8_bits(tmp_path):
    text = addresses(
        "address_8bit: 0x0E, address_7bit: 3, binary: '1'", "address_8bit: 0x0E"
    )
    rows = findings_of(tmp_path, text, "ICD090")
    assert [(f.help, f.fix and f.fix.text) for f in rows] == [
        ("0x0E is 0x07 with 7 bits", "0x07"),
        ("0x0E is 0b00001110", '"0b00001110"'),
        ("correct it: the last bit of a read address is 1", None),
        ("the read address is 0x0F", "0x0F"),
    ]


# Catalogue of parametrised CRC algorithms: width, polynomial, init, reflect_in,
# reflect_out, xor_out, check.
CATALOGUE = {
    "gsm": (3, 0x3, 0x0, False, False, 0x7, 0x4),
    "usb": (5, 0x05, 0x1F, True, True, 0x1F, 0x19),
    "smbus": (8, 0x07, 0x00, False, False, 0x00, 0xF4),
    "umts": (12, 0x80F, 0x000, False, True, 0x000, 0xDAF),
    "genibus": (16, 0x1021, 0xFFFF, False, False, 0xFFFF, 0xD64E),
    "kermit": (16, 0x1021, 0x0000, True, True, 0x0000, 0x2189),
    "iso": (32, 0x04C11DB7, 0xFFFFFFFF, True, True, 0xFFFFFFFF, 0xCBF43926),
}


def checksums(rows: dict[str, str]) -> str:
    lines = "".join(f"      {name}: {{{row}}}\n" for name, row in rows.items())
    return f"protocol:\n  link:\n    checksums:\n{lines}"


def crc(width, polynomial, init, reflect_in, reflect_out, xor_out, check) -> str:
    return (
        f"kind: crc, width: {width}, polynomial: {polynomial}, init: {init}, "
        f"reflect_in: {reflect_in}, reflect_out: {reflect_out}, xor_out: {xor_out}, "
        f"check: {check}"
    ).lower()


def test_check_values_of_the_catalogue_are_right_and_all_others_are_not(tmp_path):
    right = {name: crc(*row) for name, row in CATALOGUE.items()}
    assert reported(tmp_path, checksums(right), "ICD091") == []
    wrong = {name: crc(*row[:-1], row[-1] ^ 1) for name, row in CATALOGUE.items()}
    message = (
        "these parameters give 0x{:02X} over 123456789, not the check value 0x{:02X}"
    )
    assert reported(tmp_path, checksums(wrong), "ICD091") == [
        (str(row[-1] ^ 1), message.format(row[-1], row[-1] ^ 1))
        for row in CATALOGUE.values()
    ]


def test_a_check_value_that_has_too_many_bits_is_left_to_another_rule(tmp_path):
    row = CATALOGUE["gsm"][:-1]
    for check, is_reported in ((7, True), (8, False)):
        rows = reported(tmp_path, checksums({"gsm": crc(*row, check)}), "ICD091")
        assert bool(rows) == is_reported


@pytest.mark.parametrize(
    ("kind", "width", "init", "xor_out", "value"),
    [
        ("sum", 8, 0, 0, 0xDD),
        ("sum", 16, 1, 0, 0x1DE),
        ("sum", 8, 0, 0xFF, 0x22),
        ("xor", 8, 0, 0, 0x31),
        ("xor", 8, 0xFF, 0, 0xCE),
        ("fletcher", 16, 0, 0, 0x15DD),
        ("fletcher_255", 16, 0, 0, 0x1EDE),
    ],
)
def test_check_values_of_sums_need_no_polynomial(
    kind, width, init, xor_out, value, tmp_path
):
    row = f"kind: {kind}, width: {width}"
    row += f", init: {init}" * bool(init) + f", xor_out: {xor_out}" * bool(xor_out)
    text = checksums(
        {"right": f"{row}, check: {value}", "wrong": f"{row}, check: {value ^ 1}"}
    )
    assert [marked for marked, _ in reported(tmp_path, text, "ICD091")] == [
        str(value ^ 1)
    ]


@pytest.mark.parametrize(
    "change",
    [
        ("width: 8", "width: 0"),
        ("width: 8", "width: 65"),
        ("width: 8", "width: true"),
        ("polynomial: 7", "polynomial: 256"),
        ("polynomial: 7", "polynomial: -1"),
        ("polynomial: 7, ", ""),
        ("init: 0", "init: 256"),
        ("init: 0", "init: x"),
        ("xor_out: 0", "xor_out: 256"),
        ("kind: crc", "kind: other"),
        ("check: 1", "check: true"),
        ("check: 1", "check: -1"),
    ],
    ids=" to ".join,
)
def test_parameters_that_are_wrong_themselves_give_no_check_value(change, tmp_path):
    text = checksums({"crc8": crc(8, 7, 0, False, False, 0, 1)})
    assert len(reported(tmp_path, text, "ICD091")) == 1
    old, new = change
    assert old in text
    assert reported(tmp_path, text.replace(old, new), "ICD091") == []


def test_widths_up_to_64_bits_are_computed(tmp_path):
    """The format allows up to 32 bits; the report about more does not hide this one."""
    xz = (64, 0x42F0E1EBA9EA3693, 2**64 - 1, True, True, 2**64 - 1)
    for check, number in ((0x995DC9BBDF1939FA, 0), (1, 1)):
        rows = reported(tmp_path, checksums({"xz": crc(*xz, check)}), "ICD091")
        assert len(rows) == number


@given(st.data())
@settings(max_examples=40, deadline=None)
def test_a_checksum_of_a_polynomial_is_the_remainder(data):
    """Division with remainder of the whole message as one number."""
    width = data.draw(st.integers(1, 40))
    polynomial = data.draw(st.integers(0, 2**width - 1))
    message = data.draw(st.binary(max_size=12))
    rest = int.from_bytes(message, "big") << width
    for bit in range(rest.bit_length() - 1, width - 1, -1):
        if rest >> bit & 1:
            rest ^= (1 << width | polynomial) << bit - width
    assert checksum.crc(message, width, polynomial, 0, False, False, 0) == rest


def test_sections_are_all_mappings_of_the_section_at_any_depth(tmp_path):
    text = """\
protocol:
  log_mask: {bytes: 2, frame_bytes: 6}
  msdos_time:
    bits: 32
    parts: [{at: 0, bits: 5, name: second}, {at: 5, bits: 6, name: minute}]
"""
    (node,) = load([write(tmp_path, text)]).icd.nodes
    protocol = node.source["protocol"]
    time = protocol["msdos_time"]
    expected = [protocol, protocol["log_mask"], time, *time["parts"]]
    assert sorted(map(id, sections(node))) == sorted(map(id, expected))
    (bare,) = load([write(tmp_path, "messages: []\n")]).icd.nodes
    assert [*sections(bare)] == []


def layout(*rows: str, size: str = "entry_bytes: 100") -> str:
    lines = "".join(f"      - {{{row}}}\n" for row in rows)
    return f"protocol:\n  index_file:\n    {size}\n    entry:\n{lines}"


def row(byte: int, length: int, name: str) -> str:
    return f"byte: {byte}, bytes: {length}, name: {name}, type: uint"


def test_neighbouring_rows_do_not_overlap(tmp_path):
    text = layout(row(0, 4, "A"), row(4, 2, "B"), row(7, 1, "C"), row(6, 1, "D"))
    assert reported(tmp_path, text, "ICD092") == []


def test_a_row_is_compared_with_the_row_that_ends_last(tmp_path):
    """A long row reaches behind shorter rows that begin within it."""
    text = layout(
        row(0, 8, "Long"), row(2, 1, "Short"), row(7, 2, "Late"), row(8, 1, "Last")
    )
    rows = reported_by_line(tmp_path, text, "ICD092", "entry:")
    assert rows == {
        2: [("2", "`Short` overlaps `Long` (line 7) in byte 2")],
        3: [("7", "`Late` overlaps `Long` (line 7) in byte 7")],
        4: [("8", "`Last` overlaps `Late` (line 9) in byte 8")],
    }


def test_rows_are_compared_in_the_order_of_their_positions(tmp_path):
    text = layout(row(3, 2, "Second"), row(0, 4, "First"))
    assert reported(tmp_path, text, "ICD092") == [
        ("3", "`Second` overlaps `First` (line 8) in byte 3")
    ]


@pytest.mark.parametrize("keys", ["byte: 0, name: B", "bytes: 9, name: B"])
def test_rows_without_a_place_overlap_nothing(keys, tmp_path):
    """The schema check reports them."""
    text = layout(row(0, 2, "A"), f"{keys}, type: uint", row(1, 1, "C"))
    message = "`C` overlaps `A` (line 7) in byte 1"
    assert reported(tmp_path, text, "ICD092") == [("1", message)]


def test_rows_end_within_their_size(tmp_path):
    for length, is_inside in ((9, True), (10, True), (11, False)):
        text = layout(row(0, length, "All"), size="entry_bytes: 10")
        message = "`All` ends behind byte 10, but the whole has 10 bytes (`entry_bytes: 10`, line 5)"
        expected = [] if is_inside else [(str(length), message)]
        assert reported(tmp_path, text, "ICD092") == expected
    (finding,) = findings_of(tmp_path, text, "ICD092")
    assert finding.help == "correct `byte`, `bytes` or `entry_bytes`"


def test_bits_of_a_time_end_within_its_bits(tmp_path):
    time = "protocol:\n  msdos_time:\n    bits: {}\n    parts: [{{at: 1, bits: {}, name: second}}]\n"
    for bits, size, is_inside in ((2, 1, True), (2, 2, False), (1, 1, False)):
        text = time.format(bits, size)
        (code, *_) = [*findings_of(tmp_path, text, "ICD092"), None]
        assert (code is None) == is_inside
    message = "`second` ends behind bit 1, but the whole has 1 bit (`bits: 1`, line 5)"
    assert reported(tmp_path, text, "ICD092") == [("1", message)]
    assert code.help == "correct `at`, or a `bits`"
    assert marked_text(text, code) == "1"


def test_a_row_without_a_name_has_its_role(tmp_path):
    """Names and roles of other types are reported by the schema check."""
    text = """\
protocol:
  unsolicited_log:
    id: 1
    message:
      - {byte: 0, bytes: 2, role: id, type: uint}
      - {byte: 1, bytes: 2, name: 7, type: uint}
      - {byte: 2, bytes: 2, role: mask, type: bytes}
    frames_byte: 9
"""
    assert [message for _, message in reported(tmp_path, text, "ICD092")] == [
        "this row overlaps `id` (line 7) in byte 1",
        "`mask` overlaps another row (line 8) in byte 2",
    ]


@given(
    st.lists(st.tuples(st.integers(0, 12), st.integers(1, 6)), min_size=1, max_size=6)
)
@settings(max_examples=30, deadline=None)
def test_rows_overlap_if_two_of_them_have_a_byte_in_common(tmp_path_factory, rows):
    folder = tmp_path_factory.getbasetemp()
    text = layout(*(row(*place, f"R{n}") for n, place in enumerate(rows)))
    ranges = sorted((at, at + size) for at, size in rows)
    # Each row that begins before the end of one in front of it.
    expected = sum(
        any(at < end for _, end in ranges[:number])
        for number, (at, _) in enumerate(ranges)
    )
    assert len(reported(folder, text, "ICD092")) == expected
