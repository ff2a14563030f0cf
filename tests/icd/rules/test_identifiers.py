"""Rules of identifiers, with languages that declare a few names each.

Each name of a line of the ICD becomes many identifiers. A line has one finding for all
of them.
"""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import pytest

from icdgen.icd.identifiers import Identifier
from icdgen.icd.model import Icd
from icdgen.loading import load
from tests.icd.files import write

MESSAGES = "messages:\n" + "".join(
    f"  - {{name: {name}, id: {id}, kind: telecommand, length: 0}}\n"
    for id, name in enumerate("ABC", 1)
)
"""Messages `A`, `B` and `C` in lines 4, 5 and 6."""

ANOTHER = "other words from which its names in all languages are built"


class FewNames:
    """Language that declares these identifiers: the name of a message (or what else
    declares it, the runtime by default), the text and, if it is not the usual one, the
    scope.
    """

    def __init__(
        self, title: str, *rows: tuple[str, ...], reserved: tuple[str, ...] = ()
    ) -> None:
        self.name = title.lower()
        self.title = title
        self.reserved = frozenset(reserved)
        self._rows = rows

    def identifiers(self, icd: Icd) -> Iterator[Identifier]:
        sources = {each.name: each.source for each in icd.nodes[0].messages}
        sources["demo"] = icd.nodes[0].source
        sources |= {row["symbol"]: row for row in sources["demo"].get("units", ())}
        for name, text, *scope in self._rows:
            source = sources.get(name)
            owner = f"message `{name}`" if source else name or "the runtime"
            yield Identifier(scope[0] if scope else "file", text, owner, source)


def reported(folder: Path, *languages: FewNames, text: str = MESSAGES):
    """Return code, line, column, message and help of each finding."""
    result = load([write(folder, text)], plug_ins=languages, languages=())
    return [
        (each.code, each.place.line, each.place.column, each.message, each.help)
        for each in result.findings
    ]


def texts(folder: Path, *languages: FewNames) -> list[tuple[int, str]]:
    """Return line and message of each finding."""
    return [(line, message) for _, line, _, message, _ in reported(folder, *languages)]


def test_a_line_has_one_finding_for_reserved_words_of_all_languages(tmp_path):
    words = "class", "type", "b.h"
    one = FewNames("One", ("A", "class"), ("A", "type"), ("B", "b.h"), reserved=words)
    two = FewNames("Two", ("A", "class"), ("B", "class_"), reserved=words)
    three = FewNames(
        "Three", ("A", "type"), ("A", "class"), ("B", "b.h"), reserved=words
    )
    assert reported(tmp_path, one, two, three) == [
        (
            "ICD070",
            4,
            12,
            "message `A` becomes `class`, a reserved word in One and Two and `type`, a "
            "reserved word in Three",
            f"give it an `identifier:`, {ANOTHER}",
        ),
        (
            "ICD070",
            5,
            12,
            "message `B` becomes `b.h`, a header in One and Three",
            f"give it an `identifier:`, {ANOTHER}",
        ),
    ]


def test_a_word_is_reserved_in_the_languages_that_reserve_it(tmp_path):
    one = FewNames("One", ("A", "class"), ("B", "b/c"), reserved=("b/c",))
    two = FewNames("Two", ("A", "class"), ("B", "b/c"), reserved=("class",))
    assert texts(tmp_path, one, two) == [
        (4, "message `A` becomes `class`, a reserved word in Two"),
        (5, "message `B` becomes `b/c`, a header in One"),
    ]


@pytest.mark.parametrize("names", ["ABC", "CAB", "BCA", "CBA"])
def test_a_clash_is_reported_at_the_later_of_two_lines(names, tmp_path):
    """The languages list them in any order."""
    first = [("", "other"), *((name, "same") for name in names)]
    found = reported(tmp_path, FewNames("One", *first))
    assert {(code, help) for code, _, _, _, help in found} == {
        ("ICD071", f"give one of them an `identifier:`, {ANOTHER}")
    }
    # Each name clashes with the first in the list.
    pairs = [sorted((names[0], name)) for name in names[1:]]
    assert sorted(each[1:4] for each in found) == sorted(
        (
            "ABC".index(later) + 4,
            12,
            f"message `{later}` and message `{earlier}` (line "
            f"{'ABC'.index(earlier) + 4}) both become `same` in One",
        )
        for earlier, later in pairs
    )


def test_clashes_of_two_lines_are_one_finding_for_all_languages(tmp_path):
    one = FewNames("One", ("A", "a"), ("B", "a"), ("A", "get_a"), ("B", "get_a"))
    two = FewNames("Two", ("B", "b"), ("A", "b"))
    three = FewNames("Three", ("A", "a"), ("B", "a"))
    four = FewNames("Four", ("A", "c"), ("B", "c"))
    assert texts(tmp_path, one, two, three, four) == [
        (
            5,
            "message `B` and message `A` (line 4) both become `a` in One and Three, `b` "
            "in Two and `c` in Four",
        )
    ]


def test_equal_names_in_two_scopes_do_not_clash(tmp_path):
    rows = ("A", "same", "first"), ("B", "same", "second"), ("C", "other", "first")
    assert texts(tmp_path, FewNames("One", *rows)) == []
    assert texts(tmp_path, FewNames("One", *rows, ("C", "same", "second"))) == [
        (6, "message `C` and message `B` (line 5) both become `same` in One")
    ]


@pytest.mark.parametrize("rows", [[("", "same"), ("B", "same")], [("B", "same"), ("", "same")]])  # fmt: skip
def test_a_clash_with_a_name_of_the_runtime_is_reported_at_the_line(rows, tmp_path):
    assert texts(tmp_path, FewNames("One", *rows)) == [
        (5, "message `B` and the runtime both become `same` in One")
    ]


def test_clashes_of_a_line_with_two_names_of_the_runtime_are_two_findings(tmp_path):
    rows = ("B", "one"), ("", "one"), ("B", "two"), ("the header", "two")
    languages = [FewNames(title, *rows[n : n + 2]) for n, title in ((0, "One"), (2, "Two"))]  # fmt: skip
    assert sorted(texts(tmp_path, *languages)) == [
        (5, "message `B` and the header both become `two` in Two"),
        (5, "message `B` and the runtime both become `one` in One"),
    ]


def test_a_clash_of_two_names_of_the_runtime_is_no_finding(tmp_path):
    assert texts(tmp_path, FewNames("One", ("", "same"), ("", "same"))) == []


@pytest.mark.parametrize(
    ("text", "shown"),
    [
        ("a1", None),
        ("_", None),
        ("r#type", None),
        ("r#1", "`r#1`"),
        ("#type", "`#type`"),
        ("a.h", None),
        ("1.h", None),
        ("a/b", None),
        ("", "nothing"),
        ("1a", "`1a`"),
        ("a b", "`a b`"),
        ("é", "`é`"),
        ("aé", "`aé`"),
    ],
)
def test_names_are_identifiers_of_ascii_letters_or_files(text, shown, tmp_path):
    expected = (
        "ICD072",
        5,
        12,
        f"message `B` becomes {shown} in One, which is not a valid name",
        f"give it an `identifier:`, {ANOTHER}",
    )
    found = reported(tmp_path, FewNames("One", ("A", "fine"), ("B", text)))
    assert found == ([expected] if shown else [])


def test_invalid_names_of_a_line_are_listed_by_language(tmp_path):
    languages = [
        FewNames(title, ("A", text), ("A", "1b"))
        for title, text in (("One", "1a"), ("Two", ""), ("Three", "1a"), ("Four", "é"))
    ]
    assert texts(tmp_path, *languages) == [
        (
            4,
            "message `A` becomes `1a` in One and Three, nothing in Two and `é` in Four, "
            "which is not a valid name",
        )
    ]


def test_a_finding_stands_at_what_the_name_is_made_from(tmp_path):
    text = (
        "units: [{symbol: furlong, identifier: furlongs, quantity: length}]\n"
        "messages:\n"
        "  - {name: A, identifier: again, id: 1, kind: telecommand, length: 0}\n"
    )
    rows = [("demo", "1"), ("furlong", "2"), ("A", "3"), ("", "4")]
    another = f"give it another `identifier:`, {ANOTHER}"
    assert [
        (line, column, help)
        for _, line, column, _, help in reported(
            tmp_path, FewNames("One", *rows), text=text
        )
    ] == [
        (1, 1, f"give it an `identifier:`, {ANOTHER}"),
        (2, 14, "give the node another name"),
        (3, 39, another),
        (5, 27, another),
    ]
