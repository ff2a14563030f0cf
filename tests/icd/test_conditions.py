"""Optional fields: which conditions are valid, the values of a field that they can
name, and when two fields exclude each other.
"""

from __future__ import annotations

from itertools import product

import pytest
from hypothesis import given
from hypothesis import strategies as st

from icdgen.icd import conditions
from icdgen.icd.conditions import are_exclusive, conditions_of, fields_by_name
from icdgen.icd.enumeration import Enum, Member
from icdgen.icd.layout import Condition
from icdgen.icd.located import Map
from icdgen.icd.source import parse
from tests.limits import assert_limits

STATE = Enum(
    "State",
    (Member(0, "Idle"), Member(3, "Busy"), Member(8, "Fault", to=11), Member(5, "Run")),
)
SIGNED = Enum("Signed", (Member(-1, "None"), Member(1, "Some")))
ENUMS = {"State": STATE, "Signed": SIGNED}


def message(*fields: str) -> Map:
    """Return a message `Status`; the optional field is the last."""
    rows = "".join(f"  - {{{field}}}\n" for field in fields)
    return parse(f"name: Status\nfields:\n{rows}".encode(), "demo.yaml")


def faults(*fields: str, enums: dict[str, Enum] = ENUMS) -> list[tuple[str, str, str]]:
    """Return place, message and help of the faults of the last field."""
    owner = message(*fields)
    named, item = fields_by_name(owner), owner["fields"][-1]
    found = [
        *conditions.faults_of_names(owner, named, item),
        *conditions.faults_of_values(named, item, enums),
    ]
    return [
        (f"{fault.place.line}:{fault.place.column}", fault.message, fault.help)
        for fault in found
    ]


def values(field: str, when: str) -> list[tuple[str, tuple[int, ...]]]:
    """Return the conditions of a field that depends on the field `F`."""
    owner = message(f"name: F, {field}", f"name: X, type: uint, bits: 8, when: {when}")
    found = conditions_of(fields_by_name(owner), owner["fields"][1], ENUMS)
    return [(condition.field, condition.values) for condition in found]


@pytest.mark.parametrize(
    ("field", "when", "raws"),
    [
        ("type: uint, bits: 8", "{F: 7}", (7,)),
        ("type: uint, bits: 8", "{F: [7, 3, 7]}", (7, 3)),
        ("type: int, bits: 8", "{F: [-1, 0]}", (-1, 0)),
        ("type: bool, bits: 1", "{F: true}", (1,)),
        ("type: bool, bits: 1", "{F: [0, 1, false]}", (0, 1)),
        ("type: enum, bits: 4, enum: State", "{F: [Busy, Idle]}", (3, 0)),
        ("type: enum, bits: 4, enum: State", "{F: [9, Run]}", (9, 5)),
        ("type: enum, bits: 4, enum: Signed", "{F: [None, -8]}", (-1, -8)),
    ],
)
def test_conditions_have_the_raw_values_in_the_order_of_the_icd(field, when, raws):
    assert values(field, when) == [("F", raws)]


@pytest.mark.parametrize(
    ("field", "when"),
    [
        ("type: uint, bits: 8", "{F: []}"),
        ("type: uint, bits: 8", "{F: [1, 256]}"),
        ("type: uint, bits: 8", "{F: true}"),
        ("type: uint, bits: 8", "{F: '1'}"),
        ("type: uint, bits: 8", "{F: 1.5}"),
        ("type: uint, bits: 8", "{G: 1}"),
        ("type: uint, bits: 8", "F"),
        ("type: bool, bits: 1", "{F: 2}"),
        ("type: bool, bits: 1", "{F: 1.5}"),
        ("type: bool, bits: 1", "{F: 'true'}"),
        ("type: enum, bits: 4, enum: State", "{F: Fault}"),
        ("type: enum, bits: 4, enum: State", "{F: idle}"),
        ("type: enum, bits: 4, enum: State", "{F: true}"),
        ("type: enum, bits: 4, enum: State", "{F: -1}"),
        ("type: float, bits: 32", "{F: 1}"),
        ("type: uint, bits: 65", "{F: 1}"),
        ("type: uint, bits: '8'", "{F: 1}"),
        ("type: uint, bits: true", "{F: 1}"),
        ("type: enum, bits: 8, enum: [State]", "{F: 1}"),
        ("type: uint, bits: 8, formula: raw*2", "{F: 1}"),
        ("type: uint, bits: 8, count: 2", "{F: 1}"),
        ("type: uint, bits: 8, view: true", "{F: 1}"),
    ],
)
def test_an_invalid_condition_is_left_out(field, when):
    assert values(field, when) == []


def test_valid_conditions_remain_beside_an_invalid_one():
    owner = message(
        "name: A, type: uint, bits: 2",
        "name: B, type: uint, bits: 2",
        "name: X, type: uint, bits: 8, when: {A: 4, B: 3, A B: 1}",
    )
    found = conditions_of(fields_by_name(owner), owner["fields"][2], {})
    assert found == (Condition("B", (3,)),)


@pytest.mark.parametrize(
    ("field", "least", "most"),
    [
        ("type: uint, bits: 2", 0, 3),
        ("type: uint, bits: 64", 0, 2**64 - 1),
        ("type: int, bits: 3", -4, 3),
        ("type: int, bits: 1", -1, 0),
        ("type: enum, bits: 3, enum: State", 0, 7),
        ("type: enum, bits: 3, enum: Signed", -4, 3),
        ("type: enum, bits: 3, enum: Unknown", 0, 7),
        ("type: bool, bits: 1", 0, 1),
    ],
)
def test_a_condition_has_values_that_fit_the_field(field, least, most):
    assert_limits(
        lambda raw: values(field, f"{{F: {raw}}}") == [("F", (raw,))],
        least=least,
        most=most,
    )


def test_fields_of_up_to_64_bits_decide():
    assert_limits(
        lambda bits: bool(values(f"type: uint, bits: {bits}", "{F: 1}")),
        least=1,
        most=64,
    )


X = "name: X, type: uint, bits: 8, when: "


@pytest.mark.parametrize(
    ("when", "expected"),
    [
        ("{State: Busi}", ("`Busi`", "`Idle`, `Busy`, `Fault`, `Run`")),
        ("{State: 16}", ("16", "`Idle`, `Busy`, `Fault`, `Run`")),
        ("{State: false}", ("false", "`Idle`, `Busy`, `Fault`, `Run`")),
        ("{State: -1}", ("-1", "`Idle`, `Busy`, `Fault`, `Run`")),
    ],
)
def test_a_value_that_no_member_has_is_reported_with_the_members(when, expected):
    shown, members = expected
    text, help = (
        f"`State` is never {shown}",
        f"`State` has a value of `State`: {members}",
    )
    state = "name: State, type: enum, bits: 4, enum: State"
    assert faults(state, f"{X}{when}") == [("4:43", text, help)]


def test_the_help_names_at_most_five_members():
    def help(members: int) -> str:
        enum = Enum("State", tuple(Member(n, f"M{n}") for n in range(members)))
        state = "name: State, type: enum, bits: 8, enum: State"
        ((_, _, help),) = faults(state, f"{X}{{State: M}}", enums={"State": enum})
        return help.removeprefix("`State` has a value of `State`: ")

    assert help(5) == "`M0`, `M1`, `M2`, `M3`, `M4`"
    assert help(6) == "`M0`, `M1`, `M2`, `M3`, `M4` ..."


@pytest.mark.parametrize(
    ("field", "value", "text", "help"),
    [
        ("type: uint, bits: 16", "65536", "65536", "is 0 to 65,535"),
        ("type: int, bits: 16", "-32769", "-32769", "is -32,768 to 32,767"),
        ("type: uint, bits: 16", "'1'", "`1`", "is 0 to 65,535, never a text"),
        ("type: uint, bits: 16", "true", "true", "is 0 to 65,535"),
        ("type: bool, bits: 1", "2", "2", "is true or false"),
        ("type: bool, bits: 1", "maybe", "`maybe`", "is true or false, never a text"),
    ],
)
def test_a_value_that_a_number_never_has_is_reported_with_its_range(
    field, value, text, help
):
    assert faults(f"name: F, {field}", f"{X}{{F: {value}}}") == [
        ("4:43", f"`F` is never {text}", f"`F` {help}")
    ]


def test_each_wrong_value_of_a_list_is_reported():
    reported = faults("name: F, type: uint, bits: 2", f"{X}{{F: [1, 4, 5, 3]}}")
    assert [text for _, text, _ in reported] == ["`F` is never 4", "`F` is never 5"]


def test_a_member_that_is_a_range_is_listed_as_numbers():
    state = "name: State, type: enum, bits: 4, enum: State"
    assert faults(state, f"{X}{{State: [Idle, Fault]}}") == [
        (
            "4:43",
            "`Fault` is a range of values of `State`",
            "list the values as numbers",
        )
    ]


@pytest.mark.parametrize(
    ("field", "when", "is_twice"),
    [
        ("type: enum, bits: 4, enum: State", "[Idle, 0]", True),
        ("type: enum, bits: 4, enum: State", "[Idle, 3]", False),
        ("type: bool, bits: 1", "[true, 1]", True),
        ("type: bool, bits: 1", "[true, 0]", False),
        ("type: uint, bits: 4", "[1, 2, 1]", True),
        ("type: uint, bits: 4", "[1, 16, 16]", False),
    ],
)
def test_values_are_compared_as_raw_values(field, when, is_twice):
    reported = faults(f"name: F, {field}", f"{X}{{F: {when}}}")
    twice = ("4:43", "a value of `F` is given twice", "remove one of them")
    assert (twice in reported) == is_twice


def test_a_name_that_is_unknown_is_compared_with_fields_that_can_decide():
    fields = (
        "name: Mode A, type: float, bits: 32",
        "name: Mode B, type: uint, bits: 8, formula: raw*2",
        "name: Mode D, type: uint, bits: 8",
        "name: Mode C, type: uint, bits: 8, when: {Mode E: 1}",
    )
    text = "`Mode C` depends on `Mode E`, but the message `Status` has no such field"
    assert faults(*fields) == [("6:48", text, "did you mean `Mode D`?")]
    # The field itself is not suggested either.
    assert faults(fields[0], fields[1], fields[3])[0][2].startswith("`when` names a")


def test_each_unsuitable_field_of_a_condition_is_reported():
    reported = faults(
        "name: A, type: uint, bits: 8, when: {D: 1}, points: [[0, 1], [1, 2]]",
        "name: B, type: float, bits: 32",
        "name: C, type: bytes, bits: 128",
        "name: D, type: uint, bits: 65",
        "name: E, type: text, size: rest",
        "name: X, type: uint, bits: 8, when: {A: 1, B: 1, C: 1, D: 1, E: 1, X: 1}",
    )
    assert [text for _, text, _ in reported] == [
        "`X` cannot depend on `A`: it is optional",
        "`X` cannot depend on `B`: it is `float`, not `uint`, `int`, `enum` or `bool`",
        "`X` cannot depend on `C`: it is `bytes`, not `uint`, `int`, `enum` or `bool`",
        "`X` cannot depend on `E`: it has a variable length",
        "`X` cannot depend on itself",
    ]


def test_the_first_of_two_fields_of_a_name_decides():
    owner = message(
        "name: F, struct: Pair",
        "name: F, type: uint, bits: 2",
        "name: F, type: uint, bits: 8",
        "name: G, struct: Pair",
        "name: [F], type: uint, bits: 8",
    )
    assert fields_by_name(owner) == {"F": owner["fields"][1]}


def test_a_condition_that_a_constant_never_meets_is_reported():
    constant = "name: F, type: uint, bits: 8, const: 3"
    never = "`F` is always 3, so `X` is never present"
    assert (
        faults(constant, f"{X}{{F: [2, 4]}}")
        == [
            ("4:43", never, "correct the value, or remove the field"),
        ]
        * 2
    )
    assert faults(constant, f"{X}{{F: 3}}") == []
    # With its own value, the field is always present.
    assert faults(constant, f"{X}{{F: [2, 3]}}") == [
        ("4:43", "`F` is never 2, but always 3", "remove the value")
    ]


@pytest.mark.parametrize(
    ("when", "is_valid"),
    [("{F: 1, G: 2}", True), ("{F: 1, G: 4}", False), ("{H: 1}", False)],
)
def test_a_field_is_valid_if_all_of_its_conditions_are(tmp_path, when, is_valid):
    from tests.icd.files import loaded, status

    text = status(
        "at: 0, bits: 2, name: F, type: uint",
        "at: 2, bits: 2, name: G, type: uint",
        f"at: 8, bits: 8, name: X, type: uint, when: {when}",
    )
    (demo,) = loaded(tmp_path, text).icd.nodes
    nodes = demo.messages[0].layout.nodes
    assert [conditions.are_valid(node) for node in nodes] == [True, True, is_valid]


CONDITIONS = st.lists(
    st.builds(
        Condition,
        st.sampled_from("ABC"),
        st.lists(st.integers(0, 3), min_size=1, max_size=3).map(tuple),
    ),
    max_size=3,
    unique_by=lambda condition: condition.field,
).map(tuple)


@given(CONDITIONS, CONDITIONS)
def test_fields_are_exclusive_if_no_frame_has_both(first, second):
    def is_present(frame: dict[str, int], needed: tuple[Condition, ...]) -> bool:
        return all(frame[each.field] in each.values for each in needed)

    frames = [
        dict(zip("ABC", raws, strict=True)) for raws in product(range(4), repeat=3)
    ]
    together = any(is_present(f, first) and is_present(f, second) for f in frames)
    assert are_exclusive(first, second) == (not together)
