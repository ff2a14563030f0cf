"""Containers become messages: of space packets by their primary header, of other frames
by a discriminator, or counted.
"""

from __future__ import annotations

import pytest

from icdgen.definitions.model import Definitions, Network, NotSupported
from icdgen.definitions.packets import (
    TELECOMMAND,
    TELEMETRY,
    PrimaryHeader,
    fill,
    header,
    is_of_header,
)
from tests.limits import assert_limits

WHOLE = {(0, 3): 0, (3, 1): 1, (4, 1): 0, (5, 11): 42, (16, 2): 3, (18, 14): None,
         (32, 16): None}  # fmt: skip
JOINED = {(0, 3): 5, (3, 2): 2, (5, 11): 7, (16, 2): 3, (18, 14): None, (32, 16): None}


def header_of(values, *more):
    return header([(*place, value) for place, value in values.items()] + list(more))


@pytest.mark.parametrize(
    ("values", "expected"),
    [
        (WHOLE, PrimaryHeader(0, 1, 0, 42)),
        (WHOLE | {(3, 1): None, (4, 1): 1}, PrimaryHeader(0, None, 1, 42)),
        (WHOLE | {(5, 11): None}, PrimaryHeader(0, 1, 0, None)),
        # Type and secondary header flag are one part.
        (JOINED, PrimaryHeader(5, 1, 0, 7)),
        (JOINED | {(3, 2): 1}, PrimaryHeader(5, 0, 1, 7)),
        (JOINED | {(3, 2): 0}, PrimaryHeader(5, 0, 0, 7)),
        (JOINED | {(3, 2): None}, PrimaryHeader(5, None, None, 7)),
        # Only the parts that a database uses
        ({(5, 11): 9, (18, 14): None}, PrimaryHeader(None, None, None, 9)),
        ({(3, 2): 3, (5, 11): 9}, PrimaryHeader(None, 1, 1, 9)), ({(5, 11): 9}, None),
        ({(0, 3): 0, (3, 1): 1}, None), ({(5, 11): 9, (16, 16): 1}, None),
        # Parts of both forms are none.
        ({(3, 1): 1, (3, 2): 1, (5, 11): 9}, None), ({}, None),
    ],
)  # fmt: skip
def test_a_primary_header_consists_of_its_parts(values, expected):
    assert header_of(values) == expected


def test_parts_behind_the_header_do_not_matter_and_within_it_only_if_it_is_incomplete():
    few = {(5, 11): 9, (18, 14): None}
    assert header_of(few, (48, 8, 1)) == PrimaryHeader(None, None, None, 9)
    assert header_of(few, (47, 8, 1)) is None
    assert header_of(WHOLE, (40, 8, 1)) == PrimaryHeader(0, 1, 0, 42)
    # The application process alone is no header, also with data behind it.
    assert header([(5, 11, 9), (48, 8, 1)]) is None


def test_the_first_part_at_a_position_counts():
    assert header_of(WHOLE, (5, 11, 43)) == PrimaryHeader(0, 1, 0, 42)


def test_the_type_of_a_header_is_its_direction():
    kinds = {type_: PrimaryHeader(0, type_, 0, 1).kind for type_ in (None, 0, 1)}
    assert kinds == {None: None, 0: TELEMETRY, 1: TELECOMMAND}


def test_parts_of_the_header_have_its_positions_and_widths():
    own = {
        (at, bits) for at in range(64) for bits in range(33) if is_of_header(at, bits)
    }
    assert own == set(WHOLE) | set(JOINED)


class Frame:
    """Container with a message of ``length`` bytes."""

    def __init__(self, name, kind=TELEMETRY, header=None, length=1, **more):
        self.name, self.kind, self.header, self.length = name, kind, header, length
        self.front = more.get("front")
        self.constants = more.get("constants", {})
        self.why = more.get("why")
        self.fields = more.get("fields")

    def message(self, id, start, to):
        if self.why:
            raise NotSupported(self.why)
        message = {"name": self.name, "id": id, "start": start, "length": self.length}
        return message | ({"fields": self.fields} if self.fields else {})


def filled(*frames):
    """Return the network of these containers, and the findings."""
    network, to = Network("probe", "Probe", {}), Definitions("a.xml")
    fill(network, frames, to)
    return network, [
        (each.code, each.severity, each.message, each.help)
        for each in to.import_findings
    ]


def ids(network):
    return [(each["name"], each["id"], each["start"]) for each in network.messages]


def test_space_packets_have_their_header_as_framing_and_the_apid_as_id():
    network, findings = filled(
        Frame("Housekeeping", header=PrimaryHeader(1, 0, 1, 0)),
        Frame("Order", TELECOMMAND, PrimaryHeader(None, None, 0, 2047)),
    )
    assert findings == []
    assert ids(network) == [("Housekeeping", 0, 48), ("Order", 2047, 48)]
    assert network.head == {"id_bits": 11}
    assert network.protocol == {
        "link": {
            "framing": {"by": "length"},
            "header": [
                {"bits": 3, "role": "constant", "value": 1},
                {
                    "bits": 1,
                    "role": "constant",
                    "value": {"telecommand": 1, "telemetry": 0},
                },
                {
                    "bits": 1,
                    "role": "flags",
                    "value": {"telecommand": 0, "telemetry": 1},
                },
                {"bits": 11, "role": "id"},
                {"bits": 2, "role": "type", "value": 3},
                {"bits": 14, "role": "sequence", "per": "id"},
                {"bits": 16, "role": "length", "plus": -1},
            ],
        }
    }


FLAG = {"telecommand": 0, "telemetry": 0}


@pytest.mark.parametrize(
    ("telemetry", "telecommand", "value"),
    [
        ([1], [1], FLAG | {"telecommand": 1, "telemetry": 1}),
        ([1], [], FLAG | {"telemetry": 1}), ([0, 0], [], FLAG),
        ([], [1], FLAG | {"telecommand": 1}), ([0, 1], [1], FLAG | {"telecommand": 1}),
        ([0, 1], [0, 1], None), ([None], [None], None), ([1, None], [], None),
    ],
)  # fmt: skip
def test_the_secondary_header_flag_is_stated_if_it_is_constant_in_a_direction(
    telemetry, telecommand, value
):
    flags = [(flag, TELEMETRY) for flag in telemetry]
    flags += [(flag, TELECOMMAND) for flag in telecommand]
    network, _ = filled(
        *(
            Frame(f"M{number}", kind, PrimaryHeader(0, None, flag, number))
            for number, (flag, kind) in enumerate(flags)
        )
    )
    expected = {"bits": 1, "role": "flags"} | (
        {} if value is None else {"value": value}
    )
    assert network.protocol["link"]["header"][2] == expected


def test_the_version_is_the_first_one_that_is_stated_and_else_0():
    def version(*versions):
        network, _ = filled(
            *(
                Frame(f"M{number}", header=PrimaryHeader(version, 0, 0, number))
                for number, version in enumerate(versions)
            )
        )
        return network.protocol["link"]["header"][0]["value"], len(network.messages)

    assert version(None, None) == (0, 2)
    assert version(None, 3, 5) == (3, 2)
    assert version(0, 3) == (0, 1)


def test_packets_with_another_header_are_left_out_with_the_reason():
    network, findings = filled(
        Frame("Kept", header=PrimaryHeader(0, 0, 0, 1)),
        Frame("Bare"),
        Frame("Unstated", header=PrimaryHeader(0, 0, 0, None)),
        Frame("Versioned", header=PrimaryHeader(1, 0, 0, 2)),
        Frame("Opposite", header=PrimaryHeader(0, 1, 0, 3)),
        Frame("Order", TELECOMMAND, PrimaryHeader(0, 0, 0, 3)),
        Frame("Empty", header=PrimaryHeader(0, 0, 0, 4), length=0),
        Frame("Odd", header=PrimaryHeader(0, 0, 0, 5), why="it is odd"),
        Frame("Open", header=PrimaryHeader(0, 0, 0, 6), length=0, fields=[{}]),
    )
    assert ids(network) == [("Kept", 1, 48), ("Open", 6, 48)]
    reasons = {
        "Bare": "it does not begin with the header of a space packet, "
        "although others do",
        "Unstated": "its application process is not stated",
        "Versioned": "its header is not that of a space packet with telemetry",
        "Opposite": "its header is not that of a space packet with telemetry",
        "Order": "its header is not that of a space packet with telecommand",
        "Empty": "it has no data, and a space packet has at least one byte "
        "behind its header",
        "Odd": "it is odd",
    }
    assert findings == [
        ("IMP070", "error", f"message `{name}` is not imported: {why}", "")
        for name, why in reasons.items()
    ]


def test_a_discriminator_in_front_of_all_messages_is_the_id_in_the_header():
    front = ("id", 16)
    network, findings = filled(
        Frame("A", front=front, constants={"x": 1, "id": 300}),
        Frame("C", TELECOMMAND, front=front, constants={"id": 7}),
        Frame("B", front=front, constants={"x": 1, "id": 0}),
    )
    assert findings == []
    # Telemetry comes first.
    assert ids(network) == [("A", 300, 16), ("B", 0, 16), ("C", 7, 16)]
    header = [{"bits": 16, "role": "id"}]
    assert network.protocol == {
        "link": {"framing": {"by": "datagram"}, "header": header}
    }
    assert network.head == {"id_bits": 9}


@pytest.mark.parametrize(
    "other",
    [
        {"front": ("id", 8), "constants": {"id": 2}},
        {"front": ("else", 16), "constants": {"id": 2}},
        {"front": None, "constants": {"id": 2}}, {"front": ("id", 16), "constants": {}},
    ],
)  # fmt: skip
def test_an_id_of_only_some_messages_is_no_header(other):
    first = Frame("A", front=("id", 16), constants={"id": 1})
    network, findings = filled(first, Frame("B", TELECOMMAND, **other))
    assert ids(network) == [("A", 1, 0), ("B", other["constants"].get("id", 1), 0)]
    assert network.protocol is None and findings == []
    assert network.head == {"id_bits": 8}


def test_the_discriminator_is_the_constant_of_all_messages_with_most_values():
    rows = [
        {"same": 1, "two": 1, "three": 3, "some": 1, "negative": -1},
        {"same": 1, "two": 1, "three": 2, "some": 2, "negative": -2},
        {"same": 1, "two": 2, "three": 1, "negative": -3},
    ]
    network, _ = filled(
        *(Frame(f"M{at}", constants=row) for at, row in enumerate(rows))
    )
    assert [each["id"] for each in network.messages] == [3, 2, 1]
    # The first of equally good ones.
    rows = [{"a": 1, "b": 3}, {"a": 2, "b": 4}]
    network, _ = filled(
        *(Frame(f"M{at}", constants=row) for at, row in enumerate(rows))
    )
    assert [each["id"] for each in network.messages] == [1, 2]


def test_an_id_has_at_most_32_bits_and_is_not_negative():
    def is_used(value):
        network, _ = filled(Frame("A", constants={"id": value}))
        return [each["id"] for each in network.messages] == [value]

    assert_limits(lambda value: is_used(value + 10), least=-10)
    assert_limits(is_used, most=2**32 - 1)
    network, _ = filled(Frame("A", constants={"id": 2**32 - 1}))
    assert network.head == {"id_bits": 32}


def test_messages_without_a_discriminator_are_counted_from_1_in_each_direction():
    names = [f"T{number}" for number in range(4)]
    network, findings = filled(
        *map(Frame, names),
        Frame("C0", TELECOMMAND),
        Frame("C1", TELECOMMAND, why="it is odd"),
        Frame("C2", TELECOMMAND),
    )
    assert ids(network) == [
        ("T0", 1, 0), ("T1", 2, 0), ("T2", 3, 0), ("T3", 4, 0),
        ("C0", 1, 0), ("C2", 3, 0),
    ]  # fmt: skip
    help = "their ids are counted from 1"
    text = "no parameter tells all {} messages of {}: {}"
    assert findings == [
        (
            "IMP079",
            "warning",
            text.format(4, "telemetry", "`T0`, `T1`, `T2` ..."),
            help,
        ),
        ("IMP070", "error", "message `C1` is not imported: it is odd", ""),
        (
            "IMP079",
            "warning",
            text.format(3, "telecommand", "`C0`, `C1`, `C2`"),
            help,
        ),
    ]


def test_a_single_message_without_a_discriminator_needs_no_finding():
    network, findings = filled(Frame("A"), Frame("B", TELECOMMAND))
    assert ids(network) == [("A", 1, 0), ("B", 1, 0)] and findings == []
    _, findings = filled(Frame("A"), Frame("B"))
    assert [text for _, _, text, _ in findings] == [
        "no parameter tells all 2 messages of telemetry: `A`, `B`"
    ]


def test_ids_need_at_least_8_bits():
    network, _ = filled(*(Frame(f"M{at}") for at in range(256)))
    assert network.head == {"id_bits": 9}
    network, _ = filled()
    assert network.head == {"id_bits": 8} and network.messages == []
