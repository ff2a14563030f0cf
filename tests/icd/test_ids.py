"""Ids of messages: who reports a clash, the ends of ranges, and the advice that is
given.
"""

from __future__ import annotations

import pytest

from tests.icd.files import codes, findings
from tests.limits import assert_limits

NODE = "node: {{name: {}, title: Demo, byte_order: little, bit_order: lsb0{}}}\n"
UART = (
    "protocol: {link: {buses: {uart: {line: {baud_rate: 9600}, framing: "
    "{by: escape, escape: 0x10, start: 0x02, end: 0x03, data: 0x10}}}}}\n"
)


def node(name: str, *messages: str, bits: int = 8, head: str = "") -> str:
    """Return an ICD with these messages, each the inside of a flow mapping."""
    own = NODE.format(name, f", id_bits: {bits}" if bits != 8 else "")
    rows = "".join(f"  - {{{message}}}\n" for message in messages)
    return f"icdgen: 1\n{own}{head}" + (f"messages:\n{rows}" if rows else "")


def command(name: str, id: object, keys: str = "length: 0") -> str:
    return f"name: {name}, id: {id}, kind: telecommand, {keys}"


def telemetry(name: str, id: object, keys: str = "length: 0") -> str:
    return f"name: {name}, id: {id}, kind: telemetry, {keys}"


def lost(id: object, kind: str = "telecommand") -> str:
    """Return a list of missing messages with one entry."""
    return (
        f"missing: [{{kind: {kind}, id: {id}, name: Lost, why: It is not printed.}}]\n"
    )


def fixed(value: int) -> str:
    """Return the keys of a message whose only byte is a constant."""
    field = f"{{at: 0, bits: 8, name: Kind, type: uint, const: {value}}}"
    return f"length: 1, fields: [{field}]"


INCLUDE = "include: [base.yaml]\n"


def with_base(demo: str, base: str) -> str:
    return f"{demo}# base.yaml\n{base}"


@pytest.mark.parametrize(
    ("bits", "id", "missing"),
    [
        (8, 0, 0),
        (8, 255, "[255]"),
        (8, 0, "[0]"),
        (32, 2**32 - 1, 2**32 - 1),
        (32, 2**32 - 1, "[255, 255, 255, 255]"),
    ],
)
def test_a_missing_message_with_the_id_of_a_message_is_reported(
    bits, id, missing, tmp_path
):
    text = node("demo", command("Ping", id), bits=bits, head=lost(missing))
    (finding,) = findings(tmp_path, text)
    assert finding.code == "ICD055"
    assert " already belongs to `Ping` (line 5)" in finding.message
    assert finding.help == "correct one `id`"


@pytest.mark.parametrize(
    "id", [-1, 2**32, "[256]", "[1, 256]", "[-1, 1]", "[]", "[0, 0, 0, 0, 1]"]
)
def test_a_missing_message_with_an_impossible_id_has_one_finding(id, tmp_path):
    text = node("demo", command("Ping", 1), bits=32, head=lost(id))
    assert codes(tmp_path, text) == ["ICD010"]


@pytest.mark.parametrize("head", [INCLUDE, INCLUDE + UART])
def test_a_message_with_the_id_of_a_missing_message_of_a_base_is_reported(
    head, tmp_path
):
    """Nothing describes a missing message, so no constant could distinguish the two."""
    text = with_base(
        node("demo", command("Ping", 5), head=head), node("base", head=lost(5))
    )
    (finding,) = findings(tmp_path, text)
    assert finding.code == "ICD055" and finding.place.line == len(head.splitlines()) + 4
    base = tmp_path / "base.yaml"
    assert finding.message == f"telecommand id 5 already belongs to `Lost` ({base}:3)"
    assert finding.help == "correct one `id`"


def test_the_text_about_links_is_only_for_messages_that_differ(tmp_path):
    same, different = (
        findings(
            tmp_path,
            node(
                "demo",
                command("A", 5, fixed(1)),
                command("B", 5, fixed(second)),
                head=UART,
            ),
        )
        for second in (1, 2)
    )
    assert [finding.message for finding in same + different] == [
        "telecommand id 5 already belongs to `A` (line 5)",
        "telecommand id 5 already belongs to `A` (line 5), and the links that `protocol` "
        "describes distinguish messages only by id",
    ]


@pytest.mark.parametrize(
    ("demo", "base", "second", "expected"),
    [
        ("", "", 1, ["base.yaml ICD055"]),
        ("", "", 2, ["base.yaml ICD181"]),
        (UART, "", 2, ["base.yaml ICD055", "base.yaml ICD181"]),
        ("", UART, 2, ["base.yaml ICD055"]),
        (UART, UART, 2, ["base.yaml ICD055"]),
    ],
    ids=["no link", "no link, distinguishable", "own link", "included link", "both"],
)
def test_a_clash_in_an_included_file_is_reported_once(
    demo, base, second, expected, tmp_path
):
    """A link of the including file makes messages clash that its base permits."""
    messages = command("A", 5, fixed(1)), command("B", 5, fixed(second))
    text = with_base(
        node("demo", head=INCLUDE + demo), node("base", *messages, head=base)
    )
    assert [
        f"{finding.place.file.rpartition('/')[2]} {finding.code}"
        for finding in findings(tmp_path, text)
    ] == expected


def test_a_clash_by_a_link_belongs_to_the_first_file_with_the_link(tmp_path):
    shared = (
        command(name, 5, f"shares_id: true, {fixed(value)}")
        for name, value in (("A", 1), ("B", 2))
    )
    middle = node("middle", head=INCLUDE + UART)
    text = with_base(
        node("demo", head="include: [middle.yaml]\n") + f"# middle.yaml\n{middle}",
        node("base", *shared),
    )
    (finding,) = findings(tmp_path, text)
    assert finding.code == "ICD055" and "`middle` includes both" in finding.message


def test_a_missing_message_of_a_base_does_not_hide_an_id_shared_by_mistake(tmp_path):
    messages = telemetry("A", 5, fixed(1)), telemetry("B", 5, fixed(2))
    text = with_base(
        node("demo", *messages, head=INCLUDE), node("base", head=lost(5, "telemetry"))
    )
    assert codes(tmp_path, text) == ["ICD055", "ICD055", "ICD181"]


@pytest.mark.parametrize(
    ("bits", "id", "needed"),
    [
        (8, 0x100, 16),
        (8, 0xFFFF, 16),
        (8, 0x10000, 24),
        (8, 0xFFFFFF, 24),
        (8, 0x1000000, 32),
        (8, 0xFFFFFFFF, 32),
        (11, 0x800, 29),
        (11, 0x1FFFFFFF, 29),
        (11, 0x20000000, 32),
        (29, 0x20000000, 32),
    ],
)
def test_the_advice_names_the_smallest_width_of_ids(bits, id, needed, tmp_path):
    (finding,) = findings(tmp_path, node("demo", command("Ping", id), bits=bits))
    assert finding.code == "ICD056"
    assert finding.message.endswith(f", 0 to {2**bits - 1}")
    assert finding.help.endswith(f"`id_bits: {needed}` in `node`")


RANGES = (
    "protocol: {link: {ids: {telecommand: {direction: 0, first: 10, last: 0x64}, "
    "telemetry: {direction: 1, first: 128, last: 0xF0}, direction_bit: 7}}}\n"
)


@pytest.mark.parametrize(
    ("message", "other"),
    [
        (command("Ping", 128), "telemetry"),
        (command("Ping", 240), "telemetry"),
        (command("Ping", 127), None),
        (command("Ping", 241), None),
        (command("Ping", 9), None),
        (telemetry("Ping", 10), "telecommand"),
        (telemetry("Ping", 100), "telecommand"),
        (telemetry("Ping", 9), None),
        (telemetry("Ping", 101), None),
    ],
)
def test_an_id_out_of_range_is_said_to_be_of_the_other_direction(
    message, other, tmp_path
):
    (finding,) = findings(tmp_path, node("demo", message, head=RANGES))
    assert finding.code == "ICD056"
    is_command = "telecommand" in message
    assert finding.message.endswith(", 10 to 0x64" if is_command else ", 128 to 0xF0")
    id = message.split("id: ")[1].split(",")[0]
    wrong = f"{id} is a {other} id: correct `id` or `kind`" if other else "correct `id`"
    assert finding.help == f"{wrong}, or the range in `link: ids`"


def test_an_incomplete_range_is_not_compared_with_ids(tmp_path):
    for missing in ("first: 10, ", "last: 0x64"):
        text = node("demo", command("Ping", 200), head=RANGES.replace(missing, "", 1))
        assert codes(tmp_path, text) == ["ICD010"]


def uart_codes(folder, *messages: str, head: str = UART) -> list[str]:
    return codes(folder, node("demo", *messages, head=head))


def test_telecommands_of_a_uart_have_ids_outside_those_of_telemetry(tmp_path):
    def is_below_or_inside(id: int) -> bool:
        return "ICD114" in uart_codes(
            tmp_path, command("Ping", id), telemetry("A", 100), telemetry("B", 110)
        )

    assert_limits(is_below_or_inside, least=100, most=110)


def test_a_uart_without_telemetry_permits_all_ids_of_telecommands(tmp_path):
    assert uart_codes(tmp_path, command("A", 0), command("B", 255)) == []


def test_missing_telemetry_does_not_widen_the_ids_of_a_uart(tmp_path):
    messages = command("Ping", 2), telemetry("State", 3)
    assert uart_codes(tmp_path, *messages, head=UART + lost(1, "telemetry")) == []


def test_missing_telecommands_are_not_sent_over_a_uart(tmp_path):
    messages = telemetry("A", 1), telemetry("B", 3)
    assert uart_codes(tmp_path, *messages, head=UART + lost(2)) == []


def test_an_id_of_an_included_uart_is_reported_once(tmp_path):
    base = node(
        "base", command("Ping", 2), telemetry("A", 1), telemetry("B", 3), head=UART
    )
    text = with_base(node("demo", head=INCLUDE), base)
    assert codes(tmp_path, text) == ["ICD114"]


def test_declared_ranges_decide_instead_of_the_ids_of_a_uart(tmp_path):
    ranges = RANGES.removeprefix("protocol: {link: {").removesuffix("}}\n")
    head = UART.replace("{link: {", f"{{link: {{{ranges}, ")
    messages = command("Ping", 130), telemetry("State", 129), telemetry("B", 131)
    assert uart_codes(tmp_path, *messages, head=head) == ["ICD056"]


KEYS_OF_KINDS = {
    "telecommand": ("`id`", ["id"]),
    "telemetry": ("`id`", ["id"]),
    "configuration": ("`set_id` and `get_id`", ["set_id", "get_id"]),
}


@pytest.mark.parametrize("kind", KEYS_OF_KINDS)
def test_a_message_has_the_ids_of_its_kind(kind, tmp_path):
    shown, own = KEYS_OF_KINDS[kind]
    text = node(
        "demo", f"name: A, id: 1, set_id: 2, get_id: 3, kind: {kind}, length: 0"
    )
    assert [(f.message, f.help) for f in findings(tmp_path, text) if f.code == "ICD059"] == [
        (f"a {kind} message has no `{key}`", f"remove it: {kind} has {shown}")
        for key in ("id", "set_id", "get_id")
        if key not in own
    ]  # fmt: skip


@pytest.mark.parametrize("kind", KEYS_OF_KINDS)
def test_only_telemetry_has_no_acknowledge_and_hazard(kind, tmp_path):
    ids = "set_id: 1, get_id: 2" if kind == "configuration" else "id: 1"
    keys = "acknowledge: false, hazard: It is lost."
    text = node("demo", f"name: A, {ids}, kind: {kind}, length: 0, {keys}")
    assert codes(tmp_path, text) == ["ICD065"] * 2 * (kind == "telemetry")


SHARED = "shares_id: true, "


@pytest.mark.parametrize(
    ("shared", "lines"),
    [
        ("ABC", []),
        ("AB", [(6, "`C`")]),
        ("BC", [(5, "`A`"), (6, "`A`")]),
        ("A", [(5, "`B`"), (6, "`C`")]),
        ("", [(5, "each of the two"), (6, "each of the two")]),
    ],
)
def test_each_message_of_a_shared_id_is_compared_with_the_first(
    shared, lines, tmp_path
):
    messages = [
        command(name, "0x05", SHARED * (name in shared) + fixed(value))
        for value, name in enumerate("ABC")
    ]
    reported = findings(tmp_path, node("demo", *messages))
    one = ", and only one of the two has `shares_id`" * bool(shared)
    assert [(f.code, f.place.line, f.message, f.help) for f in reported] == [
        (
            "ICD181",
            line,
            f"telecommand id 0x05 already belongs to `A` (line 4){one}",
            "correct one `id`; or, if they share the id on purpose, add `shares_id: "
            f"true` to {to}",
        )
        for line, to in lines
    ]


def test_shares_id_needs_a_message_of_the_same_direction_in_one_device(tmp_path):
    """A file that includes both messages is such a device."""
    one = command("A", 5, SHARED + fixed(1))
    other = node("base", command("B", 5, SHARED + fixed(2)))
    assert codes(tmp_path, node("demo", one)) == ["ICD182"]
    state = telemetry("B", 5, SHARED + fixed(2))
    assert codes(tmp_path, node("demo", one, state)) == ["ICD182"] * 2
    assert codes(tmp_path, with_base(node("demo", one), other)) == ["ICD182"] * 2
    assert codes(tmp_path, with_base(node("demo", one, head=INCLUDE), other)) == []


@pytest.mark.parametrize(
    ("bits", "given", "is_right"),
    [
        (8, [1], True),
        (8, [1, 2], False),
        (11, [1, 2], True),
        (11, [1], False),
        (16, [1, 2], True),
        (17, [1, 2], False),
        (29, [0, 0, 0, 1], True),
        (32, [1, 2, 3], False),
    ],
)
def test_an_id_in_bytes_has_the_bytes_of_its_bits(bits, given, is_right, tmp_path):
    reported = findings(tmp_path, node("demo", command("Ping", given), bits=bits))
    size = -(-bits // 8)
    needed = f"{size} byte{'s' * (size > 1)}"
    has = f"{len(given)} byte{'s' * (len(given) > 1)}"
    assert [(f.code, f.message, f.help) for f in reported] == [
        (
            "ICD111",
            f"ids have {bits} bits, which is {needed}: `Ping` has an id of {has}",
            f"write {needed}, or correct `id_bits` in `node`",
        )
    ] * (not is_right)


def test_shares_id_is_not_reported_beside_a_message_with_errors(tmp_path):
    """It may be the other message of the id."""
    messages = command("A", 5, SHARED + fixed(1)), command("B", 5, SHARED + "length: x")
    assert codes(tmp_path, node("demo", *messages)) == ["ICD010"]
