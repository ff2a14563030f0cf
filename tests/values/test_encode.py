"""``icdgen encode`` with values as ``name=value``."""

from __future__ import annotations

import struct
from fractions import Fraction

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from icdgen.describe.numbers import exact_text
from icdgen.icd import floats
from icdgen.values import numbers
from icdgen.values.encode import encode
from icdgen.values.errors import BadValue
from tests.values.decoding import decode

SPEED = {"x": "1", "y": "-1", "timeout": "0"}
EVERYTHING = {"enabled": "yes", "small": "-64", "mode": "on", "ratio": "1", "precise": "0", "Key = Code": "01020304",
              "wide": "0", "wide angle": "0", "gain": "0"}  # fmt: skip


def given_as(values: dict[str, str], **changes: str) -> list[str]:
    return [f"{name}={value}" for name, value in (values | changes).items()]


def speed(icd, raw=False, **changes):
    return encode(icd, "top", "Set Speed", given_as(SPEED, **changes), raw=raw)


def everything(icd, name: str, value: str, raw=False):
    frame = encode(
        icd, "top", "Everything", given_as(EVERYTHING, **{name: value}), raw=raw
    )
    return next(row for row in frame.rows if row.field.name.lower() == name.lower()).raw


def refusal(call, *arguments, **changes) -> BadValue:
    with pytest.raises(BadValue) as caught:
        call(*arguments, **changes)
    return caught.value


def test_physical_values_by_words_of_the_fields_and_constants_by_themselves(icd):
    frame = encode(icd, "top", "Set Speed", ["x=100", "y=-100", "timeout=no timeout"])
    assert frame.data.hex(" ") == "10 27 f0 d8 5a ff"
    assert decode(icd, "top", "17", frame.data).to_json() == frame.to_json()


def test_raw_values(icd):
    assert (
        speed(icd, raw=True, x="100", y="-0x64", timeout="0xff").data.hex(" ")
        == "64 00 9c ff 5a ff"
    )


def test_decimals_are_taken_exactly_and_ties_go_to_even(icd):
    assert [
        speed(icd, x=x).rows[0].raw
        for x in ("0.005", "0.015", "-0.005", "0.0050000000000000000001")
    ] == [
        0,
        2,
        0,
        1,
    ]
    assert speed(icd, x="1/3").rows[0].raw == 33
    assert speed(icd, x="1e-2").rows[0].raw == 1


def test_rounding_is_pointed_out(icd):
    assert speed(icd, x="0.016").rows[0].remarks == ("rounded from 0.016",)
    assert speed(icd, x="0.02").rows[0].remarks == ()


@pytest.mark.parametrize("text", ["1.5 deg/s", "1.5deg/s", "1.5", "+1.50", "15e-1"])
def test_the_unit_may_be_written_out(icd, text):
    assert speed(icd, x=text).rows[0].raw == 150


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        (
            {"x": "327.68"},
            "Commanded X speed: takes -327.68 to 327.67 deg/s, not 327.68",
        ),
        ({"x": "1e999"}, "not 1e999"),
        ({"x": "nan"}, "Commanded X speed: `nan` is not a number (in deg/s)"),
        ({"x": "inf"}, "`inf` is not a number"),
        ({"x": "1 rpm"}, "`1 rpm` is not a number"),
        ({"x": ""}, "`` is not a number"),
        ({"x": "1/0"}, "`1/0` is not a number"),
        ({"x": "1_0"}, "`1_0` is not a number"),
        ({"x": "9" * 500}, "is not a number"),
        ({"timeout": "61"}, "Timeout: takes 0 to 60 s, not 61"),
        ({"timeout": "1.5"}, "Timeout: 1.5 is not a whole number"),
        ({"timeout": "256"}, "Timeout: takes 0 to 60 s, not 256"),
        ({"timeout": "-1"}, "Timeout: takes 0 to 60 s, not -1"),
        ({"magic": "0x5B"}, "Magic Number: 0x5B is not allowed: must be 90 (0x5A)"),
    ],
)
def test_values_that_do_not_fit_are_refused(icd, changes, words):
    assert words in str(refusal(speed, icd, **changes))


def test_with_raw_only_the_width_is_checked(icd):
    frame = speed(icd, raw=True, timeout="61", magic="1")
    assert frame.data[4:].hex() == "013d"
    assert [row.remarks for row in frame.rows[2:]] == [
        ("must be 90 (0x5A)",),
        ("above the maximum 60 s",),
    ]
    assert "takes 0 to 255, not 256" in str(
        refusal(speed, icd, raw=True, timeout="256")
    )
    assert "`1.5` is not a whole number" in str(refusal(speed, icd, raw=True, x="1.5"))


@pytest.mark.parametrize(
    ("name", "value", "raw"),
    [
        *(("enabled", text, 1) for text in ("true", "Yes", "ON", "1")),
        *(("enabled", text, 0) for text in ("false", "No", "OFF", "0")),
        *(
            ("mode", text, 7)
            for text in ("Auto reset", "auto_reset", "AutoReset", "reset", "7", "0x07")
        ),
        ("mode", "off", 0),
        ("ratio", "0.1", 0x3DCCCCCD),
        ("ratio", "50 %", 0x42480000),
        ("precise", "-0", 1 << 63),
        ("precise", "nan", 0x7FF8000000000000),
        ("precise", "-inf", 0xFFF0000000000000),
        ("precise", "Not Known", 0x7FF8000000000000),
        ("precise", "no data", 0xC0C3878000000000),
        ("precise", "Infinity", 0x7FF0000000000000),
        ("wide", "0xFFFFFFFFFFFFFFFF", 2**64 - 1),
        ("wide", "1e3", 1000),
        ("wide angle", "5", 41),
        ("Key = Code", "0xde 0xad be:ef", b"\xde\xad\xbe\xef"),
    ],
)
def test_every_type(icd, name, value, raw):
    assert everything(icd, name, value) == raw


@pytest.mark.parametrize(
    ("name", "value", "words"),
    [
        ("enabled", "maybe", "Enabled: `maybe` is neither true nor false"),
        (
            "mode",
            "auto",
            "Mode: `auto` fits several members; members: 0 Off, 1 On, 7 Auto reset, 9 Auto retry",
        ),
        ("mode", "nope", "Mode: `nope` is no member of Switch; members: 0 Off"),
        (
            "mode",
            "reserved",
            "Mode: `reserved` is 32 to 47: give the number; members: 0 Off, 1 On",
        ),
        ("mode", "13", "Mode: 13 is not allowed: no member of Switch; members: 0 Off"),
        (
            "mode",
            "300",
            "Mode: 300 is not allowed: no member of Switch; members: 0 Off",
        ),
        ("ratio", "1e39", "Ratio: 1e39 is beyond what a 32-bit float can represent"),
        ("ratio", "-1e39", "Ratio: takes above 0 %, not -1e39"),
        ("ratio", "0", "Ratio: takes above 0 %, not 0"),
        ("ratio", "0x3f800000", "Ratio: `0x3f800000` is not a number"),
        (
            "precise",
            "1e309",
            "Precise: 1e309 is beyond what a 64-bit float can represent",
        ),
        ("precise", "one", "Precise: `one` is not a number"),
        ("Key = Code", "0102", "Key = Code: 4 bytes are needed, 2 given"),
        (
            "Key = Code",
            "010z0304",
            "Key = Code: character 4 of the bytes: `z` is not hexadecimal",
        ),
    ],
)
def test_every_type_refuses_values_of_other_types(icd, name, value, words):
    assert words in str(refusal(everything, icd, name, value))


def test_raw_floats_are_bits_or_a_number(icd):
    assert everything(icd, "ratio", "0x7FA00001", raw=True) == 0x7FA00001
    assert everything(icd, "ratio", "0.5", raw=True) == 0x3F000000
    assert everything(icd, "mode", "13", raw=True) == 13
    assert everything(icd, "mode", "on", raw=True) == 1
    assert everything(icd, "enabled", "on", raw=True) == 1
    assert "takes 0 to 4294967295" in str(
        refusal(everything, icd, "ratio", "0x1FFFFFFFF", raw=True)
    )


def test_all_missing_fields_are_named_at_once(icd):
    error = refusal(encode, icd, "top", "Set Speed", ["y=1"])
    assert str(error) == "no value for `Commanded X speed`, `Timeout`"
    assert error.help == "give each field as name=value"


def test_all_errors_are_reported_at_once(icd):
    error = refusal(
        encode,
        icd,
        "top",
        "Set Speed",
        ["x=1000", "speed=1", "y", "nope=1", "x=2", "timeout=a"],
    )
    assert str(error).splitlines() == [
        "`speed` fits several fields: `Commanded X speed`, `Commanded Y speed` (give more of the name)",
        "`y` is not of the form name=value (for instance `speed=100`)",
        "Set Speed has no field `nope` (fields: Commanded X speed, Commanded Y speed, Magic Number, Timeout)",
        "`Commanded X speed` is given twice: 1000 and 2",
        "Commanded X speed: takes -327.68 to 327.67 deg/s, not 1000",
        "Timeout: `a` is not a number (in s)",
    ]
    assert error.help == "`icdgen show top 'Set Speed'` lists the values of each field"


def test_a_remedy_is_next_to_its_error(icd):
    error = refusal(encode, icd, "top", "Set Speed", ["x=1", "timeout=61"])
    assert str(error).splitlines() == [
        "Timeout: takes 0 to 60 s, not 61 (--raw encodes it anyway)",
        "no value for `Commanded Y speed` (give each field as name=value)",
    ]
    alone = refusal(encode, icd, "top", "Set Speed", ["x=1", "y=1", "timeout=61"])
    assert alone.help == "--raw encodes it anyway"


def test_a_message_without_fields_needs_no_values(icd):
    assert encode(icd, "top", "42", []).data == b""


@settings(deadline=None)
@given(st.binary(min_size=35, max_size=35))
def test_what_decode_shows_raw_can_be_typed_back(icd, data):
    data = data + b"\0"
    shown = decode(icd, "top", "Everything", data).rows
    typed = [f"{row.field.name}={row.raw_text}" for row in shown]
    assert encode(icd, "top", "Everything", typed, raw=True).data == data


@given(st.floats(allow_nan=False, allow_infinity=False))
def test_a_double_is_the_nearest_to_its_decimal(value):
    assert numbers.float_bits(repr(value), 64) == int.from_bytes(
        struct.pack("<d", value), "little"
    )


@given(st.integers(0, 2**32 - 1), st.fractions(0, 1))
def test_a_single_is_the_nearest_to_the_exact_decimal_not_to_a_double(bits, between):
    """The nearer of two neighbours is chosen, however close the decimal is to the
    middle.
    """
    bits = bits & 0x7F7FFFFF if (bits >> 23) & 0xFF == 0xFF else bits & 0x7FFFFFFF
    bits = min(bits, 0x7F7FFFFE)
    low, high = (
        Fraction(struct.unpack("<f", n.to_bytes(4, "little"))[0])
        for n in (bits, bits + 1)
    )
    exact = low + (high - low) * between
    half = Fraction(1, 2)
    expected = bits + (between > half or (between == half and bits & 1))
    text = f"{exact.numerator}/{exact.denominator}"
    if len(text) <= numbers.LONGEST:
        assert numbers.float_bits(text, 32) == expected


@pytest.mark.parametrize(
    ("bits", "largest"), [(32, 0x7F7FFFFF), (64, 0x7FEFFFFFFFFFFFFF)]
)
def test_numbers_up_to_the_largest_float_are_accepted(bits, largest):
    """The next number would be 2**128 (2**1024); half the distance rounds up to it."""
    highest = Fraction(floats.value_of(largest, bits))
    distance = highest - Fraction(floats.value_of(largest - 1, bits))
    assert highest + distance == 2 ** (128 if bits == 32 else 1024)
    for sign, sign_bit in ((1, 0), (-1, 1 << bits - 1)):
        for number, raw in (
            (highest, largest),
            (highest - distance, largest - 1),
            (highest + distance * Fraction(499, 1000), largest),
            ((highest + distance) / 2, largest + 1 - (1 << (23 if bits == 32 else 52))),
        ):
            assert floats.nearest(sign * number, bits) == raw | sign_bit
        with pytest.raises(OverflowError):
            floats.nearest(sign * (highest + distance / 2), bits)


@pytest.mark.parametrize("low", [0, 1, 2, 0x7FFFFF, 0x3F800000, 0x3F800001, 0x7F7FFFFE])
def test_a_number_near_the_middle_of_two_singles_is_rounded_once(low):
    """A double cannot tell such a number from the middle."""
    first, second = (Fraction(floats.value_of(raw, 32)) for raw in (low, low + 1))
    middle, little = (first + second) / 2, (second - first) / 2**60
    assert float(middle + little) == float(middle)
    even = low + (low & 1)
    numbers = (first, middle - little, middle, middle + little, second)
    expected = [low, low, even, low + 1, low + 1]
    assert [floats.nearest(number, 32) for number in numbers] == expected


def test_the_shortest_text_of_a_float_is_read_back():
    for bits in (
        0,
        1,
        0x007FFFFF,
        0x00800000,
        0x3DCCCCCD,
        0x3F800001,
        0x7F7FFFFF,
        0x80000000,
        0xC2F6E979,
    ):
        value = struct.unpack("<f", bits.to_bytes(4, "little"))[0]
        assert numbers.float_bits(floats.text_of(value, 32), 32) == bits
    assert floats.text_of(struct.unpack("<f", struct.pack("<f", 0.1))[0], 32) == "0.1"


@pytest.mark.parametrize(
    ("value", "text"),
    [
        (Fraction(-617, 50), "-12.34"),
        (Fraction(0), "0"),
        (Fraction(-1, 1000), "-0.001"),
        (Fraction(1, 3), "0.3333333333333333"),
        (Fraction(3, 2**20), "0.00000286102294921875"),
        (Fraction(1, 2**32), "2.3283064365386963e-10"),
    ],
)
def test_exact_numbers_are_shown_as_decimals_where_they_end(value, text):
    assert exact_text(value) == text


def test_a_text_is_typed_as_it_is(icd):
    sent = encode(
        icd, "top", "Version", ["software=u-blox 9", "hardware="], kind="telemetry"
    )
    assert sent.data == b"u-blox 9\0\0" + bytes(2)
    bare = encode(
        icd,
        "top",
        "Version",
        ["software=" + "ff" * 10, "hardware=3100"],
        raw=True,
        kind="telemetry",
    )
    assert bare.data == b"\xff" * 10 + b"1\0"


def test_an_overlay_field_shows_the_bits_of_other_fields_and_cannot_be_set(icd):
    sent = encode(icd, "top", "Seen Twice", ["low=0x5A", "high=0x81"], kind="telemetry")
    assert sent.data == b"\x5a\x81"
    assert [(row.field.name, row.text) for row in sent.rows] == [
        ("Low", "90"),
        ("High", "129"),
        ("Most", "-1013.5"),
    ]
    for raw in (True, False):
        refused = refusal(
            encode,
            icd,
            "top",
            "Seen Twice",
            ["low=1", "high=2", "most=3"],
            raw=raw,
            kind="telemetry",
        )
        assert str(refused) == "Most: an overlay field has no bits of its own"


@pytest.mark.parametrize("text", ["12345678901", "\u00b5-blox"])
def test_a_text_that_does_not_fit_is_refused(icd, text):
    refused = refusal(
        encode,
        icd,
        "top",
        "Version",
        [f"software={text}", "hardware=1"],
        kind="telemetry",
    )
    assert str(refused) == f"Software: `{text}` is not of up to 10 ASCII characters"


def test_an_array_takes_all_of_its_values_in_brackets(icd):
    frame = encode(
        icd, "top", "Set Heaters", ["temperatures=[1, 2.5, -3]", "Levels=[1,4095]"]
    )
    assert frame.data.hex(" ") == "64 00 fa 00 d4 fe 01 f0 ff"
    assert [row.text for row in frame.rows] == ["1", "2.5", "-3", "1", "4095"]


@pytest.mark.parametrize("name", ["Temperatures", "temperatures", "temps"])
def test_an_element_of_an_array_is_given_by_its_index(icd, name):
    values = [f"{name}[{index}]={index}" for index in range(3)]
    assert (
        encode(icd, "top", "Set Heaters", [*values, "levels=[0, 0]"]).data.hex(" ")
        == "00 00 64 00 c8 00 00 00 00"
    )


@pytest.mark.parametrize(
    ("values", "expected"),
    [
        (
            ["temperatures=[1, 2]", "levels=[0,0]"],
            "`temperatures` takes 3 values in brackets, 2 given",
        ),
        (
            ["temperatures=7", "levels=[0,0]"],
            "`temperatures` takes 3 values in brackets, not 7",
        ),
        (
            ["temperatures=[1, 2, 81]", "levels=[0,0]"],
            "Temperatures[2]: takes -327.68 to 80 C, not 81",
        ),
        (
            ["temperatures=[1, 2, 3]", "levels=[0,4096]"],
            "Levels[1]: takes 0 to 4095, not 4096",
        ),
        (
            ["temps=[1,2,3]", "temps[1]=1", "levels=[0,0]"],
            "`Temperatures[1]` is given twice: 2 and 1",
        ),
        (["temps=[1,2,3]", "levels[0]=1"], "no value for `Levels[1]`"),
    ],
)
def test_errors_of_an_array_name_the_array_or_its_element(icd, values, expected):
    with pytest.raises(BadValue) as caught:
        encode(icd, "top", "Set Heaters", values)
    assert expected in str(caught.value)


def test_a_value_beyond_the_limits_and_one_beyond_the_type_are_refused_with_the_same_range(
    icd,
):
    ranges = {
        str(refusal(speed, icd, timeout=text)).rpartition(", not ")[0]
        for text in ("61", "254", "256", "100000", "-1")
    }
    assert ranges == {"Timeout: takes 0 to 60 s"}
