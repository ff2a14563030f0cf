"""A simulator in a process of its own, as any client meets it."""

from __future__ import annotations

import signal
import subprocess
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import replace

from icdgen.link.ports import open_port
from icdgen.protocol import transfer
from icdgen.protocol.sections import Settings
from tests.conformance.icds import icd_of
from tests.sim.reference import Session

FAST = Settings(reply_timeout=150, retries=4, poll_interval=5, poll_timeout=2000)
ICD = icd_of()


def _interruptible() -> None:
    """A shell starts what runs in the background without an interrupt, and children
    inherit that.
    """
    signal.signal(signal.SIGINT, signal.SIG_DFL)


@contextmanager
def simulator(*options: str) -> Iterator[tuple[str, subprocess.Popen]]:
    """Where it listens, and the process."""
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


@contextmanager
def session(
    *options: str, node: str = "cubeacp", settings: Settings = FAST, **more
) -> Iterator[Session]:
    """A client that is connected to a simulator of its own."""
    ways = () if {"--tcp", "--udp", "--pty"} & set(options) else ("--tcp", "0")
    with (
        simulator("--node", node, *ways, *options) as (place, _),
        Session(
            ICD, ICD.node(node), open_port(place, {}), settings=settings, **more
        ) as connected,
    ):
        connected.known = hasty(connected.known)
        yield connected


def hasty(known):
    """The facts with short waits, for a device that is never slow."""
    procedures = {
        name: replace(one, poll_interval=5)
        for name, one in known.files.procedures.items()
    }
    if "download" in procedures:
        procedures["download"] = replace(procedures["download"], silence=60)
    operations = {
        name: form and replace(form, poll_interval=5)
        for name, form in (
            ("program_copy", known.program_copy),
            ("program_information", known.program_information),
        )
    }
    return replace(known, files=replace(known.files, **procedures), **operations)


def download(
    client: Session, type_: int, counter: int, size: int | None
) -> tuple[str, bytes]:
    """The result, and what came."""
    procedure = transfer.Download(client.known, "uart", type_, counter, size)
    result = client.run(procedure)
    return result, b"".join(data for _, data in procedure.blocks)
