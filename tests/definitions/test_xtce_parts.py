"""Entries of XTCE containers from the first one of variable length on become fields with
their counter, size and position.
"""

from __future__ import annotations

from xml.etree.ElementTree import fromstring

import pytest

from icdgen.definitions.containers import Counter
from icdgen.definitions.frames import BIG, LITTLE
from icdgen.definitions.model import Definitions, NotSupported
from icdgen.definitions.xtce_parts import (
    Reference,
    XtcePart,
    names_of_parts,
    sequence_fields,
)
from icdgen.definitions.xtce_types import XtceFieldType

MOST_BYTES = 65535  # of a frame


def reference(name, *path, up_to=None):
    inner = ""
    if up_to is not None:
        data = f'<AncillaryData name="ICD up_to">{up_to}</AncillaryData>'
        inner = f"<AncillaryDataSet>{data}</AncillaryDataSet>"
    return Reference(fromstring(f'<Parameter name="{name}">{inner}</Parameter>'), path)


def part(
    name, width=8, at=0, order=BIG, element=8, size="", plus=None, up_to=None, **item
):
    """Return a part; ``size`` is the parameter that counts it, if it has no bits."""
    item = item or {"type": "uint"}
    if not width:
        item.setdefault("up_to", MOST_BYTES)
    path = name.split("/")
    return XtcePart(
        (path[-1],), item, at, width, order, element,
        field_type=XtceFieldType(item, width, size=size, plus=plus),
        reference=reference(path[0], *path[1:], up_to=up_to),
    )  # fmt: skip


def data(name="Data", **keys):
    """Return a part of bytes with a variable length."""
    return part(name, 0, **{"type": "bytes", **keys})


def fields(parts, front=(), length=1, order=BIG, names=None, **message):
    """Return the fields of parts behind ``length`` bytes, and the findings."""
    to = Definitions("a.xml")
    names = names_of_parts([*front, *parts]) if names is None else names
    message = {"name": "M", "length": length, **message}
    return sequence_fields(parts, list(front), names, message, order, to), [
        (f.code, f.severity, f.message, f.help) for f in to.import_findings
    ]


def test_repeated_names_of_parts_get_numbers():
    parts = [part(name) for name in ("Mode", "Gain", "x/Mode", "Mode")]
    names = names_of_parts(parts)
    assert [names[id(each)] for each in parts] == ["Mode", "Gain", "Mode 2", "Mode 3"]


def test_a_reference_has_the_name_of_its_parameter_and_members():
    assert reference("P").name == "P"
    assert reference("P", "a", "b").name == "P/a/b"


def test_the_width_of_a_part_is_that_of_an_element():
    assert part("A", 16).width == 16
    assert part("A", 32, type="uint", bits=8, count=4).width == 8
    assert data(element=24).width == 24


def test_fields_of_a_sequence_follow_the_part_in_front():
    parts = [
        data(size="N", plus=0),
        part("A", 8),
        part("B", 16, type="int"),
    ]
    result, findings = fields(parts, [part("N")], length=3)
    assert result == [
        {"at": 24, "name": "Data", "type": "bytes", "up_to": 255, "size": "N"},
        {"at": 24, "after": "Data", "bits": 8, "name": "A", "type": "uint"},
        {"at": 24, "after": "A", "bits": 16, "name": "B", "type": "int"},
    ]
    assert findings == []


def test_a_reserved_part_of_a_sequence_is_bytes():
    reserved = part("R", 24)
    reserved.is_reserved = True
    result, _ = fields([data(), reserved])
    assert result[1] == {
        "at": 8,
        "after": "Data",
        "bits": 24,
        "name": "R",
        "type": "bytes",
    }


@pytest.mark.parametrize(
    ("keys", "order", "message", "expected"),
    [
        ({"width": 16, "order": LITTLE}, BIG, {}, ("little", "lsb0")),
        ({"width": 16, "order": BIG}, LITTLE, {}, ("big", "msb0")),
        ({"width": 16, "order": BIG}, BIG, {}, None),
        ({"width": 9, "order": LITTLE}, BIG, {}, ("little", "lsb0")),
        ({"width": 8, "order": LITTLE}, BIG, {}, None),
        ({"width": 16, "order": LITTLE}, BIG, {"byte_order": LITTLE}, None),
        ({"width": 16, "order": BIG}, BIG, {"byte_order": LITTLE}, ("big", "msb0")),
        ({"width": 16, "order": LITTLE, "type": "bytes"}, BIG, {}, None),
        ({"width": 16, "order": LITTLE, "type": "text"}, BIG, {}, None),
    ],
)
def test_numbers_of_several_bytes_state_an_order_that_differs_from_the_message(
    keys, order, message, expected
):
    (_, field), _ = fields([data(), part("A", **keys)], order=order, **message)
    assert (
        None
        if expected is None
        else {"byte_order": expected[0], "bit_order": expected[1]}
    ) == ({k: v for k, v in field.items() if k.endswith("_order")} or None)


def test_elements_of_a_variable_array_have_the_order_of_their_numbers():
    def order(element):
        (field,), _ = fields(
            [part("A", 0, order=LITTLE, element=element, type="uint", bits=element)]
        )
        return field.get("byte_order")

    assert (order(8), order(16)) == (None, "little")


@pytest.mark.parametrize(
    ("stated", "counter", "plus", "size", "most"),
    [
        (None, 8, 0, "N", 255),
        (None, 8, 2, {"field": "N", "plus": 2}, 257),
        (None, 8, -4, {"field": "N", "plus": -4}, 251),
        (9, 8, 0, "N", 9),
        (256, 8, 0, "N", 255),
        (0, 8, 0, "N", 1),  # at least one
        (3, 8, 3, {"field": "N", "plus": 3}, 3),
        (None, 3, 0, "N", 7),
        (None, 8, -254, {"field": "N", "plus": -254}, 1),
    ],
)
def test_a_counted_part_has_the_most_elements_that_are_stated_and_countable(
    stated, counter, plus, size, most
):
    parts = [data(size="N", plus=plus, up_to=stated)]
    (field,), findings = fields(parts, [part("N", counter)])
    assert (field["size"], field["up_to"], findings) == (size, most, [])
    assert parts[0].counter == Counter(parts[0].counter.part, plus)


@pytest.mark.parametrize(
    ("plus", "counter"),
    [
        (None, {}),
        (-255, {}),  # never more than 0
        (4, {"up_to": 3}),  # a counter of 0 means 4, more than the maximum
        (0, {"type": "int"}),
        (0, {"type": "uint", "formula": "raw*2"}),
        (0, {"type": "uint", "const": 3}),
    ],
)
def test_a_part_that_its_counter_cannot_count_extends_to_the_end_of_the_frame(
    plus, counter
):
    stated = counter.pop("up_to", None)
    parts = [data(size="N", plus=plus, up_to=stated)]
    (field,), findings = fields(parts, [part("N", **counter)])
    assert (field["size"], parts[0].counter) == ("rest", None)
    assert findings == [
        (
            "IMP080",
            "warning",
            "message `M`: `Data` is as long as `N` says",
            "it is imported up to the end of the frame",
        )
    ]


def test_a_part_without_a_counter_extends_to_the_end_without_a_finding():
    for size in ("", "Other"):
        (field,), findings = fields([data(size=size, plus=0)], [part("N")])
        assert (field["size"], findings) == ("rest", [])


@pytest.mark.parametrize(
    ("name", "size", "is_counter"),
    [
        ("N", "N", True),
        ("N", "/s/t/N", True),
        ("N", "../N", True),
        ("P/n", "P/n", True),
        ("P/n", "/s/P/n", True),
        ("P/n", "n", False),
        ("N", "MN", False),
        ("N", "N/n", False),
    ],
)
def test_a_counter_is_named_by_the_end_of_a_reference(name, size, is_counter):
    (field,), _ = fields([data(size=size, plus=0)], [part(name)])
    assert (field["size"] != "rest") == is_counter


def test_the_first_of_equal_names_counts_and_a_fixed_value_does_not():
    fixed = part("N")
    fixed.reference = None
    front = [fixed, part("N", 4), part("N")]
    (field,), _ = fields([data(size="N", plus=0)], front)
    assert (field["size"], field["up_to"]) == ("N 2", 15)


def test_the_longest_frame_has_65535_bytes():
    def most(length, behind, element=8, **keys):
        parts = [part("A", 0, element=element, **{"type": "bytes", **keys})]
        parts += [part("B", behind)] if behind else []
        result, _ = fields(parts, length=length)
        return result[0]["up_to"]

    assert most(0, 0) == MOST_BYTES
    assert most(3, 0) == MOST_BYTES - 3
    assert most(3, 16) == MOST_BYTES - 5
    assert most(3, 16, 32, type="uint", bits=32) == (MOST_BYTES - 5) // 4
    counted = [data(size="N", plus=0), part("B", 8)]
    result, _ = fields(counted, [part("N", 16)], length=2)
    assert result[0]["up_to"] == MOST_BYTES - 3  # less than its counter can state
    assert most(3, 16, type="bytes", up_to=20) == 20


def test_a_part_to_the_end_leaves_room_for_counted_parts():
    parts = [data("First", size="N", plus=0, up_to=10), data("Last")]
    result, _ = fields(parts, [part("N")], length=1)
    assert [field["up_to"] for field in result] == [10, MOST_BYTES - 11]


def failure(*parts, **keys):
    with pytest.raises(NotSupported) as caught:
        fields(list(parts), [part("N")], **keys)
    return str(caught.value)


def test_parts_behind_a_variable_part_cannot_be_optional_or_follow_an_end():
    assert failure(data(size="N", plus=0), part("A", type="uint", when={"N": 1})) == (
        "`A` is behind a part of variable size"
    )
    assert failure(data(), data("More")) == (
        "`More` follows a part that no parameter counts"
    )
    # A fixed part may follow it.
    assert [field["name"] for field in fields([data(), part("A")])[0]] == ["Data", "A"]


def test_a_counter_must_be_a_field_of_the_message():
    parts = [data(size="N", plus=0)]
    with pytest.raises(
        NotSupported, match="`Data` is counted by a field of the header"
    ):
        fields(parts, [part("N")], names=names_of_parts(parts))
