"""Rules about the limits of procedures, and the sizes of blocks, packets and fields."""

from __future__ import annotations

import pytest

from tests.icd.rules.marked import findings_of, marked_text, reported
from tests.icd.rules.steps import by_step, icd, procedure
from tests.limits import assert_limits


def test_a_procedure_that_receives_or_collects_has_a_limit_for_it(tmp_path):
    blocks = "blocks: {size: 4, rounds: 1, steps: [{send: Next}]}"
    collects = (
        "repeat: [{get: State, as: state}, {collect: state}, {end_if_zeros: state}]"
    )
    for step, key, what, other in (
        (blocks, "bytes", "receives bytes", "collects entries"),
        (collects, "entries", "collects entries", "receives bytes"),
    ):
        without = icd(procedure(step))
        message = f"the procedure {what}, and a device could send them for ever"
        assert reported(tmp_path, without, "ICD192") == [("time_s", message)]
        assert findings_of(tmp_path, without, "ICD192")[0].help == f"add `{key}`"
        with_limit = icd(procedure(step, limits=f", {key}: 1"))
        assert reported(tmp_path, with_limit, "ICD192") == []
        (unused,) = {"bytes", "entries"} - {key}
        text = icd(procedure(step, limits=f", {key}: 1, {unused}: 1"))
        message = f"`{unused}` limits nothing: no step {other}"
        assert reported(tmp_path, text, "ICD192") == [(unused, message)]
    sends = icd(
        procedure(
            blocks.replace("size", "of: image, size"),
            inputs="image: {type: bytes, most: 4}",
        )
    )
    assert reported(tmp_path, sends, "ICD192") == []


def test_each_further_transfer_is_reported(tmp_path):
    step = "blocks: {size: 4, rounds: 1, steps: [{send: Next}]}"
    text = icd(procedure("send: Next", step, step, step, limits=", bytes: 9"))
    message = "a procedure transfers bytes once, and this is the second `blocks`"
    expected = {number: [("blocks", message)] for number in (2, 3)}
    assert by_step(tmp_path, text, "ICD192") == expected


def test_bytes_that_are_sent_have_a_limit(tmp_path):
    """Only the number of bytes to receive can be left out."""
    transfer = "blocks: {of: image, size: 4, rounds: 1, steps: [{send: Next}]}"
    for keys, expected in (
        ("type: bytes, most: 9", []),
        ("type: bytes", [("type", "nothing says how many bytes the input can have")]),
        (
            "type: bytes, most: 9, optional: true",
            [("optional", "`image` has no value if it is left out")],
        ),
    ):
        text = icd(procedure(transfer, inputs=f"image: {{{keys}}}"))
        assert reported(tmp_path, text, "ICD192") == expected
    receives = "blocks: {total: size, size: 4, rounds: 1, steps: [{send: Next}]}"
    inputs = "size: {type: uint, optional: true}, flag: {type: bool, optional: true}"
    text = icd(procedure(receives, inputs=inputs, limits=", bytes: 9"))
    message = "`flag` has no value if it is left out"
    assert reported(tmp_path, text, "ICD192") == [("optional", message)]


def test_the_number_of_bytes_to_receive_is_a_number(tmp_path):
    for type, is_number in (
        ("type: uint", True),
        ("type: uint, optional: true", True),
        ("type: bool", False),
        ("type: bytes, most: 4", False),
        ("enum: Area", False),
    ):
        text = icd(
            procedure(
                "blocks: {total: size, size: 4, rounds: 1, steps: [{send: Next}]}",
                inputs=f"size: {{{type}}}",
                limits=", bytes: 9",
            )
        )
        expected = [("size", "no input `size` is a number")] * (not is_number)
        assert reported(tmp_path, text, "ICD192") == expected


@pytest.mark.parametrize("has_each", [False, True])
@pytest.mark.parametrize("steps", ["", "receive", "send", "get", "receive get"])
def test_the_side_that_receives_packets_sends_the_map_of_them(
    has_each, steps, tmp_path
):
    rows = {
        "receive": "{receive: Packet, number: Number, data: Data, silence_ms: 1}",
        "send": "{map: send, messages: [Map], field: Bits}",
        "get": "{map: get, messages: [Map], field: Bits}",
    }
    keys = ["packet: 4"]
    keys += ["each: [{send: Next}]"] * has_each
    listed = ", ".join(rows[step] for step in steps.split())
    keys += [f"steps: [{listed}]"] * bool(steps)
    step = (
        f"blocks: {{size: 4, rounds: 1, steps: [{{missing: {{{', '.join(keys)}}}}}]}}"
    )
    text = icd(procedure(step, limits=", bytes: 9"))
    expected = []
    if not has_each and "receive" not in steps:
        expected.append(("missing", "nothing in `missing` transfers packets"))
    if has_each and steps and "get" not in steps:
        expected.append(
            ("steps", "no step tells which packets are still missing after a round")
        )
    if has_each and "send" in steps:
        message = "the packets are sent, and the device knows which have arrived"
        expected.append(("send", message))
    if not has_each and "get" in steps:
        message = (
            "the packets are received, and the device does not know which have arrived"
        )
        expected.append(("get", message))
    assert reported(tmp_path, text, "ICD192") == expected


def test_a_repetition_asks_the_device_and_ends(tmp_path):
    poll = "poll: State, until: {Busy: 0}, every_ms: 1, for_ms: 9"
    text = icd(
        procedure(
            "get: State",
            "repeat: [{get: State, as: state}, {end_if_zeros: state}]",
            f"repeat: [{{{poll}, as: state}}, {{end_if_zeros: state}}]",
            "repeat: [{send: Next}, {end_if_zeros: state}]",
            "repeat: [{get: State}]",
        )
    )
    assert by_step(tmp_path, text, "ICD192") == {
        3: [("repeat", "the repetition asks the device nothing")],
        4: [("repeat", "no step ends the repetition")],
    }


@pytest.mark.parametrize(
    ("inputs", "stored", "tested"), [(0, 0, 0), (7, 0, 0), (3, 4, 2), (0, 8, 3)]
)
def test_a_procedure_keeps_up_to_24_numbers(inputs, stored, tested, tmp_path):
    """Five of blocks and packets, which count without blocks too, inputs, fields of
    telemetry that steps use, and values that end a poll. Each counts once.
    """
    flags = "".join(
        f"      - {{at: {n}, bits: 1, name: F{n}, type: bool}}\n" for n in range(24)
    )
    message = "  - name: Flags\n    id: 150\n    kind: telemetry\n    length: 3\n"

    def text(numbers: int) -> str:
        own = names[: numbers - 5 - stored - tested]
        steps = ["get: Flags", *(f"send: Next, if: {name}" for name in own)]
        for n in range(stored):
            steps += [f"send: Next, unless: Flags.F{n}"] * 2
        ends = ", ".join(f"F{n}: 1" for n in range(tested))
        if ends:
            until, _, fail = ends.partition(", ")
            rest = f", fail: {{{fail}}}" if fail else ""
            steps.append(
                f"poll: Flags, until: {{{until}}}{rest}, every_ms: 1, for_ms: 9"
            )
        declared = ", ".join(f"{name}: {{type: bool}}" for name in own)
        return (
            icd(procedure(*steps, inputs=declared)) + f"{message}    fields:\n{flags}"
        )

    names = [f"i{n}" for n in range(24)]
    assert_limits(
        lambda numbers: not reported(tmp_path, text(numbers), "ICD193"), most=24
    )
    (finding,) = findings_of(tmp_path, text(25), "ICD193")
    assert finding.message == "the procedure keeps 25 numbers, at most 24 are possible"
    assert (marked_text(text(25), finding), finding.help) == (
        "steps",
        "write two procedures",
    )


def transfer(
    size: int, packet: int, steps: str, *, each: str = "", first: int | None = None
) -> str:
    """Return a step that transfers blocks in packets."""
    keys = [f"packet: {packet}"]
    keys += [f"first: {first}"] * (first is not None)
    keys += [f"each: [{{{each}}}]"] * bool(each)
    keys += [f"steps: [{{{steps}}}]"] * bool(steps)
    inner = f"{{missing: {{{', '.join(keys)}}}}}"
    return f"blocks: {{size: {size}, rounds: 1, steps: [{inner}]}}"


@pytest.mark.parametrize(("messages", "packets"), [("Map", 8), ("Map, More", 16)])
@pytest.mark.parametrize("packet", [1, 3, 4])
def test_a_map_has_a_bit_for_each_packet_of_a_block(
    messages, packets, packet, tmp_path
):
    def text(size: int) -> str:
        rows = f"map: get, messages: [{messages}], field: Bits"
        step = transfer(size, packet, rows, each="send: Next")
        return icd(procedure(step, limits=", bytes: 9"))

    assert_limits(
        lambda size: not reported(tmp_path, text(size), "ICD193"), most=packets * packet
    )
    message = f"the map has {packets} bits, and a block {packets + 1} packets"
    assert reported(tmp_path, text(packets * packet + 1), "ICD193") == [
        ("messages", message)
    ]


@pytest.mark.parametrize("first", [None, 0, 200])
@pytest.mark.parametrize("packet", [1, 4, 5])
def test_the_number_of_the_last_packet_fits_its_field(first, packet, tmp_path):
    def text(size: int) -> str:
        rows = "receive: Packet, number: Number, data: Data, silence_ms: 1"
        return icd(
            procedure(transfer(size, packet, rows, first=first), limits=", bytes: 9")
        )

    most = packet * (256 - (first or 0))
    fault = (
        "Number",
        "`Number` holds 0 to 255, and the last packet of a block is 256",
    )
    size = ("Data", f"`Data` holds 4 bytes, and a packet has {packet}")
    expected = [size] * (packet != 4)
    for length in (1, most - 1, most):
        assert reported(tmp_path, text(length), "ICD193") == expected
    assert reported(tmp_path, text(most + 1), "ICD193") == [fault, *expected]


@pytest.mark.parametrize("is_sent", [False, True])
def test_numbers_of_a_block_fit_the_fields_that_get_them(is_sent, tmp_path):
    """The last byte of all has the largest offset; a block is as long as its size."""

    def messages(size: int, total: int) -> list[tuple[str, str]]:
        source = "of: image, " if is_sent else ""
        inner = "send: Write, with: {Number: block.length, Area: block.offset, Offset: block.offset}"
        text = icd(
            procedure(
                f"blocks: {{{source}size: {size}, rounds: 1, steps: [{{{inner}}}]}}",
                inputs=f"image: {{type: bytes, most: {total}}}" if is_sent else "",
                limits="" if is_sent else f", bytes: {total}",
            )
        )
        return reported(tmp_path, text, "ICD193")

    length = "`Number` holds 0 to 255, and `block.length` can be {}"
    offset = "`{}` holds 0 to {}, and `block.offset` can be {}"
    assert messages(255, 256) == []
    assert messages(256, 256) == [("block.length", length.format(256))]
    assert messages(1, 257) == [("block.offset", offset.format("Area", 255, 256))]
    assert messages(300, 65537) == [
        ("block.length", length.format(300)),
        ("block.offset", offset.format("Area", 255, 65536)),
        ("block.offset", offset.format("Offset", 65535, 65536)),
    ]


@pytest.mark.parametrize("first", [None, 0, 1, 200])
def test_numbers_of_a_packet_fit_the_fields_that_get_them(first, tmp_path):
    def messages(size: int, total: int) -> list[tuple[str, str]]:
        each = "send: Write, with: {Number: packet.number, Offset: packet.offset, Data: packet.data}"
        step = transfer(size, 4, "", each=each, first=first).replace(
            "size:", "of: image, size:"
        )
        text = icd(procedure(step, inputs=f"image: {{type: bytes, most: {total}}}"))
        return reported(tmp_path, text, "ICD193")

    most = 4 * (256 - (first or 0))
    number = "`Number` holds 0 to 255, and `packet.number` can be 256"
    offset = "`Offset` holds 0 to 65535, and `packet.offset` can be 65536"
    assert messages(most, 65536) == []
    assert messages(most + 1, 65536) == [("packet.number", number)]
    assert messages(most, 65537) == [("packet.offset", offset)]
