"""Outcomes of telecommands on a link with ACK and NAK: `icdgen send`, `icdgen monitor`
and a session report them for a simulated reaction wheel.
"""

from __future__ import annotations

import json
import re
from random import Random

import pytest
from icdgen_runtime.wire.awaited import Request
from icdgen_runtime.wire.events import Busy, Done, Late, Refused, Sent, Stray, Timeout
from icdgen_runtime.wire.stream import stream_encode

from icdgen.commands.common import load_or_exit
from icdgen.errors import UserError
from icdgen.link.outcomes import failure_text
from icdgen.sim import run
from tests.conformance.icds import LINKS
from tests.conftest import ROOT
from tests.sim.device import simulator
from tests.sim.test_framed_line import ICD, MemoryPort, icdgen, talking

WHEEL = ROOT / "examples" / "links" / "wheel.yaml"
ACK, NAK, BUSY, EVENTS = 0x06, 0x15, 0x16, 0x83
SET_MODE, SET_SPEED, GET_EVENTS, SAVE, RESET = 0x01, 0x02, 0x04, 0x05, 0x7F
SPEED = bytes(3)
# The first acknowledge is lost with this seed, and the second is not.
LOSES_FIRST = next(
    seed for seed in range(100) if (r := Random(seed)).random() < 0.5 <= r.random()
)


def send(place: str, *words: str):
    return icdgen("send", "wheel", *words, "--port", place, folder=WHEEL)


@pytest.mark.parametrize(
    ("options", "words", "status", "text"),
    [
        ([], ["Set Mode", "mode=Speed"], 0, "Set Mode: acknowledged with Ack"),
        ([], ["Get Events"], 0, "Get Events: answered with Events"),
        ([], ["Reset"], 0, "Reset: sent; the ICD describes no response to it"),
        (
            ["--strict"],
            ["Set Mode", "mode=7", "--raw"],
            1,
            "Set Mode: refused: Out of range (code 3)",
        ),
        (
            ["--fault", "nak=100%:Wrong mode"],
            ["Save"],
            1,
            "Save: refused: Wrong mode (code 4)",
        ),
        (
            ["--fault", "foreign=100%"],
            ["Set Speed", "speed=100"],
            3,
            "Set Speed: no answer; whether it was executed is not known",
        ),
        (
            ["--fault", "silence=100%"],
            ["Set Mode", "mode=Speed"],
            3,
            "Set Mode: no answer after 3 attempts; whether it was executed is not known",
        ),
        (
            ["--fault", "late=100%:900@acknowledge"],
            ["Set Speed", "speed=100"],
            3,
            "Set Speed: no answer; whether it was executed is not known",
        ),
        (
            ["--fault", "busy=100%"],
            ["Set Mode", "mode=Speed"],
            4,
            "Set Mode: busy after 3 attempts",
        ),
        (
            ["--fault", "drop=50%@acknowledge", "--seed", str(LOSES_FIRST)],
            ["Set Mode", "mode=Speed"],
            0,
            "Set Mode: acknowledged with Ack",
        ),
    ],
)
def test_send_reports_the_outcome_and_its_exit_status(options, words, status, text):
    chosen = ("--tcp", "0", "--every", "0", *options, "--icd", str(WHEEL))
    with simulator(*chosen) as (place, _):
        sent = send(place, *words)
    output, other = (sent.stderr, sent.stdout) if status else (sent.stdout, sent.stderr)
    assert (sent.returncode, output.splitlines()[0]) == (status, text)
    assert not other or "foreign=100%" in options


def test_the_option_timeout_replaces_the_time_out_of_the_telecommand_itself():
    chosen = ("--tcp", "0", "--every", "0", "--fault", "late=1:800@acknowledge")
    with simulator(*chosen, "--icd", str(WHEEL)) as (place, _):
        assert send(place, "Save").returncode == 0  # `timeout_ms: 3000`
        assert send(place, "Save", "--timeout", "200").returncode == 3


@pytest.mark.pty
def test_the_acknowledge_of_another_telecommand_is_counted_and_confirms_nothing():
    chosen = ("--pty", "--every", "0", "--fault", "foreign=100%", "--icd", str(WHEEL))
    with simulator(*chosen) as (place, _):
        sent = send(place, "Set Mode", "mode=Speed")
    assert sent.returncode == 3
    assert "on the line: responses without a request (3)" in sent.stderr


@pytest.mark.parametrize(
    ("options", "words", "report"),
    [
        (
            ["--strict"],
            ["Set Mode", "mode=7", "--raw"],
            {"event": "refused", "reason": "Out of range", "code": 3, "attempts": 1},
        ),
        (
            ["--fault", "drop=50%@acknowledge", "--seed", str(LOSES_FIRST)],
            ["Set Mode", "mode=Speed"],
            {"event": "done", "attempts": 2},
        ),
        (
            ["--fault", "busy=100%"],
            ["Set Mode", "mode=Speed"],
            {"event": "busy", "attempts": 3},
        ),
        (
            ["--fault", "silence=100%"],
            ["Set Mode", "mode=Speed"],
            {"event": "timeout", "attempts": 3},
        ),
    ],
)
def test_send_reports_the_outcome_as_json(options, words, report):
    chosen = ("--tcp", "0", "--every", "0", *options, "--icd", str(WHEEL))
    with simulator(*chosen) as (place, _):
        sent = json.loads(send(place, *words, "--format", "json").stdout)
    response = sent.pop("response", None)
    assert sent == {"message": "Set Mode", **report}
    names = {"refused": "Nak", "done": "Ack"}
    assert (response and response["message"]) == names.get(report["event"])


def test_a_response_with_further_fields_is_shown(tmp_path):
    text = WHEEL.read_text().replace(
        "{at: 8, bits: 8, name: Reason, type: enum, enum: Nak Reason}",
        "{at: 8, bits: 8, name: Reason, type: enum, enum: Nak Reason}\n"
        "      - {at: 16, bits: 8, name: Position, type: uint}",
    )
    text = text.replace(
        "    length: 2\n    fields:\n      - {at: 0, bits: 8, name: C",
        "    length: 3\n    fields:\n      - {at: 0, bits: 8, name: C",
    )
    file = tmp_path / "wheel.yaml"
    file.write_text(text)
    chosen = ("--set", "Nak", "Position=9", "--strict", "--every", "0", "--tcp", "0")
    with simulator(*chosen, "--icd", str(file)) as (place, _):
        words = ("Set Mode", "mode=7", "--raw", "--port", place)
        sent = icdgen("send", "wheel", *words, folder=file)
    assert sent.returncode == 1
    assert "Position" in sent.stderr and " 9" in sent.stderr


@pytest.mark.parametrize(
    ("outcome", "text"),
    [
        (Busy(SAVE, 3, 0, "Nothing"), "busy"),
        (Busy(SAVE, 3, 0), "busy"),
        (Busy(SAVE, 3, 4, "Wrong mode"), "busy: Wrong mode (code 4)"),
        (Refused(SAVE, 1, 0, "Nothing"), "refused: Nothing (code 0)"),
    ],
)
def test_a_busy_device_without_a_reason_is_only_busy(outcome, text):
    assert failure_text(outcome) == text


def test_each_value_of_a_range_of_reasons_has_its_name(tmp_path):
    last = "{value: 5, name: Bad CRC}"
    text = WHEEL.read_text().replace(
        last, f"{last}\n      - {{value: 16, to: 31, name: Device specific}}"
    )
    file = tmp_path / "wheel.yaml"
    file.write_text(text)
    for reason, code in (("Device specific", 16), ("31", 31)):
        chosen = ("--tcp", "0", "--every", "0", "--fault", f"nak=1:{reason}")
        with simulator(*chosen, "--icd", str(file)) as (place, _):
            sent = icdgen("send", "wheel", "Save", "--port", place, folder=file)
        assert sent.stderr.strip() == f"Save: refused: Device specific (code {code})"


def test_monitor_shows_why_a_request_was_refused():
    for fault, text in (
        ("nak=100%:Wrong mode", "refused: Wrong mode (code 4)"),
        ("busy=100%", "busy"),
    ):
        chosen = ("--tcp", "0", "--every", "0.1", "--fault", fault, "--icd", str(WHEEL))
        with simulator(*chosen) as (place, _):
            words = ("Events", "Status", "--port", place, "--once", "--every", "0.5")
            shown = icdgen("monitor", "wheel", *words, folder=WHEEL)
        assert shown.returncode == 1, shown.stderr
        row = next(row for row in shown.stdout.splitlines() if row.startswith("Events"))
        assert text in row and "nothing came" not in shown.stdout


def only_requested(folder):
    """Return the ICD of a wheel that sends no telemetry without a request."""
    text = WHEEL.read_text()
    begin, end = text.index("  - name: Status\n"), text.index("  - name: Events\n")
    file = folder / "wheel.yaml"
    file.write_text(text[:begin] + text[end:])
    return file


def test_monitor_says_at_once_which_telemetry_must_be_requested(tmp_path):
    file = only_requested(tmp_path)
    with simulator("--tcp", "0", "--icd", str(file)) as (place, _):
        words = ("--port", place, "--once", "--every", "0.2")
        shown = icdgen("monitor", "wheel", *words, folder=file)
        result = icdgen("monitor", "wheel", "Events", *words, folder=file)
    assert (shown.returncode, shown.stdout) == (1, "nothing came\n")
    assert shown.stderr == (
        "icdgen: wheel sends telemetry only in response to telecommands; name messages "
        "to request them, such as `icdgen monitor wheel Events`; they can be: Events\n"
    )
    assert (result.returncode, result.stderr) == (0, "")


@pytest.mark.parametrize(
    ("fault", "event", "message", "response"),
    [
        ("nak=1:Wrong mode", "refused", "Events", "Nak"),
        ("busy=1", "busy", "Events", None),
        ("late=1:250@reply", "late", "Events", "Events"),
        ("late=1:450@acknowledge", "stray", "Ack", "Ack"),
    ],
)
def test_monitor_prints_responses_that_are_no_telemetry_as_json(
    tmp_path, fault, event, message, response
):
    file = only_requested(tmp_path)
    text = file.read_text()
    if event == "stray":  # later than `late_ms` after the time-out
        file.write_text(text.replace("{ack: none, reply", "{reply"))
    elif event == "late":
        file.write_text(text.replace("late_ms: 200", "late_ms: 5000"))
    chosen = ("--tcp", "0", "--every", "0", "--fault", fault, "--icd", str(file))
    with simulator(*chosen) as (place, _):
        words = ("--once", "--every", "1", "--timeout", "100", "--retries", "0")
        shown = icdgen(
            *("monitor", "wheel", "Events", "--port", place, "--format", "json"),
            *words,
            folder=file,
        )
    events = [json.loads(line) for line in shown.stdout.splitlines()]
    (report,) = (each for each in events if each.get("event") == event)
    assert report["message"] == message and report["time"].endswith("Z")
    assert report.get("response", {}).get("message") == response
    if event == "refused":
        assert (report["reason"], report["code"]) == ("Wrong mode", 4)


def test_the_acknowledge_of_a_telecommand_that_has_ended_does_not_confirm_the_next():
    session, port, heard = talking("wheel", every=0, faults=["late=1:250@acknowledge"])
    assert session.start(Request("telecommand", SET_SPEED, SPEED)) == Timeout(
        SET_SPEED, 1
    )
    port.line.faults.faults = [port.line.fault("silence=1")]
    # The same telecommand waits until its late response can no longer arrive.
    assert session.start(Request("telecommand", SET_SPEED, SPEED)) == Timeout(
        SET_SPEED, 1
    )
    assert heard == [Late(ACK, bytes([SET_SPEED]), heard[0].type)]


def outcome(id: int, data: bytes = b"", *faults: str, **options):
    session, _, heard = talking("wheel", every=0, faults=faults, **options)
    return session.start(Request("telecommand", id, data)), heard


def test_each_fault_of_a_response_leads_to_its_outcome():
    refused, _ = outcome(SET_SPEED, SPEED, "nak=1")
    assert isinstance(refused, Refused) and refused.reason == "Out of range"
    refused, _ = outcome(SET_SPEED, SPEED, "nak=1:4")
    assert isinstance(refused, Refused) and refused.reason == "Wrong mode"
    assert isinstance(outcome(SET_SPEED, SPEED, "busy=1")[0], Busy)
    assert isinstance(outcome(GET_EVENTS, b"", "silence=1")[0], Timeout)
    assert isinstance(outcome(SAVE, b"", "late=1:2900@acknowledge")[0], Done)
    assert isinstance(outcome(SAVE, b"", "late=1:3100@acknowledge")[0], Timeout)
    assert isinstance(outcome(RESET, b"", "nak=1")[0], Sent)
    ended, heard = outcome(SET_SPEED, SPEED, "foreign=1")
    assert isinstance(ended, Timeout)
    assert [(type(event), event.id, event.data) for event in heard] == [
        (Stray, ACK, bytes([SET_MODE]))
    ]


@pytest.mark.parametrize(("fault", "refusal"), [("nak=1", Refused), ("busy=1", Busy)])
def test_faults_of_acknowledges_hit_refusals_too(fault, refusal):
    """A fault of replies does not; only the reply to a request is one."""
    assert isinstance(outcome(SAVE, b"", fault, "drop=1@reply")[0], refusal)
    assert isinstance(outcome(SAVE, b"", fault, "drop=1@acknowledge")[0], Timeout)
    assert isinstance(outcome(SAVE, b"", "drop=1@acknowledge")[0], Timeout)


def test_a_device_that_executes_a_telecommand_defers_the_next():
    port = MemoryPort("wheel", every=0, processing=300)
    link = port.line.computer.program.link
    for id, data in ((SET_MODE, b"\1"), (SET_SPEED, SPEED)):
        port.write(stream_encode(link, id, data))
    busy = stream_encode(link, BUSY, bytes([SET_SPEED]), "telemetry")
    assert port.line.pieces(0) == [busy]
    acknowledged = stream_encode(link, ACK, bytes([SET_MODE]), "telemetry")
    assert port.line.pieces(300) == [acknowledged]


def frame(id: int, data: bytes) -> bytes:
    """Return a telecommand that the encoder refuses to encode."""
    inner = bytes([len(data), id]) + data
    crc = 0xFFFF
    for byte in inner:
        crc ^= byte << 8
        for _ in range(8):
            crc = (crc << 1 ^ (0x1021 if crc & 0x8000 else 0)) & 0xFFFF
    return b"\xa5\x5a" + inner + crc.to_bytes(2, "big")


@pytest.mark.parametrize(
    ("received", "refusal"),
    [
        (frame(0x33, b"\1"), (0x33, 1)),  # Unknown command
        (frame(SET_MODE, b"\1\2"), (SET_MODE, 2)),  # Bad length
        (frame(SET_MODE, b"\7"), (SET_MODE, 3)),  # Out of range
        (frame(SET_SPEED, (6_000_001).to_bytes(3, "big")), (SET_SPEED, 3)),
        (frame(SET_MODE, b"\1")[:-1] + b"\0", (SET_MODE, 5)),  # Bad CRC
    ],
)
def test_a_telecommand_is_refused_with_the_reason_of_the_icd(received, refusal):
    port = MemoryPort("wheel", every=0, strict=True)
    port.write(received)
    link = port.line.computer.program.link
    expected = stream_encode(link, NAK, bytes(refusal), "telemetry")
    assert port.line.pieces(0) == [expected]


def test_without_a_reason_for_it_a_wrong_checksum_has_no_response(tmp_path):
    icd = WHEEL.read_text().replace(", checksum: Bad CRC", "")
    (tmp_path / "wheel.yaml").write_text(icd)
    line, _ = run.build_device(
        load_or_exit((tmp_path / "wheel.yaml",)).icd, None, run.Options(every=0)
    )
    line.received(0, frame(SET_MODE, b"\1")[:-1] + b"\0")
    assert line.pieces(0) == []


def test_responses_are_not_sent_periodically():
    port = MemoryPort("wheel", every=0.1)
    assert [message.name for message in port.line.unsolicited] == ["Status"]


@pytest.mark.parametrize(
    ("node", "fault", "text"),
    [
        ("wheel", "nak=1:Overheated", "`Overheated` is no reason of a refusal"),
        ("wheel", "nak=1:300", "`300` is no reason of a refusal"),
        ("wheel", "busy=1:3", "`busy` has no detail `3`"),
        ("wheel", "late=1:soon", "`soon` is no number of milliseconds"),
        ("receiver", "nak=1", "the ICD describes no response that refuses"),
        ("receiver", "busy=1", "the ICD describes no response of a busy device"),
    ],
)
def test_a_fault_that_the_link_cannot_have_is_an_error(node, fault, text):
    with pytest.raises(UserError) as error:
        run.build_device(ICD, node, run.Options(faults=[fault]))
    assert text in str(error.value) and error.value.help


STATUS_OF_ONE_BIT = """\
icdgen: 1
node: {name: valve, title: Valve, byte_order: big, bit_order: msb0}
protocol:
  link:
    framing: {by: slip}
    header: [{at: 0, bits: 8, role: id}]
    commands:
      ack: {message: Result, status: Has Time, success: [1], busy: [0]}
messages:
  - {name: Result, id: 128, kind: telemetry, length: 1, fields: [{at: 7, bits: 1, name: Has Time, type: uint}]}
  - {name: Open, id: 1, kind: telecommand, length: 0}
"""


@pytest.mark.parametrize(
    ("sets", "fault", "lacks"),
    [
        (", busy: [0]", "nak=1", "needs `nak` in `link: commands`, or values of a"),
        ("", "busy=1", "needs `busy` in `link: commands`, in the values of a"),
    ],
)
def test_a_fault_that_no_response_can_express_names_what_the_icd_lacks(
    tmp_path, sets, fault, lacks
):
    file = tmp_path / "valve.yaml"
    file.write_text(STATUS_OF_ONE_BIT.replace(", busy: [0]", sets))
    icd = load_or_exit((file,)).icd
    with pytest.raises(UserError, match="describes no response") as error:
        run.build_device(icd, None, run.Options(faults=[fault]))
    assert lacks in str(error.value)


def test_a_device_without_acknowledges_cannot_refuse(tmp_path):
    text = (LINKS / "battery.yaml").read_text()
    file = tmp_path / "battery.yaml"
    text = re.sub(r"\n        commands:\n(          .*\n)*", "\n", text)
    text = re.sub(r"\n    commands:\n(      .*\n)*", "\n", text)
    file.write_text(re.sub(r"\n      acknowledge: .*\n", "\n", text))
    with pytest.raises(UserError, match="it needs an `ack` of the UART"):
        run.build_device(load_or_exit((file,)).icd, None, run.Options(faults=["nak=1"]))


def test_a_reason_that_some_refusals_cannot_have_is_a_warning(tmp_path):
    file = tmp_path / "wheel.yaml"
    file.write_text(
        WHEEL.read_text().replace(
            "response: {timeout_ms: 3000}",
            "response: {nak: {message: Busy}, busy: none}",
        )
    )
    chosen = ("--tcp", "0", "--every", "0", "--icd", str(file))
    with simulator(*chosen, "--fault", "nak=1:Wrong mode", "--orders") as (
        place,
        child,
    ):
        sent = icdgen("send", "wheel", "Save", "--port", place, folder=file)
        output, warnings = child.communicate("fault nak=50%:4\n", timeout=20)
    assert (sent.returncode, sent.stderr.splitlines()[0]) == (1, "Save: refused")
    assert output == "ok\n"
    assert warnings.splitlines() == [
        f"icdgen: `{fault}`: refusals of `Save` do not have this reason, as their "
        "response has no field for it"
        for fault in ("nak=1:Wrong mode", "nak=50%:4")
    ]


def test_a_telecommand_that_nothing_can_refuse_is_executed():
    port = MemoryPort("wheel", every=0, faults=["nak=1"])
    link = port.line.computer.program.link
    port.write(stream_encode(link, RESET, b""))
    assert port.line.computer.program.counts["telecommands"] == 1
    assert "refused" not in port.line.computer.program.counts
