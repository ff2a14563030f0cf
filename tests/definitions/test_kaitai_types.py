"""Types of Kaitai Struct: built-in types, scopes, sizes and contents."""

from __future__ import annotations

import pytest

from icdgen.definitions import kaitai_types
from icdgen.definitions.frames import BIG, LITTLE
from icdgen.definitions.kaitai_yaml import parse
from icdgen.definitions.model import NotSupported
from icdgen.icd.located import Map
from tests.limits import assert_limits

MOST_BYTES = 65535

SCOPES = """
meta: {id: top, endian: le, encoding: ascii}
enums:
  mode: {0: off, 0x10: {id: on}, x: bad}
types:
  a:
    meta: {endian: be, bit-endian: le}
    enums: {mode: {1: inner}}
    types:
      b: {seq: []}
  c:
    meta: {endian: {switch-on: x}, encoding: utf-16}
  d: text
"""


def declared(text=SCOPES):
    return kaitai_types.declare_types("top", parse("a.ksy", text.encode()))


def attribute(**keys):
    text = "meta: {id: a}\nof:\n  id: x\n"
    text += "".join(
        f"  {key.replace('_', '-')}: {value}\n" for key, value in keys.items()
    )
    return parse("a.ksy", text.encode())["of"]


def reason(call, *arguments):
    with pytest.raises(NotSupported) as raised:
        call(*arguments)
    return str(raised.value)


def built_in(name, within=None, **keys):
    return kaitai_types.built_in_type(name, attribute(**keys), within or declared())


def test_a_type_inherits_the_orders_of_the_enclosing_one():
    top = declared()
    a, c = top.types["a"], top.types["c"]
    assert list(top.types) == ["a", "c"]
    assert (top.endian, top.bit_endian) == (LITTLE, BIG)
    assert (a.endian, a.bit_endian) == (BIG, LITTLE)
    assert (a.types["b"].endian, a.types["b"].bit_endian) == (BIG, LITTLE)
    # An order that depends on a value is none.
    assert (c.endian, c.bit_endian) == (None, BIG)


def test_a_type_is_searched_in_the_enclosing_ones():
    top = declared()
    a, b = top.types["a"], top.types["a"].types["b"]
    assert a.find_type("b") is b and b.find_type("c") is top.types["c"]
    assert top.find_type("a::b") is b and b.find_type("top") is top
    assert b.find_type("top::a::b") is b and b.find_type("a") is a
    assert reason(top.find_type, "b") == "there is no type `b`"
    assert reason(top.find_type, "a::c") == "there is no type `a::c`"


def test_an_enumeration_is_searched_in_the_enclosing_types():
    top = declared()
    b = top.types["a"].types["b"]
    assert top.members("mode") == {0: "off", 16: "on"}
    assert b.members("mode") == top.members("a::mode") == {1: "inner"}
    assert top.types["c"].members("mode") == {0: "off", 16: "on"}
    assert reason(b.members, "state") == "there is no enumeration `state`"


def test_types_are_nested_at_most_40_levels_deep():
    def is_declared(depth):
        spot = parse("a.ksy", SCOPES.encode()).spot
        body = Map(spot)
        for _ in range(depth):
            types = Map(spot)
            types["t"], body = body, Map(spot)
            body["types"] = types
        scope = kaitai_types.declare_types("top", body)
        for _ in range(depth):
            if "t" not in scope.types:
                return False
            scope = scope.types["t"]
        return True

    assert_limits(is_declared, most=40)


def test_a_sequence_is_a_list_of_attributes():
    a = declared().types["a"]
    assert a.seq == [] and a.types["b"].seq == []
    for text in ("meta: {id: a}\nseq: 1\n", "meta: {id: a}\nseq: [1]\n"):
        scope = declared(text)
        with pytest.raises(NotSupported, match=r"^the `seq` of `top` is not a list"):
            _ = scope.seq


@pytest.mark.parametrize(
    ("name", "kind", "bits", "order"),
    [
        ("u1", "uint", 8, LITTLE),
        ("s2", "int", 16, LITTLE),
        ("u4be", "uint", 32, BIG),
        ("s8le", "int", 64, LITTLE),
        ("f4", "float", 32, LITTLE),
        ("f8be", "float", 64, BIG),
    ],
)
def test_a_number_has_its_size_and_order(name, kind, bits, order):
    field = built_in(name)
    assert (field.item, field.bits, field.order) == ({"type": kind}, bits, order)
    assert not field.is_bits


def test_a_number_of_several_bytes_needs_an_order():
    c = declared().types["c"]
    assert built_in("u1", c).order == BIG and built_in("u2le", c).order == LITTLE
    message = "the byte order of `u2` is not stated"
    assert reason(built_in, "u2", c) == message
    for name in ("f1", "f2le"):
        assert reason(built_in, name) == f"there is no type `{name}`"
    for name in ("u3", "x1", "u1x", "b0", "b", "other"):
        assert built_in(name) is None


def test_bits_are_a_boolean_or_an_integer_of_at_most_64_bits():
    def is_accepted(bits):
        try:
            field = built_in(f"b{bits}")
        except NotSupported as error:
            assert str(error) == f"an integer has {bits} bits"
            return False
        return field.bits == bits and field.item == {"type": "uint"} and field.is_bits

    assert_limits(is_accepted, least=2, most=64)
    assert built_in("b1").item == {"type": "bool"}
    assert built_in("b1", enum="mode").item == {"type": "uint"}
    assert built_in("b4").order == BIG and built_in("b4le").order == LITTLE
    a = declared().types["a"]
    assert built_in("b4", a).order == LITTLE and built_in("b4be", a).order == BIG


@pytest.mark.parametrize(
    ("name", "keys", "kind", "bits"),
    [
        ("str", {"size": 4}, "text", 32),
        ("strz", {"size": "'0x4'"}, "text", 32),
        ("", {"size": 4}, "bytes", 32),
        ("str", {"size": 4, "encoding": "utf-8"}, "text", 32),
        ("str", {"size": 4, "encoding": "ISO-8859-1"}, "text", 32),
        ("str", {"size": 4, "encoding": "utf-16"}, "bytes", 32),
        ("str", {"size": "length"}, "text", 0),
        ("str", {"size_eos": "true"}, "text", 0),
        ("", {"size": 0}, "bytes", 0),
    ],
)
def test_texts_and_bytes_have_a_size(name, keys, kind, bits):
    field = built_in(name, **keys)
    assert (field.item, field.bits) == ({"type": kind}, bits)


def test_the_encoding_is_that_of_the_nearest_type():
    top = declared()
    assert built_in("str", top.types["a"].types["b"], size=1).item == {"type": "text"}
    assert built_in("str", top.types["c"], size=1).item == {"type": "bytes"}


def test_a_text_without_a_size_is_not_supported():
    terminated = "its size is not stated: it ends at a terminator"
    assert reason(lambda: built_in("strz")) == terminated
    assert reason(lambda: built_in("str", terminator=0)) == terminated
    assert reason(lambda: built_in("str")) == "its size is not stated"
    assert reason(lambda: built_in("", size_eos="false")) == "its size is not stated"


def test_a_size_is_at_most_65535_bytes():
    def is_accepted(size):
        try:
            return kaitai_types.stated_size(attribute(size=size)) == size
        except NotSupported as error:
            assert str(error) == f"its size is {size}"
            return False

    assert_limits(is_accepted, least=0, most=MOST_BYTES)
    for other in ("true", "length", "1.5"):
        assert kaitai_types.stated_size(attribute(size=other)) is None


@pytest.mark.parametrize(
    ("contents", "result"),
    [
        ("AB", b"AB"),
        ("'é'", "é".encode()),
        ("[0x41, 0, 255]", b"\x41\x00\xff"),
        ("[A, '10', 0b1, '300']", b"A\x0a\x01300"),
    ],
)
def test_contents_are_bytes_and_texts(contents, result):
    assert kaitai_types.stated_contents(attribute(contents=contents)) == result


def test_other_contents_are_not_supported():
    stated = kaitai_types.stated_contents
    assert stated(attribute()) is None
    for contents, shown in (("[256]", "256"), ("[-1]", "-1"), ("[1.5]", "1.5")):
        message = f"its contents are `{shown}`"
        assert reason(stated, attribute(contents=contents)) == message
    assert reason(stated, attribute(contents="[]")) == "its contents are 0 bytes"

    def is_accepted(length):
        try:
            return stated({"contents": "a" * length}) == b"a" * length
        except NotSupported as error:
            assert str(error) == f"its contents are {length} bytes"
            return False

    assert_limits(is_accepted, least=1, most=MOST_BYTES)
