"""A proxy between a client and the simulator that records what the client sends."""

from __future__ import annotations

import socket
import threading
from types import TracebackType

from icdgen_runtime.wire.uart import UartDecoder

from icdgen.icd.model import Icd
from icdgen.protocol import facts
from tests import links


class Tap:
    """Accepts one connection on `port` and forwards everything in both directions."""

    def __init__(self, host: str, port: int) -> None:
        self.target = (host, port)
        self.sent = bytearray()
        self.ends: list[socket.socket] = []
        self.server = socket.create_server(("127.0.0.1", 0))
        self.port = self.server.getsockname()[1]
        threading.Thread(target=self._serve, daemon=True).start()

    def __enter__(self) -> Tap:
        return self

    def __exit__(
        self, *_: type[BaseException] | BaseException | TracebackType | None
    ) -> None:
        for end in (self.server, *self.ends):
            end.close()

    def messages(self, icd: Icd, node: str) -> list[bytes]:
        """Return the messages that the client sent, id first."""
        node_facts = facts.of(icd, icd.node(node))
        decoder = UartDecoder(links.link(icd, node), node_facts.longest_telecommand)
        events = decoder.feed(bytes(self.sent))
        return [event.message for event in events if event.event == "message"]

    def _serve(self) -> None:
        try:
            client, _ = self.server.accept()
        except OSError:  # no client connected
            return
        device = socket.create_connection(self.target)
        self.ends = [client, device]
        for end in self.ends:
            end.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
        threading.Thread(
            target=_pass, args=(device, client, bytearray()), daemon=True
        ).start()
        _pass(client, device, self.sent)


def _pass(source: socket.socket, target: socket.socket, sent: bytearray) -> None:
    try:
        while data := source.recv(65536):
            sent += data
            target.sendall(data)
        target.shutdown(socket.SHUT_WR)
    except OSError:  # one side has closed the connection
        return


def missing(icd: Icd, node: str, messages: list[bytes]) -> list[str]:
    """Return the names of messages that were never requested or sent, or only after a
    reset.
    """
    node_facts = facts.of(icd, icd.node(node))
    ids = [message[0] for message in messages]
    resets = {
        id for id, message in node_facts.telecommands.items() if message.expects_reset
    }
    first = next((at for at, id in enumerate(ids) if id in resets), len(ids))
    before = {*ids[:first], *resets.intersection(ids)}
    return [
        m.name
        for id, m in (node_facts.telemetry | node_facts.telecommands).items()
        if id not in before
    ]
