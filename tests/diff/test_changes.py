"""Changes of one field: code, severity, message, old and new value and details."""

from __future__ import annotations

import pytest

from icdgen.diff.changes.framing import LONGEST, _short
from icdgen.diff.changes.numbers import is_wider
from icdgen.icd.meanings import Limits
from tests.diff.cases import compared_texts

LEVEL = "at: 0, bits: 16, name: Level, type: uint"
VOLTS = f"{LEVEL}, unit: V, formula: "
NO_VALUE = "special: [{value: 0, meaning: no value}]"
SPECIAL = "special: [{value: 0, meaning: no value}, {value: 1, meaning: too hot}]"
OTHER = "special: [{value: 0, meaning: No value}, {value: 1, meaning: too cold}, {value: 2, meaning: broken}]"
STILL = "Values that were allowed are still allowed."
NO_LONGER = "Values that were allowed no longer are."


def message(field: str) -> str:
    return (
        "messages:\n  - name: Status\n    id: 130\n    kind: telemetry\n"
        f"    length: 8\n    fields:\n      - {{{field}}}\n"
    )


def rows(folder, old: str, new: str) -> list[tuple]:
    """Return the changes except those of generated names and types."""
    comparison = compared_texts(folder, message(old), message(new), is_checked=False)
    return [
        (
            change.code,
            change.severity,
            change.message,
            change.was,
            change.now,
            *change.details,
        )
        for change in comparison.changes
        if change.layer != "source"
    ]


@pytest.mark.parametrize(
    ("old", "new", "expected"),
    [
        (
            f"{VOLTS}raw*0.5",
            f"{VOLTS}raw*0.75",
            [
                (
                    "DIF201",
                    "error",
                    "the value of `Level` is raw*0.75, was raw*0.5",
                    "raw*0.5",
                    "raw*0.75",
                    "Identical bits give 1.5 times the value.",
                )
            ],
        ),
        (
            f"{VOLTS}raw*0.5",
            f"{VOLTS}raw*0.75 + 1",
            [
                (
                    "DIF201",
                    "error",
                    "the value of `Level` is raw*0.75 + 1, was raw*0.5",
                    "raw*0.5",
                    "raw*0.75 + 1",
                )
            ],
        ),
        (
            f"{VOLTS}raw*0.5 + 1",
            f"{VOLTS}raw*-0.5 + 1",
            [
                (
                    "DIF203",
                    "error",
                    "the sign of `Level` is turned: raw*-0.5 + 1, was raw*0.5 + 1",
                    "raw*0.5 + 1",
                    "raw*-0.5 + 1",
                )
            ],
        ),
        (
            f"{VOLTS}raw*0.5",
            f"{LEVEL}, unit: V",
            [
                (
                    "DIF201",
                    "error",
                    "the value of `Level` is raw, was raw*0.5",
                    "raw*0.5",
                    "raw",
                    "Identical bits give 2 times the value.",
                )
            ],
        ),
        (f"{LEVEL}, unit: V, formula: raw*1", f"{LEVEL}, unit: V", []),
        (
            f"{LEVEL}, unit: V",
            f"{LEVEL}, unit: mV",
            [("DIF202", "error", "the unit of `Level` is mV, was V", "V", "mV")],
        ),
        (
            f"{LEVEL}, unit: V",
            LEVEL,
            [
                (
                    "DIF202",
                    "warning",
                    "the unit of `Level` is no longer stated, was V",
                    "V",
                    "",
                )
            ],
        ),
        (
            LEVEL,
            f"{LEVEL}, unit: V",
            [
                (
                    "DIF202",
                    "warning",
                    "the unit of `Level` is V, was not stated",
                    "",
                    "V",
                )
            ],
        ),
        (
            f"{LEVEL}, const: 7",
            f"{LEVEL}, const: 8",
            [
                (
                    "DIF209",
                    "error",
                    "`Level` must be 8 (0x08), was 7 (0x07)",
                    "7 (0x07)",
                    "8 (0x08)",
                )
            ],
        ),
        (
            f"{LEVEL}, const: 0",
            LEVEL,
            [
                (
                    "DIF209",
                    "warning",
                    "`Level` need no longer be 0 (0x00)",
                    "0 (0x00)",
                    "",
                )
            ],
        ),
        (
            LEVEL,
            f"{LEVEL}, const: 256",
            [
                (
                    "DIF209",
                    "error",
                    "`Level` must be 256 (0x100), was free",
                    "",
                    "256 (0x100)",
                )
            ],
        ),
        (
            f"{LEVEL}, {SPECIAL}",
            f"{LEVEL}, {OTHER}",
            [
                (
                    "DIF210",
                    "warning",
                    "the raw value 1 of `Level` stands for `too cold`, stood for `too hot`",
                    "too hot",
                    "too cold",
                ),
                (
                    "DIF210",
                    "warning",
                    "the raw value 2 of `Level` stands for `broken` now",
                    "",
                    "broken",
                ),
                (
                    "DIF412",
                    "note",
                    "what 0 of `Level` stands for is spelled otherwise",
                    "no value",
                    "No value",
                ),
            ],
        ),
        (
            f"{LEVEL}, {NO_VALUE}",
            LEVEL,
            [
                (
                    "DIF210",
                    "warning",
                    "the raw value 0 of `Level` no longer stands for `no value`",
                    "no value",
                    "",
                )
            ],
        ),
        (
            f"{LEVEL}, min: 1, max: 10",
            f"{LEVEL}, min: 0, max: 11",
            [
                (
                    "DIF211",
                    "warning",
                    "`Level` may be >= 0 and <= 11, could be >= 1 and <= 10",
                    ">= 1 and <= 10",
                    ">= 0 and <= 11",
                    STILL,
                )
            ],
        ),
        (
            f"{LEVEL}, max: 10",
            LEVEL,
            [
                (
                    "DIF211",
                    "warning",
                    "`Level` may be anything, could be <= 10",
                    "<= 10",
                    "",
                    STILL,
                )
            ],
        ),
        (
            LEVEL,
            f"{LEVEL}, below: 10",
            [
                (
                    "DIF211",
                    "warning",
                    "`Level` may be < 10, could be anything",
                    "",
                    "< 10",
                    NO_LONGER,
                )
            ],
        ),
        (
            LEVEL,
            LEVEL.replace("at: 0", "at: 16"),
            [
                (
                    "DIF107",
                    "error",
                    "`Level` is at bit 16, was at bit 0",
                    "bit 0",
                    "bit 16",
                )
            ],
        ),
        (
            LEVEL,
            LEVEL.replace("bits: 16", "bits: 15"),
            [("DIF110", "error", "`Level` has 15 bits, had 16", "16 bits", "15 bits")],
        ),
        (
            LEVEL,
            f"{LEVEL}, count: 3",
            [
                (
                    "DIF118",
                    "error",
                    "`Level` is an array of 3 elements, was one value",
                    "one value",
                    "3 elements",
                )
            ],
        ),
        (
            f"{LEVEL}, count: 2",
            f"{LEVEL}, count: 3",
            [
                (
                    "DIF118",
                    "error",
                    "`Level` is an array of 3 elements, was an array of 2 elements",
                    "2 elements",
                    "3 elements",
                )
            ],
        ),
        (
            f"{LEVEL}, count: 2",
            LEVEL,
            [
                (
                    "DIF118",
                    "error",
                    "`Level` is one value, was an array of 2 elements",
                    "2 elements",
                    "one value",
                )
            ],
        ),
        (
            LEVEL,
            LEVEL.replace("uint", "int"),
            [
                (
                    "DIF111",
                    "error",
                    "`Level` is a 16-bit int, was a 16-bit uint",
                    "uint",
                    "int",
                    "Bits read as 32768 is read as -32768.",
                )
            ],
        ),
        (
            LEVEL.replace("uint", "int"),
            LEVEL,
            [
                (
                    "DIF111",
                    "error",
                    "`Level` is a 16-bit uint, was a 16-bit int",
                    "int",
                    "uint",
                    "Bits read as -32768 is read as 32768.",
                )
            ],
        ),
        (
            "at: 0, bits: 32, name: Level, type: uint",
            "at: 0, bits: 32, name: Level, type: float",
            [
                (
                    "DIF111",
                    "error",
                    "`Level` is a 32-bit float, was a 32-bit uint",
                    "uint",
                    "float",
                )
            ],
        ),
        (
            LEVEL,
            f"{LEVEL}, byte_order: big",
            [
                (
                    "DIF117",
                    "error",
                    "the byte order of `Level` is big, was little",
                    "little",
                    "big",
                )
            ],
        ),
        (LEVEL, f"{LEVEL}, byte_order: little", []),
        (
            f"{LEVEL}, display: hex",
            LEVEL,
            [
                (
                    "DIF417",
                    "note",
                    "`Level` is displayed by its resolution, was displayed in hexadecimal",
                    "displayed in hexadecimal",
                    "",
                )
            ],
        ),
        (
            f"{LEVEL}, aliases: [Fill]",
            f"{LEVEL}, aliases: [Fill, Amount]",
            [
                (
                    "DIF401",
                    "note",
                    "`Level` is also called Fill, Amount, was Fill",
                    "Fill",
                    "Fill, Amount",
                )
            ],
        ),
        (
            LEVEL,
            f"{LEVEL}, summary: How full it is.",
            [
                (
                    "DIF401",
                    "note",
                    "the summary of `Level` is new",
                    "",
                    "How full it is.",
                )
            ],
        ),
    ],
)
def test_a_change_of_a_field_is_reported_completely(tmp_path, old, new, expected):
    assert rows(tmp_path, old, new) == expected


NOTHING, ONE_TO_TEN = Limits(), Limits(min=1, max=10)


@pytest.mark.parametrize(
    ("old", "new", "expected"),
    [
        (None, None, True),
        (NOTHING, ONE_TO_TEN, False),
        (ONE_TO_TEN, NOTHING, True),
        (ONE_TO_TEN, ONE_TO_TEN, True),
        (ONE_TO_TEN, Limits(min=0, max=10), True),
        (ONE_TO_TEN, Limits(min=1, max=11), True),
        (ONE_TO_TEN, Limits(min=2, max=10), False),
        (ONE_TO_TEN, Limits(min=1, max=9), False),
        (Limits(above=1), Limits(above=0), True),
        (Limits(above=1), Limits(above=2), False),
        (Limits(below=1), Limits(below=2), True),
        (Limits(below=1), Limits(below=0), False),
        (Limits(min=1), Limits(above=0), False),
        (Limits(max=1), None, True),
    ],
)
def test_limits_are_wider_if_they_permit_all_earlier_values(old, new, expected):
    assert is_wider(old, new) is expected


def test_a_long_text_is_cut_to_80_characters():
    assert LONGEST == 80
    assert _short("a" * 80) == "a" * 80
    assert _short("a" * 81) == "a" * 77 + "..."
