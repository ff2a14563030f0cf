"""Every value of a file has its place in the tree, and the meaning that it appears to
have.
"""

from __future__ import annotations

import json

import pytest
from hypothesis import given
from hypothesis import strategies as st

from icdgen.diagnostics import Findings, Place
from icdgen.icd import source
from icdgen.icd.located import Map, Seq
from tests.limits import assert_limits

TEXT = """\
# a comment
icdgen: 1
node: {name: demo, title: "A \\"title\\""}
messages:
  - name: Größe 温度
    length: 0x10
    fields:
      - {at: 0, bits: 16}
      - {at: -1.50, bits: }
"""


@pytest.fixture
def tree() -> Map:
    return source.parse(TEXT.encode(), "demo.yaml")


def shown(place: Place) -> str:
    """Return the text at a place."""
    return TEXT.splitlines()[place.line - 1][place.column - 1 :][: place.length]


def test_values_and_keys_know_their_places(tree):
    assert (shown(tree.key_at("icdgen")), shown(tree.at("icdgen"))) == ("icdgen", "1")
    assert shown(tree["node"].at("title")) == '"A \\"title\\""'
    message = tree["messages"][0]
    assert shown(message.at("name")) == "Größe 温度"
    assert shown(message.at("length")) == "0x10"
    first, second = message["fields"]
    assert (shown(first.at("bits")), shown(second.at("at"))) == ("16", "-1.50")
    assert shown(message["fields"].item_at(1)) == "{"


def test_a_mapping_knows_where_it_begins(tree):
    message = tree["messages"][0]
    assert message.place == Place("demo.yaml", 5, 5, 1)
    assert message["fields"][0].place == Place("demo.yaml", 8, 9, 1)
    assert message.at("no such key") == message.place


def test_numbers_texts_and_absent_values_have_their_apparent_type(tree):
    assert tree["messages"][0]["length"] == 16
    assert tree["messages"][0]["fields"][1] == {"at": -1.5, "bits": None}
    assert isinstance(tree["messages"], Seq)


def test_a_byte_order_mark_does_not_change_places():
    tree = source.parse(b"\xef\xbb\xbficdgen: 1\n", "demo.yaml")
    assert tree.key_at("icdgen") == Place("demo.yaml", 1, 1, 6)


@pytest.mark.parametrize(
    ("text", "value"),
    [
        ("0", 0),
        ("-7", -7),
        ("0xff", 255),
        ("1.50", 1.5),
        ("-0.1", -0.1),
        ("4.0", 4),
        ("-0.00", 0),
        ("12345678901234567890.0", 12345678901234567890),
        ("true", True),
        ("false", False),
        ("null", None),
        ("~", None),
        ("two words", "two words"),
        ("1 Failed boot attempt", "1 Failed boot attempt"),
        ("3 to 4", "3 to 4"),
        ("raw*0.01", "raw*0.01"),
        ('"010"', "010"),
        ("'on'", "on"),
        ("N.m", "N.m"),
        ("2D", "2D"),
        ("8b", "8b"),
        ("3A", "3A"),
        ("4e", "4e"),
        ("1-2", "1-2"),
        ("10BASE", "10BASE"),
    ],
)
def test_plain_values_have_their_type(text, value):
    read = source.parse(f"a:\n {text}\n".encode(), "demo.yaml")["a"]
    assert read == value
    assert type(read) is type(value)


TREACHEROUS = """
010 1_0 0b1 0o7 0B1 0x_1 +1 1. .5 1e3 1E+3 1.5e3 1.2.3 12:30 190:20:30 .inf -.inf .nan .NaN
on On OFF yes No y N True NULL 2020-11-03
"""


@pytest.mark.parametrize("text", TREACHEROUS.split())
def test_values_with_different_meanings_in_yaml_readers_are_refused(text):
    with pytest.raises(Findings) as error:
        source.parse(f"a: {text}\n".encode(), "demo.yaml")
    (finding,) = error.value.findings
    assert (finding.code, finding.place) == (
        "ICD003",
        Place("demo.yaml", 1, 4, len(text)),
    )


@given(st.integers(-(10**30), 10**30))
def test_integers_are_read_as_written(number):
    assert source.parse(f"a: {number}\n".encode(), "demo.yaml")["a"] == number


@given(st.text(st.characters(exclude_categories=("Cs",)), max_size=40))
def test_a_text_in_quotes_is_read_as_written(text):
    # JSON strings are YAML, except for characters outside the basic plane. NUL is
    # refused.
    quoted = json.dumps(text)
    if "\\ud" not in quoted and "\\u0000" not in quoted:
        assert source.parse(f"a: {quoted}\n".encode(), "demo.yaml")["a"] == text


@given(st.binary(max_size=200))
def test_any_bytes_give_a_tree_or_findings(data):
    try:
        tree = source.parse(data, "demo.yaml")
    except Findings as error:
        assert error.findings
        assert all(
            f.place.line >= 1 and f.place.column >= 1 and f.place.length >= 1
            for f in error.findings
        )
    else:
        assert isinstance(tree, Map)


@given(st.text("ab:-[]{},\n #&*!|>'\"%@`?0.", max_size=60))
def test_any_punctuation_gives_a_tree_or_findings(text):
    try:
        source.parse(text.encode(), "demo.yaml")
    except Findings as error:
        assert {f.code for f in error.findings} <= {"ICD001", "ICD002", "ICD003"}


def value_of(text: str) -> object:
    return source.parse(f"a: {text}\n".encode(), "demo.yaml")["a"]


def is_read(text: str) -> bool:
    try:
        value_of(text)
    except Findings:
        return False
    return True


def test_limits_of_a_file():
    assert_limits(
        lambda n: is_read("[" * n + "]" * n), most=39
    )  # in the file's mapping
    assert_limits(lambda n: is_read("{a: " * n + "}" * n), most=39)
    assert_limits(lambda n: is_read('"' + "x" * n + '"'), most=20_000)
    assert_limits(lambda n: isinstance(value_of("1" * n), int), least=1, most=39)
    assert_limits(lambda n: isinstance(value_of("0x" + "1" * n), int), most=37)


def test_a_file_is_read_up_to_the_limit(tmp_path, monkeypatch):
    monkeypatch.setattr(source, "MAX_BYTES", 10)

    def is_accepted(size: int) -> bool:
        (tmp_path / "demo.yaml").write_bytes(b"x" * size)
        try:
            return len(source.contents(tmp_path / "demo.yaml", "demo")) == size
        except Findings as error:
            (finding,) = error.findings
            assert finding.message == "the file has more than the 10 bytes allowed"
            return False

    assert_limits(is_accepted, most=10)


def test_a_duplicate_key_is_reported_at_each_place_with_the_line_of_the_last_before_it():
    with pytest.raises(Findings) as error:
        source.parse(b"a: 1\nb: {c: 1}\na: 2\n\na: 3\n", "demo.yaml")
    assert [(each.code, each.place, each.message) for each in error.value.findings] == [
        ("ICD002", Place("demo.yaml", line, 1, 1), f"the key `a` is twice in this mapping, first in line {first}")
        for line, first in ((3, 1), (5, 3))
    ]  # fmt: skip


def test_a_point_is_a_text():
    assert value_of(".") == "."
