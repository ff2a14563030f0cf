"""What is read without the library of YAML is what the library reads, value for value and place for place."""

from __future__ import annotations

import subprocess
from pathlib import Path

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from icdgen.icd import source, usual_yaml
from icdgen.icd.located import Map, Seq, place_of

TOP = Path(__file__).parents[2]
FILES = sorted(
    TOP / name
    for name in subprocess.run(
        ["git", "ls-files", "*.yaml"], cwd=TOP, capture_output=True, text=True, check=True
    ).stdout.splitlines()
)
SHIPPED = [*(TOP / "icd").glob("*.yaml"), *(TOP / "icd" / "errata").glob("*.yaml")]
# What means something to YAML where it stands, or somewhere else.
BITS = [
    *":-,[]{}#&*!|>'\"%@`?~=.\\/_()<019nyé°\t\r\n \x85\u2028\xa0\ufeff\x07", "- ", ": ", " #", "\n  ", "\n    ", "---\n", "...\n",
    "\n\n", "''", '""', "{}", "[]", "null", "yes", "0x1F", "1.5e+3", "2020-01-01", "[a, b]", "{a: b}", ",}", ",]", "\n# c\n",
    " # c", "k: ", "- - ", "? ", "key:\n", "|\n", " >-\n", "<<: ",
]  # fmt: skip


def described(value: object, spot: object) -> object:
    place = place_of(spot)
    if isinstance(value, Map):
        return place, [
            (key, place_of(value.spots[key][0]), described(one, value.spots[key][1])) for key, one in value.items()
        ]
    if isinstance(value, Seq):
        return place, [described(one, its) for one, its in zip(value, value.spots, strict=True)]
    return place, type(value), value


def agrees(text: str) -> bool:
    """Whether the text is usual. Fails where the library reads it otherwise."""
    usual = usual_yaml.tree(text, "demo.yaml")
    if usual is None:
        return False
    tree, findings = source.Builder(text, "demo.yaml").build()
    assert not findings
    assert described(usual, usual.spot) == described(tree, tree.spot)
    return True


@pytest.mark.parametrize("path", SHIPPED, ids=lambda path: str(path.relative_to(TOP)))
def test_what_is_shipped_needs_no_library(path):
    assert agrees(path.read_text(encoding="utf-8"))


def test_every_other_file_is_read_as_the_library_reads_it():
    texts = (path.read_bytes().decode("utf-8", "replace") for path in FILES if path not in SHIPPED)
    assert sum(map(agrees, texts)) > 300


@st.composite
def spoilt(draw: st.DrawFn) -> str:
    """Some lines of an ICD or overlay into which things fell that YAML makes much of."""
    lines = draw(st.sampled_from(SHIPPED)).read_text(encoding="utf-8").split("\n")
    begin = draw(st.integers(0, len(lines) - 1))
    some = lines[begin : begin + draw(st.integers(1, 12))]
    margin = min((len(line) - len(line.lstrip()) for line in some if line.strip()), default=0)
    text = "key:\n" + "\n".join(f"  {line[margin:]}" for line in some) + draw(st.sampled_from(["", "\n"]))
    for _ in range(draw(st.integers(0, 3))):
        at = draw(st.integers(0, len(text)))
        text = text[:at] + draw(st.sampled_from(BITS)) + text[at + draw(st.integers(0, 2)) :]
    return text


@given(spoilt())
@settings(max_examples=500, deadline=None)
def test_no_text_is_read_otherwise(text):
    agrees(text)


@pytest.mark.parametrize(
    "text",
    [
        "a: &x 1\n", "a: 'b'\n", 'a: "\\t"\n', "a: |\n  b\n", "a: yes\n", "a: 1\na: 2\n", "- a\n", "", "# c\n", "a: {b: 1,}\n",
        "a: b: c\n", "a: [1\n", "a:\tb\n", "a: b\r\n", "? a\n", "a: !t b\n", "---\na: 1\n", "a: 1\n---\nb: 2\n",
        "a: {b: 1, b: 2}\n", "a: " + "[" * 50 + "]" * 50, f"a: {'b' * 20_001}\n",
    ],
)  # fmt: skip
def test_what_is_not_usual_is_left_to_the_library(text):
    assert usual_yaml.tree(text, "demo.yaml") is None
