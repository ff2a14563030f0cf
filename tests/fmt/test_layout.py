"""The layout that ``icdgen fmt`` gives to files: the ``*.in.yaml`` here become their
``*.out.yaml``.
"""

from __future__ import annotations

from pathlib import Path

import pytest

from icdgen.diagnostics import Findings
from icdgen.errors import UserError
from icdgen.icd import source
from icdgen.icd.fmt import format_text, same, write
from icdgen.icd.fmt.rows import aligned

HERE = Path(__file__).parent
ROOT = HERE.parent.parent
CASES = sorted(HERE.glob("*.in.yaml"))
SHIPPED = sorted(
    [*(ROOT / "icd").glob("*.yaml"), *(ROOT / "icd" / "errata").glob("*.yaml")]
)


def expected(case: Path) -> Path:
    return case.with_name(case.name.replace(".in.", ".out."))


def formatted(text: str) -> str:
    return format_text(text, "test.yaml")


@pytest.mark.parametrize("case", CASES, ids=lambda path: path.name)
def test_canonical_layout(case):
    """After an intended change run ``python -m tests.fmt.update``."""
    assert formatted(case.read_bytes().decode("utf-8")) == expected(
        case
    ).read_bytes().decode("utf-8")


@pytest.mark.parametrize("case", CASES, ids=lambda path: path.name)
def test_canonical_layout_stays_as_it_is(case):
    text = expected(case).read_bytes().decode("utf-8")
    assert formatted(text) == text


@pytest.mark.parametrize("case", CASES, ids=lambda path: path.name)
def test_nothing_changes_but_the_layout(case):
    before = source.parse(case.read_bytes(), "before")
    after = source.parse(expected(case).read_bytes(), "after")
    assert same(before, after)


def test_there_are_cases():
    assert len(CASES) >= 4 and len(SHIPPED) >= 5


@pytest.mark.parametrize(
    "path", SHIPPED, ids=lambda path: f"{path.parent.name}/{path.name}"
)
def test_shipped_files_are_in_the_canonical_layout(path):
    text = path.read_bytes().decode("utf-8")
    assert formatted(text) == text


@pytest.mark.parametrize("kind", ["icd", "overlay"])
def test_words_in_comments_do_not_change_the_layout(kind):
    text = expected(HERE / f"{kind}.in.yaml").read_text("utf-8")
    text += "# The keys `icdgen: 1`, `errata: 1` and `accepted: 1` begin files.\n"
    assert formatted(text) == text


def test_line_ends_and_byte_order_mark_are_normalised():
    assert formatted("\ufefficdgen: 1\r\nnode: {}\r\n") == "icdgen: 1\nnode: {}\n"


@pytest.mark.parametrize(
    "text, code",
    [
        ("a: [1", "ICD001"),
        ("", "ICD001"),
        ("- a\n", "ICD001"),
        ("a: 1\na: 2\n", "ICD002"),
        ("a: off\n", "ICD003"),
        ("a: &x 1\nb: *x\n", "ICD001"),
        ("a: \ud800\n", "ICD001"),
        ("a: " + "[" * 10_000, "ICD001"),
    ],
)
def test_what_has_no_one_meaning_is_refused(text, code):
    with pytest.raises(Findings) as caught:
        formatted(text)
    assert code in {finding.code for finding in caught.value.findings}


@pytest.mark.parametrize(
    ("first", "second", "expected"),
    [
        ({"a": 1, "b": 2}, {"b": 2, "a": 1}, True),
        ({"a": 1}, {"a": 1, "b": 2}, False),
        ({"a": 1}, {"b": 1}, False),
        ({"a": 1}, {"a": True}, False),
        ({"a": 1}, {"a": 1.0}, False),
        ({"a": "1"}, {"a": 1}, False),
        ({"a": {}}, {"a": []}, False),
        ({"a": []}, {"a": {}}, False),
        ({"a": None}, {"a": ""}, False),
        ([1, [2, {"a": 3}]], [1, [2, {"a": 3}]], True),
        ([1, [2, {"a": 3}]], [1, [2, {"a": 4}]], False),
        ([1, 2], [2, 1], False),
        ([1, 2], [1], False),
        ([1], [1, 2], False),
    ],
)
def test_trees_are_equal_with_their_types_and_the_order_of_lists(
    first, second, expected
):
    assert same(first, second) is expected


@pytest.mark.parametrize(
    ("written", "is_fine"),
    [
        ("b: [1]  # y\na: 1  # x\n", True),
        ("a: 1  # y\nb: [1]  # x\n", True),
        ("a: 1  # x\nb: [1]\n", False),
        ("a: 1  # x\nb: [1]  # y\n# y\n", False),
        ("a: 1  # x\nb: [2]  # y\n", False),
        ("a: true  # x\nb: [1]  # y\n", False),
        ("a: 1  # x\nb: [1]  # y\nc: 1\n", False),
    ],
)
def test_a_result_with_other_values_or_comments_is_not_written(
    written, is_fine, monkeypatch
):
    """Each comment is there as often as before."""
    monkeypatch.setattr(write, "write_canonical", lambda root, kind: written)
    text = "a: 1  # x\nb: [1] # y\n"
    if is_fine:
        assert formatted(text) == written
        return
    with pytest.raises(UserError) as caught:
        formatted(text)
    assert str(caught.value).startswith(
        "test.yaml: the formatter would change the meaning of this file"
    )


def test_only_the_keys_that_all_rows_begin_with_are_aligned():
    rows = [
        {"at": "at: 0", "name": "name: A", "type": "type: int"},
        {
            "at": "at: 128",
            "name": "name: Long",
            "identifier": "identifier: B",
            "type": "type: int",
        },
        {"at": "at: 8", "name": "name: " + "x" * 60, "type": "type: int"},
    ]
    assert aligned(rows) == [
        "{at: 0,   name: A,    type: int}",
        "{at: 128, name: Long, identifier: B, type: int}",
        "{at: 8,   name: " + "x" * 60 + ", type: int}",
    ]


def test_the_width_of_a_column_ignores_the_last_cell_of_a_row():
    rows = [{"name": "name: A", "summary": "summary: S"}, {"name": "name: Much longer"}]
    assert aligned(rows) == ["{name: A, summary: S}", "{name: Much longer}"]
