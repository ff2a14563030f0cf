"""Help and fixes for common mistakes in the YAML text and the keys of an ICD."""

from __future__ import annotations

import pytest
import yaml
from hypothesis import given
from hypothesis import strategies as st

from icdgen.diagnostics import Remedy
from icdgen.icd import remedies
from tests.limits import assert_limits

TABS = "indent with spaces: YAML does not allow tabs"
COLON = "a colon followed by a space begins a value: put the text in quotes if they belong to it, or correct the indentation"
NESTED = "within { }, put the text in quotes if it has brackets"
OPEN = "a bracket before this place is not closed, or a comma is missing: `{at: 0, bits: 8, name: Mode}`"


@pytest.mark.parametrize(
    ("problem", "line", "column", "help"),
    [
        ("found a tab character", "x", 0, TABS),
        ("anything", "a\tb", 1, TABS),
        ("anything", "a\tb", 0, ""),
        ("found character '@' that cannot start any token", "a: @b", 3,
            "a text cannot begin with @: put the text in quotes"),
        ("that cannot start any token", "a:", 2, ""),
        ("mapping values are not allowed here", "a: b: c", 4, COLON),
        ("expected ',' or '}'", "{a: b[", 5, NESTED),
        ("expected ',' or '}'", "{a: b{", 5, NESTED),
        ("expected ',' or '}'", "{a: b]", 5, NESTED),
        ("expected ',' or '}'", "{a: b}", 5, OPEN),
        ("expected ',' or '}'", "{a: b", 5, OPEN),
        ("expected the node content", "a", 0, ""),
    ],
)  # fmt: skip
def test_syntax_errors_are_explained(problem, line, column, help):
    assert remedies.of_syntax(problem, line, column) == help


@pytest.mark.parametrize(
    ("line", "marked"),
    [
        ("name: @^word and more", "@word and more"),
        ("name: ^a: b  # note", "a: b"),
        ("name: a#^b", "a#b"),
        ("name: a: ^b", "a: b"),
        ("name: a^: b", "a: b"),
        ("  - ^@a", "@a"),
        ("  - @a^b", "@ab"),
        ("- @^a", "@a"),
        ("  - name: ^@a ", "@a"),
        ("  - {name: ^@a, at: 0}", "@a"),
        ("  - {name: x, unit: ^%, at: 0}", "%"),
        ("  - {names: [^@a, b]}", "@a"),
        ("  - {names: [a, ^@b]}", "@b"),
        ("name: ^'quoted'", ""),
        ("name: ^[a]", ""),
        ("  - {name: ^'x'}", ""),
    ],
)
def test_the_value_around_a_place_is_what_needs_quotes(line, marked):
    column = line.index("^")
    line = line.replace("^", "")
    begin, end = remedies.value_around(line, column)
    assert line[begin:end] == marked


@given(st.text(st.sampled_from('ab"\\ :#{}[]@')))
def test_a_text_in_quotes_is_itself(text):
    assert yaml.safe_load(remedies.in_quotes(text)) == text


WORDS = {
    "kind": {
        "telemetry": "tlm tm telemetries status",
        "telecommand": "tc cmd command tcmd telecmd",
        "configuration": "config cfg conf",
    },
    "byte_order": {"little": "le lsb intel", "big": "be msb motorola network"},
    "bit_order": {"lsb0": "lsb lsb_first", "msb0": "msb msb_first"},
}


@pytest.mark.parametrize("key", WORDS)
def test_other_words_for_a_value_are_replaced(key):
    for value, words in WORDS[key].items():
        for word in words.split():
            expected = Remedy(f"write `{key}: {value}`", value)
            assert remedies.of_value(key, word, {}, []) == expected
            assert remedies.of_value(key, f" {word.upper()} ", {}, []) == expected
            assert remedies.of_value("other", word, {}, []) is None


@pytest.mark.parametrize(
    ("word", "type", "bits"),
    [
        ("u8", "uint", 8),
        ("u16", "uint", 16),
        ("uint32_t", "uint", 32),
        ("uint8", "uint", 8),
        ("int16", "int", 16),
        ("int8_t", "int", 8),
        ("s8", "int", 8),
        ("i64", "int", 64),
        ("S16", "int", 16),
        ("f32", "float", 32),
        ("float64", "float", 64),
        ("16", "int", 16),
    ],
)
def test_a_type_with_a_width_becomes_a_type_if_the_width_is_right(word, type, bits):
    help = f"write `type: {type}` with `bits: {bits}`"
    for own, fix in ((bits, type), (bits + 1, ""), (None, "")):
        assert remedies.of_value("type", word, {"bits": own}, []) == Remedy(help, fix)


@pytest.mark.parametrize(
    "word", ["f16", "float", "uint", "u", "u128", "u8t", "us8", "xu8"]
)
def test_words_that_are_no_type_with_a_width_are_not_corrected(word):
    assert remedies.of_value("type", word, {"bits": 8}, []) is None


DOUBLE = (
    "write `type: float` with `bits: 64`, or `int` or `uint` if the raw value is an "
    "integer with a formula"
)


@pytest.mark.parametrize(
    ("word", "bits", "help", "fix"),
    [
        ("double", 64, DOUBLE, "float"),
        ("double", 32, DOUBLE, ""),
        ("unsigned", 8, "write `type: uint`", ""),
        ("signed", 8, "write `type: int`", ""),
        ("integer", 8, "write `type: int`", ""),
        ("Boolean", 1, "write `type: bool` with `bits: 1`", "bool"),
        ("flag", 8, "write `type: bool` with `bits: 1`", ""),
        ("enumeration", 8, "write `type: enum`", ""),
        ("string", 8, "write `type: text`", ""),
        ("str", 8, "write `type: text`", ""),
        ("char", 8, "write `type: uint` with `bits: 8`", "uint"),
        ("byte", 16, "write `type: uint` with `bits: 8`", ""),
    ],
)  # fmt: skip
def test_words_for_types_are_explained(word, bits, help, fix):
    assert remedies.of_value("type", word, {"bits": bits}, []) == Remedy(help, fix)


def test_a_similar_value_is_suggested():
    allowed = ["none", "odd", "even"]
    assert remedies.of_value("parity", "Nome", {}, allowed) == Remedy(
        "did you mean `none`?", "none"
    )
    assert remedies.of_value("parity", "mark", {}, allowed) is None


@pytest.mark.parametrize(
    ("wanted", "written", "expected"),
    [
        ("boolean", "yes", "true"),
        ("boolean", "Y", "true"),
        ("boolean", "ON", "true"),
        ("boolean", "true", "true"),
        ("boolean", "no", "false"),
        ("boolean", "n", "false"),
        ("boolean", "off", "false"),
        ("boolean", "False", "false"),
        ("boolean", "1", ""),
        (["string", "integer"], "5.5", '"5.5"'),
        ("string", "2020-01-01", '"2020-01-01"'),
        ("string", "12:30", '"12:30"'),
        ("string", "'5'", ""),
        ("string", "!x 5", ""),
        ("integer", "'5'", "5"),
        ("integer", '"0x1F"', "0x1F"),
        ("integer", "5.0", ""),
        ("number", "5.0", "5.0"),
        (["integer", "number"], "'5.0'", "5.0"),
        ("integer", "five", ""),
        ("object", "5", ""),
    ],
)
def test_a_value_is_written_as_the_type_that_is_wanted(wanted, written, expected):
    assert remedies.of_type(wanted, written) == expected


@pytest.mark.parametrize(
    ("written", "help"),
    [
        ("yes", 'write "yes" in quotes if it is text, true if it is a boolean'),
        ("Off", 'write "Off" in quotes if it is text, false if it is a boolean'),
        ("nan", 'write "nan" in quotes if it is text'),
        ("1_000", 'write "1_000" in quotes if it is text, 1000 if it is a number'),
        ("0b11", 'write "0b11" in quotes if it is text, 3 if it is a number'),
        ("1e5", 'write "1e5" in quotes if it is text, 1.0e+5 if it is a number'),
        ("010", 'write "010" in quotes if it is text, a plain decimal or 0x number if it is a number'),
        ("12:30", 'write "12:30" in quotes if it is text, a plain decimal or 0x number if it is a number'),
    ],
)  # fmt: skip
def test_an_ambiguous_word_is_text_or_a_value(written, help):
    assert remedies.of_ambiguous(written) == help


@pytest.mark.parametrize(
    ("written", "plain"),
    [
        ("5", "5"),
        ("+5", "5"),
        ("-5", "-5"),
        ("0", "0"),
        ("-0", "-0"),
        ("1_000_000", "1000000"),
        ("0x1f", "0x1f"),
        ("0X1F", "0x1F"),
        ("0b101", "5"),
        ("0B11", "3"),
        ("0o17", "15"),
        ("0O17", "15"),
        ("017", ""),
        ("00", ""),
        ("00.5", ""),
        ("1.50", "1.50"),
        (".5", "0.5"),
        ("5.", "5"),
        ("-.5", "-0.5"),
        ("1e20", "1.0e+20"),
        ("1E20", "1.0e+20"),
        ("1.5e-3", "1.5e-3"),
        ("1.5e+3", "1.5e+3"),
        ("2.e1", "2.0e+1"),
        ("1e99", "1.0e+99"),
        ("1e100", ""),
        ("1e", ""),
        ("12:30", ""),
        ("five", ""),
        ("0x", ""),
        ("0b12", ""),
        ("0o18", ""),
    ],
)
def test_a_number_has_a_plain_spelling(written, plain):
    assert remedies.plain_number(written) == plain


def test_long_numbers_are_not_converted():
    assert_limits(lambda digits: bool(remedies.plain_number("1" * digits)), most=30)


@given(st.decimals(-1000, 1000, allow_nan=False, places=3) | st.floats(1e-9, 1e9))
def test_a_plain_number_has_the_same_value_for_each_reader(number):
    plain = remedies.plain_number(str(number))
    assert plain and float(plain) == float(number)
    assert yaml.safe_load(plain) == float(number)


def test_positions_in_bytes_are_converted_to_bits():
    keys = ["at", "bits"]
    at = "the first bit, if bytes count from 0"
    bits = "the width in bits"
    for key, value, help in (
        ("byte", 2, f"write `at: 16`, {at}"),
        ("Byte", 0, f"write `at: 0`, {at}"),
        ("bytes", 4, f"write `bits: 32`, {bits}"),
        ("bytes", 65535, f"write `bits: 524280`, {bits}"),
        ("bytes", 65536, f"write `bits:`, {bits}"),
        ("bytes", -1, f"write `bits:`, {bits}"),
        ("bytes", True, f"write `bits:`, {bits}"),
        ("bytes", "4", f"write `bits:`, {bits}"),
    ):
        assert remedies.of_key(key, value, keys) == Remedy(help)
    assert remedies.of_key("byte", 2, ["bits"]) is None
    assert remedies.of_key("bytes", 2, ["at"]) is None


@pytest.mark.parametrize(
    "key",
    ["stream", "checksums", "client", "message_id", "errors", "uart", "i2c", "can"],
)
def test_keys_of_earlier_versions_are_converted_by_fmt(key):
    help = "it is in `link:` now; `icdgen fmt` converts the file"
    assert remedies.of_key(key, 1, ["link"]) == Remedy(help)
    assert remedies.of_key(key, 1, ["other"]) is None


@pytest.mark.parametrize(
    "key",
    ["reasons", "acknowledge", "unsolicited", "message_types", "telecommand", "telemetry", "extended"],
)  # fmt: skip
def test_keys_of_earlier_links_are_converted_by_fmt(key):
    help = "it is in `packets:`, `commands:` and `requests:` now; `icdgen fmt` converts the file"
    assert remedies.of_key(key, 1, ["commands"]) == Remedy(help)
    assert remedies.of_key(key, 1, ["other"]) is None


@pytest.mark.parametrize(
    "key", ["count", "Repeat", "array", "times", "elements", "length"]
)
def test_only_fields_are_repeated(key):
    array = "write `count:`: `{at: 0, bits: 16, count: 6, name: Temperatures, type: int}` is an array of six numbers"
    other = "only fields can be repeated, with `count:`; write anything else as often as it occurs"
    assert remedies.of_key(key, 3, ["count"]) == Remedy(array)
    assert remedies.of_key(key, 3, ["name"]) == Remedy(other)


@pytest.mark.parametrize(
    ("key", "known", "help", "fix"),
    [
        ("covers", ["name"], "write it at the field with the role `checksum`", ""),
        ("1", ["name"], "write decimals with a point, not with a comma: `formula: raw*0.1`", ""),
        ("offset", ["at"], "write `at:`, in bits", ""),
        ("Scale", ["formula"], "write `formula: raw*0.01`", ""),
        ("factor", ["formula"], "write `formula: raw*0.01`", ""),
        ("size", ["bits"], "write `bits:`, or the `length:` of a message in bytes", ""),
        ("width", ["bits"], "write `bits:`", "bits"),
        ("description", ["summary"], "write `summary:`", "summary"),
        ("Comment", ["summary"], "write `summary:`", "summary"),
        ("values", ["enum"], "write `enum:`, with the members under `enums:`", ""),
        ("summry", ["summary"], "did you mean `summary`?", "summary"),
    ],
)  # fmt: skip
def test_a_wrong_key_is_replaced(key, known, help, fix):
    assert remedies.of_key(key, 1, known) == Remedy(help, fix)


@pytest.mark.parametrize(
    "key", ["offset", "scale", "factor", "width", "comment", "values", "xyz"]
)
def test_a_key_that_the_mapping_does_not_have_is_not_suggested(key):
    assert remedies.of_key(key, 1, ["name", "link", "commands"]) is None
