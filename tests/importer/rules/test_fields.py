"""Roles of a row become a field with its place, size, type, scale and limits."""

from __future__ import annotations

import pytest

from icdgen.importer import profile
from icdgen.importer.rules.bit_order import Order
from icdgen.importer.rules.cells import Roles
from icdgen.importer.rules.fields import FieldReader, scale_formula
from icdgen.importer.rules.notes import Notes
from icdgen.importer.rules.rows import DataRow
from tests.importer.rules.small import rule, table
from tests.limits import assert_limits

LITTLE = Order("little", "lsb0")
WORDS = profile.load()


def read(*rows: dict[str, str], words=WORDS, members=(), **keys):
    """Return the fields of rows, and the findings without their common beginning.

    Each row has the name `X` and the type `uint` unless it states others.
    """
    notes, source = Notes(), table(*["x"] * len(rows))
    reader = FieldReader(rule(**keys), source, words, LITTLE, notes)
    fields = []
    for given, row in zip(rows, source.rows, strict=True):
        roles = Roles({"name": "X", "type": "uint"} | given, DataRow({}, row))
        roles.members = list(members)
        fields += reader.read(roles)
    where = "table 7, field `X`: "
    return fields, [
        (f.code, f.severity, f.message.removeprefix(where))
        for f in notes.import_findings
    ]


def field(**given: str):
    (result,), findings = read(given)
    assert findings == []
    return result


def problem(*, words=WORDS, rule_keys=None, **given: str) -> tuple:
    """Return the only finding of a row that gives no field."""
    fields, (finding,) = read(given, words=words, **rule_keys or {})
    assert fields == []
    return finding


def size(**given: str) -> tuple[int, int]:
    result = field(**given)
    return result.bits, result.count


def test_a_row_needs_a_name_and_a_type():
    assert problem(name="", byte="1") == (
        "IMP025",
        "error",
        "table 7: the row `` gives no name",
    )
    assert problem(type="") == ("IMP026", "error", "its type is not stated")
    text = f"the type `{'q' * 40}` is unknown"
    assert problem(type="q" * 50) == ("IMP026", "error", text)


def test_a_reserved_field_needs_no_type():
    for type in ("", "-", "strange"):
        result = field(name="Reserved", type=type, bits="3")
        assert (result.kind, result.bits) == ("reserved", 3)
    assert field(name="Reserved", type="u8").kind == "uint"


def test_types_of_the_profile_precede_common_names():
    own = {"types": {"Big U8": {"type": "int", "bits": 24}, "odd": {"type": "bytes"}}}
    words = profile.Profile(WORDS.data, own, [])
    (result, other), findings = read(
        {"type": "bigu8"}, {"type": "ODD", "bits": "16"}, words=words
    )
    assert findings == []
    assert (result.kind, result.bits, other.kind) == ("int", 24, "bytes")


@pytest.mark.parametrize(
    ("given", "expected"),
    [
        ({"bits": "12"}, (12, 0)),
        ({"bytes": "3"}, (24, 0)),
        ({"type": "u16"}, (16, 0)),
        ({"type": "u16", "bits": "16"}, (16, 0)),
        ({"type": "u16", "bytes": "2"}, (16, 0)),
        ({"type": "u16", "count": "3"}, (16, 3)),
        # Some tables print the size of an element, others that of the field.
        ({"type": "u16", "count": "3", "bytes": "6"}, (16, 3)),
        ({"type": "u16", "count": "3", "bytes": "2"}, (16, 3)),
        ({"type": "u16", "count": "3", "bits": "16"}, (16, 3)),
        ({"bits": "4", "count": "3"}, (4, 3)),
        ({"bytes": "6", "count": "3"}, (16, 3)),
        ({"bits": "4", "count": "1"}, (4, 0)),
        ({"type": "text", "count": "5"}, (40, 0)),
        ({"type": "bytes", "count": "5", "bytes": "5"}, (40, 0)),
        ({"type": "bytes", "count": "2", "bytes": "6"}, (24, 2)),
        ({"type": "bool"}, (1, 0)),
        ({"type": "bool", "bits": "8"}, (8, 0)),
        ({"byte": "2", "last_byte": "4"}, (24, 0)),
        ({"byte": "2", "last_byte": "5", "count": "2"}, (16, 2)),
        ({"bit": "2", "last_bit": "4"}, (3, 0)),
        ({"rest": "x", "up_to": "9"}, (8, 0)),
        ({"counter": "N", "up_to": "9", "type": "u16"}, (16, 0)),
        # In a group, the count is that of the group.
        ({"bits": "4", "count": "3", "group": "G"}, (4, 0)),
    ],
)
def test_a_size_comes_from_type_size_count_or_range(given, expected):
    assert size(**given) == expected


@pytest.mark.parametrize(
    ("given", "message"),
    [
        ({}, "its size is not given"),
        ({"byte": "1"}, "its size is not given"),
        ({"bit": "1"}, "its size is not given"),
        ({"group": "G", "rest": "x"}, "its size is not given"),
        ({"type": "u16", "bits": "8"}, "its type `u16` has 16 bits, its size is 8"),
        ({"type": "u16", "bytes": "3", "count": "2"},
         "its type `u16` has 16 bits times 2, its size is 24"),
        ({"bytes": "4", "count": "3"}, "3 elements do not fit into 4 bytes"),
        ({"byte": "0", "last_byte": "1", "bits": "12"},
         "its position covers 16 bits, its size is 12"),
        ({"byte": "0", "last_byte": "1", "count": "2", "bits": "4"},
         "its position covers 16 bits, its size is 8"),
        ({"byte": "0", "last_byte": "2", "count": "5"},
         "its position covers 24 bits, its size is 20"),
    ],
)  # fmt: skip
def test_missing_and_contradictory_sizes_are_reported(given, message):
    assert problem(**given) == ("IMP105", "error", message)


def test_a_position_without_a_size_is_a_unit_if_the_rule_says_so():
    rows = ({"byte": "1"}, {"byte": "2", "bit": "3"}, {"bit": "20"})
    fields, findings = read(*rows, is_unit_wide=True)
    assert [(f.at, f.bits) for f in fields] == [(8, 8), (19, 1), (20, 1)]
    assert findings == []
    assert problem(rule_keys={"is_unit_wide": True})[2] == "its size is not given"


def test_a_field_without_a_position_follows_the_field_before():
    rows = ({"byte": "2", "bits": "4"}, {"bits": "3"}, {"bits": "2", "count": "3"})
    fields, _ = read(*rows, {"bits": "1"})
    assert [(f.at, f.end) for f in fields] == [(16, 20), (20, 23), (23, 29), (29, 30)]


def test_a_field_begins_with_the_message():
    def is_accepted(byte: int) -> bool:
        fields, findings = read({"byte": str(byte), "bits": "8"}, origin=2)
        at = 8 * (byte - 2)
        text = f"it begins before the message, at bit {at}"
        assert findings == ([] if fields else [("IMP105", "error", text)])
        return [f.at for f in fields] == [at]

    assert_limits(is_accepted, least=2)


def test_a_number_has_at_most_64_bits():
    for kind in ("uint", "int", "enum"):

        def is_accepted(bits: int, kind: str = kind) -> bool:
            fields, findings = read({"bits": str(bits), "type": kind})
            text = f"a number has at most 64 bits, this one {bits}"
            assert findings == ([] if fields else [("IMP105", "error", text)])
            return bool(fields)

        assert_limits(is_accepted, most=64)
    assert size(type="bytes", bits="72") == (72, 0)


@pytest.mark.parametrize("bits", [32, 40, 48, 56, 64])
def test_a_range_of_five_to_seven_bytes_may_be_an_array(bits):
    given = {"byte": "0", "last_byte": str(bits // 8 - 1)}
    text = f"a number of {bits // 8} bytes is unusual, and only its range of bytes gives this size"
    (result,), findings = read(given)
    assert result.bits == bits
    unusual = bits not in (32, 64)
    assert findings == ([("IMP105", "warning", text)] if unusual else [])
    for more in ({"type": f"u{bits}"}, {"type": "bytes"}, {"count": str(bits // 8)}):
        assert read(given | more)[1] == []
    assert read({"bits": str(bits)})[1] == []


@pytest.mark.parametrize(
    ("role", "text", "help"),
    [
        ("byte", "x" * 50, "correct the pattern or the table file"),
        ("bits", "-1", "correct the pattern or the table file"),
        ("bits", "1-2", "correct the pattern or the table file"),
        ("byte", "1 ~ 2", "take both ends of the range: `'^{byte}(?:[-–:~]{last_byte})?$'`"),
        ("bit", "7:4", "take both ends of the range: `'^{bit}(?:[-–:~]{last_bit})?$'`"),
    ],
)  # fmt: skip
def test_a_role_that_is_no_number_is_reported(role, text, help):
    notes, source = Notes(), table("x")
    reader = FieldReader(rule(), source, WORDS, LITTLE, notes)
    given = {"name": "X", "type": "u8", role: text}
    assert reader.read(Roles(given, DataRow({}, source.rows[0]))) == []
    (finding,) = notes.import_findings
    assert (finding.code, finding.help) == ("IMP023", help)
    message = f"`{role}` is `{text[:40]}`, which is not a number"
    assert finding.message == f"table 7, field `X`: {message}"


def test_only_bytes_are_counted_in_the_base_of_the_rule():
    (result,), findings = read(
        {"byte": "10", "last_byte": "1f", "bit": "", "count": "16", "bits": "8"},
        base=16,
    )
    assert (result.at, result.count, findings) == (128, 16, [])
    assert problem(bits="1f", rule_keys={"base": 16})[0] == "IMP023"


@pytest.mark.parametrize(
    ("printed", "places"),
    [("0, 1, 3", [(0, 16), (24, 8)]), ("2,1", [(8, 16)]), ("5; 1 and 3", [(8, 8), (24, 8), (40, 8)])],
)  # fmt: skip
def test_padding_in_several_places_is_several_fields(printed, places):
    fields, findings = read({"name": "Reserved", "byte": printed})
    assert ([(f.at, f.bits) for f in fields], findings) == (places, [])
    if len(places) == 1:
        assert [(f.at, f.bits) for f in read({"byte": printed})[0]] == places
        return
    text = f"its bytes `{printed}` are not consecutive"
    assert problem(byte=printed) == ("IMP105", "error", text)
    bits = problem(bit="1, 3")
    assert bits == ("IMP105", "error", "its bits `1, 3` are not consecutive")


@pytest.mark.parametrize(
    ("scale", "offset", "bias", "formula"),
    [
        (None, None, None, ""),
        ("1.0", "0.0", "-0", ""),
        ("0.10", None, None, "raw*0.10"),
        (None, "5", None, "raw + 5"),
        (None, "-5", None, "raw - 5"),
        (None, None, "5", "raw - 5"),
        (None, None, "-5", "raw + 5"),
        ("2", "3", "4", "(raw - 4)*2 + 3"),
        ("2", "-3", "-4", "(raw + 4)*2 - 3"),
        ("1", "3", "4", "raw - 4 + 3"),
        ("-2", None, None, "raw*-2"),
    ],
)
def test_scale_offset_and_bias_are_a_formula(scale, offset, bias, formula):
    assert scale_formula(scale, offset, bias) == formula


def test_numbers_of_a_row_are_a_formula_that_precedes_the_column_of_formulas():
    given = {"bits": "8", "formula": "2 mV", "unit": "V"}
    described = field(**given).described
    assert (described.formula, described.unit) == ("raw*2", "mV")
    described = field(**given | {"formula": "2"}).described
    assert (described.formula, described.unit) == ("raw*2", "V")
    described = field(**given, scale="3", offset="n/a", bias="None").described
    assert described.formula == "raw*3"
    for text in ("", "n/a", "None"):
        assert field(bits="8", formula=text, unit=text).described.unit == ""


@pytest.mark.parametrize(
    ("printed", "unit"),
    [("(V)", "V"), ("(N)·(m)", "(N)·(m)"), ("[m/s ²]", "m/s²"), ("(kg(m))", "kg(m)")],
)
def test_a_unit_has_no_brackets_around_it(printed, unit):
    assert field(bits="8", unit=printed).described.unit == unit


@pytest.mark.parametrize(
    ("given", "finding"),
    [
        ({"formula": "sin(x)"}, ("IMP040", "the formula `sin(x)` cannot be read")),
        ({"scale": "a"}, ("IMP023", "`scale` is `a`, which is not a number")),
        ({"max": "5 V"}, ("IMP023", "`max` is `5 V`, which is not a number")),
        ({"const": "x"}, ("IMP023", "`const` is `x`, which is not a number")),
        ({"members": "0: a; b"}, ("IMP104", "`members` leaves `b`, which is no value with a name")),
    ],
)  # fmt: skip
def test_texts_that_cannot_be_read_are_reported(given, finding):
    _, ((code, severity, message),) = read({"bits": "8"} | given)
    assert (code, severity, message) == (finding[0], "error", finding[1])


@pytest.mark.parametrize(
    ("printed", "const"), [("0x5A", "0x5A"), ("5Ah", "90"), ("90", "90"), ("", "")]
)
def test_a_constant_keeps_a_hexadecimal_spelling(printed, const):
    assert field(bits="8", const=printed).described.const == const


def test_limits_are_numbers_of_an_icd():
    facts = field(bits="8", min="−3.0", max=".5", type="int").facts
    assert facts == {"min": -3, "max": 0.5}
    assert [type(value) for value in facts.values()] == [int, float]


def test_a_number_has_the_digits_of_the_source_with_a_short_exponent():
    described = field(bits="8", scale=" +1.50e-007", offset="–.5E+01").described
    assert described.formula == "raw*1.50e-7 - 0.5E+1"
    assert field(bits="8", min="-1e99", type="int").facts == {"min": -int(1e99)}
    assert field(bits="8", scale="1e000").described.formula == ""


@pytest.mark.parametrize("role", ["scale", "offset", "bias", "min", "max"])
@pytest.mark.parametrize("text", ["1e100", "-1e400", "1e-100", "1e" + "9" * 20])
def test_a_number_that_no_formula_can_have_is_reported(role, text):
    fields, findings = read({"bits": "8", role: text})
    assert len(fields) == 1 and fields[0].facts == {}
    assert fields[0].described.formula == ""
    assert findings == [
        ("IMP023", "error", f"`{role}` is `{text}`, which is not a number")
    ]


def test_limits_that_raw_values_do_not_reach_are_a_warning():
    given = {"bits": "8", "scale": "0.5", "offset": "-10"}

    def is_reached(role: str, value: str, **more: str) -> bool:
        fields, findings = read(given | more | {role: value})
        assert len(fields) == 1
        text = f"its range has the {role} {float(value):g}, its raw values give -10.0 to 117.5"
        assert findings in ([], [("IMP106", "warning", text)])
        return not findings

    assert is_reached("min", "-10") and not is_reached("min", "-10.5")
    assert is_reached("max", "117.5") and not is_reached("max", "118")
    # Signed numbers, and those that a double does not hold, are not checked.
    assert is_reached("max", "118", type="int")
    assert read({"bits": "53", "max": "1e30"})[1] != []
    assert read({"bits": "54", "max": "1e30"})[1] == []
    falling = {"bits": "8", "scale": "-1", "bias": "5"}
    assert read(falling | {"min": "-250", "max": "5"})[1] == []
    assert len(read(falling | {"min": "-251", "max": "6"})[1]) == 2


@pytest.mark.parametrize(
    ("given", "key", "value"),
    [
        ({"rest": "x"}, "count", "rest"),
        ({"counter": "N"}, "count", "N"),
        ({"counter": "N", "type": "text"}, "size", "N"),
        ({"rest": "x", "type": "bytes"}, "size", "rest"),
    ],
)
def test_a_variable_length_has_a_counter_and_a_limit(given, key, value):
    assert field(**given, up_to="9").facts == {key: value, "up_to": 9}
    (result,), findings = read(given)
    assert result.facts == {key: value}
    assert findings == [("IMP105", "error", "its greatest length is not stated")]
    assert field(**given, up_to="9", group="G", bits="8").facts == {}


@pytest.mark.parametrize(
    ("text", "members"),
    [
        ("0: off; 1: on", [(0, "off"), (1, "on")]),
        ("0=off, 1=on, or so", [(0, "off"), (1, "on, or so")]),
        ("0 off\n0x1F – on\n0b11:x", [(0, "off"), (31, "on"), (3, "x")]),
        ("-1: a;", [(-1, "a")]),
    ],
)
def test_a_cell_of_members_has_values_and_names(text, members):
    result = field(bits="8", members=text)
    assert (result.members, result.kind) == (members, "enum")


def test_members_of_lines_precede_those_of_a_cell_in_the_base_of_the_rule():
    (result,), findings = read(
        {"bits": "8", "members": "12: b"}, members=[("1f", "a")], base=16
    )
    assert (result.members, findings) == ([(0x1F, "a"), (0x12, "b")], [])
    _, findings = read({"bits": "8"}, members=[("zz", "a")])
    text = "the value `zz` of `a` is no number"
    assert findings == [("IMP023", "error", text)]
    # The members of lines make an enumeration of a field without a type.
    (result,), findings = read({"bits": "8", "type": ""}, members=[("1", "a")])
    assert (result.kind, findings) == ("enum", [])


def test_a_number_with_members_or_an_enumeration_is_an_enumeration():
    for kind in ("uint", "int", "enum"):
        result = field(bits="8", type=kind, enumeration="Mode")
        assert (result.kind, result.described.enum_title) == ("enum", "Mode")
    result = field(bits="8", members="0: a", enumeration="Mode")
    assert (result.kind, result.described.enum_title) == ("enum", "")
    assert field(bits="8", members="0: a", scale="2").kind == "uint"
    text = "a field of the type {} cannot have the enumeration `Mode`"
    for given, kind in (
        ({"type": "bool"}, "bool"),
        ({"scale": "2"}, "uint with a formula"),
    ):
        _, findings = read({"bits": "8", "enumeration": "Mode"} | given)
        assert findings == [("IMP050", "error", text.format(kind))]


@pytest.mark.parametrize(
    ("part", "last", "numbers"),
    [("L", "", (0, 0)), ("h", "", (1, 1)), ("3", "", (3, 3)), ("3", "7", (3, 7))],
)
def test_a_part_has_the_bit_numbers_of_its_piece(part, last, numbers):
    assert field(bits="8", part=part, last_part=last).part == numbers
    assert field(bits="8").part is None


def test_descriptions_are_searched_only_if_the_profile_states_phrases():
    text = "Speed. (Unit: [rpm])"
    described = field(bits="8", text=text).described
    assert (described.prose, described.unit) == (text, "")
    words = profile.Profile(WORDS.data, {"phrases": {}}, [])
    (result,), _ = read({"bits": "8", "text": text}, words=words)
    assert (result.described.prose, result.described.unit) == ("Speed", "rpm")
    (result,), _ = read({"bits": "8", "text": text, "unit": "Hz"}, words=words)
    assert result.described.unit == "Hz"
    unread = "value = RAW^2"
    _, (finding,) = read({"bits": "8", "text": unread}, words=words)
    assert finding[:2] == ("IMP040", "warning") and finding[2].endswith(f": `{unread}`")


def test_a_range_over_bytes_is_placed_by_its_ends_or_reported():
    ends = {"byte": "1", "bit": "4", "last_byte": "2", "end_bit": "3"}
    result = field(**ends)
    assert (result.at, result.bits) == (12, 8)
    assert problem(**ends | {"bit": "8"})[2] == "a byte has no bit 8"


def test_rows_with_one_fault_are_named_by_their_fields():
    rows = [{"name": name, "type": ""} for name in ("A", "B")]
    _, ((code, _, message),) = read(*rows)
    assert code == "IMP026"
    assert message.endswith("its type is not stated; the same in 1 more row: `B`")


@pytest.mark.parametrize(("kind", "table"), [("enum", 8), ("uint", None)])
def test_only_descriptions_of_enumerations_name_a_table(kind, table):
    words = profile.Profile(WORDS.data, {"phrases": {}}, [])
    given = {"bits": "8", "type": kind, "text": "Possible values are in Table 8: Modes"}
    (result,), _ = read(given, words=words)
    assert result.described.enum_table == table
