"""Rules of positions and widths: all widths of all types, and keys without effect."""

from __future__ import annotations

import pytest

from tests.icd.files import findings, status
from tests.icd.rules.reported import reported

SIZES = (1, 2, 7, 8, 9, 16, 31, 32, 33, 63, 64, 65, 72, 1032)
INTEGERS = [size for size in SIZES if size <= 64]
BYTES = [size for size in SIZES if size % 8 == 0]
WIDTHS = {
    "uint": ("a", INTEGERS, "1 to 64 bits"),
    "int": ("an", INTEGERS, "1 to 64 bits"),
    "enum": ("an", INTEGERS, "1 to 64 bits"),
    "bool": ("a", [1], "1 bit"),
    "float": ("a", [32, 64], "32 or 64 bits"),
    "bytes": ("a", BYTES, "whole bytes: a multiple of 8 bits"),
    "text": ("a", BYTES, "whole bytes: a multiple of 8 bits"),
}
ENUM = "enums: [{name: Mode, members: [{value: 0, name: Idle}]}]\n"


@pytest.mark.parametrize("type", WIDTHS)
def test_each_type_has_its_widths(type, tmp_path):
    article, widths, words = WIDTHS[type]
    keys = ", enum: Mode" * (type == "enum")
    fields = [
        f"at: {2048 * n}, bits: {size}, name: F{n}, type: {type}{keys}"
        for n, size in enumerate(SIZES)
    ]
    text = ENUM + status(*fields, length=256 * len(SIZES))
    fixes = {
        f.fix and f.fix.text for f in findings(tmp_path, text) if f.code == "ICD022"
    }
    assert fixes == {"1" if type == "bool" else None}
    assert reported(tmp_path, text, "ICD022") == [
        (
            10 + n,
            str(size),
            f"{article} `{type}` field takes {words}, not {size:,}",
            "correct `bits` or `type`",
        )
        for n, size in enumerate(SIZES)
        if size not in widths
    ]


@pytest.mark.parametrize(
    ("type", "keys", "what"),
    [
        ("uint", [], ""),
        ("int", [], ""),
        ("enum", [], ""),
        ("float", [], ""),
        ("bool", ["byte_order"], "it is one bit"),
        ("bytes", ["byte_order", "bit_order"], "bytes are sent in order"),
        ("text", ["byte_order", "bit_order"], "characters are sent in order"),
    ],
)
def test_orders_have_no_effect_on_single_bits_and_characters(
    type, keys, what, tmp_path
):
    bits = 1 if type == "bool" else 32
    row = f"at: 0, bits: {bits}, name: A, type: {type}" + ", enum: Mode" * (type == "enum")  # fmt: skip
    text = ENUM + status(f"{row}, byte_order: big, bit_order: msb0", length=4)
    values = {"byte_order": "big", "bit_order": "msb0"}
    assert reported(tmp_path, text, "ICD026") == [
        (
            10,
            values[key],
            f"`A` is `{type}`: {what}, so `{key}` has no effect",
            f"remove `{key}`",
        )
        for key in keys
    ]


STRUCT = "structs:\n  - name: Pair\n    length: 2\n    fields: [{at: 0, bits: 16, name: Two, type: uint}]\n"


@pytest.mark.parametrize(
    ("field", "marked", "end", "help"),
    [
        ("at: 8, bits: 17, name: A, type: uint", "17", "25", "`at` or `bits`"),
        ("at: 24, bits: 1, name: A, type: uint", "24", "25", "`at` or `bits`"),
        ("at: 16, bits: 9, name: A, type: uint", "9", "25", "`at` or `bits`"),
        ("at: 8, bits: 8, count: 3, name: A, type: uint", "3", "32", "`at`, `count` or `bits`"),
        ("at: 24, bits: 8, count: 1000, name: A, type: uint", "24", "8,024", "`at`, `count` or `bits`"),
        ("at: 16, name: A, struct: Pair", "Pair", "32", "`at` or `struct`"),
        ("at: 0, name: A, struct: Pair, count: 2", "2", "32", "`at`, `count` or `struct`"),
        ("at: 24, name: A, struct: Pair, count: 2", "24", "56", "`at`, `count` or `struct`"),
    ],
)  # fmt: skip
def test_what_makes_a_field_too_long_is_marked(field, marked, end, help, tmp_path):
    text = STRUCT + status(field, length=3)
    assert reported(tmp_path, text, "ICD020") == [
        (
            13,
            marked,
            f"`A` ends at bit {end}, but `Status` has 24 bits (3 bytes)",
            f"correct {help}, or the `length` in line 11",
        )
    ]


@pytest.mark.parametrize(
    "field",
    [
        "at: 23, bits: 1, name: A, type: uint",
        "at: 0, bits: 24, name: A, type: uint",
        "at: 0, bits: 8, count: 3, name: A, type: uint",
        "at: 8, name: A, struct: Pair",
    ],
)
def test_a_field_can_end_with_its_message(field, tmp_path):
    assert reported(tmp_path, STRUCT + status(field, length=3), "ICD020") == []


def test_the_first_field_that_ends_furthest_is_named_in_an_overlap(tmp_path):
    """`B` ends with `A`, and `D` begins behind the end of `A` but not of `C`."""
    rows = {"A": (0, 16), "B": (8, 8), "C": (12, 12), "D": (16, 2), "E": (24, 8)}
    fields = [
        f"at: {at}, bits: {bits}, name: {name}, type: uint"
        for name, (at, bits) in rows.items()
    ]
    found = reported(tmp_path, status(*fields, length=4), "ICD021")
    assert [each.message for each in found] == [
        "`B` overlaps `A` (line 9) in bits 8 to 15",
        "`C` overlaps `A` (line 9) in bits 12 to 15",
        "`D` overlaps `C` (line 11) in bits 16 to 17",
    ]
