"""Rules of responses: widths of repeated parts, values of a status, and contradictions."""

from __future__ import annotations

import pytest

from tests.icd.rules.reported import Reported, messages, reported
from tests.limits import assert_limits

NODE = (
    "node: {name: demo, title: Demo, byte_order: big, bit_order: msb0, id_bits: 16}\n"
)
HEADER = (
    "[{bits: 16, role: id}, {bits: 5, role: flags}, {bits: 3, name: Lot, role: source}]"
)


def sent(name: str, id: int, *fields: str, kind: str = "telecommand", length: int = 8, keys: str = "") -> str:  # fmt: skip
    rows = ", ".join(f"{{{field}}}" for field in fields)
    content = f", fields: [{rows}]" if fields else ""
    return f"  - {{name: {name}, id: {id}, kind: {kind}, length: {length}{keys}{content}}}\n"


def field(bits: int, name: str = "Number", at: int = 0, type: str = "uint") -> str:
    return f"at: {at}, bits: {bits}, name: {name}, type: {type}"


def link(commands: str, *content: str, keys: str = "", enums: str = "") -> str:
    """Return an ICD with a framed link: its responses are in line 7."""
    return (
        f"icdgen: 1\n{NODE}protocol:\n  link:\n    framing: {{by: slip}}\n"
        f"    header: {HEADER}\n    commands: {{{commands}}}\n{keys}{enums}"
        f"messages:\n{''.join(content)}"
    )


def ack(bits: int, type: str = "uint", id: int = 9) -> str:
    return sent("Ack", id, field(bits, type=type), kind="telemetry")


@pytest.mark.parametrize(
    ("repeated", "id", "least"),
    [
        ("Value", 1, 12),
        ("id", 0x1FF, 9),
        ("id", 0x0FF, 8),
        ("id", 1, 1),
        ('"id[0]"', 1, 8),
        ('"id[1]"', 0x1FF, 8),
        ("header.flags", 1, 5),
        ("header.Lot", 1, 3),
        ("header.source", 1, 3),
        ("header.id", 1, 16),
    ],
)
def test_a_field_has_the_bits_of_the_part_that_it_repeats(
    repeated, id, least, tmp_path
):
    def text(bits: int) -> str:
        echo = f"ack: {{message: Ack, echo: {{Number: {repeated}}}}}"
        return link(echo, ack(bits), sent("Save", id, field(12, "Value")))

    if least > 1:
        assert_limits(
            lambda bits: messages(tmp_path, text(bits), "ICD177") == [], least=least
        )
        (found,) = messages(tmp_path, text(least - 1), "ICD177")
        size = f"{least - 1} bit{'s' * (least > 2)}"
        assert found.startswith(f"`Number` of {size} cannot repeat {least} bits of `")
    assert messages(tmp_path, text(32), "ICD177") == []


@pytest.mark.parametrize(
    ("echo", "message", "help"),
    [
        (
            "ack: {message: Ack, echo: {Number: header.Lat}}",
            "the link has no field `Lat` in its header",
            "did you mean `Lot`?",
        ),
        (
            "ack: {message: Ack, echo: {Number: header.flag}}",
            "the link has no field `flag` in its header",
            "did you mean `flags`?",
        ),
        (
            "ack: {packet: Done, echo: {Cde: id}}",
            "the packet `Done` has no field `Cde`",
            "did you mean `Code`?",
        ),
        (
            "ack: {packet: Done, echo: {flag: id}}",
            "the packet `Done` has no field `flag`",
            "did you mean `flags`?",
        ),
    ],
)
def test_similar_names_and_roles_of_frame_fields_are_suggested(
    echo, message, help, tmp_path
):
    packets = (
        "    packets: {All: {from: both, messages: [Ack, Save]}, Done: {from: device, header: "
        "[{bits: 16, name: Code, role: type}, {bits: 8, role: flags}]}}\n"
    )
    keys = packets if "packet" in echo else ""
    text = link(echo, ack(16), sent("Save", 1, field(64)), keys=keys)
    (found,) = reported(tmp_path, text, "ICD177")
    assert (found.message, found.help) == (message, help)


@pytest.mark.parametrize(
    ("type", "why"),
    [
        ("uint", None),
        ("int", "may be negative"),
        ("bytes", "is not a whole number"),
    ],
)
def test_a_wider_field_repeats_unsigned_numbers_only(type, why, tmp_path):
    echo = "ack: {message: Ack, echo: {Number: Value}}"
    save = sent("Save", 1, field(16, "Value", type=type))
    assert messages(tmp_path, link(echo, ack(16), save), "ICD177") == []
    part = "`Number` of 17 bits cannot repeat `Value` of `Save`, which has 16"
    expected = Reported(
        7,
        "Value",
        f"{part} and {why}",
        "give both the same width, or name another field",
    )
    found = reported(tmp_path, link(echo, ack(17), save), "ICD177")
    assert found == ([expected] if why else [])


def test_the_first_telecommand_whose_part_is_too_wide_is_named(tmp_path):
    echo = "ack: {message: Ack, echo: {Number: Value}}"
    content = [
        sent(name, id, field(bits, "Value"))
        for id, (name, bits) in enumerate((("A", 8), ("B", 9), ("C", 10)), 1)
    ]
    assert messages(tmp_path, link(echo, ack(8), *content), "ICD177") == [
        "`Number` of 8 bits cannot repeat 9 bits of `B`"
    ]


@pytest.mark.parametrize(
    ("own", "inherits"),
    [
        ("", True),
        (", response: none", False),
        (", response: {ack: none}", False),
        (", response: {ack: Done}", False),
        (", response: {nak: Done}", True),
    ],
)
def test_a_telecommand_has_the_parts_that_its_own_responses_repeat(
    own, inherits, tmp_path
):
    """`Save` has no `Value`."""
    content = [
        ack(16),
        sent("Done", 8, field(64), kind="telemetry"),
        sent("Save", 1, field(64), keys=own),
    ]
    text = link("ack: {message: Ack, echo: {Number: Value}}", *content)
    expected = ["`Save` has no field `Value`"] * inherits
    assert messages(tmp_path, text, "ICD177") == expected


@pytest.mark.parametrize(("id", "bits"), [(0x7F, 7), (0x80, 8), (0x1FF, 9)])
def test_a_response_to_a_request_repeats_any_id_of_telemetry(id, bits, tmp_path):
    keys = "    requests: {nak: {message: Ack, echo: Number}}\n"
    state = sent("State", id, field(64), kind="telemetry")

    def is_wide_enough(width: int) -> bool:
        text = link("ack: none", ack(width), state, keys=keys)
        return messages(tmp_path, text, "ICD177") == []

    assert_limits(is_wide_enough, least=bits)


def test_a_response_to_a_request_repeats_a_byte_of_the_id(tmp_path):
    """The node has ids of 16 bits, so that there is no third byte."""
    state = sent("State", 1, field(64), kind="telemetry")

    def text(bits: int, repeated: str) -> str:
        keys = (
            f"    requests: {{nak: {{message: Ack, echo: {{Number: '{repeated}'}}}}}}\n"
        )
        return link("ack: none", ack(bits), state, keys=keys)

    for byte in ("id[0]", "id[1]"):
        assert_limits(
            lambda bits, byte=byte: (
                messages(tmp_path, text(bits, byte), "ICD177") == []
            ),
            least=8,
        )
        (found,) = reported(tmp_path, text(7, byte), "ICD177")
        assert found[2:] == (
            f"`Number` of 7 bits cannot repeat `{byte}` of 8 bits",
            "name another field",
        )
    (found,) = reported(tmp_path, text(32, "id[2]"), "ICD177")
    assert found[2:] == (
        "a request of telemetry has no part but its id and its header",
        "write `id`, or `header.` and the name of a field",
    )


@pytest.mark.parametrize(
    ("type", "least", "most"), [("uint", 0, 7), ("int", -4, 3)]
)  # fmt: skip
def test_values_of_a_status_are_those_of_its_field(type, least, most, tmp_path):
    def text(value: int) -> str:
        status = f"ack: {{message: Ack, status: Number, success: [{value}]}}"
        return link(status, ack(3, type), sent("Save", 1, field(64)))

    def fits(value: int) -> bool:
        return messages(tmp_path, text(value), "ICD177") == []

    assert_limits(fits, least=least, most=most)
    assert reported(tmp_path, text(8), "ICD177") == [
        (
            7,
            "8",
            "8 does not fit 3 bits of `Number`",
            "correct the value, or name another field",
        )
    ]


def test_a_status_has_values_that_confirm(tmp_path):
    text = link(
        "ack: {message: Ack, status: Number, busy: [2], progress: [2]}",
        ack(8),
        sent("Save", 1, field(64)),
    )
    assert reported(tmp_path, text, "ICD177") == [
        (
            7,
            "Number",
            "no value of the status confirms the telecommand",
            "add `success:`, the values that do",
        ),
        (
            7,
            "2",
            "`2` is in `busy` already",
            "remove it from one of the two lists",
        ),
    ]


def test_each_list_of_values_needs_a_status(tmp_path):
    text = link(
        "ack: {message: Ack, progress: [3], success: [1], busy: [2]}",
        ack(8),
        sent("Save", 1, field(64)),
    )
    assert reported(tmp_path, text, "ICD177") == [
        (
            7,
            key,
            f"`{key}` lists values of a status, and there is no `status`",
            f"add `status`, or remove `{key}`",
        )
        for key in ("progress", "success", "busy")
    ]


LETTERS = "ABCDEF"


def parts(*echoes: str) -> str:
    """Return an ICD with a response for each text of letters, of which each letter is a
    part of the telecommand.
    """
    rows = [
        f"{kind}: {{message: M{n}, echo: {{{', '.join(f'{letter}: {letter}' for letter in echo)}}}}}"
        for n, (kind, echo) in enumerate(
            zip(("ack", "nak", "busy"), echoes, strict=False)
        )
    ]
    fields = [field(8, letter, 8 * at) for at, letter in enumerate(LETTERS)]
    content = [
        sent(f"M{n}", 9 + n, *fields, kind="telemetry", length=6)
        for n in range(len(echoes))
    ]
    saves = [
        sent(name, id, *fields, length=6) for id, name in enumerate(("Save", "Load"), 1)
    ]
    return link(", ".join(rows), *content, *saves)


@pytest.mark.parametrize(
    ("echoes", "number"),
    [
        (["ABCD"], None),
        (["ABCD", "ABCD", "DA"], None),
        (["AB", "BC", "CD"], None),
        (["ABCDE"], 5),
        (["ABC", "DEF"], 6),
        (["ABC", "CDE", "F"], 5),
    ],
)
def test_different_parts_of_a_telecommand_are_counted_once(echoes, number, tmp_path):
    """A telecommand is reported at the response that has too many."""
    assert messages(tmp_path, parts(*echoes), "ICD177") == [
        f"responses repeat {number} parts of `{name}`, more than 4"
        for name in ("Load", "Save")
        if number
    ]


SAME = "`{}` and `{}` of `Save` are the same {}"
UNCONFIRMED = "`Save` has no response that confirms it, so a client could not tell success from loss"  # fmt: skip


@pytest.mark.parametrize(
    ("response", "expected"),
    [
        ("ack: A, nak: B", []),
        ("reply: A", []),
        ("reply: A, ack: B", []),
        ("nak: A", [("A", UNCONFIRMED)]),
        ("progress: B, busy: A", [("A", UNCONFIRMED)]),
        ("ack: A, nak: A", [("A", SAME.format("ack", "nak", "telemetry"))]),
        (
            "nak: A, busy: A, reply: A",
            [
                ("A", SAME.format("reply", "nak", "telemetry")),
                ("A", SAME.format("reply", "busy", "telemetry")),
            ],
        ),
        (
            "ack: {packet: P}, nak: {packet: P}",
            [("{", SAME.format("ack", "nak", "packet"))],
        ),
        ("ack: {packet: A}, nak: {message: A}", []),
    ],
)
def test_responses_that_contradict_each_other_are_reported(
    response, expected, tmp_path
):
    save = sent("Save", 1, field(64), keys=f", response: {{{response}}}")
    content = [sent(name, id, field(64), kind="telemetry") for name, id in (("A", 9), ("B", 8))]  # fmt: skip
    found = reported(tmp_path, link("timeout_ms: 9", *content, save), "ICD179")
    assert [(each.marked, each.message) for each in found] == expected
    assert {each.line for each in found} <= {11}


def test_a_contradiction_of_all_telecommands_is_reported_once(tmp_path):
    """A telecommand with a response of its own is reported at that response."""
    saves = [
        sent("Save", 1, field(64)),
        sent("Load", 2, field(64)),
        sent("Stop", 3, field(64), keys=", response: {busy: B}"),
    ]
    content = [sent(name, id, field(64), kind="telemetry") for name, id in (("A", 9), ("B", 8))]  # fmt: skip
    text = link("ack: A, nak: A, busy: B", *content, *saves)
    alike = SAME.format("ack", "nak", "telemetry")
    assert [each[:3] for each in reported(tmp_path, text, "ICD179")] == [
        (7, "A", alike)
    ]
    text = text.replace("busy: B}\nmess", "busy: none}\nmess").replace(
        "{busy: B}", "{busy: A}"
    )
    assert [each[:3] for each in reported(tmp_path, text, "ICD179")] == [
        (7, "A", alike),
        (13, "A", alike.replace("nak", "busy").replace("Save", "Stop")),
    ]


def test_a_configuration_can_be_the_reply_to_a_telecommand(tmp_path):
    config = "  - {name: Mode, set_id: 2, get_id: 3, kind: configuration, length: 0}\n"
    text = link("reply: Mode", config, sent("Save", 1, field(64)))
    assert messages(tmp_path, text, "ICD176") == []
    text = link("reply: Load", sent("Load", 2, field(64)))
    assert messages(tmp_path, text, "ICD176") == [
        "`Load` is a telecommand, and a response comes from the device"
    ]


REASONS = "enums: [{name: Why, members: [{value: 0, name: Bad value}, {value: 1, name: Bad length}]}]\n"  # fmt: skip


def test_reasons_are_members_of_the_enumeration_of_any_refusal(tmp_path):
    nak = sent("Nak", 8, "at: 0, bits: 32, name: Reason, type: enum, enum: Why", kind="telemetry")  # fmt: skip
    reasons = "reasons: {value: Bad value, length: Bad lengths, unknown_id: Other}"
    text = link(
        f"ack: Ack, nak: {{message: Nak, reason: Reason}}, {reasons}",
        ack(8),
        nak,
        sent("Save", 1, field(64)),
        enums=REASONS,
    )
    assert reported(tmp_path, text, "ICD177") == [
        (
            7,
            "Bad lengths",
            "no refusal has the reason `Bad lengths`",
            "did you mean `Bad length`?",
        ),
        (
            7,
            "Other",
            "no refusal has the reason `Other`",
            "name a member of the enumeration",
        ),
    ]


@pytest.mark.parametrize(
    ("key", "marked"),
    [("status: Number", "Number"), ("status: Other, reason: Number", "Number")],
)
def test_a_reason_of_too_many_values_is_marked_at_the_key_that_names_it(
    key, marked, tmp_path
):
    """The status of a refusal is its reason if no other field is."""
    enums = "enums: [{name: Why, members: [{value: 0, name: Fine}, {value: 1, to: 257, name: Bad}]}]\n"
    number = "at: 0, bits: 16, name: Number, type: enum, enum: Why"
    answer = sent("Ack", 9, number, field(8, "Other", 16), kind="telemetry")
    commands = f"ack: {{message: Ack, {key}, success: [0]}}"
    text = link(commands, answer, sent("Save", 1, field(64)), enums=enums)
    assert reported(tmp_path, text, "ICD177") == [
        (
            7,
            marked,
            "the reason `Bad` is a range of 257 values, more than 256",
            "shorten the range to the values that the device uses, or remove it",
        )
    ]


OTHER_LINKS = [
    "can: {max_data_bytes: 8}",
    "i2c: {write: {address_7bit: 16}}",
    "uart: {framing: {by: escape, escape: 0x1F, start: 0x7F, end: 0xFF, data: 0x1F}}",
]
ON_FRAMED = "`{}` has an effect on framed links (`link: framing`) only"
ON_REQUEST = "`period_ms` has no effect, because on this link telemetry is sent on request only"  # fmt: skip
DEMO = "node: {name: demo, title: Demo, byte_order: big, bit_order: msb0}\n"
BASE = f"# base.yaml\nicdgen: 1\n{DEMO.replace('demo', 'base')}"
ALL_KEYS = "messages:\n" + (
    "  - {name: Save, id: 1, kind: telecommand, length: 0, response: none, repeat: true}\n"
    "  - {name: State, id: 130, kind: telemetry, length: 0, period_ms: 9}\n"
)


def without_effect(section: str) -> list[str]:
    """Return the messages about the keys of `ALL_KEYS`, and of a client if the section
    has one.
    """
    client = [ON_FRAMED.format(key) for key in ("in_flight", "gap_ms")]
    keys = [ON_FRAMED.format(key) for key in ("response", "repeat")]
    return client * ("client" in section) + [*keys, ON_REQUEST]


@pytest.mark.parametrize("bus", OTHER_LINKS)
@pytest.mark.parametrize(
    "client", ["", "client: {retries: 1, in_flight: 2, gap_ms: 5}, "]
)
def test_keys_of_framed_links_have_no_effect_on_each_other_link(bus, client, tmp_path):
    section = f"protocol: {{link: {{{client}buses: {{{bus}}}}}}}\n"
    text = f"icdgen: 1\n{DEMO}{section}{ALL_KEYS}"
    assert messages(tmp_path, text, "ICD183") == without_effect(section)


def test_keys_of_framed_links_are_ignored_without_a_link(tmp_path):
    """Another file may include the messages and describe the link."""
    uart = "protocol: {link: {buses: {uart: {line: {baud_rate: 9600}}}}}\n"
    for section in ("", uart):
        text = f"icdgen: 1\n{DEMO}{section}{ALL_KEYS}"
        assert messages(tmp_path, text, "ICD183") == []


@pytest.mark.parametrize("is_framed", [True, False])
def test_the_links_of_files_that_include_a_message_decide(is_framed, tmp_path):
    other = f"protocol: {{link: {{buses: {{{OTHER_LINKS[0]}}}}}}}\n"
    framed = "protocol: {link: {framing: {by: slip}, header: [{bits: 8, role: id}]}}\n"
    include = "icdgen: 1\ninclude: [base.yaml]\n"
    text = include + DEMO + other + BASE + ALL_KEYS
    if is_framed:
        text += f"# third.yaml\n{include}{DEMO.replace('demo', 'third')}{framed}"
    expected = [] if is_framed else without_effect(other)
    assert messages(tmp_path, text, "ICD183") == expected


def test_keys_of_the_other_direction_are_reported_on_any_link(tmp_path):
    command, state = "telecommand", "telemetry"
    wrong = ALL_KEYS
    for old, new in ((command, ""), (state, command), ("kind: ,", f"kind: {state},")):
        wrong = wrong.replace(old, new)
    text = f"icdgen: 1\n{DEMO}{wrong}"
    assert reported(tmp_path, text, "ICD183") == [
        (4, "response", "`response` applies to a telecommand, not to telemetry", "remove it"),
        (4, "repeat", "`repeat` applies to a telecommand, not to telemetry", "remove it"),
        (5, "period_ms", "`period_ms` applies to telemetry, not to a telecommand", "remove it"),
    ]  # fmt: skip


@pytest.mark.parametrize(
    ("keys", "lines"),
    [
        (["", "", ""], []),
        (["repeat: true"] * 3, []),
        (["repeat: true", "", "repeat: true"], [("A", "B", 8)]),
        (["", "repeat: true", "repeat: true"], [("A", "B", 9), ("A", "C", 10)]),
        (["repeat: true", "repeat: false", ""], [("A", "B", 9), ("A", "C", 8)]),
    ],
)
def test_messages_of_one_id_are_compared_with_the_first(keys, lines, tmp_path):
    """The message that has the key is marked, or else the first."""
    content = [
        sent(name, 1, field(8 * length), length=length, keys=f", shares_id: true{', ' * bool(key)}{key}")
        for length, (name, key) in enumerate(zip("ABC", keys, strict=True), 1)
    ]  # fmt: skip
    found = reported(tmp_path, link("ack: none", *content), "ICD178")
    assert [each[:3] for each in found] == sorted(
        (
            line + 1,
            "repeat",
            f"`repeat` of `{name}` differs from that of `{first}`, which has the same id",
        )
        for first, name, line in lines
    )


@pytest.mark.parametrize(
    ("at", "bits", "is_moved"), [(0, 8, False), (8, 8, True), (4, 8, True)]
)
def test_messages_of_one_id_have_repeated_parts_at_one_place(
    at, bits, is_moved, tmp_path
):
    content = [
        sent(
            "A", 1, field(8, "Value"), length=2, keys=", shares_id: true, reserved: 1"
        ),
        sent("B", 1, field(bits, "Value", at), length=3, keys=", shares_id: true"),
    ]
    commands = "ack: {message: Ack, echo: {Number: Value}}"
    expected = (
        11,
        "B",
        "`Value`, which a response repeats, is not where `A` has it, which has the same "
        "id",
        "correct its place, or the id",
    )
    found = reported(tmp_path, link(commands, ack(32), *content), "ICD178")
    assert found == [expected] * is_moved


@pytest.mark.parametrize("repeated", ["id", "header.flags", "Value", "Other"])
def test_only_parts_that_both_messages_of_one_id_have_are_compared(repeated, tmp_path):
    """`A` has `Value`, and no message has `Other` (ICD177)."""
    content = [
        sent(
            "A", 1, field(8, "Value"), length=2, keys=", shares_id: true, reserved: 1"
        ),
        sent("B", 1, field(24, "Data"), length=3, keys=", shares_id: true"),
    ]
    text = link(
        f"ack: {{message: Ack, echo: {{Number: {repeated}}}}}", ack(32), *content
    )
    assert messages(tmp_path, text, "ICD178") == []
