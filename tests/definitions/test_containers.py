"""Parts of a container: positions, counters, lost entries and the fields of an ICD."""

from __future__ import annotations

import pytest

from icdgen.definitions import containers
from icdgen.definitions.containers import Container, ContainerPart, Counter
from icdgen.definitions.frames import BIG, LITTLE
from icdgen.definitions.model import Definitions, NotSupported
from tests.limits import assert_limits

MOST_BYTES = 65535


def part(name, at, width, order=BIG, counter=None, element=8, **item):
    item = item or {"type": "uint"}
    return ContainerPart((name,), item, at, width, order, element, counter)


def filled(*bits):
    container = Container()
    for number, width in enumerate(bits):
        container.add(part(f"P{number}", container.at, width))
    return container


def test_a_container_ends_before_its_first_part_of_variable_length():
    assert filled().length == 0 and not filled().is_open
    assert [filled(8, 1).length, filled(8, 8).length] == [2, 2]
    container = filled(8, 16)
    assert (container.at, container.length) == (24, 3)
    assert not container.is_open and container.first_variable is None
    container = filled(8, 0, 16, 0)
    assert (container.length, container.is_open) == (1, True)
    first = container.first_variable
    assert first is container.parts[1]
    assert [container.is_behind(each) for each in container.parts] == [
        False,
        False,
        True,
        True,
    ]
    assert not filled(8, 8).is_behind(part("X", 0, 8))


@pytest.mark.parametrize(
    ("is_id", "changes"),
    [
        (True, {}),
        (True, {"width": 16}),
        (True, {"width": 24}),
        (True, {"width": 32}),
        (True, {"type": "enum"}),
        (False, {"width": 11}),
        (False, {"width": 40}),
        (False, {"at": 8}),
        (False, {"order": LITTLE}),
        (False, {"type": "int"}),
        (False, {"type": "uint", "formula": "raw*2"}),
    ],
)
def test_a_message_id_is_an_unsigned_big_endian_integer_at_the_start(is_id, changes):
    keys = {"at": 0, "width": 8, "type": "uint", **changes}
    assert part("Id", **keys).is_message_id == is_id


def test_a_counter_reaches_its_largest_number():
    assert Counter(part("N", 0, 8)).most == 255
    assert Counter(part("N", 0, 8), -3).most == 252
    assert Counter(part("N", 0, 16), 1).most == 65536


def is_small(container):
    try:
        container.check_size()
    except NotSupported as error:
        assert str(error) == "it has more than 5000 fields or 65535 bytes"
        return False
    return True


def test_a_container_has_at_most_5000_fields_and_65535_bytes():
    assert_limits(lambda count: is_small(filled(*[8] * count)), most=5000)
    assert_limits(lambda bits: is_small(filled(bits)), most=8 * MOST_BYTES)


WHY = NotSupported("it is strange", "mend it")


def test_lost_entries_become_bytes_up_to_the_end_of_the_frame():
    container = filled(8, 8, 8)
    container.lose(part("P1", 8, 0, order=BIG, type="uint"), WHY, 1)
    assert [each.path for each in container.parts] == [("P0",), ("P1",)]
    assert container.parts[1].item == {"type": "bytes", "up_to": MOST_BYTES}
    assert container.at == 8 and container.lost == ("P1", WHY)
    definitions = Definitions("a.xml")
    container.lost.report("Status", definitions, 7, "b.xml")
    (finding,) = definitions.import_findings
    assert (finding.code, finding.severity) == ("IMP081", "error")
    assert finding.spot.place == "b.xml, line 7"
    assert (finding.message, finding.help) == (
        "message `Status`: from `P1` on only bytes are imported: it is strange",
        "mend it",
    )
    missing = container.missing("Mode")
    assert str(missing) == (
        "it depends on `Mode`, which is in or behind `P1`: it is strange"
    )
    assert missing.help == "mend it"


def test_a_lost_entry_without_a_remedy_gets_one():
    container = filled(8, 8)
    container.lose(part("P1", 8, 0), NotSupported("it is strange"), 1)
    definitions = Definitions("a.xml")
    container.lost.report("Status", definitions)
    (finding,) = definitions.import_findings
    assert finding.help == "describe the rest by hand, or simplify the definition"
    missing = filled(8).missing("Mode")
    assert str(missing) == "it depends on `Mode`, which it does not have"


def test_entries_cannot_be_lost_within_a_byte_first_or_behind_variable_parts():
    def is_lost(container, at, before):
        try:
            container.lose(part("P", at, 0), WHY, before)
        except NotSupported as error:
            assert error is WHY
            return False
        return True

    assert is_lost(filled(8, 8), 8, 1)
    assert is_lost(filled(8, 0), 8, 1)
    assert not is_lost(filled(8, 8), 0, 0)
    assert not is_lost(filled(4, 8), 4, 1)
    assert not is_lost(filled(8, 0, 8), 8, 2)
    container = filled(8, 8, 8)
    assert is_lost(container, 16, 2) and not is_lost(container, 8, 1)


def test_a_field_with_another_constant_contradicts_a_condition():
    containers.check_only_value({"type": "uint"}, 3, "Mode")
    containers.check_only_value({"const": 3}, 3, "Mode")
    with pytest.raises(NotSupported) as raised:
        containers.check_only_value({"const": 0}, 3, "Mode")
    assert str(raised.value) == "it depends on `Mode`, which is both 0 and 3"


@pytest.mark.parametrize(
    ("source", "order"),
    [
        (part("A", 0, 16, LITTLE), {"byte_order": LITTLE}),
        (part("A", 0, 9, LITTLE), {"byte_order": LITTLE}),
        (part("A", 0, 8, LITTLE), {}),
        (part("A", 0, 16), {}),
        (part("A", 0, 16, LITTLE, type="bytes"), {}),
        (part("A", 0, 16, LITTLE, type="text"), {}),
        (part("A", 0, 32, LITTLE, type="uint", bits=8), {}),
        (part("A", 0, 32, LITTLE, type="uint", bits=16), {"byte_order": LITTLE}),
    ],
)
def test_a_number_of_several_bytes_has_a_byte_order(source, order):
    item, width = source.item, source.item.get("bits", source.bits)
    keys = {"at": 40, "bits": width, "name": "N", "type": item["type"], **order}
    field = containers.fixed_field(source, "N", 40)
    assert field is item and field == keys
    assert list(field)[:3] == ["at", "bits", "name"]


def test_a_struct_has_no_bits():
    source = part("A", 0, 32, LITTLE, struct="Point", count=2)
    field = containers.fixed_field(source, "N", 8)
    assert field == {"at": 8, "name": "N", "struct": "Point", "count": 2}


def test_only_counted_parts_need_room():
    counter = Counter(part("N", 0, 8))
    parts = [
        part("A", 8, 0, counter=counter, element=16, type="uint", up_to=10),
        part("B", 8, 0, type="bytes", up_to=99),
        part("C", 8, 0, counter=counter, type="bytes", up_to=3),
    ]
    assert containers.bits_of_counted(parts) == 184


def test_fields_behind_a_variable_length_field_name_the_one_in_front():
    fields = [
        {"at": 0, "name": "A"},
        {"at": 8, "name": "B", "up_to": 9},
        {"at": 80, "name": "C", "bits": 8},
        {"at": 88, "name": "D", "up_to": 3},
    ]
    placed = containers.in_sequence(fields)
    assert placed == [
        {"at": 0, "name": "A"},
        {"at": 8, "name": "B", "up_to": 9},
        {"at": 8, "after": "B", "name": "C", "bits": 8},
        {"at": 8, "after": "C", "name": "D", "up_to": 3},
    ]
    assert all(new is old for new, old in zip(placed, fields, strict=True))


def variable(at=8, behind=0, counter=None, names=None, element=8, **item):
    item = item or {"type": "bytes", "up_to": 10**6}
    source = part("V", at, 0, counter=counter, element=element, **item)
    return containers.variable_field(source, "V", at, names or {}, behind)


def test_a_variable_length_field_has_a_counter_or_extends_to_the_end():
    number = part("N", 0, 8)
    names = {id(number): "Number"}
    assert variable(up_to=9, type="bytes") == {
        "at": 8,
        "name": "V",
        "type": "bytes",
        "up_to": 9,
        "size": "rest",
    }
    assert variable(counter=Counter(number), names=names)["size"] == "Number"
    assert variable(counter=Counter(number, -4), names=names)["size"] == {
        "field": "Number",
        "plus": -4,
    }
    with pytest.raises(NotSupported) as raised:
        variable(counter=Counter(number))
    assert str(raised.value) == "`V` is counted by a field of the header"
    for keys in ({"bits": 8, "type": "uint"}, {"struct": "Point"}):
        field = variable(up_to=9, **keys)
        assert field["count"] == "rest" and "size" not in field


def test_a_variable_length_field_fits_between_the_others_in_the_largest_frame():
    assert variable(at=0)["up_to"] == MOST_BYTES
    assert variable(at=16)["up_to"] == MOST_BYTES - 2
    assert variable(at=16, behind=24)["up_to"] == MOST_BYTES - 5
    assert variable(at=0, element=32)["up_to"] == MOST_BYTES // 4
    assert variable(at=8 * MOST_BYTES)["up_to"] == 1
    with pytest.raises(NotSupported) as raised:
        variable(at=12)
    assert str(raised.value) == "`V`, whose length is not fixed, begins within a byte"
