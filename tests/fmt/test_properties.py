"""Properties of ``icdgen fmt`` for every file: the layout is stable, no value changes,
and each comment stays at its line.
"""

from __future__ import annotations

from collections import Counter

import pytest
import yaml
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from icdgen.diagnostics import Findings
from icdgen.icd import source
from icdgen.icd.fmt import format_text, same
from icdgen.icd.fmt.read import comments

quick = settings(
    max_examples=100,
    deadline=None,
    derandomize=True,
    suppress_health_check=list(HealthCheck),
)

# Text with a special meaning in YAML, complete and in pieces.
PIECES = ["a", "#", "# b", ":", "x:", "- ", "-", " ", "  ", "\n", "\n\n", "{", "}", ",", "[", "]", "'", '"', "\\", "|",
          ">", "%", "*", "&", "!", "?", "@", "`", "~", "=", "<<", "\t", "\r", "\x85", "\u2028", "é", "\u00a0", "---",
          "...", "0x1F", "010", "on", "Off", "2020-11-03", "12:30", "word", "1e5", ".inf"]  # fmt: skip
WHOLE = [
    "yes",
    "No",
    "null",
    "~",
    "",
    "1",
    "0x1f",
    "-5",
    "1.50",
    "true",
    "word " * 60,
    "x" * 1500,
    "... 0",
    "--- a",
]
KEYS = ["name", "at", "bits", "type", "id", "fields", "members", "source", "table", "where", "message", "printed",
        "why", "zz"]  # fmt: skip
SECTIONS = ["icdgen", "errata", "node", "include", "vocabulary", "units", "protocol", "enums", "messages", "loggable",
            "missing", "entries"]  # fmt: skip

texts = st.one_of(
    st.text(st.characters(codec="utf-8", exclude_characters="\0"), max_size=40),
    st.lists(st.sampled_from(PIECES), max_size=30).map(" ".join),
    st.lists(st.sampled_from(PIECES), max_size=20).map("".join),
    st.sampled_from(WHOLE),
)
numbers = st.one_of(
    st.integers(),
    st.booleans(),
    st.none(),
    st.integers(-(10**9), 10**9).map(lambda n: n / 1000),
)
keys = st.one_of(st.sampled_from(KEYS), texts)
trees = st.recursive(
    st.one_of(texts, numbers),
    lambda inner: st.one_of(
        st.lists(inner, max_size=5), st.dictionaries(keys, inner, max_size=5)
    ),
    max_leaves=20,
)
documents = st.dictionaries(
    st.one_of(st.sampled_from(SECTIONS), keys), trees, max_size=5
)


def check(text: str) -> str:
    """Check all properties and return the formatted text. Refused texts are skipped."""
    try:
        before = source.parse(text.encode("utf-8"), "before")
    except Findings:
        return ""
    result = format_text(text, "test.yaml")
    assert same(before, source.parse(result.encode("utf-8"), "after"))
    assert Counter(comments(text)) == Counter(comments(result))
    assert format_text(result, "test.yaml") == result
    return result


@quick
@given(
    documents,
    st.sampled_from([None, True, False]),
    st.sampled_from([20, 80, 10**6]),
    st.sampled_from([None, '"', "'", "|", ">"]),
)
def test_any_tree_in_any_style(tree, flow, width, style):
    check(
        yaml.safe_dump(
            tree,
            default_flow_style=flow,
            width=width,
            default_style=style,
            sort_keys=False,
        )
    )


SOUP = ["# c", "#", "\n", "\n  ", "\n    ", "- ", "a: ", "b:", "c: 1", ", ", "{", "}", "[", "]", "x", "'q'", '"d"',
        "|\n   l\n", "> # h\n   f\n", "name: n", "fields:", "messages:", "icdgen: 1", " ", "? ", ": ", "\r\n",
        "\u2028", " #d", "---\n", "...\n", "%YAML 1.1\n", "-\n"]  # fmt: skip


@settings(quick, max_examples=600)
@given(st.lists(st.sampled_from(SOUP), max_size=16).map("".join))
def test_any_text_that_the_loader_accepts(text):
    check(text)


class RandomWriter:
    """Writes an ICD in a random style. Each comment contains a unique word of the line
    at which it must stay.
    """

    def __init__(self, draw) -> None:
        self.draw, self.lines = draw, []

    def maybe(self) -> bool:
        return self.draw(st.booleans())

    def above(self, indent: int, word: str) -> None:
        for number in range(self.draw(st.integers(0, 2))):
            self.lines.append(
                " " * indent + f"# above {word} {number}" + "\n" * self.maybe()
            )

    def behind(self, word: str) -> str:
        return f"   # behind {word}" if self.maybe() else ""

    def below(self, indent: int, word: str) -> None:
        if self.maybe():
            self.lines.append("\n" * self.maybe() + " " * indent + f"# below {word}")

    def text(self) -> str:
        self.lines.append("icdgen: 1\nmessages:")
        for index in range(self.draw(st.integers(1, 3))):
            self.message(f"M{index}")
        self.lines.append("node: {name: demo}")
        return "\n".join(self.lines) + "\n"

    def message(self, name: str) -> None:
        self.above(2, name)
        self.lines.append(f"  - name: {name}{self.behind(name)}")
        entries = self.draw(
            st.permutations(["group", "source", "summary", "fields", "unknown"])
        )
        for entry in entries:
            word = f"{name}{entry}"
            if entry == "fields":
                self.lines.append("    fields:")
                for index in range(self.draw(st.integers(1, 3))):
                    self.field(f"{name}F{index}")
                self.below(6, f"{name}F{index}")
            elif entry == "source":
                self.above(4, word)
                self.lines.append(f"    source: {{section: {word}}}{self.behind(word)}")
            else:
                self.above(4, word)
                self.lines.append(f"    {entry}: {word}{self.behind(word)}")

    def field(self, name: str) -> None:
        self.above(6, name)
        style = self.draw(st.sampled_from(["flow", "flow lines", "block"]))
        if style == "flow":
            self.lines.append(
                f"      - {{bits: 8, name: {name}, at: 0}}{self.behind(name)}"
            )
        elif style == "flow lines":
            self.lines += [
                f"      - {{bits: 8,{self.behind(name + ' 1')}",
                f"         name: {name}{self.behind(name + ' 2')}",
            ]
            self.above(9, f"{name} inside")
            self.lines.append(f"         , at: 0}}{self.behind(name)}")
        else:
            self.lines += [
                f"      - bits: 8{self.behind(name + ' 1')}",
                f"        at: 0{self.behind(name + ' 2')}",
            ]
            self.above(8, f"{name} inside")
            self.lines.append(f"        name: {name}{self.behind(name + ' 3')}")


@st.composite
def commented(draw) -> str:
    return RandomWriter(draw).text()


def about(line: str) -> str:
    """Return the line without its comment."""
    return line.split("#")[0]


@quick
@given(commented())
def test_each_comment_stays_at_its_line(text):
    lines = [line for line in check(text).splitlines() if line.strip()]
    assert lines
    for index, line in enumerate(lines):
        if "#" not in line:
            continue
        where, word = line.split("#")[1].split()[:2]
        if about(line).strip():
            owner = about(line)
        elif where == "below":
            owner = next(
                about(line) for line in reversed(lines[:index]) if about(line).strip()
            )
        else:
            owner = next(about(line) for line in lines[index:] if about(line).strip())
        assert word in owner.replace("}", " ").replace(",", " ").split(), line


@pytest.mark.parametrize(
    "text",
    [
        "a: 1\n" + "# c\n" * 100_000,
        "a: [" + "1, " * 20_000 + "]\n",
        "messages:\n" + "  - {fields: [{at: 0}]}\n" * 4_000,
        "a: " + "[" * 38 + "]" * 38 + "\n",
        "# yaml-language-server: x\n" * 20_000 + "a: 1\n",
        "a: x" + " #" * 100_000 + "\n",
        "".join(f"k{number}: 1\n" for number in range(10_000)),
        "a:\n" + "".join(f"  - {{k{number}: 1, x: 2}}\n" for number in range(4_000)),
    ],
    ids=[
        "comments",
        "items",
        "rows",
        "depth",
        "schema lines",
        "hashes",
        "keys",
        "unlike rows",
    ],
)
def test_large_files_take_linear_time(text):
    import time

    start = time.process_time()
    assert check(text)
    assert time.process_time() - start < 10
