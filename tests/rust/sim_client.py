"""Build the client of `tests.sim.harness` from the generated Rust crate.

``python -m tests.rust.sim_client FOLDER`` builds it in a folder and prints its path.
"""

from __future__ import annotations

import shutil
import sys
from pathlib import Path
from typing import NamedTuple

import jinja2

from icdgen import codec
from icdgen.describe import MessageDescription, describe
from icdgen.icd.model import CONFIGURATION, Icd, Message, Node
from icdgen.icd.places import NodePlace
from icdgen.protocol import facts
from icdgen.sim.values import allowed_values
from tests.rust import harness
from tests.rust.tools import USED, Toolchain

HERE = Path(__file__).parent
NODE = "cubeacp"


class Row(NamedTuple):
    """Type of a message, and the data to send, as text of Rust."""

    type: str
    data: str


class Place(NamedTuple):
    """A field of a frame."""

    type: str
    field: str


def source(icd: Icd, node_name: str = NODE) -> str:
    """Return the text of the client's main file."""
    node = icd.node(node_name)
    protocol = facts.of(icd, node)
    descriptions = describe(icd).node(node).all_messages
    rows = {message.model.name: message for message in descriptions}

    def of(messages, values) -> list[Row]:
        return [
            _row(icd, rows[message.name], values(icd, message)) for message in messages
        ]

    commands = [m for m in protocol.telecommands.values() if m.kind != CONFIGURATION]
    starters = [
        other.name
        for other in icd.nodes
        if other.protocol.get("program_start", {}).get("application") == node.name
    ]
    boot = icd.node(starters[0])
    last = protocol.polled
    unsolicited_log = icd.protocol_of(node).get("unsolicited_log", {})
    log = unsolicited_log.get("configured_by", {}).get("message")
    environment = jinja2.Environment(
        loader=jinja2.FileSystemLoader(HERE),
        trim_blocks=True,
        lstrip_blocks=True,
        undefined=jinja2.StrictUndefined,
    )
    return environment.get_template("sim_client.rs.j2").render(
        node=node.name,
        telemetry=of(protocol.telemetry.values(), allowed_values),
        settings=of(
            (m for m in protocol.telecommands.values() if m.kind == CONFIGURATION),
            distinct_values,
        ),
        acknowledged=of(
            (m for m in commands if m.acknowledge and not m.expects_reset),
            allowed_values,
        ),
        silent=of(
            (m for m in commands if not m.acknowledge and not m.expects_reset),
            allowed_values,
        ),
        resets=of((m for m in commands if m.expects_reset), allowed_values),
        last=Place(_type(rows[last.name]), _field(rows[last.name], "Last TC ID")),
        identification=_type(rows[protocol.identification.message.name]),
        log=log and _type(rows[log]),
        restarted=starters[0],
        start=_start(icd, boot),
        running=icd.protocol_of(boot)["procedures"]["program_copy"]["effect"]["to"][0],
    )


def _start(icd: Icd, boot: Node) -> str:
    """Return the type of the telecommand that starts the application."""
    name = boot.protocol["program_start"]["message"]
    messages = describe(icd).node(boot).messages
    return _type(next(message for message in messages if message.model.name == name))


def build(folder: Path) -> list[str]:
    """Build the client in ``folder`` and return the command that starts it."""
    icd, tools = harness.shipped(), Toolchain("default")
    shutil.rmtree(folder / "rust", ignore_errors=True)  # remove an earlier build
    # The options include checks of arithmetic.
    library = tools.library(harness.generate(icd, folder), *USED)
    main = folder / "sim_client.rs"
    main.write_text(source(icd), encoding="utf-8")
    shutil.copy(HERE / "sim_device.rs", folder)
    return [str(tools.program(main, library, folder / "sim_client"))]


def distinct_values(icd: Icd, message: Message) -> dict[str, int | bytes]:
    """Return raw values of a message in which nearly all fields differ.

    A node that mixes up two fields then returns another message.
    """
    raw = allowed_values(icd, message)
    for number, field in enumerate(message.fields, 1):
        if field.const is None:
            raw[field.name] = _distinct_value(field, number, raw[field.name])
    return raw


def _distinct_value(
    field: NodePlace, number: int, otherwise: int | bytes
) -> int | bytes:
    if field.is_bytes:
        return bytes((number + at) % 256 for at in range(field.bits // 8))
    if field.type == "float":
        return codec.float_bits(field, float(number))
    if field.type in ("uint", "int", "bool"):
        return number % (field.raw_max + 1)
    return otherwise


def _row(icd: Icd, row: MessageDescription, raw: dict[str, int | bytes]) -> Row:
    return Row(_type(row), f"&{list(codec.encode(row.node, row.model, raw))}")


def _type(row: MessageDescription) -> str:
    return f"icd::{row.node.name}::{row.camel_name}"


def _field(row: MessageDescription, name: str) -> str:
    return next(field.name for field in row.fields if field.model.name == name)


if __name__ == "__main__":
    print(*build(Path(sys.argv[1])))
