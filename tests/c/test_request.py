"""The example in C that requests telemetry over TCP repeats unanswered requests."""

from __future__ import annotations

import socket
import subprocess
import threading

import pytest
from icdgen_runtime.wire.uart import UartDecoder, uart_encode

from tests import links
from tests.c import harness
from tests.conformance import ROOT

EXAMPLE = ROOT / "examples" / "request.c"
FRAME = bytes.fromhex("1f1f0a00ff7f")  # full of escape bytes


@pytest.fixture(scope="module")
def program(tmp_path_factory):
    folder = tmp_path_factory.mktemp("request")
    headers = harness.generate(harness.shipped(), folder)
    flags = (
        "-std=c99",
        "-D_POSIX_C_SOURCE=200809L",
        *harness.WARNINGS,
        *harness.SANITIZERS,
    )
    return harness.compile(EXAMPLE, *flags, f"-I{headers}", output=folder / "request")


class Node(threading.Thread):
    """Node for one connection that ignores the first ``silent`` requests.

    It responds to every later request for telemetry.
    """

    def __init__(self, silent: int) -> None:
        super().__init__(daemon=True)
        self.silent, self.requests = silent, []
        self.server = socket.create_server(("127.0.0.1", 0))
        self.port = self.server.getsockname()[1]
        self.start()

    def run(self) -> None:
        link = links.link(harness.shipped(), "cubeacp")
        decoder = UartDecoder(link)
        connection, _ = self.server.accept()
        with connection:
            while data := connection.recv(4096):
                for event in decoder.feed(data):
                    self.requests.append(event.message)
                    if len(self.requests) > self.silent:
                        line = b"noise\x1f" + uart_encode(link, event.message + FRAME)
                        for byte in line:  # a byte at a time
                            connection.sendall(bytes((byte,)))


def run(program, port: int | str) -> subprocess.CompletedProcess:
    return subprocess.run(
        [program, str(port)], capture_output=True, text=True, timeout=60
    )


@pytest.mark.parametrize("silent", [0, 1])
def test_the_example_repeats_its_request_until_a_response_arrives(program, silent):
    node = Node(silent)
    done = run(program, node.port)
    assert (done.returncode, done.stdout, done.stderr) == (0, "roll 79.67 deg\n", "")
    assert node.requests == [bytes((146,))] * (silent + 1)


def test_the_example_fails_without_a_response(program):
    done = run(program, Node(99).port)
    assert (done.returncode, done.stdout, done.stderr) == (
        1,
        "",
        "no telemetry, attempts: 4\n",
    )


def test_the_example_reports_a_refused_connection(program):
    with socket.create_server(("127.0.0.1", 0)) as server:
        unused = server.getsockname()[1]
    done = run(program, unused)
    assert (done.returncode, done.stdout, done.stderr) == (
        1,
        "",
        "cannot connect: Connection refused\n",
    )
