"""A simulator in a process of its own, as a client uses it."""

from __future__ import annotations

import signal
import subprocess
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

from icdgen_runtime.wire.awaited import Request
from icdgen_runtime.wire.events import Done, Outcome
from icdgen_runtime.wire.identity import Identity, identify
from icdgen_runtime.wire.link import Settings
from icdgen_runtime.wire.session import Session

from icdgen.icd.model import Message
from icdgen.link.ports import Port, open_port
from icdgen.protocol import facts
from icdgen.runtime_objects.links import link_of
from tests.conformance.icds import icd_of

FAST = Settings(reply_timeout=150, retries=4, poll_interval=5, poll_timeout=2000)
ICD = icd_of()


def _interruptible() -> None:
    """Enable interrupts, because a shell starts background processes with interrupts
    ignored and children inherit this.
    """
    signal.signal(signal.SIGINT, signal.SIG_DFL)


@contextmanager
def simulator(*options: str) -> Iterator[tuple[str, subprocess.Popen]]:
    """Start a simulator; yield its address and the process."""
    command = [sys.executable, "-m", "icdgen", "sim", *options]
    process = subprocess.Popen(
        command,
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        preexec_fn=_interruptible,
    )
    try:
        place = process.stdout.readline().strip()
        assert place, process.stderr.read()
        yield place, process
    finally:
        process.kill()
        process.communicate(timeout=10)


class NodeSession(Session):
    """A session with a node, for messages of the model and any bytes."""

    def __init__(self, node: str, port: Port, **options: Any) -> None:
        self.node, self.port = ICD.node(node), port
        self.node_facts = facts.of(ICD, self.node)
        self.link = hasty(link_of(ICD, self.node_facts))
        super().__init__(self.link, port.write, port.read, **options)

    def telemetry(self, message: Message) -> bytes | None:
        """Return the frame, or ``None`` without a response."""
        outcome = self.start(Request("telemetry", message.telemetry_id))
        return outcome.data if isinstance(outcome, Done) else None

    def telecommand(
        self, message: Message, data: bytes, repeat: bool = False
    ) -> Outcome:
        return self.start(Request("telecommand", message.telecommand_id, data, repeat))

    def identify(self) -> Identity | None:
        """Return the identification of the node, or ``None`` without a response."""
        frame = self.telemetry(self.node_facts.identification.message)
        return None if frame is None else identify(self.link, frame)


@contextmanager
def connected(
    node: str, place: str, settings: Settings = FAST, **more: Any
) -> Iterator[NodeSession]:
    """Yield a client that is connected to a simulator."""
    port = open_port(place, {})
    try:
        yield NodeSession(node, port, settings=settings, **more)
    finally:
        port.close()


@contextmanager
def session(*options: str, node: str = "cubeacp", **more: Any) -> Iterator[NodeSession]:
    """Yield a client that is connected to its own simulator."""
    ways = () if {"--tcp", "--udp", "--pty"} & set(options) else ("--tcp", "0")
    with (
        simulator("--node", node, *ways, *options) as (place, _),
        connected(node, place, **more) as client,
    ):
        yield client


def hasty(link: Any) -> Any:
    """Return the link with short time-outs, for a device that is never slow."""
    return link._replace(
        procedures={
            name: form._replace(steps=tuple(map(_hasty_step, form.steps)))
            for name, form in link.procedures.items()
        }
    )


def _hasty_step(step: Any) -> Any:
    if hasattr(step, "interval"):
        return step._replace(interval=5)
    return step._replace(silence=60) if hasattr(step, "silence") else step
