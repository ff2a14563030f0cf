"""Construction and execution of a simulated device.

`build_device` makes the device and its line from the options; `run` serves it until the user
stops it.
"""

from __future__ import annotations

import asyncio
import sys
import threading
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from random import Random
from typing import Any

from icdgen.errors import UserError
from icdgen.icd.model import Icd, Node
from icdgen.protocol import facts
from icdgen.sim import control, serve
from icdgen.sim.computer import Computer
from icdgen.sim.device_line import DeviceLine
from icdgen.sim.faults import Faults
from icdgen.sim.files import read_file, saver
from icdgen.sim.framed_line import FramedLine
from icdgen.sim.line import UartLine
from icdgen.sim.settings import SimulationSettings
from icdgen.sim.storage import DeviceStorage
from icdgen.values.chosen import chosen_values
from icdgen.values.find import find_node, is_part

Transport = tuple[Any, ...]  # name of a function of `serve`, and its arguments


@dataclass
class Options:
    """Options of `icdgen sim`; see `icdgen sim --help`."""

    values: Sequence[tuple[str, str]] = ()
    script: Path | None = None
    files: Sequence[str] = ()
    uploads: Path | None = None
    faults: Sequence[str] = ()
    late: int = 1500
    seed: int = 0
    boot: int | None = None
    busy: int = 20
    processing: int = 0
    strict: bool = False
    orders: bool = False
    every: float | None = None
    chosen: Sequence[str] = ()


FRAMING = "describe the link in `protocol: link`; `icdgen init NAME` writes an example"


def node_of(icd: Icd, name: str | None) -> Node:
    """Return the node of this name, or the only one with a protocol on a byte stream.

    Raise `icdgen.errors.UserError`.
    """
    candidates = [
        node for node in icd.nodes if has_protocol(icd, node) and not is_part(icd, node)
    ]
    if name is None:
        if len(candidates) == 1:
            return candidates[0]
        if not candidates:
            raise UserError(
                "no node of the ICD says how its messages are framed on a stream of bytes",
                FRAMING,
            )
        names = ", ".join(node.name for node in candidates)
        raise UserError(
            "it is not said which node is meant", f"--node NAME; nodes: {names}"
        )
    node = find_node(icd, name)
    if not has_protocol(icd, node):
        raise UserError(
            f"the ICD does not say how messages of {node.name} are framed on a stream of bytes",
            FRAMING,
        )
    return node


def has_protocol(icd: Icd, node: Node) -> bool:
    """Return whether the ICD describes the protocol of the node on a byte stream."""
    node_facts = facts.of(icd, node)
    return node_facts.framing is not None or node_facts.stream is not None


def build_device(
    icd: Icd,
    name: str | None,
    options: Options,
    warn: Callable[[str], object] = lambda text: None,
) -> tuple[DeviceLine, control.Control]:
    """Return the device on its line, and its control.

    ``warn`` is called for faults that apply in part only. Raise
    `icdgen.errors.UserError`.
    """
    node = node_of(icd, name)
    storage = DeviceStorage(on_write=saver(options.uploads))
    for text in options.files:
        kind, key, file = read_file(icd, node, text)
        storage.objects_of(kind)[key] = file
    settings = SimulationSettings(
        boot_ms=options.boot,
        busy_ms=options.busy,
        processing_ms=options.processing,
        strict=options.strict,
        every_ms=None if options.every is None else round(options.every * 1000),
    )
    line_faults = Faults(Random(options.seed), late_ms=options.late)
    chosen = chosen_values(facts.of(icd, node), options.chosen)
    computer = Computer(icd, node, settings, storage)
    line: DeviceLine
    if computer.program.facts.stream:
        line = FramedLine(computer, line_faults, chosen)
    else:
        line = UartLine(computer, line_faults)
    line.warn = warn
    line_faults.faults = [line.fault(text) for text in options.faults]
    steps = (
        control.read_script(options.script, icd, node, line) if options.script else []
    )
    controller = control.Control(icd, node, line, steps)
    for message, text in options.values:
        controller.assign(message, text)
    return line, controller


def run(
    icd: Icd,
    name: str | None,
    transports: list[Transport],
    options: Options,
    report: Callable[[str], None],
    warn: Callable[[str], object] = lambda text: None,
) -> None:
    """Run the device until interrupted. Raise `icdgen.errors.UserError`.

    ``report`` and ``warn`` are called with lines for the user.
    """
    line, controller = build_device(icd, name, options, warn)
    if line.keeps_packets and any(
        "udp" not in transport[:2] for transport in transports
    ):
        raise UserError(
            "only packets delimit messages here, and a stream of bytes keeps none apart",
            "use --udp PORT",
        )
    asyncio.run(_run(line, controller, transports, options.orders, report))


async def _run(
    line: DeviceLine,
    controller: control.Control,
    transports: list[Transport],
    reads_commands: bool,
    report: Callable[[str], None],
) -> None:
    server, holders = serve.Server(line, controller), []
    for transport, *arguments in transports:
        address, holder = await getattr(serve, transport)(server, *arguments)
        holders.append(holder)
        report(address)
    running = asyncio.create_task(server.run())
    waiting = [running]
    if reads_commands:
        waiting.append(asyncio.create_task(_listen(server, report)))
    done, _ = await asyncio.wait(waiting, return_when=asyncio.FIRST_COMPLETED)
    running.cancel()
    for task in done:
        if not task.cancelled() and task.exception():
            raise task.exception()  # type: ignore[misc]


async def _listen(server: serve.Server, report: Callable[[str], None]) -> None:
    """Execute commands from standard input until it ends."""
    loop = asyncio.get_running_loop()
    lines: asyncio.Queue[str | None] = asyncio.Queue()

    # In a thread: asyncio cannot wait for files or terminals on all systems.
    def read() -> None:
        for line in sys.stdin or ():
            loop.call_soon_threadsafe(lines.put_nowait, line)
        loop.call_soon_threadsafe(lines.put_nowait, None)

    threading.Thread(target=read, daemon=True).start()
    while (line := await lines.get()) is not None:
        try:
            answer = server.execute(line.strip())
        except UserError as error:
            answer = f"error: {error}" + (f"; {error.help}" if error.help else "")
        if answer:
            report(answer.replace("\n", " "))
