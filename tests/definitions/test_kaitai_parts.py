"""Parts of Kaitai Struct messages: positions and sizes, references to parts in front,
and valid values.
"""

from __future__ import annotations

import pytest

from icdgen.definitions.containers import ContainerPart, Counter
from icdgen.definitions.frames import BIG, LITTLE
from icdgen.definitions.kaitai_parts import File, TypeScope, apply_valid, placed
from icdgen.definitions.kaitai_types import KaitaiFieldType, declare_types
from icdgen.definitions.kaitai_yaml import parse
from icdgen.definitions.model import Definitions, NotSupported

ENUMS = "enums: {mode: {3: idle, -1: fault}}"


def top(more=ENUMS):
    return declare_types("top", parse("a.ksy", f"meta: {{id: top}}\n{more}\n".encode()))


def part(type_="uint", bits=8, order=BIG, is_bits=False, at=0, **keys):
    field_type = KaitaiFieldType({"type": type_, **keys}, bits, order, is_bits=is_bits)
    return placed(("a", "b"), field_type, at)


def counter(bits, plus=0):
    return Counter(ContainerPart(("n",), {"type": "uint"}, 0, bits), plus)


def test_a_part_has_the_size_of_all_its_elements():
    single = part(bits=12, order=LITTLE, at=4)
    assert (single.path, single.at, single.bits, single.element, single.order) == (
        ("a", "b"), 4, 12, 12, LITTLE,
    )  # fmt: skip
    assert single.item == {"type": "uint"} and single.counter is None
    array = part(bits=16, count=3)
    assert (array.bits, array.element, array.item["count"]) == (48, 16, 3)
    assert "up_to" not in array.item
    assert (single.place.at, single.place.bits, single.place.order) == (4, 12, LITTLE)


@pytest.mark.parametrize(
    ("item", "bits", "count", "up_to", "element"),
    [
        ({"type": "bytes"}, 0, None, 65535, 8),
        ({"type": "bytes"}, 0, counter(8), 255, 8),
        ({"type": "bytes"}, 0, counter(8, 2), 257, 8),
        ({"type": "text"}, 0, counter(16), 65535, 8),
        ({"type": "bytes"}, 0, counter(32), 65535, 8),
        ({"type": "uint", "count": "rest"}, 16, None, 1024, 16),
        ({"type": "uint", "count": "rest"}, 16, counter(8), 255, 16),
        ({"type": "uint", "count": "rest"}, 16, counter(16), 1024, 16),
    ],
)
def test_a_part_of_variable_length_has_as_many_elements_as_are_countable(
    item, bits, count, up_to, element
):
    result = placed(("x",), KaitaiFieldType(dict(item), bits), 24, count)
    assert result.item == {**item, "up_to": up_to}
    assert (result.bits, result.element, result.counter) == (0, element, count)


@pytest.mark.parametrize(
    ("made", "is_ordered"),
    [
        (part(bits=8), False), (part(bits=9), True), (part(bits=3, is_bits=True), True),
        (part("bytes", bits=16), False), (part("text", bits=16), False),
        (part("enum", bits=16), True),
    ],
)  # fmt: skip
def test_numbers_of_several_bytes_and_bits_have_an_order(made, is_ordered):
    assert made.is_ordered == is_ordered


def test_a_byte_of_which_bits_are_fixed_has_an_order():
    byte, array = part(), part(count=2)
    byte.mask = array.mask = 1
    assert byte.is_ordered and not array.is_ordered


def scopes():
    """Return the scopes of three nested types."""
    outer = TypeScope(top())
    middle = TypeScope(outer.type, outer)
    inner = TypeScope(outer.type, middle)
    outer.names |= {"length": part(), "header": middle}
    middle.names |= {"length": part(), "body": inner}
    inner.names |= {"length": part()}
    return outer, middle, inner


def test_a_path_leads_through_scopes_to_a_part():
    outer, middle, inner = scopes()
    for scope, path, owner in (
        (inner, "length", inner),
        (inner, "_parent.length", middle),
        (inner, "_parent._parent.length", outer),
        (inner, "_root.length", outer),
        (outer, "_root.length", outer),
        (outer, "header.length", middle),
        (outer, "header.body.length", inner),
        (middle, "body._parent._parent.header.length", middle),
    ):
        assert scope.find_part(path) is owner.names["length"], path


@pytest.mark.parametrize(
    "path",
    ["other", "header", "_root", "_parent", "_parent.length", "length.more",
     "length._root.length", "other.length", "header.other"],
)  # fmt: skip
def test_another_path_is_no_part(path):
    with pytest.raises(NotSupported) as caught:
        scopes()[0].find_part(path)
    assert str(caught.value) == f"`{path}` is not a number in front of it"


def valid(text, made):
    """Apply the value of `valid` and return constant bits and keys of the part."""
    body = parse("a.ksy", f"meta: {{id: top}}\nvalid: {text}\n".encode())
    apply_valid(made, body["valid"], TypeScope(top()))
    made.item.pop("type")
    return made.mask, made.value, made.item


@pytest.mark.parametrize(
    ("text", "made", "expected"),
    [
        ("5", part(), (255, 5, {})), ("0", part(), (255, 0, {})),
        ("0x7F", part(bits=16), (0xFFFF, 0x7F, {})),
        ("-1", part("int"), (255, 255, {})), ("{eq: 7}", part(), (255, 7, {})),
        ("mode::idle", part("enum"), (255, 3, {})),
        ("{eq: 'mode::fault'}", part("enum"), (255, 255, {})),
        ("{min: 0, max: 9}", part(), (0, 0, {"min": 0, "max": 9})),
        ("{min: 0, max: 255}", part(), (0, 0, {"min": 0, "max": 255})),
        ("{min: -1, max: 256}", part(), (0, 0, {})),
        ("{min: -128, max: 128}", part("int"), (0, 0, {"min": -128})),
        ("{min: true, max: 1.5}", part(), (0, 0, {})),
        ("{min: 1, max: 2}", part("enum"), (0, 0, {})),
        ("{any-of: [1, 2]}", part(), (0, 0, {})),
        ("{min: 1, eq: 2}", part(), (255, 2, {"min": 1})),
        ("other", part(), (0, 0, {})), ("5", part("float", bits=32), (0, 0, {})),
        ("5", part("bytes"), (0, 0, {})), ("5", part(count=2), (0, 0, {"count": 2})),
        ("null", part(), (0, 0, {})),
    ],
)  # fmt: skip
def test_a_valid_value_is_a_constant_or_limits(text, made, expected):
    assert valid(text, made) == expected


def test_a_finding_is_reported_once_with_its_line():
    to = Definitions("a.ksy")
    file = File(to)
    for help in ("first", "second"):
        file.note("IMP081", "text", help, "error", 7)
    (finding,) = to.import_findings
    assert (finding.code, finding.message, finding.help) == ("IMP081", "text", "first")
    assert (finding.severity, finding.spot.line) == ("error", 7)
