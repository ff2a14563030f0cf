"""A device that requires checksums in both directions: sent messages have one, and
received messages without a correct one are reported.
"""

from __future__ import annotations

import socketserver
import subprocess
import sys
import threading

import pytest
from icdgen_runtime.wire.awaited import Request
from icdgen_runtime.wire.events import Done, LineError, Refused, Timeout
from icdgen_runtime.wire.i2c import i2c_write
from icdgen_runtime.wire.session import Session
from icdgen_runtime.wire.uart import UartDecoder, uart_encode

from icdgen.protocol import facts
from icdgen.runtime_objects.links import link_of
from icdgen.sim import run
from tests.conformance.icds import LINKS, icd_of

FILE = LINKS / "battery.yaml"
ICD = icd_of([FILE])
LINK = link_of(ICD, facts.of(ICD, ICD.node("battery")))
HEATER, VOLTAGES = 5, 130


class BoardPort:
    """The simulated board. ``spoil`` changes its responses, ``changed`` the received
    messages.
    """

    def __init__(self, spoil=lambda message: message, changed=lambda message: message):
        self.line, _ = run.build_device(ICD, "battery", run.Options())
        self.spoil, self.changed, self.now = spoil, changed, 0.0

    def write(self, data: bytes) -> None:
        for event in UartDecoder(LINK).feed(data):
            self.line.received(
                round(self.now * 1000), uart_encode(LINK, self.changed(event.message))
            )

    def read(self, seconds: float) -> bytes:
        data = self.line.take(round(self.now * 1000))
        self.now += 0 if data else seconds
        return b"".join(
            uart_encode(LINK, self.spoil(event.message))
            for event in UartDecoder(LINK).feed(data)
        )


def start_request(port: BoardPort, request: Request):
    heard = []
    session = Session(
        LINK, port.write, port.read, on_event=heard.append, clock=lambda: port.now
    )
    return session.start(request), heard


def test_both_directions_have_their_checksum_by_default():
    seen = []
    outcome, heard = start_request(
        BoardPort(changed=lambda message: seen.append(message) or message),
        Request("telecommand", HEATER, b"\1"),
    )
    assert outcome == Done(HEATER, 1, b"\0") and heard == []
    assert seen == [i2c_write(LINK, HEATER, b"\1", True)] and len(seen[0]) == 4
    outcome, heard = start_request(BoardPort(), Request("telemetry", VOLTAGES))
    assert isinstance(outcome, Done) and len(outcome.data) == 16 and heard == []


@pytest.mark.parametrize(
    ("spoil", "error"),
    [
        (lambda message: message[:-1] + bytes([message[-1] ^ 1]), "checksum"),
        (lambda message: message[:-2], "unchecked"),
    ],
)
def test_a_frame_with_a_wrong_or_missing_checksum_is_reported_and_discarded(
    spoil, error
):
    outcome, heard = start_request(
        BoardPort(spoil=spoil), Request("telemetry", VOLTAGES)
    )
    assert (
        isinstance(outcome, Timeout)
        and heard == [LineError(error, VOLTAGES)] * outcome.attempts
    )


@pytest.mark.parametrize(
    "changed",
    [
        lambda message: message[:-2],
        lambda message: message[:-1] + bytes([message[-1] ^ 1]),
    ],
)
def test_the_board_refuses_a_telecommand_without_its_checksum(changed):
    outcome, _ = start_request(
        BoardPort(changed=changed), Request("telecommand", HEATER, b"\1")
    )
    assert isinstance(outcome, Refused) and outcome.reason == "Checksum"


class Board(socketserver.BaseRequestHandler):
    """Answers every request with a frame that ends in ``end``."""

    end = b""

    def handle(self) -> None:
        decoder = UartDecoder(LINK)
        while data := self.request.recv(4096):
            for event in decoder.feed(data):
                self.request.sendall(
                    uart_encode(LINK, event.message[:1] + bytes(16) + self.end)
                )


@pytest.mark.parametrize(
    ("end", "expected"), [(b"", "no checksum"), (b"\0\0", "wrong checksum")]
)
def test_the_monitor_reports_the_wrong_checksum_and_no_time_out(end, expected):
    handler = type("Board", (Board,), {"end": end})
    with socketserver.ThreadingTCPServer(("127.0.0.1", 0), handler) as board:
        threading.Thread(target=board.serve_forever, daemon=True).start()
        place = f"tcp://127.0.0.1:{board.server_address[1]}"
        command = [
            sys.executable,
            "-m",
            "icdgen",
            "monitor",
            "Cell Voltages",
            "--once",
            "--timeout",
            "100",
        ]
        done = subprocess.run(
            [*command, "--icd", str(FILE), "--port", place],
            capture_output=True,
            text=True,
            timeout=60,
        )
        board.shutdown()
    assert (
        done.returncode == 1
        and expected in done.stdout
        and "no answer" not in done.stdout
    )
