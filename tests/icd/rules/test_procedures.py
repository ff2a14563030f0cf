"""Rules about the steps of procedures: the keys and places of each step, and the names
and numbers that it uses.
"""

from __future__ import annotations

from itertools import product

import pytest

from tests.icd.rules.marked import findings_of, reported
from tests.icd.rules.steps import PLACES, by_step, icd, procedure

# Kind of a step -> an example, the keys that it needs, and those that it can have.
STEPS = {
    "send": ("Next", "", "with once ignore"),
    "get": ("State", "", "as"),
    "poll": ("State", "until every_ms for_ms", "as fail"),
    "blocks": ("{size: 4, rounds: 1, steps: [{send: Next}]}", "", ""),
    "block_length": ("state.Length", "", ""),
    "missing": ("{packet: 4}", "", ""),
    "map": ("get", "messages field", "bit_order received beyond_end"),
    "receive": ("Packet", "number data silence_ms", "requested_on"),
    "verify": ("{field: state.Sum, equals: 1}", "", "else"),
    "repeat": ("[{send: Next}]", "", ""),
    "collect": ("state", "", ""),
    "end_if_zeros": ("state", "", ""),
}
KEYS = {
    "if": "state.Busy",
    "assumptions": "{if: Not given.}",
    "with": "{Number: 1}",
    "once": "true",
    "ignore": "[timeout]",
    "as": "other",
    "until": "{Busy: false}",
    "every_ms": "1",
    "for_ms": "1",
    "fail": "{Busy: true}",
    "messages": "[Map]",
    "field": "Bits",
    "bit_order": "lsb0",
    "received": "1",
    "beyond_end": "1",
    "number": "Number",
    "data": "Data",
    "silence_ms": "1",
    "requested_on": "[can]",
    "else": "again",
}


def test_each_step_needs_its_keys_and_can_have_no_key_of_another_step(tmp_path):
    every = ", ".join(f"{key}: {value}" for key, value in KEYS.items())
    steps = []
    for kind, (value, *_) in STEPS.items():
        steps += [f"{kind}: {value}", f"{kind}: {value}, {every}"]
    rows = by_step(tmp_path, icd(procedure(*steps)), "ICD190")
    for number, (kind, (_, needed, possible)) in enumerate(STEPS.items()):
        bare, full = (
            [
                (marked, message)
                for marked, message in rows.get(2 * number + part, [])
                if message.startswith("a step with")
            ]
            for part in (0, 1)
        )
        lacks = [
            (kind, f"a step with `{kind}` lacks `{key}`") for key in needed.split()
        ]
        assert sorted(bare) == sorted(lacks)
        own = f"if assumptions {needed} {possible}".split()
        others = [key for key in KEYS if key not in own]
        assert full == [(key, f"a step with `{kind}` has no `{key}`") for key in others]


def test_a_step_with_three_kinds_has_two_too_many(tmp_path):
    text = icd(procedure("as: x, get: State, send: Next, collect: state"))
    both = "the step has `get` and `{}`, and a step does one thing"
    assert reported(tmp_path, text, "ICD190") == [
        ("send", both.format("send")),
        ("collect", both.format("collect")),
    ]


def test_each_step_is_in_the_list_where_it_has_a_meaning(tmp_path):
    allowed = {
        "blocks": ("steps", "no other step"),
        "repeat": ("steps", "no other step"),
        "missing": ("blocks", "the steps of `blocks`"),
        "block_length": ("blocks", "the steps of `blocks`"),
        "map": ("round", "the steps of `missing`"),
        "receive": ("round", "the steps of `missing`"),
        "collect": ("repeat", "the steps of `repeat`"),
        "end_if_zeros": ("repeat", "the steps of `repeat`"),
    }
    cases = [*product(STEPS, PLACES)]
    steps = [
        PLACES[place].format(f"assumptions: {{}}, {kind}: {STEPS[kind][0]}")
        for kind, place in cases
    ]
    rows = by_step(tmp_path, icd(procedure(*steps)), "ICD190")
    for number, (kind, place) in enumerate(cases):
        messages = [row for row in rows.get(number, []) if " stands in " in row[1]]
        wanted, words = allowed.get(kind, (place, ""))
        expected = [(kind, f"`{kind}` stands in {words}")] * (place != wanted)
        assert messages == expected, (kind, place)


def test_a_block_is_transferred_again_by_a_step_in_blocks_at_any_depth(tmp_path):
    step = "verify: {field: state.Sum, equals: 1}, else: again"
    steps = [place.format(step) for place in PLACES.values()]
    rows = by_step(tmp_path, icd(procedure(*steps)), "ICD190")
    text = "`again` transfers a block again, and this step is not in `blocks`"
    assert rows == {0: [("again", text)], 4: [("again", text)]}


def test_a_comparison_is_of_a_checksum_or_of_a_field(tmp_path):
    keys = {
        "checksum": "sum",
        "of": "block",
        "covers_fill": "true",
        "field": "state.Sum",
    }
    cases = [
        [key for key, is_given in zip(keys, given, strict=True) if is_given]
        for given in product([False, True], repeat=4)
    ]
    steps = [
        f"verify: {{equals: 1{''.join(f', {key}: {keys[key]}' for key in case)}}}"
        for case in cases
    ]
    rows = by_step(tmp_path, icd(procedure(*steps)), "ICD190")
    valid = [["checksum", "of"], ["checksum", "of", "covers_fill"], ["field"]]
    text = "`verify` compares a checksum (`checksum`, `of`), or a field (`field`)"
    assert rows == {
        number: [("equals", text)]
        for number, case in enumerate(cases)
        if case not in valid
    }


def test_messages_of_steps_have_an_id_for_their_direction(tmp_path):
    text = icd(
        procedure(
            "send: Map",
            "send: Packet",
            "get: Map",
            "get: Next",
            "poll: Write, until: {Number: 1}, every_ms: 1, for_ms: 9",
            "receive: Write, number: Number, data: Data, silence_ms: 1",
            "receive: Pocket, number: Number, data: Data, silence_ms: 1",
            "map: send, messages: [Map, Packet, Mop, State, Next], field: Bits",
            "map: get, messages: [Map, Write, Packet, Next], field: Bits",
        )
    )
    assert by_step(tmp_path, text, "ICD191") == {
        1: [("Packet", "`Packet` is not a telecommand")],
        3: [("Next", "`Next` is not telemetry")],
        4: [("Write", "`Write` is not telemetry")],
        5: [("Write", "`Write` is not telemetry")],
        6: [("Pocket", "there is no message `Pocket`")],
        7: [
            ("Packet", "`Packet` cannot be sent"),
            ("Mop", "there is no message `Mop`"),
            ("State", "`State` cannot be sent"),
        ],
        8: [
            ("Write", "`Write` cannot be requested"),
            ("Next", "`Next` cannot be requested"),
        ],
    }
    helps = [f.help for f in findings_of(tmp_path, text, "ICD191")]
    assert helps[:2] == ["name a telecommand", "name telemetry"]
    assert helps[5:7] == ["name messages that can", "did you mean `Map`?"]


def test_fields_of_steps_are_those_of_the_own_message(tmp_path):
    text = icd(
        procedure(
            "receive: Packet, number: Nummer, data: Date, silence_ms: 1",
            "map: get, messages: [Map, More], field: Bytes",
            "receive: Packet, number: Data, data: Number, silence_ms: 1",
            "poll: State, until: {Bus: 1}, fail: {Sun: 1}, every_ms: 1, for_ms: 9",
        )
    )
    assert by_step(tmp_path, text, "ICD191") == {
        0: [
            ("Nummer", "`Packet` has no field `Nummer`"),
            ("Date", "`Packet` has no field `Date`"),
        ],
        1: [("Bytes", "`Map` has no field `Bytes`")],
        2: [
            ("Data", "`Data` is not a whole number"),
            ("Number", "`Number` is not a field of bytes"),
        ],
        3: [
            ("Bus", "`State` has no field `Bus`"),
            ("Sun", "`State` has no field `Sun`"),
        ],
    }


WIDTHS = {"Number": 8, "Offset": 16, "Area": 8}


@pytest.mark.parametrize("name", WIDTHS)
def test_a_number_that_is_sent_fits_its_field(name, tmp_path):
    most = (1 << WIDTHS[name]) - 1
    values = [0, most - 1, most, most + 1]
    steps = [f"send: Write, with: {{{name}: {value}}}" for value in values]
    text = f"`{name}` has {WIDTHS[name]} bits: 0 to {most}"
    assert by_step(tmp_path, icd(procedure(*steps)), "ICD191") == {
        3: [(str(most + 1), text)]
    }


def test_numbers_are_inputs_that_are_no_bytes(tmp_path):
    """Polls compare with inputs too."""
    poll = "poll: State, {}: {{Length: {}}}, every_ms: 1, for_ms: 9"
    text = icd(
        procedure(
            "send: Write, with: {Number: image, Offset: number}",
            poll.format("until", "image"),
            poll.format("until: {Length: number}, fail", "nummer"),
            inputs="image: {type: bytes, most: 9}, number: {type: uint}",
        )
    )
    assert by_step(tmp_path, text, "ICD191") == {
        0: [("image", "there is no number `image`")],
        1: [("image", "there is no number `image`")],
        2: [("nummer", "there is no number `nummer`")],
    }


def test_values_of_polls_fit_their_fields(tmp_path):
    step = "poll: State, {}: {{Busy: {}}}, every_ms: 1, for_ms: 9"
    cases = [*product(["until", "fail"], ["true", "1", "2"])]
    text = icd(procedure(*(step.format(*case) for case in cases)))
    message = "`Busy` has 1 bit: 0 to 1"
    assert by_step(tmp_path, text, "ICD191") == {
        2: [("2", message)],
        5: [("2", message)],
    }


ODD = """\
  - name: Odd
    id: 140
    kind: telemetry
    length: 14
    fields:
      - {at: 0,   bits: 8,  name: Mode,     type: uint}
      - {at: 0,   bits: 8,  name: Overlay,  type: uint, view: true}
      - {at: 8,   bits: 8,  name: Optional, type: uint, when: {Mode: 1}}
      - {at: 16,  bits: 32, name: Longest,  type: uint}
      - {at: 48,  bits: 33, name: Too Long, type: uint}
      - {at: 88,  bits: 8,  name: Signed,   type: int}
      - {at: 96,  bits: 16, name: Last,     type: uint}
      - {at: 112, bits: 8,  name: Rest,     type: uint, count: Mode, up_to: 4}
      - {at: 112, after: Rest, bits: 8, name: Behind, type: uint}
  - name: Load
    id: 5
    kind: telecommand
    length: 2
    fields:
      - {at: 0,  bits: 8,  name: Size, type: uint}
      - {at: 8,  bits: 8,  name: Kind, type: uint}
      - {at: 16, name: Bytes, type: bytes, size: Size, up_to: 4}
"""


def test_fields_that_a_step_cannot_compare_are_reported_with_the_reason(tmp_path):
    reasons = {
        "Mode": "",
        "Overlay": "has no bits of its own",
        "Optional": "is not in each frame",
        "Longest": "",
        "Too Long": "is not one run of bits in 4 bytes",
        "Signed": "",
        "Last": "",
        "Rest[0]": "is not at the same place in each frame",
        "Behind": "is not at the same place in each frame",
    }
    steps = [
        f'poll: Odd, until: {{"{name}": 1}}, every_ms: 1, for_ms: 9' for name in reasons
    ]
    text = icd(procedure(*steps)) + ODD
    assert by_step(tmp_path, text, "ICD191") == {
        number: [(f'"{name}"', f"`{name}` {reason}")]
        for number, (name, reason) in enumerate(reasons.items())
        if reason
    }
    outputs = ", ".join(f'o{n}: "Odd.{name}"' for n, name in enumerate(reasons))
    text = icd(procedure("get: Odd", outputs=outputs)) + ODD
    messages = [message for _, message in reported(tmp_path, text, "ICD191")]
    expected = [f"`Odd.{name}` {reason}" for name, reason in reasons.items() if reason]
    assert messages == expected


def test_the_bytes_of_a_packet_can_be_the_first_part_of_variable_length(tmp_path):
    step = PLACES["each"].format("send: Load, with: {Bytes: packet.data, Kind: 1}")
    text = icd(procedure(step)) + ODD
    assert [
        message
        for _, message in reported(tmp_path, text, "ICD191")
        if "same place" in message
    ] == []


@pytest.mark.parametrize("size", [3, 4, 5])
def test_a_field_holds_the_bytes_of_a_packet(size, tmp_path):
    step = PLACES["each"].format("send: Write, with: {Data: packet.data}")
    text = icd(procedure(step.replace("packet: 4", f"packet: {size}")))
    message = f"`Data` holds 4 bytes, and a packet has {size}"
    expected = [("packet.data", message)] * (size != 4)
    assert reported(tmp_path, text, "ICD191") == expected


def test_numbers_of_blocks_and_packets_have_a_value_within_their_loop(tmp_path):
    names = {
        "block.offset": "blocks",
        "block.length": "blocks",
        "block.is_empty": "blocks",
        "packet.number": "each",
        "packet.offset": "each",
        "packet.data": "each",
    }
    within = {"blocks": ["blocks", "each", "round"], "each": ["each"]}
    cases = [*product(names, PLACES)]
    steps = []
    for name, place in cases:
        field = "Data" if name == "packet.data" else "Offset"
        steps.append(PLACES[place].format(f"send: Write, with: {{{field}: {name}}}"))
    rows = by_step(tmp_path, icd(procedure(*steps)), "ICD191")
    assert rows == {
        number: [(name, f"`{name}` has a value in the steps of `{names[name]}` only")]
        for number, (name, place) in enumerate(cases)
        if place not in within[names[name]]
    }


def test_conditions_are_flags(tmp_path):
    inputs = "flag: {type: bool}, number: {type: uint}, area: {enum: Area}"
    used = "send: Write, with: {Area: area, Number: number}"
    cases = [*product(["if", "unless"], ["flag", "number", "area", "State.Busy",
        "State.Length", "Busy", "other"])]  # fmt: skip
    steps = ["get: State", used, *(f"send: Next, {k}: {v}" for k, v in cases)]
    rows = by_step(tmp_path, icd(procedure(*steps, inputs=inputs)), "ICD191")
    assert rows == {
        number: [(value, f"`{value}` is no flag")]
        for number, (_, value) in enumerate(cases, 2)
        if value not in ("flag", "State.Busy")
    }
    steps = [
        place.format("send: Next, unless: block.is_empty") for place in PLACES.values()
    ]
    rows = by_step(tmp_path, icd(procedure(*steps)), "ICD191")
    text = "`block.is_empty` is no flag"
    assert rows == {0: [("block.is_empty", text)], 4: [("block.is_empty", text)]}


def test_telemetry_has_the_name_of_the_step_that_requests_it(tmp_path):
    """`as` replaces the name of the message; `poll` and `get` name telemetry alike."""
    poll = "poll: State, as: other, until: {Busy: 0}, every_ms: 1, for_ms: 9"
    names = {"State.Sum": 0, "other.Sum": 1, "packet_.Number": 2, "Packet.Number": 3}
    steps = [f"send: Write, with: {{Offset: {name}}}" for name in names]
    text = icd(procedure("get: Packet, as: packet_", poll, *steps))
    rows = by_step(tmp_path, text, "ICD191")
    assert rows == {
        2: [("State.Sum", "there is no field `State.Sum`")],
        5: [("Packet.Number", "there is no field `Packet.Number`")],
    }
    text = icd(procedure("get: Packet", *steps[2:]))
    assert by_step(tmp_path, text, "ICD191") == {
        1: [("packet_.Number", "there is no field `packet_.Number`")]
    }


def test_what_steps_take_from_telemetry_is_telemetry(tmp_path):
    text = icd(
        procedure(
            "get: State, as: state",
            "collect: stat",
            "end_if_zeros: other",
            "block_length: state.Lenght",
            "verify: {field: stat.Sum, equals: state.Sun}",
            "verify: {checksum: sum, of: number, equals: nummer}",
            inputs="number: {type: uint}",
            outputs="number: number, sum: state.Sum",
        ),
        link="  link: {checksums: {some: {kind: sum, width: 8}}}\n",
    )
    fault, *faults = reported(tmp_path, text, "ICD191")
    assert fault == ("number", "there is no field `number`")
    assert faults == [
        ("stat", "there is no telemetry `stat`"),
        ("other", "there is no telemetry `other`"),
        ("state.Lenght", "there is no field `state.Lenght`"),
        ("stat.Sum", "there is no field `stat.Sum`"),
        ("state.Sun", "there is no field `state.Sun`"),
        ("sum", "there is no checksum `sum`"),
        ("number", "no input `number` has bytes"),
        ("nummer", "there is no number `nummer`"),
    ]
    helps = [f.help for f in findings_of(tmp_path, text, "ICD191")]
    assert "did you mean `state.Length`?" in helps
    assert "did you mean `number`?" in helps


def test_an_input_is_used_by_any_key_of_any_step(tmp_path):
    inputs = [f"{name}: {{type: {type}}}" for name, type in (
        ("image", "bytes, most: 9"), ("total", "uint"), ("flag", "bool"), ("other", "bool"),
        ("number", "uint"), ("sum", "uint"), ("covered", "bytes, most: 9"), ("idle", "uint"),
        ("spare", "uint"),
    )]  # fmt: skip
    text = icd(
        procedure(
            "blocks: {of: image, total: total, size: 4, rounds: 1, steps: [{send: Write, with: {Number: number}}]}",
            "repeat: [{send: Next, if: flag}]",
            "send: Next, unless: other",
            "verify: {checksum: crc, of: covered, equals: sum}",
            inputs=", ".join(inputs),
        ),
        link="  link: {checksums: {crc: {kind: sum, width: 8}}}\n",
    )
    assert reported(tmp_path, text, "ICD191") == [
        ("idle", "no step uses the input `idle`"),
        ("spare", "no step uses the input `spare`"),
    ]
