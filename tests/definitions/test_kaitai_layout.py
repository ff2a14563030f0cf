"""Attributes of Kaitai Struct follow each other at these bits, in each combination of
branches; attributes that an ICD cannot represent become bytes with the reason.
"""

from __future__ import annotations

import pytest

from icdgen.definitions.kaitai_layout import KaitaiLayout
from icdgen.definitions.kaitai_parts import File, Undecided
from icdgen.definitions.kaitai_types import declare_types
from icdgen.definitions.kaitai_yaml import parse
from icdgen.definitions.model import Definitions
from tests.limits import assert_limits


def layouts(*attributes, more="", endian="be"):
    """Return the layout of each combination of branches, and the definitions."""
    text = f"meta: {{id: top, endian: {endian}}}\nseq:\n"
    text += "".join(f"  - {{{attribute}}}\n" for attribute in attributes)
    root = declare_types("top", parse("a.ksy", (text + more).encode()))
    to = Definitions("a.ksy")
    file, result, left = File(to), [], [{}]
    while left:
        decided = left.pop(0)
        layout = KaitaiLayout(file, decided)
        try:
            layout.read(root)
        except Undecided as error:
            left += [{**decided, error.key: option} for option in error.options]
            continue
        result.append(layout)
    return result, to


def layout_of(*attributes, **more):
    (layout,), to = layouts(*attributes, **more)
    assert to.import_findings == []
    return layout


def parts(layout):
    return [(" ".join(part.path), part.at, part.bits) for part in layout.parts]


def values(layout):
    """Return mask and value of each part of which bits are fixed."""
    return {
        part.path[-1]: (part.mask, part.value) for part in layout.parts if part.mask
    }


A = "id: a, type: u1"


def test_attributes_follow_each_other_and_bytes_begin_behind_bits():
    layout = layout_of(
        A, "id: b, type: b3", "id: c, type: b2", "type: u2", "id: d, type: b1"
    )
    assert parts(layout) == [
        ("a", 0, 8), ("b", 8, 3), ("c", 11, 2), ("unnamed3", 16, 16), ("d", 32, 1),
    ]  # fmt: skip
    assert (layout.length, layout.is_open) == (5, False)


def test_contents_are_constants_of_up_to_8_bytes():
    layout = layout_of(
        "id: b, type: b1", "id: m, contents: [1, 2], doc: Mark.",
        "id: n, contents: [1, 2, 3, 4, 5, 6, 7, 8, 9], doc: Long.",
        "id: e, contents: [9, 9, 9, 9, 9, 9, 9, 9]",
    )  # fmt: skip
    assert parts(layout) == [
        ("b", 0, 1), ("m", 8, 16), ("n 1", 24, 64), ("n 2", 88, 8), ("e", 96, 64),
    ]  # fmt: skip
    assert [(part.mask, part.value) for part in layout.parts[1:4]] == [
        (0xFFFF, 0x0102), ((1 << 64) - 1, 0x0102030405060708), (0xFF, 9),
    ]  # fmt: skip
    texts = [part.item.get("summary") for part in layout.parts]
    assert texts == [None, "Mark.", "Long.", None, None]


def test_an_attribute_without_bytes_is_no_part():
    assert parts(layout_of(A, "id: n, size: 0", "id: b, type: u1")) == [
        ("a", 0, 8), ("b", 8, 8),
    ]  # fmt: skip


PAIR = "types:\n  t:\n    seq: [{id: x, type: u1}, {id: y, type: b4}]\n"


def test_a_type_that_is_not_repeated_is_part_of_the_message():
    layout = layout_of(
        A, "id: p, type: t", "id: b, type: b2", "id: c, type: u1", more=PAIR
    )
    assert parts(layout) == [
        ("a", 0, 8), ("p x", 8, 8), ("p y", 16, 4), ("b", 20, 2), ("c", 24, 8),
    ]  # fmt: skip


def test_the_next_part_begins_behind_a_stated_size():
    layout = layout_of("id: p, type: t, size: 4", "id: b, type: u1", more=PAIR)
    assert parts(layout) == [("p x", 0, 8), ("p y", 8, 4), ("b", 32, 8)]
    rest = PAIR.replace("{id: y, type: b4}", "{id: y, size-eos: true}")
    layout = layout_of("id: p, type: t, size: 4", "id: b, type: u1", more=rest)
    assert parts(layout) == [("p x", 0, 8), ("p y", 8, 24), ("b", 32, 8)]
    assert not layout.is_open


def findings(*attributes, more="", **keys):
    """Return the parts of the only layout, and the messages with their effects."""
    (layout,), to = layouts(*attributes, more=more, **keys)
    assert {(f.code, f.severity) for f in to.import_findings} <= {("IMP081", "error")}
    return parts(layout), [(f.message, f.help) for f in to.import_findings]


REST = "the bytes up to the end of the frame are imported"
OWN = "its bytes are imported"


@pytest.mark.parametrize(
    ("attribute", "why", "effect", "behind"),
    [
        ("size: 2, process: zlib",
         "its bytes are processed by `zlib` before they are read", OWN,
         [("b", 8, 16), ("z", 24, 8)]),
        ("type: nothing", "there is no type `nothing`", REST, [("b", 8, 0)]),
        ("type: t(1), size: 3", "the type `t(1)` has parameters", OWN,
         [("b", 8, 24), ("z", 32, 8)]),
        ("type: u1, repeat: expr, repeat-expr: 0", "it is repeated 0 times", REST,
         [("b", 8, 0)]),
        ("size: 2, repeat: expr, repeat-expr: 2", "its elements are not numbers", REST,
         [("b", 8, 0)]),
        ("type: u1, if: a > 3, size: 1",
         "it depends on `a > 3`, which is more than equalities of fields", REST,
         [("b", 8, 0)]),
    ],
)  # fmt: skip
def test_an_unsupported_attribute_becomes_bytes(attribute, why, effect, behind):
    result, messages = findings(A, f"id: b, {attribute}", "id: z, type: u1", more=PAIR)
    assert messages == [(f"`b` is not imported: {why}", effect)]
    assert result == [("a", 0, 8), *behind]


def test_within_a_stated_size_the_rest_of_the_size_becomes_bytes():
    more = (
        "types:\n  t:\n    seq: [{id: x, type: u1}, {id: y, type: nothing},"
        " {id: z, type: u1}]\n"
    )
    result, messages = findings("id: p, type: t, size: 4", "id: b, type: u1", more=more)
    assert result == [("p x", 0, 8), ("p y", 8, 24), ("b", 32, 8)]
    effect = "its bytes and all bytes behind it are imported"
    assert messages == [("`p y` is not imported: there is no type `nothing`", effect)]
    # Nothing is left behind `x`.
    result, messages = findings("id: p, type: t, size: 1", "id: b, type: u1", more=more)
    assert result == [("p x", 0, 8), ("b", 8, 8)]


@pytest.mark.parametrize(
    ("seq", "why"),
    [
        ("{id: x, type: u4}", "it is longer than the part that contains it"),
        ("{id: x, type: u2}, {id: y, size-eos: true}", "no byte is left for it"),
        ("{id: x, type: u1, repeat: eos}",
         "it is repeated to the end of what is around it"),
        ("{id: x, type: u, size: 3}", "its 3 bytes are more than there are around it"),
        ("{id: x, size: 3}", "it is longer than the part that contains it"),
        ("{id: x, contents: [1, 2, 3]}", "it is longer than the part that contains it"),
    ],
)  # fmt: skip
def test_parts_do_not_reach_beyond_a_stated_size(seq, why):
    more = f"types:\n  t:\n    seq: [{seq}]\n  u:\n    seq: [{{id: w, type: u1}}]\n"
    result, messages = findings("id: p, type: t, size: 2", "id: z, type: u1", more=more)
    assert [message.partition(": ")[2] for message, _ in messages] == [why]
    assert result[-1] == ("z", 16, 8)  # behind the stated size


def test_bits_of_both_orders_do_not_share_a_byte():
    why = (
        "its bits are counted from the other end of a byte than the bits in front of it"
    )
    bits = "id: b, type: b4be", "id: c, type: b4le"
    _, messages = findings(*bits)
    assert messages[0][0] == f"`c` is not imported: {why}"
    layout = layout_of(bits[0], "id: n, type: b4be", bits[1])
    assert parts(layout) == [("b", 0, 4), ("n", 4, 4), ("c", 8, 4)]


def test_a_repeated_number_is_an_array_of_at_most_1024_elements():
    def element(count, kind="u2"):
        return f"id: b, type: {kind}, repeat: expr, repeat-expr: {count}"

    layout = layout_of(element(3), "id: c, type: u1")
    assert parts(layout) == [("b", 0, 48), ("c", 48, 8)]
    assert layout.parts[0].item == {"type": "uint", "bits": 16, "count": 3}

    def is_accepted(count):
        result, messages = findings(element(count))
        return not messages and result == [("b", 0, 16 * count)]

    assert_limits(is_accepted, least=1, most=1024)


def counted(expression, kind="u1", first="u1", **more):
    return findings(
        f"id: a, type: {first}",
        f"id: b, type: {kind}, repeat: expr, repeat-expr: {expression}",
        **more,
    )


def test_a_counter_is_an_unsigned_number_in_front():
    (layout,), to = layouts(A, "id: b, type: u2, repeat: expr, repeat-expr: a + 2")
    part = layout.parts[1]
    assert (part.counter.part, part.counter.plus) == (layout.parts[0], 2)
    assert part.item == {"type": "uint", "bits": 16, "count": "rest", "up_to": 257}
    assert (part.bits, part.element, layout.is_open) == (0, 16, False)
    assert layout.is_behind(part) is False and to.import_findings == []


@pytest.mark.parametrize(
    ("expression", "first", "why"),
    [
        ("a", "s1", ", which is not a number in front of it"),
        ("c", "u1", None),
        ("a * 2", "u1", ""),
        ("a - 255", "u1", ", which is never positive"),
        ("a - 254", "u1", "supported"),
    ],
)
def test_other_counters_are_refused(expression, first, why):
    _, messages = counted(expression, first=first)
    if why == "supported":
        assert messages == []
        return
    text = f"it is repeated as often as `{expression}` says{why}"
    text = text if why is not None else "`c` is not a number in front of it"
    assert messages[0][0] == f"`b` is not imported: {text}"


def test_a_constant_or_an_array_counts_nothing():
    why = "its size is `a`, which is not a number in front of it"
    for first in (
        "id: a, type: u1, valid: 3",
        "id: a, type: u1, repeat: expr, repeat-expr: 2",
    ):
        _, messages = findings(first, "id: b, size: a")
        assert messages[0][0] == f"`b` is not imported: {why}"


def test_an_array_of_types_is_one_of_structs():
    more = (
        "types:\n  t:\n    doc: T.\n    seq: [{id: x, type: u2}, {id: y, type: u1}]\n"
    )
    layout = layout_of(
        A, "id: p, type: t, repeat: expr, repeat-expr: 3, doc: Points.", more=more
    )
    assert parts(layout) == [("a", 0, 8), ("p", 8, 72)]
    assert layout.parts[1].item == {"struct": "t", "count": 3, "summary": "Points."}
    (struct,) = layout.file.structs.values()
    assert (struct["name"], struct["length"]) == ("t", 3)
    assert parts(struct["parts"]) == [("x", 0, 16), ("y", 16, 8)]


@pytest.mark.parametrize(
    ("seq", "why"),
    [
        ("{id: x, type: b4}", "they are not of a fixed number of bytes"),
        ("{id: x, type: u1}, {id: y, size: x}", "they are not of a fixed number of bytes"),
        ("{id: x, type: u1}, {id: y, type: u1, if: x == 1}",
         "what each of them has depends on `x`"),
        ("{id: x, type: nothing}", "there is no type `nothing`"),
    ],
)  # fmt: skip
def test_structs_have_the_same_bytes_each_time(seq, why):
    more = f"types:\n  t:\n    seq: [{seq}]\n"
    _, messages = counted("2", "t", more=more)
    assert messages == [(f"`b` is not imported: {why}", REST)]


def test_a_struct_has_one_length_in_a_file():
    element = "type: t, repeat: expr, repeat-expr: 2"
    result, messages = findings(f"id: p, {element}", f"id: q, {element}, size: 2", more=PAIR.replace("b4", "u1"))  # fmt: skip
    assert (result[0], messages) == (("p", 0, 32), [])
    _, messages = findings(f"id: p, {element}", f"id: q, {element}, size: 3", more=PAIR.replace("b4", "u1"))  # fmt: skip
    assert messages[0][0] == "`q` is not imported: they are not as long as elsewhere"


def branches(*attributes, **more):
    """Return the fixed values, the parts and the labels of each layout."""
    result, to = layouts(*attributes, **more)
    assert to.import_findings == []
    return [
        (values(each), [p.path[-1] for p in each.parts], [*map(tuple, each.labels)])
        for each in result
    ]


def test_a_condition_has_a_layout_with_and_one_without_the_attribute():
    assert branches(A, "id: b, type: u1, if: a == 3", "id: c, type: u1") == [
        ({"a": (0xFF, 3)}, ["a", "b", "c"], [("with b", "3")]),
        ({}, ["a", "c"], [("", "")]),
    ]
    without = layouts(A, "id: b, type: u1, if: a == 3")[0][1]
    assert without.parts[0].excluded == {(0xFF, 3)}


def test_a_negated_condition_has_the_attribute_for_other_values():
    assert branches(A, "id: b, type: u1, if: a != 3") == [
        ({"a": (0xFF, 3)}, ["a"], [("", "3")]),
        ({}, ["a", "b"], [("with b", "")]),
    ]


def test_the_same_value_decides_once():
    assert [row[1] for row in branches(
        A, "id: b, type: u1, if: a == 3", "id: c, type: u1, if: a == 3",
        "id: d, type: u1, if: a == 4",
    )] == [["a", "b", "c"], ["a", "d"], ["a"]]  # fmt: skip


def test_a_single_bit_has_two_values():
    assert branches("id: f, type: b1", "id: b, type: u1, if: f == 1") == [
        ({"f": (1, 1)}, ["f", "b"], [("with b", "1")]),
        ({"f": (1, 0)}, ["f"], [("", "")]),
    ]


def test_some_bits_of_a_field_decide():
    assert branches(A, "id: b, type: u1, if: a & 0xC0 == 0x40") == [
        ({"a": (0xC0, 0x40)}, ["a", "b"], [("with b", "64")]),
        ({}, ["a"], [("", "")]),
    ]
    # A value outside the mask never occurs.
    assert branches(A, "id: b, type: u1, if: a & 0xC0 == 0x41") == [({}, ["a"], [])]


SWITCH = "id: b, type: {switch-on: %s, cases: {%s}}"


def test_a_switch_has_a_layout_for_each_case_and_the_default():
    assert branches(A, SWITCH % ("a", "1: u1, 2: u2, _: u4")) == [
        ({"a": (0xFF, 1)}, ["a", "b"], [("u1", "1")]),
        ({"a": (0xFF, 2)}, ["a", "b"], [("u2", "2")]),
        ({}, ["a", "b"], [("u4", "other")]),
    ]
    bits = [
        each.parts[1].bits
        for each in layouts(A, SWITCH % ("a", "1: u1, 2: u2, _: u4"))[0]
    ]
    assert bits == [8, 16, 32]
    assert [row[1] for row in branches(A, SWITCH % ("a", "1: u1, 2: u2"))] == [
        ["a", "b"], ["a", "b"],
    ]  # fmt: skip


def test_a_switch_on_all_values_has_no_default():
    rows = branches("id: f, type: b1", SWITCH % ("f", "0: u1, 1: u2, _: u4"))
    assert [row[2] for row in rows] == [[("u1", "0")], [("u2", "1")]]


def test_values_that_a_field_cannot_have_have_no_layout():
    rows = branches("id: a, type: s1", SWITCH % ("a", "-1: u1, 200: u2, 300: u4"))
    assert [row[0] for row in rows] == [{"a": (0xFF, 0xFF)}, {"a": (0xFF, 200)}]


def test_a_constant_decides_without_a_branch():
    rows = branches("id: a, type: u1, valid: 3", "id: b, type: u1, if: a == 3",
                    "id: c, type: u1, if: a == 4")  # fmt: skip
    assert rows == [({"a": (0xFF, 3)}, ["a", "b"], [])]


@pytest.mark.parametrize(
    "first", ["type: f4", "type: u1, repeat: expr, repeat-expr: 2"]
)
def test_only_integers_decide(first):
    _, messages = findings(f"id: a, {first}", "id: b, type: u1, if: a == 1")
    assert messages[0][0] == (
        "`b` is not imported: it depends on `a`, which is not an integer"
    )


def formula(value, *attributes, doc="", **keys):
    more = f"instances:\n  p: {{value: {value}{doc}}}\n"
    (layout,), to = layouts(*(attributes or (A,)), more=more, **keys)
    item = layout.parts[0].item
    return item, [(f.code, f.severity, f.message, f.help) for f in to.import_findings]


def test_a_linear_instance_is_the_formula_of_its_field():
    doc = ", doc: Pressure., -unit: kPa"
    item, messages = formula("a * 0.5 + 1", doc=doc)
    assert item == {
        "type": "uint", "formula": item["formula"], "unit": "kPa",
        "summary": "Pressure.",
    }  # fmt: skip
    assert item["formula"].replace(" ", "") == "raw*0.5+1" and messages == []
    item, _ = formula("a * 0.5", "id: a, type: u1, doc: Own., valid: {min: 1, max: 9}",
                      doc=doc)  # fmt: skip
    assert item == {"type": "uint", "formula": "raw*0.5", "unit": "kPa",
                    "summary": "Own."}  # fmt: skip


def test_a_division_is_a_formula_of_a_float_only():
    item, messages = formula("a / 2 + 1", "id: a, type: f4")
    assert (item["formula"], messages) == ("raw/2 + 1", [])
    item, messages = formula("a / 2 + 1")
    assert "formula" not in item and messages  # a whole number in Kaitai Struct


@pytest.mark.parametrize("value", ["3", "0.5", "a"])
def test_an_instance_without_a_calculation_changes_nothing(value):
    assert formula(value) == ({"type": "uint"}, [])


@pytest.mark.parametrize(
    ("value", "attributes"),
    [
        ("a * a", (A,)),
        ("c * 2.0", (A,)),
        ("a * 2.0", (A, "id: b, size: a")),
        ("a * 2.0", ("id: a, size: 1",)),
    ],
)
def test_other_instances_are_reported(value, attributes):
    item, messages = formula(value, *attributes)
    assert "formula" not in item
    assert messages == [
        (
            "IMP078",
            "warning",
            f"`p`: `{value}` is not a linear function of one field",
            "the fields that it is computed from are imported",
        )
    ]


def test_instances_at_fixed_positions_are_fields_without_a_sequence():
    text = (
        "meta: {id: top, endian: be}\ninstances:\n"
        "  late: {pos: 6, type: u2}\n  first: {pos: 1, type: u1}\n"
        "  twice: {value: first * 2.0}\n  inside: {pos: 6, type: u1}\n"
        "  far: {pos: first, type: u1}\n  huge: {pos: 65536, type: u1}\n"
    )
    root = declare_types("top", parse("a.ksy", text.encode()))
    to = Definitions("a.ksy")
    layout = KaitaiLayout(File(to), {})
    layout.read(root)
    assert parts(layout) == [("first", 8, 8), ("late", 48, 16)]
    assert layout.parts[0].item["formula"] == "raw*2.0"
    assert {(f.message, f.severity) for f in to.import_findings} == {
        (f"`{name}` is not imported: an expression gives its position", "error")
        for name in ("inside", "far", "huge")
    }
