"""Variable-length arrays in structs: their places, numbers of elements and counters."""

from __future__ import annotations

import pytest

from tests.icd.rules.marked import findings_of, reported
from tests.limits import assert_limits

POINTS = "at: 8, name: Points, bits: 8, type: uint, count: Number, up_to: 3"


def icd(*fields: str, bits: int = 8, structs: str = "", counter: str = "") -> str:
    """Return an ICD with a struct of these fields behind `Kind`, which has 8 bits, and a
    message whose field `Number` counts the elements of the arrays in it.
    """
    rows = "".join(f"      - {{{field}}}\n" for field in fields)
    return f"""\
structs:
  - name: Curve
    length: 1
    fields:
      - {{at: 0, bits: 8, name: Kind, type: uint}}
{rows}{structs}messages:
  - name: Curves
    id: 130
    kind: telemetry
    length: 4
    fields:
      - {{at: 0, bits: 8, name: Curves Count, type: uint}}
      - {{at: 8, bits: {bits}, name: Number, type: uint{counter}}}
      - {{at: 24, bits: 8, name: Other, type: uint}}
      - {{at: 32, name: Curves, struct: Curve, count: Curves Count, up_to: 3}}
"""


def faults(folder, *fields: str, **keys) -> list[tuple[str, str]]:
    return reported(folder, icd(*fields, **keys), "ICD146")


def test_an_array_in_a_struct_has_at_most_1024_elements(tmp_path):
    def rows(up_to: int) -> list[tuple[str, str]]:
        return faults(tmp_path, POINTS.replace("3", f"{up_to}"), bits=16)

    assert_limits(lambda up_to: not rows(up_to), most=1024)
    text = "`Points` has up to 1,025 elements: an array has at most 1,024"
    assert rows(1025) == [("1025", text)]
    (finding,) = findings_of(
        tmp_path, icd(POINTS.replace("3", "1025"), bits=16), "ICD146"
    )
    assert finding.help == "write up to 1,024"


def test_an_array_can_have_the_elements_that_it_has_at_least(tmp_path):
    def rows(plus: int) -> list[tuple[str, str]]:
        count = f"count: {{field: Number, plus: {plus}}}"
        return faults(tmp_path, POINTS.replace("count: Number", count))

    assert_limits(lambda plus: not rows(plus), most=3)
    assert rows(4) == [("3", "`Points` has at least 4 elements, and up to 3")]


@pytest.mark.parametrize("bits", [1, 4, 8])
@pytest.mark.parametrize("plus", [-2, 0, 1])
def test_a_counter_can_count_all_elements(bits, plus, tmp_path):
    count = f"count: {{field: Number, plus: {plus}}}" if plus else "count: Number"

    def rows(up_to: int) -> list[tuple[str, str]]:
        field = POINTS.replace("up_to: 3", f"up_to: {up_to}")
        return faults(tmp_path, field.replace("count: Number", count), bits=bits)

    most = max((1 << bits) - 1 + plus, 0)
    assert [up_to for up_to in (most - 1, most) if up_to > 0 and rows(up_to)] == []
    up_to = most + 1
    shown = f"counts up to {most}, and `Points` of the struct `Curve` has up to {up_to}"
    assert rows(up_to) == [("Curve", f"`Number` ({bits} bits) {shown}")]
    text = icd(
        POINTS.replace("up_to: 3", f"up_to: {up_to}").replace("count: Number", count),
        bits=bits,
    )
    (finding,) = findings_of(tmp_path, text, "ICD146")
    assert finding.help == "correct `up_to` in the struct, or the `bits` of `Number`"


@pytest.mark.parametrize(
    ("first", "second", "is_possible"),
    [
        ((0, 3), (0, 3), True),
        ((0, 3), (-3, 3), True),
        ((0, 3), (-4, 3), False),
        ((-4, 3), (0, 3), False),
        ((-3, 3), (0, 3), True),
        ((2, 3), (-1, 3), True),
        ((2, 3), (-2, 3), False),
        ((3, 3), (0, 1), True),
    ],
)
def test_arrays_with_one_counter_have_a_number_that_suits_all(
    first, second, is_possible, tmp_path
):
    """The numbers of elements are `plus` more than the counter, from 0 to `up_to`."""
    (plus, up_to), (other_plus, other_up_to) = first, second
    numbers = {
        value
        for value in range(16)
        if 0 <= value + plus <= up_to and 0 <= value + other_plus <= other_up_to
    }
    assert bool(numbers) == is_possible
    row = "name: {}, bits: 8, type: uint, count: {{field: Number, plus: {}}}, up_to: {}"
    fields = [
        "at: 8, " + row.format("A", plus, up_to),
        "at: 8, after: A, " + row.format("B", other_plus, other_up_to),
    ]
    text = "`Number` counts `B` of the struct `Curve` and `A`, and no value suits both"
    assert faults(tmp_path, *fields) == [("Curve", text)] * (not is_possible)
    other = [fields[0], fields[1].replace("field: Number", "field: Other")]
    assert faults(tmp_path, *other) == []
    other = [fields[0], fields[1].replace("field: Number", "field: Curves Count")]
    text = "`Curves Count` counts both `B` of the struct `Curve` and a variable-length field of the message"
    assert faults(tmp_path, *other) == [("Curve", text)]


def test_each_array_without_a_usable_counter_is_reported(tmp_path):
    row = "name: {}, bits: 8, type: uint, count: {}, up_to: 3"
    text = icd(
        "at: 8, " + row.format("A", "Missing"),
        "at: 8, after: A, " + row.format("B", "Curves Count"),
        "at: 8, after: B, " + row.format("C", "Number"),
        counter=", formula: raw*2",
    )
    of = "of the struct `Curve`"
    assert sorted(reported(tmp_path, text, "ICD146")) == sorted(
        ("Curve", message)
        for message in (
            f"`Curves` has no field `Missing` that could count `A` {of}",
            f"`Curves Count` counts both `B` {of} and a variable-length field of the message",
            f"`Number` cannot count `C` {of}: it is scaled",
        )
    )


@pytest.mark.parametrize(
    ("rows", "marked", "message", "help", "fix"),
    [
        (
            ["at: 8, after: Kind, bits: 8, name: A, type: uint", POINTS],
            "Kind",
            "`A` has `after: Kind`, but no field in front of it has a variable length",
            "write it in front of the fields with `after`, and remove `after`",
            None,
        ),
        (
            [f"{POINTS}, after: Kind"],
            "Kind",
            "`Points` is the first field of `Curve` with a variable length",
            "remove `after`: it begins where `length` ends",
            None,
        ),
        (
            [POINTS.replace("at: 8", "at: 16")],
            "16",
            "`Points` begins at bit 16, but `length` ends at bit 8",
            "`length` is that of the fields in front of the first variable-length array; "
            "this array and all fields with `after` have `at` there",
            None,
        ),
        (
            [POINTS, POINTS.replace("Points", "More")],
            "More",
            "`More` is behind `Points`, whose end is not at a fixed place",
            "write `after: Points`, the field in front of it",
            None,
        ),
        (
            [POINTS, "at: 8, after: Kind, bits: 8, name: Last, type: uint"],
            "Kind",
            "`Last` is behind `Points`, whose end is not at a fixed place",
            "write `after: Points`, the field in front of it",
            "Points",
        ),
    ],
)  # fmt: skip
def test_only_the_first_field_at_a_wrong_place_is_reported(
    rows, marked, message, help, fix, tmp_path
):
    wrong = "at: 9, after: Nothing, bits: 3, name: Behind, type: uint"
    text = icd(*rows, wrong)
    (finding,) = findings_of(tmp_path, text, "ICD146")
    assert reported(tmp_path, text, "ICD146") == [(marked, message)]
    assert (finding.help, finding.fix and finding.fix.text) == (help, fix)


@pytest.mark.parametrize(
    ("field", "marked", "message"),
    [
        (
            "at: 8, name: Data, type: bytes, size: Number, up_to: 3",
            "Number",
            "`Data` is `bytes` of variable length, which is not supported in a struct",
        ),
        (
            "at: 8, name: Data, type: text, size: rest, up_to: 3",
            "rest",
            "`Data` is `text` of variable length, which is not supported in a struct",
        ),
        (
            POINTS.replace("count: Number", "count: rest"),
            "rest",
            "`Points` extends to the end of the frame, which is not supported in a struct",
        ),
        (
            POINTS.replace(", up_to: 3", ""),
            "Number",
            "`Points` has no fixed count and no `up_to`",
        ),
        (
            POINTS.replace("bits: 8", "bits: 9"),
            "9",
            "`Points` does not have whole bytes, so what follows has no place",
        ),
        (
            f"{POINTS}, when: {{Kind: 1}}",
            "{",
            "`Points` has no fixed place, so it cannot have `when`",
        ),
    ],
)  # fmt: skip
def test_an_array_in_a_struct_is_of_numbers_that_a_field_counts(
    field, marked, message, tmp_path
):
    assert reported(tmp_path, icd(field), "ICD146") == [(marked, message)]


@pytest.mark.parametrize(
    ("field", "key"),
    [
        ("name: Curves, struct: Curve", "Curve"),
        ("name: Curves, struct: Curve, count: 2", "2"),
        ("name: Curves, struct: Curve, count: rest, up_to: 3", "rest"),
    ],
)
def test_a_struct_of_variable_length_is_in_an_array_that_a_field_counts(
    field, key, tmp_path
):
    text = icd(POINTS)
    old = "name: Curves, struct: Curve, count: Curves Count, up_to: 3"
    assert old in text and reported(tmp_path, text, "ICD146") == []
    message = "the struct `Curve` has a variable length, and `Curves` is no array that a field counts"
    rows = reported(tmp_path, text.replace(old, field), "ICD146")
    assert rows == [(key, message)]


def test_a_struct_of_fixed_length_is_in_any_array(tmp_path):
    text = icd().replace("count: Curves Count, up_to: 3", "count: {}")
    for count in ("2", "Curves Count, up_to: 3", "rest, up_to: 3"):
        assert reported(tmp_path, text.replace("{}", count), "ICD146") == []


def test_one_level_of_variable_length_is_supported(tmp_path):
    outer = """\
  - name: Outer
    length: 1
    fields:
      - {at: 0, bits: 8, name: Kind, type: uint}
      - {at: 8, name: Curves, struct: Curve, count: Number, up_to: 3}
"""
    text = icd(POINTS, structs=outer)
    message = "`Curve` has a variable length, and so has `Outer`, which contains it"
    assert reported(tmp_path, text, "ICD146") == [("Curve", message)]
