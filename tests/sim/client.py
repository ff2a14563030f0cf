"""The reference client of the harness: python -m tests.sim.client HOST PORT SIZE"""

from __future__ import annotations

import sys

from icdgen import codec
from icdgen.icd.model import CONFIGURATION, Message
from icdgen.link.ports import open_port
from icdgen.protocol import crc, programs, transfer
from icdgen.sim.values import allowed_values
from tests.sim.device import FAST, ICD, download, hasty
from tests.sim.reference import Session

NODE = "cubeacp"
STARTER = next(
    n
    for n in ICD.nodes
    if n.protocol.get("program_start", {}).get("application") == NODE
)
DESTINATION = 3
TRIES = 20


class Failed(Exception):
    """Not what the harness expects."""


def main(host: str, port: str, size: str) -> int:
    with Session(
        ICD, ICD.node(NODE), open_port(f"tcp://{host}:{port}", {}), settings=FAST
    ) as client:
        client.known = hasty(client.known)
        found = client.identify()
        if found is None or not found[1]:
            return 3
        try:
            every_frame(client)
            every_setting(client)
            log = next(
                m for m in client.known.telecommands.values() if m.name == log_message()
            )
            client.telecommand(log, bytes(log.length))  # no logs during the transfers
            data = downloaded(client, int(size))
            every_telecommand(client)
            started(client, data)
        except Failed as failure:
            print(failure, file=sys.stderr)
            return 1
    return 0


def every_frame(client: Session) -> None:
    for message in client.known.telemetry.values():
        get(client, message)


def every_setting(client: Session) -> None:
    for message in client.known.telecommands.values():
        if message.kind == CONFIGURATION:
            raw = allowed_values(ICD, message) | {
                f.name: 1
                for f in message.fields
                if f.type == "uint" and f.const is None
            }
            data = codec.encode(ICD.node(message.node), message, raw)
            outcome = send(client, message, data)
            if outcome["event"] != "done" or get(client, message) != data:
                raise Failed(f"{message.name} is not what was set: {outcome}")


def downloaded(client: Session, size: int) -> bytes:
    result, data = download(client, 2, 1, size)
    if result != "done":
        raise Failed(f"download: {result}")
    return data


def started(client: Session, data: bytes) -> None:
    """Uploads a program, copies it to where it can run, and starts it.

    The boot program runs.
    """
    boot = Session(ICD, STARTER, client.port, settings=FAST)
    boot.known = hasty(boot.known)
    data = data[: boot.known.files.upload.destination_bytes]
    done(boot, "upload", transfer.Upload(boot.known, DESTINATION, data))
    done(boot, "copy", programs.ProgramCopy(boot.known, DESTINATION))
    running = ICD.protocol_of(STARTER)["program_copy"]["destination"]
    told = done(boot, "information", programs.ProgramInformation(boot.known, running))
    if (told.size, told.checksum) != (len(data), crc.compute(boot.known.crc16, data)):
        raise Failed(
            f"the program that can run has {told.size} bytes and the checksum {told.checksum:#x}"
        )
    start = next(
        m
        for m in boot.known.telecommands.values()
        if m.name == STARTER.protocol["program_start"]["message"]
    )
    boot.telecommand(start, b"")
    found = client.identify()
    if found is None or not found[1]:
        raise Failed(f"the program does not run: {found}")


def done(client: Session, name: str, procedure):
    result = client.run(procedure)
    if result != "done":
        raise Failed(f"{name}: {result}")
    return procedure


def every_telecommand(client: Session) -> None:
    others = [m for m in client.known.telecommands.values() if m.kind != CONFIGURATION]
    for message in sorted(others, key=lambda m: m.expects_reset):
        data = codec.encode(
            ICD.node(message.node), message, allowed_values(ICD, message)
        )
        if message.expects_reset:
            reset(client, message, data)
        elif message.acknowledge:
            outcome = send(client, message, data)
            if outcome["event"] == "timeout" or (
                outcome["event"] == "refused" and outcome["reason"] is None
            ):
                raise Failed(f"{message.name}: {outcome}")
        else:
            silent(client, message, data)


def silent(client: Session, message: Message, data: bytes) -> None:
    """The node does not acknowledge it, but remembers that it was the last one.

    If it is lost nobody notices.
    """
    form = client.known.polled
    for _ in range(TRIES):
        client.telecommand(message, data)
        frame = get(client, form.message)
        if (
            codec.decode(ICD.node(form.message.node), form.message, frame)[form.id]
            == message.telecommand_id
        ):
            return
    raise Failed(f"{message.name} does not arrive")


def reset(client: Session, message: Message, data: bytes) -> None:
    """The node restarts, and the program that starts the other one answers."""
    client.telecommand(message, data)
    found = client.identify()
    if found is None or found[0]["node_type"] != STARTER.node_type:
        raise Failed(f"{message.name} does not restart the node: {found}")


def get(client: Session, message: Message) -> bytes:
    frame = client.telemetry(message)
    if frame is None:
        raise Failed(f"{message.name} is not answered")
    return frame


def send(client: Session, message: Message, data: bytes) -> dict:
    """A refusal with a code that the ICD does not have is a damaged acknowledge: it is
    asked again.
    """
    for _ in range(TRIES):
        outcome = client.telecommand(message, data, repeat=True)
        if outcome["event"] != "refused" or outcome["reason"] is not None:
            break
    return outcome


def log_message() -> str:
    return ICD.protocol_of(ICD.node(NODE))["unsolicited_log"]["configured_by"][
        "message"
    ]


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))
