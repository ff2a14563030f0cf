"""Input of the rules: which nodes, messages and protocol facts a node has."""

from __future__ import annotations

import pytest

from icdgen.icd.rules.context import Context, is_overlay, own_fact, section_of
from tests.icd.files import loaded

NODE = (
    "icdgen: 1\n{}node: {{name: {}, title: T, byte_order: little, bit_order: lsb0}}\n"
)


def node(name: str, *include: str, rest: str = "") -> str:
    files = ", ".join(f"{each}.yaml" for each in include)
    return NODE.format(f"include: [{files}]\n" if include else "", name) + rest


def command(name: str, id: str) -> str:
    return f"messages:\n  - {{name: {name}, id: {id}, kind: telecommand, length: 0}}\n"


def context(folder, *files: str) -> Context:
    """Return the context of the files; each has the name of its node."""
    first, *others = files
    for text in others:
        name = text.partition("node: {name: ")[2].partition(",")[0]
        first += f"# {name}.yaml\n{text}"
    result = loaded(folder, first)
    return Context(result.icd, texts=result.texts)


@pytest.fixture
def ctx(tmp_path) -> Context:
    """`demo` includes `middle` and `side`, and `middle` includes `base`."""
    uart = "uart: {line: {baud_rate: 9600}}"
    broken = "  - {name: Broken, id: 9, kind: telecomand, length: 0}\n"
    return context(
        tmp_path,
        node("demo", "middle", "side", rest=command("Own", "0x05")),
        node("middle", "base", rest=command("Mid", "6") + broken),
        node(
            "base",
            rest=f"protocol: {{link: {{buses: {{{uart}}}}}}}\n"
            + command("Base", "0x7"),
        ),
        node(
            "side",
            rest="protocol: {link: {framing: {by: slip}, header: [{bits: 8, role: id}]}}\n"
            + command("Side", "[8]"),
        ),
    )


def names(items) -> list[str]:
    return [item.name for item in items]


def test_the_scope_of_a_node_is_what_it_includes_and_itself(ctx):
    by_name = {each.name: each for each in ctx.icd.nodes}
    scopes = {name: names(ctx.scope(each)) for name, each in by_name.items()}
    assert scopes == {
        "base": ["base"],
        "middle": ["base", "middle"],
        "side": ["side"],
        "demo": ["base", "middle", "side", "demo"],
    }
    users = {name: names(ctx.users(each)) for name, each in by_name.items()}
    assert users == {
        "base": ["base", "middle", "demo"],
        "middle": ["middle", "demo"],
        "side": ["side", "demo"],
        "demo": ["demo"],
    }
    demo = by_name["demo"]
    messages = ctx.messages_of(demo)
    assert names(messages) == ["Base", "Mid", "Side", "Own"]
    homes = [ctx.home_of(message, demo).name for message in messages]
    assert homes == ["base", "middle", "side", "demo"]
    assert names(ctx.messages_of(by_name["middle"])) == ["Base", "Mid"]


def test_messages_that_are_invalid_are_known_by_name(ctx):
    by_name = {each.name: each for each in ctx.icd.nodes}
    broken = {name: ctx.broken_messages(each) for name, each in by_name.items()}
    assert broken == {
        "base": set(),
        "side": set(),
        "middle": {"Broken"},
        "demo": {"Broken"},
    }


def test_protocol_facts_of_included_nodes_apply(ctx):
    by_name = {each.name: each for each in ctx.icd.nodes}
    path = ("link", "buses", "uart", "line", "baud_rate")
    rates = {name: ctx.fact(each, *path) for name, each in by_name.items()}
    # The framed link of `side` replaces the buses of `base`.
    assert rates == {"base": 9600, "middle": 9600, "demo": None, "side": None}
    own = {name: own_fact(each, *path) for name, each in by_name.items()}
    assert own == {"base": 9600, "middle": None, "demo": None, "side": None}
    line = section_of(by_name["base"], *path[:-1])
    assert line == {"baud_rate": 9600} and str(line.place).endswith("base.yaml:3:40")
    assert section_of(by_name["base"], *path) is None
    assert list(ctx.sections(*path[:-1])) == [line]
    # A framed link needs no message with an id and one length.
    linked = {name: ctx.is_linked(each) for name, each in by_name.items()}
    assert linked == {"base": True, "middle": True, "demo": False, "side": False}


def test_numbers_are_shown_as_the_file_has_them(ctx):
    written = {
        message.name: ctx.written(message.source, "id") for message, _ in ctx.messages
    }
    assert written == {"Base": "0x7", "Mid": "6", "Side": "0x08", "Own": "0x05"}
    without_texts = Context(ctx.icd)
    message = ctx.messages_of(ctx.icd.node("demo"))[0]
    assert without_texts.written(message.source, "id") == "7"


def test_of_two_files_of_one_name_the_first_is_included(tmp_path):
    twin = node("twin", rest=command("First", "1"))
    other = node("twin", rest=command("Second", "2"))
    text = node("demo", "one", "two") + f"# one.yaml\n{twin}# two.yaml\n{other}"
    result = loaded(tmp_path, text)
    ctx, demo = Context(result.icd), result.icd.node("demo")
    assert names(ctx.scope(demo)) == ["twin", "demo"]
    assert names(ctx.messages_of(demo)) == ["First"]


FIELDS = """\
enums: [{name: Mode, members: [{value: 0, name: Idle}]}]
structs:
  - {name: Pair, length: 1, fields: [{at: 0, bits: 8, name: In, type: uint, unit: V}]}
messages:
  - name: Status
    id: 130
    kind: telemetry
    length: 4
    fields:
      - {at: 0, name: A, struct: Pair}
      - {at: 8, bits: 8, name: M, type: enum, enum: Mode}
      - {at: 16, bits: 8, count: 2, name: L, type: uint, unit: V, formula: raw*2}
      - {at: 16, bits: 4, name: O, type: uint, view: true}
      - {at: 20, bits: 4, name: P, type: uint, view: false}
    derived:
      - {name: D, formula: M + M, unit: V}
"""


def test_lines_and_fields_are_listed_once(tmp_path):
    """Fields of a struct with the struct; derived values only by their unit."""
    (folder := tmp_path / "demo").mkdir()
    text = FIELDS.replace("M + M", "O + P")
    ctx = context(folder, node("demo", rest=text))
    assert [line.node.name for line in ctx.lines] == ["A", "M", "L", "O", "P", "In"]
    assert [field.name for field, _ in ctx.fields] == ["M", "L", "O", "P", "In"]
    by_key = {
        key: [field.name for field, _ in fields]
        for key, fields in ctx.fields_with.items()
        if fields
    }
    assert by_key == {
        "enum": ["M"],
        "unit": ["L", "In", "D"],
        "formula": ["L"],
        "view": ["O", "P"],
    }
    overlays = [line.node.name for line in ctx.lines if is_overlay(line.node)]
    assert overlays == ["O"]
    (pair,) = ctx.structs
    assert ctx.struct_of == {id(pair[0].layout): pair}


def test_orders_of_a_line_precede_those_of_its_message_and_node(tmp_path):
    rest = """\
messages:
  - name: Status
    id: 130
    kind: telemetry
    length: 4
    byte_order: big
    fields:
      - {at: 0, bits: 16, name: A, type: uint}
      - {at: 16, bits: 16, name: B, type: uint, byte_order: little}
"""
    ctx = context(tmp_path, node("demo", rest=rest))
    orders = [(line.orders.byte, line.orders.bit) for line in ctx.lines]
    assert orders == [("big", "lsb0"), ("little", "lsb0")]
