"""Client of `tests.sim.harness` that uses the generated Python package.

Usage: ``python -m tests.python.sim_client HOST PORT SIZE``, with ``generated/python``
on the path. The client reads the ICD only to learn which telecommands restart the node.
"""

from __future__ import annotations

import select
import socket
import sys
from typing import TYPE_CHECKING

from icdgen_messages import bootloader, cubeacp
from icdgen_messages.wire import (
    FailedError,
    Procedure,
    RefusedError,
    ReplyTimeoutError,
    Session,
    checksum,
    identify,
)

from icdgen.protocol import facts
from tests.sim.device import FAST, ICD, hasty

if TYPE_CHECKING:
    from icdgen_messages import Message


LINK, BOOT = hasty(cubeacp.LINK), hasty(bootloader.LINK)
DESTINATION, RUNNING = 3, bootloader.ProgramsList.INTERNAL_FLASH_PROGRAM
LOG_MESSAGE = ICD.protocol_of(ICD.node("cubeacp"))["unsolicited_log"]["configured_by"][
    "message"
]
LOGS = next(m for _, m in LINK.TELECOMMANDS.items() if m.NAME == LOG_MESSAGE)
TRIES = 20


class Failed(Exception):
    """The node did not do what the harness expects."""


def main(host: str, number: str, size: str) -> int:
    with socket.create_connection((host, int(number))) as port:
        port.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)

        def read(seconds: float) -> bytes:
            return port.recv(4096) if select.select([port], [], [], seconds)[0] else b""

        device = Session(LINK, port.sendall, read, settings=FAST)
        if not identity(device).matches:
            return 3
        try:
            for _, message in LINK.TELEMETRY.items():
                device.get(message)
            every_setting(device)
            send_until_acknowledged(device, LOGS())  # none during the transfers
            file = {"type": 2, "counter": 1, "size": int(size)}
            data = transfer(device, lambda: Procedure(LINK, "download", file)).data
            every_telecommand(device)
            start_program(
                device, Session(BOOT, port.sendall, read, settings=FAST), data
            )
        except (Failed, FailedError, RefusedError, ReplyTimeoutError) as failure:
            print(type(failure).__name__, failure, file=sys.stderr)
            return 1
    return 0


def start_program(device: Session, boot: Session, data: bytes) -> None:
    """Upload a program, copy it to where it can run, and start it.

    The boot program is running when this is called.
    """
    data = data[: BOOT.procedures["upload"].blocks.most]
    to, program = {"destination": DESTINATION}, {"program": DESTINATION}
    transfer(boot, lambda: Procedure(BOOT, "upload", to, data))
    transfer(boot, lambda: Procedure(BOOT, "program_copy", program))
    running = {"program": RUNNING}
    information = transfer(
        boot, lambda: Procedure(BOOT, "program_information", running)
    )
    size, value = information.output("size"), information.output("checksum")
    if (size, value) != (len(data), checksum(BOOT, "crc16", data)):
        raise Failed(
            f"the program that can run has {size} bytes and the checksum {value:#x}"
        )
    boot.send(bootloader.RunSelectedProgram())
    if not identity(device).matches:
        raise Failed("the program does not run")


def identity(device: Session):
    return identify(LINK, device.get(cubeacp.Identification).to_bytes())


def every_setting(device: Session) -> None:
    for _, message in LINK.TELECOMMANDS.items():
        if message.KIND == "configuration":
            setting = with_distinct_numbers(message)
            send_until_acknowledged(device, setting)
            if device.get(message) != setting:
                raise Failed(f"{message.NAME} is not what was set")


def with_distinct_numbers(message: type[Message]) -> Message:
    """Make a message in which nearly all numbers differ.

    A node that mixes up two fields then returns another message.
    """
    numbers = message.from_bytes(message().to_bytes())
    for number, info in enumerate(message.FIELDS, 1):
        if info.type in ("uint", "int") and info.const is None:
            setattr(numbers, info.attribute, number % (1 << info.bits - 1))
    return numbers


def every_telecommand(device: Session) -> None:
    messages = [
        message
        for _, message in LINK.TELECOMMANDS.items()
        if message.KIND != "configuration"
    ]
    resets = {
        m.name
        for m in facts.of(ICD, ICD.node("cubeacp")).telecommands.values()
        if m.expects_reset
    }
    for message in sorted(messages, key=lambda message: message.NAME in resets):
        if message.NAME in resets:
            device.send(message())
            if identity(device).matches:
                raise Failed(f"{message.NAME} does not restart the node")
        elif message.ACKNOWLEDGED:
            try:
                send_until_acknowledged(device, message())
            except RefusedError as error:
                if error.event.reason is None:
                    raise
        else:
            send_without_acknowledge(device, message)


def send_without_acknowledge(device: Session, message: type[Message]) -> None:
    """Send a telecommand that the node does not acknowledge until it arrives.

    The node reports the id of its last telecommand, which shows whether it arrived.
    """
    polled = LINK.bus_exchanges["i2c"].command
    last = LINK.TELEMETRY[polled.poll.telemetry]
    (echo,) = polled.responses[0].echoes
    for _ in range(TRIES):
        device.send(message())
        if echo.place.of(device.get(last).to_bytes()) in message.IDS:
            return
    raise Failed(f"{message.NAME} does not arrive")


def send_until_acknowledged(device: Session, message: Message) -> None:
    """Send a message until it is acknowledged, or refused twice.

    A damaged acknowledge may look like a refusal.
    """
    refused = 0
    for _ in range(TRIES):
        try:
            return device.send(message, repeat=True)
        except RefusedError as error:
            refused += error.event.reason is not None
            if refused > 1:
                raise
    raise Failed(f"{message.NAME} is never acknowledged")


def transfer(device: Session, procedure):
    """Run a procedure, and repeat it while it is refused.

    A damaged acknowledge may look like a refusal, which ends a transfer.
    """
    for _ in range(TRIES):
        try:
            return device.run(procedure())
        except FailedError as error:
            if error.result != "refused":
                raise
            failure = error
    raise failure


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))
