"""Rules about values of a field: members, constants, special values, limits and
displays. Each message is compared at the values where its text changes.
"""

from __future__ import annotations

import pytest

from tests.icd.files import codes, findings, status


def value(bits: int, keys: str, kind: str = "uint") -> str:
    """Return a message with one field `Value`."""
    return status(
        f"at: 0, bits: {bits}, name: Value, type: {kind}, {keys}", length=-(-bits // 8)
    )


def enumeration(bits: int, *values: str, keys: str = "") -> str:
    """Return a field of an enumeration with the members `M0`, `M1` and so on."""
    members = ", ".join(
        f"{{value: {each}, name: M{n}}}" for n, each in enumerate(values)
    )
    mode = f"at: 0, bits: {bits}, name: Mode, type: enum, enum: Kind{keys}"
    other = f"at: {bits}, bits: {8 - bits}, name: Other, type: uint"
    return f"enums: [{{name: Kind, members: [{members}]}}]\n" + status(
        mode, other, length=1
    )


def messages(folder, text: str, code: str) -> list[tuple[str, str | None]]:
    """Return messages and help of the findings, which all must have the code."""
    reported = findings(folder, text)
    assert {finding.code for finding in reported} <= {code}
    return [(finding.message, finding.help) for finding in reported]


NEGATIVE = ", because the enumeration also has negative values"


@pytest.mark.parametrize(
    ("values", "member", "also", "help"),
    [
        (["0", "4"], "`M1` = 4", "", "3 bits"),
        (["0", "4", "5"], "`M2` = 5", " (nor does another)", "3 bits"),
        (["0", "4", "5", "6"], "`M3` = 6", " (nor do 2 others)", "3 bits"),
        (["7", "4", "5", "6"], "`M0` = 7", " (nor do 3 others)", "3 bits"),
        (["0", "8"], "`M1` = 8", "", "4 bits"),
        (["1", "2, to: 4"], "`M1` = 2 to 4", "", "3 bits"),
        (["-1", "2"], "`M1` = 2", "", f"3 bits{NEGATIVE}"),
        (["-1", "0, to: 2"], "`M1` = 0 to 2", "", f"3 bits{NEGATIVE}"),
        (["-3", "0"], "`M0` = -3", "", "3 bits"),
        (["-3, to: -1", "0"], "`M0` = -3 to -1", "", "3 bits"),
    ],
)
def test_the_widest_member_that_does_not_fit_is_named_with_the_number_of_others(
    values, member, also, help, tmp_path
):
    text = f"{member} of the enumeration `Kind` does not fit the 2 bits of the field `Mode`{also}"
    expected = [(text, f"it takes {help}")]
    assert messages(tmp_path, enumeration(2, *values), "ICD030") == expected


@pytest.mark.parametrize("values", [("0", "3"), ("-2", "1"), ("-2, to: 1", "0, to: 0")])
def test_members_at_the_ends_of_a_field_fit(values, tmp_path):
    assert "ICD030" not in codes(tmp_path, enumeration(2, *values))


@pytest.mark.parametrize(
    ("const", "shown"),
    [
        (2**64 - 1, str(2**64 - 1)),
        (2**64, "of 65 bits"),
        (1 - 2**64, str(1 - 2**64)),
        (-(2**64), "of 65 bits"),
        (2**65 - 1, "of 65 bits"),
        (2**65, "of 66 bits"),
    ],
)
def test_a_constant_of_more_than_64_bits_is_not_written_out(const, shown, tmp_path):
    text = f"`const` {shown} does not fit `Value`"
    expected = [(text, "8 bits of `uint` hold 0 to 255")]
    assert messages(tmp_path, value(8, f"const: {const}"), "ICD031") == expected


def test_a_constant_is_compared_with_the_sign_of_its_enumeration(tmp_path):
    for first, hold in (
        ("-1", "-2 to 1, because the enumeration has negative values"),
        ("0", "0 to 3"),
    ):
        text = enumeration(2, first, "1", keys=", const: 4")
        expected = ("`const` 4 does not fit `Mode`", f"2 bits of `enum` hold {hold}")
        assert messages(tmp_path, text, "ICD031") == [expected]


def special(*values: str, kind: str, bits: int) -> str:
    rows = ", ".join(
        f"{{value: {each}, meaning: M{n}}}" for n, each in enumerate(values)
    )
    return value(bits, f"special: [{rows}]", kind)


@pytest.mark.parametrize(
    ("kind", "bits", "values", "is_twice"),
    [
        ("uint", 8, ("7", "8"), False),
        ("uint", 8, ("7", "7"), True),
        ("float", 32, ("0.1", "0.10000000149011612"), True),
        ("float", 64, ("0.1", "0.10000000149011612"), False),
        ("float", 32, ("1", "1.0"), True),
        ("float", 32, ("nan", "nan"), True),
        ("float", 32, ("inf", "-inf"), False),
    ],
)
def test_special_values_are_equal_if_their_bits_are(
    kind, bits, values, is_twice, tmp_path
):
    text = special(*values, kind=kind, bits=bits)
    assert codes(tmp_path, text) == ["ICD032"] * is_twice


def test_a_special_value_that_is_too_large_for_a_float_is_reported_once_per_entry(
    tmp_path,
):
    text = special("1.0e+39", "1.0e+39", kind="float", bits=32)
    beyond = "it is beyond what a 32-bit float holds"
    expected = [("the special value 1e+39 does not fit `Value`", beyond)] * 2
    assert messages(tmp_path, text, "ICD032") == expected
    assert codes(tmp_path, special("1.0e+39", kind="float", bits=64)) == []


def test_a_special_value_of_a_float_without_a_valid_width_has_only_the_width_reported(
    tmp_path,
):
    assert codes(tmp_path, special("1.5", kind="float", bits=16)) == ["ICD022"]


def test_a_special_value_out_of_range_is_no_duplicate(tmp_path):
    expected = (
        "the special value 256 does not fit `Value`",
        "8 bits of `uint` hold 0 to 255",
    )
    text = special("256", "255", "0", kind="uint", bits=8)
    assert messages(tmp_path, text, "ICD032") == [expected]


OF_BITS = ("hex", "binary")
OF_NUMBERS = ("decimals", "digits")
SCALED = ("has a scale, so that its value is a physical one", "number")
DISPLAYS = {
    # Type, bits and keys of a field: the words for it, and the advice for each kind of
    # display; None where the display suits.
    ("uint", 8, ""): (
        "an unsigned integer without a scale",
        None,
        "remove `display`, or use `hex` or `binary`",
    ),
    ("int", 8, ""): (
        "a signed integer without a scale",
        "use `type: uint` for a bit pattern, or remove `display`",
        "remove `display`",
    ),
    ("float", 32, ""): ("a float", "use `{decimals: N}` or `{digits: N}`", None),
    ("bool", 1, ""): ("a flag", "remove `display`", "remove `display`"),
    ("bytes", 8, ""): ("`bytes`", "remove `display`", "remove `display`"),
    ("text", 8, ""): ("`text`", "remove `display`", "remove `display`"),
    ("uint", 8, "formula: raw*2, "): (
        "",
        "use `{decimals: N}` or `{digits: N}`",
        None,
    ),
    ("int", 8, "points: [[0, 0], [1, 1]], outside: clamp, "): (
        "",
        "use `{decimals: N}` or `{digits: N}`",
        None,
    ),
}


@pytest.mark.parametrize("field", DISPLAYS, ids=lambda field: f"{field[0]} {field[2]}")
def test_a_display_suits_the_type_and_scale_of_its_field(field, tmp_path):
    kind, bits, keys = field
    words, of_bits, of_numbers = DISPLAYS[field]
    for format_ in OF_BITS:
        what = words.removesuffix(" without a scale")
        text = f"is {what}" if words else SCALED[0]
        expected = [(f"`Value` {text}, which `{format_}` does not display", of_bits)]
        got = messages(
            tmp_path, value(bits, f"{keys}display: {format_}", kind), "ICD036"
        )
        assert got == (expected if of_bits else [])
    for format_ in OF_NUMBERS:
        expected = [(f"`Value` is {words}: its value has no {format_}", of_numbers)]
        display = f"{keys}display: {{{format_}: 3}}"
        got = messages(tmp_path, value(bits, display, kind), "ICD036")
        assert got == (expected if of_numbers else [])


def test_an_enumeration_has_a_pattern_of_bits_unless_it_is_negative(tmp_path):
    for first, words in (("0", ""), ("-1", "an enumeration with negative values")):
        text = enumeration(2, first, "1", keys=", display: hex")
        message = f"`Mode` is {words}, which `hex` does not display"
        expected = [(message, "remove `display`")] if words else []
        assert messages(tmp_path, text, "ICD036") == expected
        text = enumeration(2, first, "1", keys=", display: {digits: 3}")
        message = f"`Mode` is {words or 'an enumeration'}: its value has no digits"
        or_bits = "" if words else ", or use `hex` or `binary`"
        expected = [(message, f"remove `display`{or_bits}")]
        assert messages(tmp_path, text, "ICD036") == expected


@pytest.mark.parametrize(
    ("keys", "inside", "shown"),
    [
        ("min: 10, max: 20", range(10, 21), "`min: 10` and `max: 20`"),
        ("above: 10, below: 20", range(11, 20), "`above: 10` and `below: 20`"),
        ("min: 10, above: 10", range(11, 256), "`min: 10` and `above: 10`"),
        ("min: 11, above: 10", range(11, 256), "`min: 11` and `above: 10`"),
        ("max: 20, below: 20", range(20), "`max: 20` and `below: 20`"),
        ("max: 19, below: 20", range(20), "`max: 19` and `below: 20`"),
    ],
)
def test_a_constant_is_within_the_limits_of_its_field(keys, inside, shown, tmp_path):
    ends = {0, 255, inside[0] - 1, inside[0], inside[-1], inside[-1] + 1} - {-1, 256}
    for const in sorted(ends):
        message = f"`const: {const}` of `Value` is outside {shown}"
        expected = [] if const in inside else [(message, "correct one of them")]
        text = value(8, f"const: {const}, {keys}")
        assert messages(tmp_path, text, "ICD034") == expected


def test_the_limits_of_a_scaled_constant_are_physical(tmp_path):
    """A negative factor exchanges the ends. The help gives the physical value."""
    for const, physical in ((4, "8"), (5, "7.5"), (6, ""), (10, ""), (11, "4.5")):
        message = (
            f"`const: {const}` of `Value` is outside `above: 4.5` and `below: 7.5`"
        )
        expected = [(message, f"its physical value is {physical}")] if physical else []
        keys = f"formula: 10 - raw/2, const: {const}, above: 4.5, below: 7.5"
        assert messages(tmp_path, value(8, keys), "ICD034") == expected


@pytest.mark.parametrize(
    ("limits", "inside"),
    [
        ("min: 4.5, below: 7.5", range(6, 12)),
        ("above: 4.5, max: 7.5", range(5, 11)),
        ("above: 4.6, max: 7.4", range(6, 11)),
    ],
)
def test_an_open_limit_stays_open_under_a_negative_factor(limits, inside, tmp_path):
    for const in (4, 5, 6, 10, 11, 12):
        text = value(8, f"formula: 10 - raw/2, const: {const}, {limits}")
        assert (codes(tmp_path, text) == []) == (const in inside)


def test_a_constant_out_of_range_is_not_compared_with_limits(tmp_path):
    for const, expected in (
        (-1, "ICD031"),
        (0, "ICD034"),
        (255, "ICD034"),
        (256, "ICD031"),
    ):
        text = value(8, f"const: {const}, min: 100, max: 200")
        assert codes(tmp_path, text) == [expected]


@pytest.mark.parametrize(
    ("keys", "values"),
    [
        ("min: 256", "0 to 255"),
        ("max: -1", "0 to 255"),
        ("formula: 10 - raw/2, min: 11", "-117.5 to 10"),
        ("formula: raw/8 + 1, max: 0.5", "1 to 32.875"),
    ],
)
def test_the_values_of_a_field_are_listed_if_its_limits_exclude_them(
    keys, values, tmp_path
):
    key = keys.rpartition(", ")[2]
    message = f"no value of `Value` is within `{key}`"
    expected = [(message, f"its values go from {values}")]
    assert messages(tmp_path, value(8, keys), "ICD034") == expected


def test_limits_of_curves_are_not_compared_with_raw_values(tmp_path):
    """The physical values of a polynomial or a table are not those of its ends."""
    for keys in ("formula: raw^2 + 300", "points: [[0, 300], [255, 400]]"):
        assert codes(tmp_path, value(8, f"{keys}, min: 290, max: 600")) == []


def test_a_truth_value_is_no_number_among_special_values(tmp_path):
    text = special("1", "true", kind="uint", bits=8)
    assert codes(tmp_path, text) == ["ICD010"]
