"""Model: ids of messages, included nodes, and protocol sections of several nodes."""

from __future__ import annotations

import pytest

from icdgen.icd import model
from icdgen.icd.layout import Layout
from icdgen.icd.model import Icd, Message, Node


def message(name: str, kind: str = "telemetry", node: str = "", **keys) -> Message:
    return Message(name, kind, Layout(name, 1, ()), node=node, **keys)


def node(name: str, *includes: str, messages=(), protocol=None) -> Node:
    return Node(
        name,
        name,
        "",
        "little",
        "lsb0",
        tuple(messages),
        (),
        includes=includes,
        protocol=protocol or {},
    )


@pytest.mark.parametrize(
    ("kind", "keys", "telecommand", "telemetry", "ids"),
    [
        ("telecommand", {"id": 0}, 0, None, (0,)),
        ("telemetry", {"id": 0}, None, 0, (0,)),
        ("configuration", {"set_id": 0, "get_id": 130}, 0, 130, (0, 130)),
        ("configuration", {"set_id": 7}, 7, None, (7,)),
        ("configuration", {"get_id": 7}, None, 7, (7,)),
    ],
)
def test_a_message_has_an_id_for_each_direction(
    kind, keys, telecommand, telemetry, ids
):
    each = message("Status", kind, **keys)
    assert (each.telecommand_id, each.telemetry_id) == (telecommand, telemetry)
    assert each.ids == ids


NODES = (
    node("base", messages=[message("Ping")]),
    node("loop", "mid"),
    node("mid", "base", "loop", messages=[message("State"), message("Log")]),
    node("top", "mid", "missing", messages=[message("Last")]),
    node("alone"),
)


def test_included_nodes_are_found_through_others_each_once_in_the_order_of_the_set():
    icd = Icd(NODES)
    top = icd.node("top")
    assert [each.name for each in icd.included(top)] == ["base", "loop", "mid"]
    assert [each.name for each in icd.messages_of(top)] == ["Ping", "State", "Log", "Last"]  # fmt: skip
    assert icd.included(icd.node("alone")) == ()
    assert [each.name for each in model.closure(NODES, ("base", "none"))] == ["base"]
    with pytest.raises(KeyError, match="missing"):
        icd.node("missing")


def test_of_two_nodes_with_one_name_the_includes_of_the_first_count():
    nodes = (node("a"), node("b"), node("same", "a"), node("same", "b"))
    assert [each.name for each in model.closure(nodes, ("same",))] == ["a", "same", "same"]  # fmt: skip


@pytest.mark.parametrize(
    ("earlier", "later", "merged"),
    [
        ({"a": 1, "b": 2}, {"b": 3, "c": 4}, {"a": 1, "b": 3, "c": 4}),
        ({"a": {"x": 1}}, {"a": {"y": 2}}, {"a": {"y": 2}}),
        (
            {"procedures": {"p": {"x": 1}, "q": 1}},
            {"procedures": {"p": {"y": 2}, "r": 3}},
            {"procedures": {"p": {"y": 2}, "q": 1, "r": 3}},
        ),
        ({"procedures": {"p": 1}}, {"procedures": None}, {"procedures": None}),
        ({"procedures": []}, {"procedures": {"p": 1}}, {"procedures": {"p": 1}}),
        ({"link": {"client": 1}}, {}, {"link": {"client": 1}}),
        ({"link": {"client": 1}}, {"link": 7}, {"link": 7}),
        (
            {"link": {"buses": {"uart": 1, "can": 2}, "packets": {"A": 1}, "client": 1}},
            {"link": {"buses": {"can": 3}, "packets": {"B": 2}, "commands": 4}},
            {"link": {"buses": {"uart": 1, "can": 3}, "packets": {"A": 1, "B": 2},
                      "client": 1, "commands": 4}},
        ),
        (
            {"link": {"checksums": {"a": 1}, "client": 1, "commands": 2}},
            {"link": {"checksums": {"b": 2}, "client": 3}},
            {"link": {"checksums": {"a": 1, "b": 2}, "client": 3, "commands": 2}},
        ),
        # Another framing replaces packets and responses, not the client or checksums.
        (
            {"link": {"framing": {"x": 1}, "packets": {"A": 1}, "commands": 2,
                      "client": 3, "checksums": {"a": 4}}},
            {"link": {"framing": {"y": 1}, "packets": {"B": 1}, "checksums": {"b": 5}}},
            {"link": {"framing": {"y": 1}, "packets": {"B": 1}, "client": 3,
                      "checksums": {"a": 4, "b": 5}}},
        ),
        # Buses replace a framing, and a framing replaces buses.
        (
            {"link": {"framing": {"x": 1}, "packets": {"A": 1}, "client": 3}},
            {"link": {"buses": {"can": 1}}},
            {"link": {"buses": {"can": 1}, "client": 3}},
        ),
        (
            {"link": {"buses": {"can": 1}, "requests": 2, "checksums": {"a": 4}}},
            {"link": {"framing": {"x": 1}}},
            {"link": {"framing": {"x": 1}, "checksums": {"a": 4}}},
        ),
        # Without framing or buses, a part of a framed link changes alone.
        (
            {"link": {"framing": {"x": 1}, "commands": 1}},
            {"link": {"commands": 2}},
            {"link": {"framing": {"x": 1}, "commands": 2}},
        ),
    ],
)  # fmt: skip
def test_a_later_protocol_section_replaces_parts_of_an_earlier_one(
    earlier, later, merged
):
    before = repr(earlier), repr(later)
    assert model.merged_protocols([earlier, later]) == merged
    assert (repr(earlier), repr(later)) == before, "the sections are unchanged"


def test_three_protocol_sections_are_merged_in_order():
    sections = [{"link": {"client": n, f"k{n}": n}, "a": n} for n in (1, 2, 3)]
    expected = {"link": {"client": 3, "k1": 1, "k2": 2, "k3": 3}, "a": 3}
    assert model.merged_protocols(sections) == expected
    assert model.merged_protocols([]) == {}


@pytest.mark.parametrize(
    ("path", "part"),
    [
        (("link", "buses", "can", "commands", "ack"), ("link", "buses", "can")),
        (("link", "buses"), ("link", "buses")),
        (("link", "client", "timeout_ms"), ("link", "client")),
        (("link",), ("link",)),
        (("polled", "name", "x"), ("polled",)),
        (("polled", "buses", "x"), ("polled",)),
    ],
)
def test_a_bus_a_part_of_the_link_or_a_section_is_replaced_as_a_whole(path, part):
    assert model.replaced_part(path) == part


@pytest.mark.parametrize(
    ("protocol", "buses", "framed"),
    [
        ({}, {}, False),
        ({"link": None}, {}, False),
        ({"link": {"buses": [1]}}, {}, False),
        ({"link": {"buses": {"can": {}}}}, {"can": {}}, False),
        ({"link": {"framing": None}}, {}, True),
    ],
)
def test_a_link_has_buses_or_a_framing(protocol, buses, framed):
    assert model.buses_of(protocol) == buses
    assert model.framed_link(protocol) == (protocol["link"] if framed else {})


STEPS = [{"send": "Ping"}]


@pytest.mark.parametrize(
    ("section", "has_it"),
    [
        ({"steps": STEPS}, True),
        ({"steps": []}, True),
        ({"steps": STEPS, "nodes": ["demo"]}, True),
        ({"steps": STEPS, "nodes": ["base", "demo"]}, True),
        ({"steps": STEPS, "nodes": ["base"]}, False),
        ({"steps": STEPS, "nodes": []}, False),
        ({"steps": STEPS, "nodes": "demo"}, False),
        ({"steps": STEPS, "inputs": {"a": {}}, "outputs": {"b": "c"}}, True),
        ({"steps": STEPS, "inputs": {"a": 1}}, False),
        ({"steps": STEPS, "inputs": []}, False),
        ({"steps": STEPS, "outputs": []}, False),
        ({"steps": [*STEPS, "wait"]}, False),
        ({"steps": {"a": {}}}, False),
        ({}, False),
        (None, False),
    ],
)
def test_a_node_has_the_readable_procedures_that_are_not_only_for_others(
    section, has_it
):
    base = node("base", protocol={"procedures": {"p": section, "q": {"steps": STEPS}}})
    demo = node("demo", "base")
    expected = {"p": section} if has_it else {}
    assert Icd((base, demo)).procedures_of(demo) == expected | {"q": {"steps": STEPS}}


def test_procedures_of_another_type_are_none():
    demo = node("demo", protocol={"procedures": ["p"]})
    assert Icd((demo,)).procedures_of(demo) == {}
