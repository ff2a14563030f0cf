"""Results of the simulator and of the logs for an ICD on a framed link."""

from __future__ import annotations

import io
import tempfile
from collections.abc import Iterator
from contextlib import suppress
from pathlib import Path
from random import Random

from icdgen_runtime._errors import IcdError
from icdgen_runtime.wire.packet_formats import Direction
from icdgen_runtime.wire.stream import stream_encode

from icdgen import codec
from icdgen.errors import UserError
from icdgen.icd.model import Icd, Node
from icdgen.icd.variants import ids_of
from icdgen.logfile import text
from icdgen.logfile.log import open_log
from icdgen.recognize.framed import DIRECTIONS
from icdgen.runtime_objects.links import link_of_node
from icdgen.sim.computer import Computer
from icdgen.sim.control import fields_of, raw_value_of
from icdgen.sim.faults import Faults
from icdgen.sim.framed_line import FramedLine
from icdgen.sim.settings import SimulationSettings
from icdgen.sim.storage import DeviceStorage

Frames = dict[str, list[bytes]]


def recorded(icd: Icd, node: Node, frames: Frames) -> dict[Direction, bytes]:
    """Return the bytes that are sent in each direction for these frames, one after the
    other.
    """
    return {
        direction: b"".join(_sent_of(icd, node, frames, direction))
        for direction in DIRECTIONS
    }


def _sent_of(
    icd: Icd, node: Node, frames: Frames, direction: Direction
) -> Iterator[bytes]:
    link = link_of_node(icd, node)
    for id, variants in getattr(ids_of(icd, node), direction).items():
        for variant in variants:
            for data in frames.get(variant.message.name, ()):
                with suppress(IcdError):
                    yield stream_encode(link, id, data, direction)


def log(
    icd: Icd, node: Node, sent: dict[Direction, bytes], folder: Path
) -> tuple[object, object]:
    """Return recordings as CSV and as Parquet, or the error."""
    logs = [
        _log(icd, node, direction, data, folder) for direction, data in sent.items()
    ]
    return [csv for csv, _ in logs], [arrow for _, arrow in logs]


def _log(
    icd: Icd, node: Node, direction: Direction, data: bytes, folder: Path
) -> tuple[object, object]:
    import pyarrow.parquet

    file = Path(tempfile.mkdtemp(dir=folder)) / "recording.bin"
    file.write_bytes(data)
    try:
        opened = open_log(icd, node, file, direction, [])
        notes = opened.prepare(None, lambda _: None)
    except UserError as error:
        message = str(error).replace(str(file), "")
        return message, message
    written = io.StringIO()
    text.to_csv(opened.names, opened.rows(None, lambda _: None), written)
    opened.to_parquet(file.with_suffix(".parquet"), None, lambda _: None)
    table = pyarrow.parquet.read_table(file.with_suffix(".parquet"))
    arrow = table.schema.remove_metadata().to_string(), table.to_pylist()
    return (written.getvalue(), notes), (arrow, notes)


def simulator(
    icd: Icd, node: Node, frames: Frames, words: dict[str, list[list[str]]]
) -> object:
    """Return what the simulator sends after it received the telecommands of the
    example, and after each change of its values.
    """
    line = FramedLine(
        Computer(icd, node, SimulationSettings(strict=True), DeviceStorage()),
        Faults(Random(0), [], 0),
        {},
    )
    results: list[object] = []
    for data in _sent_of(icd, node, frames, "telecommand"):
        line.received(len(results), data)
        results.append((_sent(line, len(results)), dict(line.computer.program.counts)))
    for message in node.messages:
        for row in (
            words.get(message.name, ()) if message.telemetry_id is not None else ()
        ):
            try:
                for name, value in (word.split("=", 1) for word in row):
                    for own, field, given in fields_of(
                        icd, node, message.name, name, value
                    ):
                        line.computer.program.values.update(
                            own, {field.name: raw_value_of(own, field, given)}
                        )
            except (UserError, codec.CodecError) as error:
                results.append(str(error))
            results.append(_sent(line, len(results)))
    return results


def _sent(line: FramedLine, now: int) -> list[bytes]:
    line.log(now)
    return line.pieces(now + 1000)
