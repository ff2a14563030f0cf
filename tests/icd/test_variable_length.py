"""Faults of variable-length fields: complete messages and their places."""

from __future__ import annotations

import pytest

from icdgen.icd import source, variable_length
from icdgen.icd.located import Map
from icdgen.icd.variable_length import Counting
from tests.limits import assert_limits

LENGTHS = {"Cell": 3, "Big": 1024}
NUMBER = "at: 0, bits: 8, name: Number, type: uint"
ITEMS = "at: 8, bits: 8, name: Items, type: uint, count: Number, up_to: 9"


def message(*fields: str, length: int = 1, keys: str = "") -> Map:
    rows = "".join(f"  - {{{field}}}\n" for field in fields)
    text = f"name: Status\nlength: {length}\n{keys}fields:\n{rows}"
    return source.parse(text.encode(), "demo.yaml")


def faults(owner: Map) -> list[tuple[str, str, str, str]]:
    """Return the name of the field, the text of the place, message and help of each."""
    rows = []
    for item in variable_length.sequence_of(owner):
        for fault in variable_length.faults(owner, item, LENGTHS):
            keys = [key for key in fault.owner if fault.owner.at(key) == fault.place]
            rows.append((item["name"], keys[0], fault.message, fault.help))
    return rows


@pytest.mark.parametrize(
    ("field", "expected"),
    [
        ("count: 3", None),
        ("name: A", None),
        ("count: rest", Counting("rest")),
        ("count: Number", Counting("Number")),
        ("size: Number", Counting("Number")),
        ("count: {field: Number, plus: -1}", Counting("Number", -1)),
        ("count: {field: Number, plus: 0}", Counting("Number", 0)),
        ("count: {field: Number}", None),
        ("count: {field: 1, plus: 1}", None),
        ("count: {field: Number, plus: true}", None),
        ("size: 4", None),
        ("size: 4, count: rest", None),
    ],
)
def test_a_field_or_the_end_of_the_frame_counts_a_variable_length_field(
    field, expected
):
    item = source.parse(f"{{{field}}}".encode(), "demo.yaml")
    assert variable_length.is_variable(item) == (expected is not None)
    if expected is not None:
        assert variable_length.counting(item) == expected


@pytest.mark.parametrize(
    ("fields", "sequence", "after"),
    [
        ([NUMBER], [], []),
        ([NUMBER, "at: 8, bits: 8, name: B, type: uint, after: Number"], [], []),
        ([NUMBER, ITEMS, "at: 8, bits: 8, name: B, type: uint, after: Items"],
         ["Items", "B"], []),
        ([NUMBER, ITEMS, "at: 8, bits: 8, name: B, type: uint", "at: 7, bits: 1, name: C, type: uint"],
         ["Items"], ["B"]),
        ([NUMBER, ITEMS, "at: 8, bits: 8, name: V, type: uint, view: true"], ["Items"], []),
        ([NUMBER, ITEMS.replace("Number", "None"), "at: 8, bits: 8, name: B, type: uint"], ["Items"], []),
    ],
)  # fmt: skip
def test_fields_behind_the_first_variable_length_field(fields, sequence, after):
    owner = message(*fields)
    assert [item["name"] for item in variable_length.sequence_of(owner)] == sequence
    found = variable_length.fixed_fields_after(owner)
    assert [item["name"] for item in found] == after


def test_a_counter_is_a_field_and_no_struct():
    owner = message("at: 0, name: Cell, struct: Cell", NUMBER, ITEMS)
    items = variable_length.sequence_of(owner)[0]
    assert variable_length.counter_of(owner, items)["name"] == "Number"
    for name in ("rest", "Cell", "None"):
        items["count"] = name
        assert variable_length.counter_of(owner, items) is None


@pytest.mark.parametrize(
    ("field", "bits"),
    [("bits: 12", 12), ("size: rest, bits: 4", 8), ("struct: Cell", 24), ("struct: None", 0)],
)  # fmt: skip
def test_the_width_of_an_element(field, bits):
    item = source.parse(f"{{{field}}}".encode(), "demo.yaml")
    assert variable_length.element_bits(item, LENGTHS) == bits


def test_a_sound_message_has_no_faults():
    more = "at: 8, after: Items, name: Cells, struct: Cell, count: {field: Second, plus: 1}, up_to: 4"  # fmt: skip
    check = "at: 8, after: Cells, bits: 16, name: Check, type: uint"
    rest = "at: 8, after: Check, name: Text, type: text, size: rest, up_to: 9"
    second = "at: 8, bits: 8, name: Second, type: uint"
    fields = [row.replace("at: 8, after", "at: 16, after") for row in (more, check, rest)]  # fmt: skip
    owner = message(NUMBER, second, ITEMS.replace("at: 8", "at: 16"), *fields, length=2)
    assert faults(owner) == []


RENAME = "name another counter: each variable-length field needs its own"
OTHER_COUNTER = "name an unsigned number without a formula, within the `length` of the message"  # fmt: skip
ORDER = (
    "list variable-length fields, and fields behind them, in the order of the frame; "
    "`after` names the one directly in front"
)


@pytest.mark.parametrize(
    ("fields", "expected"),
    [
        ([NUMBER, ITEMS.replace("count: Number", "count: Numbr")],
         [("Items", "count", "`Status` has no field `Numbr` that could count `Items`", "did you mean `Number`?")]),
        ([NUMBER, ITEMS.replace("count: Number", "count: xyz")],
         [("Items", "count", "`Status` has no field `xyz` that could count `Items`",
           "`count` is a number, the name of an earlier field, or `rest`")]),
        ([NUMBER, "at: 8, name: Text, type: text, size: xyz, up_to: 9"],
         [("Text", "size", "`Status` has no field `xyz` that could count `Text`",
           "`size` is the name of an earlier field, or `rest`")]),
        ([NUMBER, ITEMS.replace(", up_to: 9", "")],
         [("Items", "count", "`Items` has no fixed count and no `up_to`",
           "add `up_to:`, the greatest number of elements: buffers have that size")]),
        ([NUMBER, ITEMS, "at: 8, after: Items, bits: 8, name: More, type: uint, count: Number, up_to: 2"],
         [("More", "count", "`Number` counts both `Items` and `More`", RENAME)]),
        ([NUMBER.replace("uint", "int"), ITEMS],
         [("Items", "count", "`Number` cannot count `Items`: it is `int`, not `uint`", OTHER_COUNTER)]),
        ([NUMBER.replace("at: 0", "at: 1"), ITEMS],
         [("Items", "count", "`Number` cannot count `Items`: it is placed after the `length` of the message",
           OTHER_COUNTER)]),
        ([NUMBER.replace("bits: 8", "bits: 3"), ITEMS],
         [("Items", "up_to", "`Number` (3 bits) counts up to 7, and `Items` has up to 9 elements",
           "write `up_to: 7`, or correct the `bits` of `Number`")]),
        ([NUMBER.replace("bits: 8", "bits: 3"), ITEMS.replace("count: Number", "count: {field: Number, plus: 1}")],
         [("Items", "up_to", "`Number` (3 bits plus 1) counts up to 8, and `Items` has up to 9 elements",
           "write `up_to: 8`, or correct `plus` or the `bits` of `Number`")]),
        ([NUMBER.replace("bits: 8", "bits: 3"), ITEMS.replace("count: Number", "count: {field: Number, plus: -7}")],
         [("Items", "up_to", "`Number` (3 bits plus -7) counts up to 0, and `Items` has up to 9 elements",
           "correct `up_to`, or correct `plus` or the `bits` of `Number`")]),
        ([NUMBER.replace("bits: 8", "bits: 3"), "at: 8, name: Text, type: text, size: Number, up_to: 8"],
         [("Text", "up_to", "`Number` (3 bits) counts up to 7, and `Text` has up to 8 bytes",
           "write `up_to: 7`, or correct the `bits` of `Number`")]),
        ([NUMBER.replace("bits: 8", "bits: 3"), ITEMS.replace("up_to: 9", "up_to: 7")], []),
        ([NUMBER, ITEMS.replace("count: Number", "count: {field: Number, plus: 9}")], []),
        ([NUMBER, ITEMS.replace("count: Number", "count: {field: Number, plus: 10}")],
         [("Items", "up_to", "`Items` has at least 10 elements, and up to 9", "correct `up_to`, or `plus`")]),
        ([NUMBER, "at: 8, after: Items, bits: 8, name: Check, type: uint", ITEMS],
         [("Check", "after", "`Check` follows `Items`, which is listed later in the file", ORDER)]),
        ([NUMBER, ITEMS.replace("at: 8", "at: 8, after: Number")],
         [("Items", "after", "`Items` has `after: Number`, but no field in front of it has a variable length",
           "remove `after`: the first variable-length field begins where `length` ends")]),
        ([NUMBER, "at: 8, after: Number, bits: 8, name: Check, type: uint", ITEMS],
         [("Check", "after", "`Check` has `after: Number`, but no field in front of it has a variable length",
           "list it behind the variable-length field, or remove `after` and correct `at`"),
          ("Items", "name", "`Items` is behind `Check`, whose end is not at a fixed place",
           "write `after: Check`, the field in front of it")]),
        ([NUMBER, ITEMS, "at: 8, name: Text, type: text, size: rest, up_to: 9"],
         [("Text", "name", "`Text` is not the first variable-length field of `Status`",
           "write `after: Items`, the field in front of it")]),
        ([NUMBER, ITEMS, "at: 8, after: Number, name: Text, type: text, size: rest, up_to: 9"],
         [("Text", "after", "`Text` is not the first variable-length field of `Status`",
           "write `after: Items`, the field in front of it")]),
        ([NUMBER, ITEMS.replace("count: Number", "count: rest"),
          "at: 8, after: Items, name: Text, type: text, size: Number, up_to: 9"],
         [("Text", "after", "`Text` follows `Items`, which extends to the end of the frame",
           "let a field count `Items`: write its name instead of `rest`")]),
        ([NUMBER, ITEMS.replace("at: 8", "at: 9")],
         [("Items", "at", "`Items` has a variable length and begins at bit 9, but `length` ends at bit 8",
           "`length` is that of the fields in front of the first variable-length field; "
           "this field and all fields with `after` have `at` there")]),
        ([NUMBER, ITEMS, "at: 16, after: Items, bits: 8, name: Check, type: uint"],
         [("Check", "at", "`Check` is behind a field of variable length and begins at bit 16, but `length` ends at bit 8",
           "`length` is that of the fields in front of the first variable-length field; "
           "this field and all fields with `after` have `at` there")]),
        ([NUMBER, ITEMS, "at: 8, after: Items, bits: 4, name: Check, type: uint"],
         [("Check", "bits", "`Check` does not have whole bytes, so what follows has no place",
           "combine it with its neighbours to whole bytes: write them as a struct")]),
        ([NUMBER, ITEMS, "at: 8, after: Items, bits: 4, name: Checks, type: uint, count: 2"], []),
        ([NUMBER, ITEMS, "at: 8, after: Items, bits: 8, name: Check, type: uint, view: true"],
         [("Check", "view", "`Check` has no fixed place, so it cannot have `view`",
           "remove `view`, or place the field in front of `Items`")]),
        ([NUMBER, ITEMS.replace("bits: 8", "bits: 4")],
         [("Items", "bits", "an element of `Items` has 4 bits, but a frame has whole bytes",
           "describe elements of whole bytes, or the data as `bytes` with `size`")]),
        ([NUMBER, "at: 8, name: Text, type: uint, size: Number, up_to: 9"],
         [("Text", "size", "`Text` is `uint`: `size` is for bytes and text",
           "for numbers, write the `bits` of an element and `count`")]),
        ([NUMBER, ITEMS + ", view: true, bitfields: [1]"],
         [("Items", key, f"`Items` has a variable length, so it cannot have `{key}`", f"remove `{key}`")
          for key in ("view", "bitfields")]),
    ],
)  # fmt: skip
def test_each_fault_has_its_message_at_its_key(fields, expected):
    assert faults(message(*fields)) == expected


def test_reserved_bytes_do_not_follow_a_variable_length_field():
    owner = message(NUMBER, ITEMS, keys="reserved: 0\n")
    assert faults(owner) == [
        (
            "Items",
            "reserved",
            "`Status` has `reserved` bytes, which cannot follow `Items`, a variable-length field",
            "remove `reserved`, and describe bytes at the end of a frame as `bytes` with "
            "`after`; `length` ends where `Items` begins",
        )
    ]


def test_limits_of_elements_and_of_a_frame():
    wide = NUMBER.replace("bits: 8", "bits: 32")

    def is_accepted(up_to: int, keys: str, length: int = 4) -> bool:
        field = f"at: {8 * length}, name: Items, {keys}, up_to: {up_to}"
        return faults(message(wide, field, length=length)) == []

    assert_limits(lambda n: is_accepted(n, "bits: 8, type: uint, count: Number"), most=1024)  # fmt: skip
    assert_limits(lambda n: is_accepted(n, "type: bytes, size: rest"), most=65531)
    assert_limits(lambda n: is_accepted(n, "type: bytes, size: rest", 9), most=65526)
    field = "at: 32, name: Items, struct: Big, count: Number, up_to: 64"
    assert faults(message(wide, field, length=4)) == [
        (
            "Items",
            "up_to",
            "`Status` can have 65,540 bytes with all of `Items`, more than the limit of 65,535",
            "correct `up_to`",
        )
    ]


def test_the_length_of_a_frame_is_reported_at_its_last_variable_length_field():
    first = ITEMS.replace("bits: 8, name", "bits: 32768, name").replace("up_to: 9", "up_to: 15")  # fmt: skip
    check = "at: 8, after: Items, name: Checks, struct: Cell, count: 400"
    rest = "at: 8, after: Checks, name: Text, type: text, size: rest, up_to: 2894"
    assert faults(message(NUMBER, first, check, rest)) == []
    longer = rest.replace("2894", "2895")
    assert [row[:2] for row in faults(message(NUMBER, first, check, longer))] == [("Text", "up_to")]  # fmt: skip


@pytest.mark.parametrize(
    ("count", "bits", "fix"),
    [
        ("Numbr", 8, "Number"),
        ("{field: Numbr, plus: 1}", 8, None),
        ("Number", 3, "7"),
        ("{field: Number, plus: -7}", 3, None),
    ],
)
def test_a_fix_replaces_a_single_value(count, bits, fix):
    items = ITEMS.replace("count: Number", f"count: {count}")
    owner = message(NUMBER.replace("bits: 8", f"bits: {bits}"), items)
    (fault,) = variable_length.faults_of_count(owner, owner["fields"][1])
    assert (fault.fix and fault.fix.text) == fix
