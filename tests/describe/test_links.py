"""The description of a link: its assumptions are in the code of every language, and
incomplete parts are left out.
"""

from __future__ import annotations

import copy
import dataclasses
import re
from functools import cache

import pytest

from icdgen import backends
from icdgen.backends.lines import commented, in_rows, tamed
from icdgen.backends.literals import Brackets, Item, written
from icdgen.describe import describe
from icdgen.describe.links import Assumptions, LinkDescription, links_of
from icdgen.icd.model import Icd
from icdgen.icd.trees import at_path
from icdgen.render import Renderer
from tests.conformance.icds import shipped

LINKS = {
    "c": ("/link.c",),
    "python": ("/_link.py",),
    "rust": ("/wire/links/", "/procedures.rs"),
}


@cache
def described() -> dict[str, LinkDescription]:
    return links_of(describe(shipped()))


def without(section: str, key: str) -> LinkDescription:
    """Return the link of a node whose ICD lacks the rows of that role in a list of a
    section.
    """
    icd = shipped()
    node = icd.node("cubeacp")
    protocol = copy.deepcopy(icd.protocol_of(node))
    part = at_path(protocol, section.split("."))
    for name, rows in part.items():
        if isinstance(rows, list):
            part[name] = [
                row for row in rows if key not in (row.get("role"), row.get("name"))
            ]
    changed = dataclasses.replace(node, protocol=protocol)
    return links_of(
        describe(Icd(tuple(changed if node_ is node else node_ for node_ in icd.nodes)))
    )["cubeacp"]


def plain(text: str) -> str:
    return re.sub(r"\W+", "", text)


@pytest.mark.parametrize("language", LINKS)
def test_the_link_of_every_language_has_every_assumption(language):
    files = backends.get(language).files(shipped(), Renderer(language))
    texts = {
        str(path): text
        for path, text in files
        if any(part in f"/{path}" for part in LINKS[language])
    }
    for name, link in described().items():
        text = "".join(
            plain(re.sub(r"^\s*(\*|///?|#)", "", text, flags=re.M))
            for path, text in texts.items()
            # Procedures of included nodes are in the files of those nodes.
            if name in path or path.endswith("/procedures.rs")
        )
        assert [
            assumption
            for assumption in link.facts.assumptions
            if plain(assumption.why) not in text
        ] == []


def test_each_assumption_is_in_the_code_once():
    facts = described()["cubeacp"].facts
    assumed = Assumptions(facts)
    assert assumed.why("link.buses.can.segments", "fill") and not assumed.why(
        "link.buses.can.segments", "fill"
    )
    assert [key for key, _ in assumed.of_section("link.buses.can.segments")] == [
        "packet_timeout_ms"
    ]
    assert not assumed.of_section("link.buses.can.segments")
    assert (
        len(assumed.remaining()) == len(facts.assumptions) - 2
        and not assumed.remaining()
    )


@pytest.mark.parametrize(
    ("section", "key", "part"),
    [
        ("link.buses.can", "source", "can"),
        ("msdos_time", "hour", "time"),
        ("index_file", "meta", "index"),
    ],
)
def test_an_incomplete_part_is_left_out(section, key, part):
    assert getattr(described()["cubeacp"], part) and not getattr(
        without(section, key), part
    )


def test_literals_are_laid_out_without_counting_columns():
    flat = Brackets("Pair { ", (Item("1", "one: "), Item("2", "two: ")), " }", True)
    brackets = Brackets(
        "Whole {", (Item(flat, "pair: ", ("why",)), Item(Brackets("[", (), "]"))), "}"
    )
    assert written(
        brackets.within("Some(", ")"), lambda note, indent: f"{indent}// {note}"
    ) == ("Some(Whole {\n    // why\n    pair: Pair { one: 1, two: 2 },\n    [],\n})")
    assert in_rows("abcde", 2) == ["a, b,", "c, d,", "e,"]


def test_no_line_of_a_comment_begins_a_list_a_heading_or_a_quotation():
    assert [tamed(line) for line in ("- a", "12. a", "# a", "> a", "a - b")] == [
        "\\- a",
        "12\\. a",
        "\\# a",
        "\\> a",
        "a - b",
    ]
    assert commented(["word - word"], 8, "// ") == ["// word", "// \\-", "// word"]
