"""Rules of headers and trailers: which keys and roles they need, and what fits."""

from __future__ import annotations

from pathlib import Path

import pytest

from icdgen.icd.rules.framed_links import ROLES_OF_KEY
from tests.icd.files import codes
from tests.icd.rules.reported import messages, reported
from tests.limits import assert_limits

NODE = "node: {{name: {}, title: Demo, byte_order: {}, bit_order: {}, id_bits: 16}}\n"
ID = "bits: 16, role: id"


def message(
    name: str, id: int, length: int = 1, kind: str = "telemetry", keys: str = ""
) -> str:
    data = f"{{at: 0, bits: {8 * length}, name: Data, type: bytes}}"
    fields = f", fields: [{data}]" if length else ""
    return f"  - {{name: {name}, id: {id}, kind: {kind}, length: {length}{keys}{fields}}}\n"


def open_message(name: str, id: int, shortest: int, most: int) -> str:
    """Return telemetry that ends with up to ``most`` bytes of variable length."""
    rows = f"{{at: 0, bits: {8 * shortest}, name: Data, type: bytes}}, " * (
        shortest > 0
    )
    rest = f"{{at: {8 * shortest}, name: Rest, type: bytes, size: rest, up_to: {most}}}"
    return f"  - {{name: {name}, id: {id}, kind: telemetry, length: {shortest}, fields: [{rows}{rest}]}}\n"


def link(
    header: list[str],
    *content: str,
    by: str = "slip",
    trailer: list[str] = [],  # noqa: B006
    keys: str = "",
    orders: tuple[str, str] = ("little", "lsb0"),
) -> str:
    """Return an ICD with a framed link: line 7 is the first field of the header."""
    rows = "".join(f"      - {{{row}}}\n" for row in header)
    ends = "".join(f"      - {{{row}}}\n" for row in trailer)
    return (
        f"icdgen: 1\n{NODE.format('demo', *orders)}protocol:\n"
        f"  link:\n    framing: {{by: {by}}}\n"
        + (f"    header:\n{rows}" if rows else "")
        + (f"    trailer:\n{ends}" if ends else "")
        + f"{keys}messages:\n{''.join(content or [message('One', 1)])}"
    )


def test_only_boot_and_procedures_stand_beside_a_framed_link(tmp_path):
    text = link([ID]).replace(
        "messages:",
        "  log_mask: {bytes: 2, frame_bytes: 4}\n  boot: {}\n  procedures: {}\n"
        "  telemetry_log: {}\nmessages:",
    )
    beside = [
        (each.marked, each.message, each.help)
        for each in reported(tmp_path, text, "ICD170")
    ]
    assert beside == [
        (key, f"`{key}` has no effect beside `link: framing`", f"remove `{key}` or `framing`")
        for key in ("log_mask", "telemetry_log")
    ]  # fmt: skip


def test_ids_and_buses_have_no_effect_beside_framing(tmp_path):
    keys = "    ids: {}\n    buses: {}\n"
    assert [
        (each.marked, each.message, each.help)
        for each in reported(tmp_path, link([ID], keys=keys), "ICD170")
    ] == [
        (
            "ids",
            "`ids` has no effect beside `framing`",
            "remove `ids` or `framing`",
        ),
        (
            "buses",
            "`buses` has no effect beside `framing`",
            "remove one: a node has one framed link, or buses",
        ),
    ]


def without_framing(*keys: str, include: bool) -> str:
    """Return an ICD whose link has these keys and no framing of its own."""
    rows = "".join(f"    {key}\n" for key in keys)
    own = (
        "icdgen: 1\n"
        + "include: [base.yaml]\n" * include
        + NODE.format("demo", "little", "lsb0")
        + f"protocol:\n  link:\n{rows}"
    )
    return own + "# base.yaml\n" + link([ID]).replace("name: demo", "name: base")


PACKETS = "packets: {Data: {from: device}}"


@pytest.mark.parametrize(
    ("keys", "is_included", "key"),
    [
        (["line: {baud_rate: 9600}"], False, "line"),
        (["header: [{bits: 16, role: id}]"], False, "header"),
        (["trailer: [{bits: 16, role: id}]"], False, "trailer"),
        ([PACKETS, "header: []", "line: {}"], False, "header"),
        ([PACKETS, "header: []"], True, "packets"),
        (["requests: {}", PACKETS], True, "requests"),
        (["commands: {ack: none}"], True, "commands"),
        (["client: {retries: 1}"], True, None),
        ([PACKETS, "requests: {}", "commands: {}"], False, None),
    ],
)
def test_the_first_key_that_needs_framing_is_reported(keys, is_included, key, tmp_path):
    text = without_framing(*keys, include=is_included)
    line = 4 + is_included + next((n for n, each in enumerate(keys, 1) if each.startswith(f"{key}:")), 0)  # fmt: skip
    expected = (
        line,
        key,
        f"`{key}` belongs to a framed link, and `framing` is missing",
        "add `framing: {by: ...}`, how bytes become packets",
    )
    found = reported(tmp_path, text, "ICD170")
    assert found == ([expected] if key else [])


ROLES = (
    "sync", "constant", "id", "length", "sequence", "source", "destination", "type",
    "flags", "time", "status", "reason", "response_length", "checksum",
)  # fmt: skip
VALUES = {"counts": "data", "plus": "1", "unit": "1", "per": "id", "checksum": "sum",
    "covers": "{from: id, to: data}", "enum": "Why", "optional": "true",
}  # fmt: skip
ALLOWED = {
    "counts": ["length"],
    "plus": ["length"],
    "unit": ["length", "response_length"],
    "per": ["sequence"],
    "checksum": ["checksum"],
    "covers": ["checksum"],
    "enum": ["status", "reason"],
    "optional": ["checksum"],
}


@pytest.mark.parametrize("key", ALLOWED)
def test_a_key_of_a_field_applies_to_its_roles_only(key, tmp_path):
    text = link([f"bits: 8, role: {role}, {key}: {VALUES[key]}" for role in ROLES])
    owner = " or ".join(f"`{role}`" for role in ALLOWED[key])
    found = reported(tmp_path, text, "ICD171")
    assert [each[:4] for each in found if "applies to" in each.message] == [
        (
            line,
            key,
            f"`{key}` applies to a field of the role {owner}, not of a `{role}`",
            "remove it, or correct `role`",
        )
        for line, role in enumerate(ROLES, 7)
        if role not in ALLOWED[key]
    ]


def test_each_key_of_some_roles_has_a_row_above():
    assert list(ALLOWED) == list(ROLES_OF_KEY)


def test_constants_need_a_value_and_computed_fields_have_none(tmp_path):
    computed = ("id", "length", "response_length", "checksum")
    with_value = link([f"bits: 8, role: {role}, value: 1" for role in ROLES])
    found = messages(tmp_path, with_value, "ICD171")
    assert [each for each in found if "`value`" in each] == [
        f"the {role} follows from the message, so it has no `value`"
        for role in ROLES
        if role in computed
    ]
    without = link([f"bits: 8, role: {role}" for role in ROLES])
    found = messages(tmp_path, without, "ICD171")
    assert [each for each in found if "`value`" in each] == [
        "a `sync` has no `value`",
        "a `constant` has no `value`",
    ]


def test_each_further_field_of_a_role_is_reported_once(tmp_path):
    """Constants, ids and lengths can have several fields."""
    text = link(3 * [f"bits: 8, role: {role}" for role in ROLES])
    found = reported(tmp_path, text, "ICD171")
    repeated = [each for each in found if "two fields" in each.message]
    single = [
        role for role in ROLES if role not in ("sync", "constant", "id", "length")
    ]
    lines = [7 + len(ROLES) * n + ROLES.index(role) for n in (1, 2) for role in single]
    assert [each.line for each in repeated] == lines
    assert [each[1:] for each in repeated] == 2 * [
        (
            role,
            f"there are two fields of the role `{role}`",
            "give one of them its own role, or make it a `constant`",
        )
        for role in single
    ]


def test_a_repeated_role_of_a_header_that_packets_share_is_reported_once(tmp_path):
    rows = "bits: 8, role: flags", "bits: 8, role: flags"
    keys = "    packets: {Order: {from: host}, Data: {from: device}}\n"
    assert messages(tmp_path, link([ID, *rows], keys=keys), "ICD171") == [
        "there are two fields of the role `flags` of the packet `Order`"
    ]


@pytest.mark.parametrize(
    ("telecommands", "telemetry", "direction"),
    [(1, 1, None), (2, 1, "telecommand"), (1, 2, "telemetry"), (2, 2, "telecommand")],
)
def test_several_messages_in_one_direction_need_an_id(
    telecommands, telemetry, direction, tmp_path
):
    content = [
        message(f"{kind}{n}", n, kind=kind)
        for kind, number in (("telecommand", telecommands), ("telemetry", telemetry))
        for n in range(number)
    ]
    text = link(["bits: 8, role: flags"], *content)
    expected = (
        5,
        "{",
        "no field has the role `id`, and there are several messages in one direction "
        f"({direction})",
        "add one: the link has no other way to distinguish them",
    )
    assert reported(tmp_path, text, "ICD171") == ([expected] if direction else [])


def test_messages_of_one_id_need_no_field_for_it(tmp_path):
    """Their lengths distinguish them."""
    content = [message(f"M{n}", 5, n, keys=", shares_id: true") for n in (1, 2)]
    assert codes(tmp_path, link(["bits: 8, role: flags"], *content)) == []


@pytest.mark.parametrize(
    ("by", "header", "trailer", "content", "name"),
    [
        ("length", [], [], [message("A", 1), message("B", 2, 9)], None),
        ("length", [], [], [message("A", 1, 2), open_message("B", 2, 1, 5)], "B"),
        ("length", [], [], [message("A", 1, 2, keys=", may_end_early: zeros")], "A"),
        ("length", ["bits: 8, role: length"], [], [open_message("A", 1, 1, 5)], None),
        ("slip", [], [], [open_message("A", 1, 1, 5)], None),
    ],
)
def test_messages_without_a_fixed_length_need_a_length_if_it_delimits_them(
    by, header, trailer, content, name, tmp_path
):
    text = link([ID, *header], *content, by=by, trailer=trailer)
    expected = (
        5,
        "{",
        f"no field has the role `length`, and `{name}` has no fixed length",
        "add one, or choose another `framing`",
    )
    assert reported(tmp_path, text, "ICD171") == ([expected] if name else [])


def test_the_lengths_of_requested_telemetry_are_listed_in_order(tmp_path):
    """A packet without id and length can have telemetry of one length."""
    keys = (
        "    packets: {Read: {from: host, header: [{bits: 16, role: id}]}, "
        "Data: {from: device, header: [{bits: 8, role: flags}]}}\n"
        "    requests: {packet: Read, response: Data}\n"
    )
    for lengths, expected in (
        ((300, 5, 9, 5), ["5, 9 and 300"]),
        ((300, 5), ["5 and 300"]),
        ((5, 5), []),
    ):
        content = [message(f"M{n}", n, length) for n, length in enumerate(lengths)]
        text = link([], *content, by="length", keys=keys)
        assert messages(tmp_path, text, "ICD171") == [
            "no field of the packet `Data` has the role `length`, and the telemetry in it "
            f"has {sizes} bytes"
            for sizes in expected
        ]


@pytest.mark.parametrize("by", ["length", "slip"])
@pytest.mark.parametrize("is_in_header", [True, False])
def test_a_length_behind_the_data_delimits_nothing(by, is_in_header, tmp_path):
    header = [ID] + ["bits: 8, role: length"] * is_in_header
    text = link(header, by=by, trailer=["bits: 8, role: length"] * 2)
    found = reported(tmp_path, text, "ICD171")
    assert found == [
        (line, "length", "the length that delimits messages is after their data", "move it to `header`")
        for line in (9, 10)
        if by == "length" and not is_in_header
    ]  # fmt: skip


@pytest.mark.parametrize(
    ("header", "trailer", "around"),
    [
        (["bits: 4, role: length, counts: message", "bits: 4, role: type"], [], 1),
        (["bits: 4, role: length, counts: message", "bits: 5, role: type"], [], 2),
        (["at: 12, bits: 4, role: length, counts: message", "at: 0, bits: 8, role: type"], [], 2),
        (["bits: 4, role: length, counts: message"], ["bits: 1, role: flags"], 2),
        (["bits: 4, role: length, counts: message"], ["bits: 8, role: flags"], 2),
        (["bits: 4, role: length, counts: message"], ["bits: 16, role: flags", "bits: 1, role: time"], 4),
        (["bits: 4, role: length, counts: data", "bits: 8, role: type"], ["bits: 1, role: flags"], 0),
        (["bits: 4, role: length", "bits: 8, role: type"], ["bits: 1, role: flags"], 0),
    ],
)  # fmt: skip
def test_a_length_of_the_message_includes_header_and_trailer_in_whole_bytes(
    header, trailer, around, tmp_path
):
    def fits(length: int) -> bool:
        text = link(header, message("One", 1, length), trailer=trailer)
        return "ICD172" not in codes(tmp_path, text)

    assert_limits(fits, most=15 - around)


@pytest.mark.parametrize(
    ("keys", "length", "number"),
    [
        ("plus: 3", 12, None),
        ("plus: 3", 13, 16),
        ("unit: 2", 30, None),
        ("unit: 2", 32, 16),
        ("unit: 3, plus: 2", 39, None),
        ("unit: 3, plus: 2", 42, 16),
        ("unit: 4, plus: -2", 68, None),
        ("unit: 4, plus: -2", 72, 16),
        ("unit: 4, plus: -2", 8, None),
    ],
)
def test_a_length_is_counted_in_units_before_the_addition(
    keys, length, number, tmp_path
):
    rows = [ID, f"bits: 4, role: length, {keys}"]
    text = link(rows, message("One", 1, 8), message("Two", 2, length))
    expected = (
        8,
        "4",
        f"a length of 4 bits does not hold {number}, that of `Two`",
        "make the field wider, or the message shorter",
    )
    assert reported(tmp_path, text, "ICD172") == ([expected] if number else [])


def test_the_first_message_with_a_length_below_zero_is_named(tmp_path):
    """The shortest frame decides, and every length field is compared."""
    rows = [ID, "bits: 8, role: length, plus: -3", "bits: 2, role: length, plus: -1"]
    content = (
        message("Three", 3, 3),
        open_message("Open", 1, 1, 9),
        message("Zero", 2, 0),
    )
    assert [
        each[:3] for each in reported(tmp_path, link(rows, *content), "ICD172")
    ] == [
        (8, "-3", "the length of `Open` would be -2"),
        (9, "2", "a length of 2 bits does not hold 9, that of `Open`"),
    ]


@pytest.mark.parametrize(
    ("ids", "name"),
    [((0, 15), None), ((0, 16), "B"), ((17, 16), "A"), ((16, 300), "B")],
)
def test_the_fields_of_an_id_hold_the_largest_id_together(ids, name, tmp_path):
    rows = ["bits: 4, role: flags", "bits: 2, role: id", "bits: 2, role: id"]
    content = [message(name, id) for name, id in zip("AB", ids, strict=True)]
    expected = (
        8,
        "2",
        f"an id of 4 bits cannot represent 0x{max(ids):X}, that of `{name}`",
        "make the field wider, or correct the id",
    )
    found = reported(tmp_path, link(rows, *content), "ICD172")
    assert found == ([expected] if name else [])


@pytest.mark.parametrize(
    ("at", "bits", "crosses"),
    [
        (0, 4, False),
        (4, 4, False),
        (4, 5, True),
        (0, 8, False),
        (1, 8, True),
        (0, 9, True),
        (0, 16, False),
        (4, 16, True),
        (8, 24, False),
        (8, 20, True),
    ],
)
@pytest.mark.parametrize("bit_order", ["lsb0", "msb0"])
def test_a_field_across_bytes_has_the_byte_order_that_continues_its_bits(
    at, bits, crosses, bit_order, tmp_path
):
    """The byte order of the field is used, or else that of the node."""
    other = "big" if bit_order == "lsb0" else "little"
    same = "little" if bit_order == "lsb0" else "big"
    for of_node in (other, same):
        for of_field in (other, same, None):
            order = f", byte_order: {of_field}" if of_field else ""
            row = f"at: {at}, bits: {bits}, role: flags{order}"
            text = link([row], orders=(of_node, bit_order))
            expected = (
                7,
                str(at),
                f"the flags crosses bytes in {other} order, though bits are {bit_order}",
                "use whole bytes: only these can have a byte order that differs from "
                "the bit order",
            )
            is_wrong = crosses and (of_field or of_node) == other
            assert reported(tmp_path, text, "ICD172") == [expected] * is_wrong


@pytest.mark.parametrize(
    ("value", "bits", "problems"),
    [
        ("[1, 2]", 16, []),
        ("[1, 2]", 24, ["2 bytes are given for 24 bits"]),
        ("[255]", 16, ["1 byte is given for 16 bits"]),
        ("[1, 2]", 8, ["2 bytes are given for 8 bits"]),
        ("15", 4, []),
        ("16", 4, ["16 does not fit 4 bits"]),
        ("1", 1, []),
        ("2", 1, ["2 does not fit 1 bit"]),
        ("{telecommand: 15, telemetry: 0}", 4, []),
        (
            "{telecommand: 16, telemetry: 17}",
            4,
            ["16 does not fit 4 bits", "17 does not fit 4 bits"],
        ),
        (
            "{telecommand: 1, telemetry: [1, 2]}",
            8,
            ["2 bytes are given for 8 bits"],
        ),
    ],
)
def test_a_value_has_the_bits_of_its_field(value, bits, problems, tmp_path):
    text = link([ID, f"bits: {bits}, role: flags, value: {value}"])
    found = reported(tmp_path, text, "ICD172")
    assert [each.message for each in found] == problems
    assert {each.help for each in found} <= {"correct `bits` or `value`"}


@pytest.mark.parametrize(
    ("header", "trailer", "is_empty"),
    [([], [], True), (["bits: 1, role: flags"], [], False), ([], ["bits: 1, role: flags"], False)],
)  # fmt: skip
@pytest.mark.parametrize(
    "empty", [message("None", 2, 0), open_message("None", 2, 0, 3)]
)
def test_every_message_is_sent_as_at_least_a_byte(
    header, trailer, is_empty, empty, tmp_path
):
    content = message("One", 1, kind="telecommand"), empty
    text = link(header, *content, trailer=trailer)
    expected = (
        5,
        "{",
        "no byte is sent for `None`, which can have no data",
        "add a field to `header`, such as an id",
    )
    assert reported(tmp_path, text, "ICD172") == [expected] * is_empty


FLAGS = "at: 0, bits: 8, role: flags"
BROKEN = {
    "at: 0": ["at: -1", "at: x"],
    "bits: 8": ["bits: 0", "bits: 33", "bits: true", "bits: x"],
    "role: flags": [
        "role: 5",
        "role: length, unit: 0",
        "role: length, plus: x",
        "role: checksum, checksum: 5",
        "role: flags, name: [x]",
        "role: status, enum: 7",
        "role: flags, value: x",
        "role: flags, value: true",
        "role: flags, value: [256]",
        "role: flags, value: [1, 256]",
        "role: flags, value: [-1]",
        "role: flags, value: [x]",
        "role: flags, value: {telecommand: 1, telemetry: x}",
    ],
}


@pytest.mark.parametrize(
    "row",
    [FLAGS.replace(old, new) for old, rows in BROKEN.items() for new in rows],
)
def test_a_link_with_a_broken_field_is_reported_by_the_schema_only(row, tmp_path):
    two = message("One", 1), message("Two", 2)
    assert set(codes(tmp_path, link([row], *two))) == {"ICD010"}


@pytest.mark.parametrize(
    "row",
    [
        FLAGS,
        FLAGS.replace("bits: 8", "bits: 32"),
        FLAGS.replace("bits: 8", "bits: 1"),
        FLAGS.replace("role: flags", "role: length, unit: 1"),
        FLAGS.replace("role: flags", "role: flags, value: [255]"),
        FLAGS.replace("role: flags", "role: flags, value: [0]"),
    ],
)
def test_a_link_without_a_broken_field_is_checked(row, tmp_path: Path):
    two = message("One", 1), message("Two", 2)
    assert codes(tmp_path, link([row], *two)) == ["ICD171"]
