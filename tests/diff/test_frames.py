"""Changes of messages: ids, kinds, lengths, and messages and nodes that are added,
removed or included.
"""

from __future__ import annotations

import pytest

from icdgen.diff.compare import Comparison, compare
from icdgen.loading import load
from tests.diff.cases import compared_texts, rows_of
from tests.icd.files import HEAD

CODES = "DIF101 DIF102 DIF103 DIF105 DIF106 DIF119 DIF125 DIF126".split()
WHOLE = "Decoders of the other release take whole frames only."
TAKEN = "Decoders of the other release take such frames, too."
REFUSED = "Decoders of the other release refuse the frame: they take exactly "
COUNT = "{at: 0, bits: 8, name: Count, type: uint}"
ROWS = "{at: 8, bits: 8, name: Rows, type: uint}"
A, B, C = (
    f"{{at: {at}, bits: 8, name: {name}, type: uint}}"
    for at, name in ((0, "Alpha"), (8, "Beta"), (16, "Gamma"))
)
BLOCKS = (
    "up to {} of `Blocks`, counted by `Rows`, each with up to 2 of `Levels`, counted by "
    "`Count`"
)
CONFIGURED = "kind: configuration, length: 1, "
BLOCK = """\
structs:
  - name: Block
    length: 1
    fields:
      - {at: 0, bits: 8, name: Kind, type: uint}
      - {at: 8, bits: 8, name: Levels, type: uint, count: Count, up_to: 2}
"""


def words(kind: str, id: int, length: int, *fields: str, more: str = "") -> str:
    listed = ", ".join(fields)
    return f"kind: {kind}, id: {id}, length: {length}, {more}fields: [{listed}]"


# Old and new message, and the changes.
CASES: dict[str, tuple[str | None, str | None, list[tuple]]] = {
    "Set Heater": (
        words("telecommand", 10, 1, A),
        None,
        [
            ("DIF101", "error",
             "`Set Heater` is gone: telecommand 10 is no longer spoken",
             "telecommand 10, 1 byte", "", "Set Heater", None)
        ],
    ),
    "Orbit Position": (
        None,
        f"{CONFIGURED}set_id: 0, get_id: 140".replace("length: 1", "length: 9"),
        [
            ("DIF102", "addition",
             "`Orbit Position` is new: configuration 0 / 140, 9 bytes", "",
             "configuration 0 / 140, 9 bytes", None, "Orbit Position")
        ],
    ),
    "First Id": (
        words("telemetry", 0, 1, A),
        words("telemetry", 141, 1, A),
        [
            ("DIF103", "error", "the telemetry id of `First Id` is 141, was 0", "0",
             "141", "0", "141")
        ],
    ),
    "Both Ids": (
        f"{CONFIGURED}set_id: 12, get_id: 142, fields: [{A}]",
        f"{CONFIGURED}set_id: 13, get_id: 143, fields: [{A}]",
        [
            ("DIF103", "error", "the telecommand id of `Both Ids` is 13, was 12",
             "12", "13", "12", "13"),
            ("DIF103", "error", "the telemetry id of `Both Ids` is 143, was 142",
             "142", "143", "142", "143"),
        ],
    ),
    "Also Sent": (
        words("telemetry", 144, 1, A),
        f"{CONFIGURED}set_id: 14, get_id: 145, fields: [{A}]",
        [
            ("DIF103", "error", "the telemetry id of `Also Sent` is 145, was 144",
             "144", "145", "144", "145"),
            ("DIF105", "addition",
             "`Also Sent` is a configuration now, was a telemetry", "telemetry",
             "configuration", "telemetry", "configuration"),
        ],
    ),
    "Only Sent": (
        f"{CONFIGURED}set_id: 16, get_id: 146, fields: [{A}]",
        words("telemetry", 146, 1, A),
        [
            ("DIF105", "error",
             "`Only Sent` is a telemetry now, was a configuration", "configuration",
             "telemetry", "configuration", "telemetry", "It can no longer be sent.")
        ],
    ),
    "Grown": (
        words("telemetry", 150, 1, A),
        words("telemetry", 150, 3, A, C),
        [
            ("DIF106", "error",
             "`Grown` has 3 bytes, had 1: it gained `Gamma` at its end", "1 bytes",
             "3 bytes", "1", "3", f"{REFUSED}1 byte.", "The first byte is as it was.")
        ],
    ),
    "Shrunk": (
        words("telemetry", 151, 3, A, B, C),
        words("telemetry", 151, 1, A),
        [
            ("DIF106", "error",
             "`Shrunk` has 1 byte, had 3: it lost `Beta` and `Gamma` at its end",
             "3 bytes", "1 bytes", "3", "1", f"{REFUSED}3 bytes.",
             "The first byte is as it was.")
        ],
    ),
    "Padded": (
        words("telemetry", 152, 2, A),
        words("telemetry", 152, 3, A),
        [
            ("DIF106", "error", "`Padded` has 3 bytes, had 2: it grew by 1 byte",
             "2 bytes", "3 bytes", "2", "3", f"{REFUSED}2 bytes.")
        ],
    ),
    "Trimmed": (
        words("telemetry", 153, 3, A, more="may_end_early: zeros, "),
        words("telemetry", 153, 1, A),
        [
            ("DIF106", "error", "`Trimmed` has 1 byte, had 3: it shrank by 2 bytes",
             "3 bytes", "1 bytes", "3", "1",
             "Decoders of the other release refuse the frame: they take 1 to 3 bytes."),
            ("DIF126", "note",
             "`Trimmed` is always sent with the zeros that it ends with",
             "1 to 3 bytes", "1 byte", "zeros", "1", TAKEN),
        ],
    ),
    "May End": (
        words("telemetry", 154, 2, A),
        words("telemetry", 154, 2, A, more="may_end_early: zeros, "),
        [
            ("DIF125", "error",
             "`May End` may be sent without the zeros that it ends with", "2 bytes",
             "1 to 2 bytes", "2", "zeros", WHOLE)
        ],
    ),
    "Complete": (
        words("telemetry", 155, 2, A, more="may_end_early: zeros, "),
        words("telemetry", 155, 2, A),
        [
            ("DIF126", "note",
             "`Complete` is always sent with the zeros that it ends with",
             "1 to 2 bytes", "2 bytes", "zeros", "2", TAKEN)
        ],
    ),
    "Fewer": (
        words("telemetry", 156, 1, COUNT, "{at: 8, bits: 8, name: Rows, type: uint, count: {field: Count, plus: 1}, up_to: 9}"),
        words("telemetry", 156, 1, COUNT, "{at: 8, bits: 8, name: Rows, type: uint, count: Count, up_to: 9}"),
        [
            ("DIF119", "error",
             "what ends `Fewer` is up to 9 of `Rows`, counted by `Count`, was up to 9 of `Rows`, counted by `Count` + 1",
             "up to 9 of `Rows`, counted by `Count` + 1",
             "up to 9 of `Rows`, counted by `Count`", "1", "1",
             "Frames have 1 to 10 bytes, had 2 to 10 bytes.")
        ],
    ),
    "Nested": (
        words("telemetry", 157, 2, COUNT, ROWS, "{at: 16, name: Blocks, struct: Block, count: Rows, up_to: 3}"),
        words("telemetry", 157, 2, COUNT, ROWS, "{at: 16, name: Blocks, struct: Block, count: Rows, up_to: 2}"),
        [
            ("DIF119", "error",
             f"what ends `Nested` is {BLOCKS.format(2)}, was {BLOCKS.format(3)}",
             BLOCKS.format(3), BLOCKS.format(2), "2", "2",
             "Frames have 2 to 8 bytes, had 2 to 11 bytes.")
        ],
    ),
    "Same Name": (words("telemetry", 158, 1, A), words("telemetry", 158, 1, A), []),
}  # fmt: skip


@pytest.fixture(scope="module")
def comparison(tmp_path_factory) -> Comparison:
    old, new = (
        BLOCK
        + "messages:\n"
        + "".join(
            f"  - {{name: {name}, {case[side]}}}\n"
            for name, case in CASES.items()
            if case[side] is not None
        )
        for side in (0, 1)
    )
    folder = tmp_path_factory.mktemp("frames")
    return compared_texts(folder, old, new, is_checked=False)


@pytest.mark.parametrize("name", CASES)
def test_a_change_of_a_message_is_reported_completely(comparison, name):
    rows = [row for row in rows_of(comparison, *CODES) if f"`{name}`" in row[2]]
    assert rows == CASES[name][2]


def test_an_id_that_another_message_takes_over_is_reported_once_for_each_direction(
    tmp_path,
):
    pair = "kind: configuration, length: {}, set_id: {}, get_id: {}, fields: [{}]"
    text = (
        "messages:\n"
        f"  - {{name: Alpha, {pair.format(1, 5, 6, A)}}}\n"
        f"  - {{name: Beta, {pair.format(2, 7, 8, B)}}}\n"
    )
    first, second = "set_id: 5, get_id: 6", "set_id: 7, get_id: 8"
    new = text.replace(first, "other").replace(second, first).replace("other", second)
    rows = rows_of(compared_texts(tmp_path, text, new, is_checked=False), "DIF104")
    assert rows == [
        (
            "DIF104",
            "error",
            f"{kind} {id} was `{was}` and is `{now}` now",
            was,
            now,
            str(id),
            str(id),
            "Old software takes one for the other.",
        )
        for kind, id, was, now in (
            ("telecommand", 5, "Alpha", "Beta"),
            ("telecommand", 7, "Beta", "Alpha"),
            ("telemetry", 6, "Alpha", "Beta"),
            ("telemetry", 8, "Beta", "Alpha"),
        )
    ]


def test_added_removed_and_included_messages_of_nodes_are_counted(tmp_path):
    sides = []
    one, two = (
        "".join(
            f"  - {{name: Part {letter}, id: {id}, kind: telemetry, length: 1}}\n"
            for id, letter in enumerate("AB"[:number], 140)
        )
        for number in (1, 2)
    )
    shared = HEAD.replace("demo", "common")
    for name, (included, other, messages) in {
        "old": ("", "first", one),
        "new": ("include: [common.yaml]\n", "zulu", two),
    }.items():
        folder = tmp_path / name
        folder.mkdir()
        (folder / "common.yaml").write_text(f"{shared}messages:\n{two}")
        (folder / "demo.yaml").write_text(f"{HEAD}{included}messages: []\n")
        text = HEAD.replace("demo", other).replace("Demo", other.title())
        text += f"messages:\n{messages}".replace("Part", other.title())
        (folder / f"{other}.yaml").write_text(text)
        sides.append(load([folder], check=False).icd)
    codes = ("DIF130", "DIF131", "DIF132", "DIF133")
    included = ("They are still there, and declared or included elsewhere.",)
    there = [
        ("DIF130", "error", "node `first` is gone, with 1 message", "first", ""),
        ("DIF131", "addition", "node `zulu` is new, with 2 messages", "", "zulu"),
    ]
    more = "`demo` speaks `Part A` and `Part B` too"
    less = "`demo` no longer speaks `Part A` and `Part B`"
    assert sorted(row[:5] + row[7:] for row in rows_of(compare(*sides), *codes)) == [
        *there,
        ("DIF133", "addition", more, "", "2 messages", *included),
    ]
    rows = rows_of(compare(*reversed(sides)), *codes)
    assert ("DIF132", "error", less, "2 messages", "", *included) in [
        row[:5] + row[7:] for row in rows
    ]
    assert not any(row[0] == "DIF133" for row in rows)
