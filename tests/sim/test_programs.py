"""The simulated device stores, copies and reports its programs."""

from __future__ import annotations

import pytest

from icdgen.procedures.run import steps_of
from icdgen.protocol import facts
from icdgen.protocol.procedures import Poll, Send
from icdgen.sim.computer import Computer
from icdgen.sim.settings import SimulationSettings
from icdgen.sim.storage import DeviceStorage
from tests import links
from tests.sim.device import ICD

BOOT = facts.of(ICD, ICD.node("bootloader"))
REASONS = {"none": 0, **BOOT.reasons}
PROCEDURES = {procedure.name: procedure for procedure in BOOT.procedures}
INITIATE, BEGIN, PACKET, FINALIZE = (
    step.message.telecommand_id for step in steps_of(PROCEDURES["upload"], Send)
)
_, FINALIZED = (
    step.message.telemetry_id for step in steps_of(PROCEDURES["upload"], Poll)
)
(COPY, COPIED), (READ, INFORMATION) = (
    (
        steps_of(PROCEDURES[name], Send)[0].message.telecommand_id,
        steps_of(PROCEDURES[name], Poll)[0].message.telemetry_id,
    )
    for name in ("program_copy", "program_information")
)


@pytest.fixture
def device():
    return Computer(
        ICD,
        ICD.node("bootloader"),
        SimulationSettings(boot_ms=10**9, busy_ms=10),
        DeviceStorage(),
    )


def code(device, now: int, *message: int) -> int:
    return device.take(now, bytes(message), "uart").code


def uploaded(device, destination: int, data: bytes) -> None:
    assert code(device, 0, INITIATE, destination, 0) == 0
    assert code(device, 0, BEGIN) == 0
    device.take(0, bytes([PACKET, 0, 0]) + data.ljust(20, b"\xff"), "uart")
    assert code(device, 0, FINALIZE, destination, 0, 0, 0, 0, len(data), 0) == 0


def test_a_copied_program_is_the_one_that_was_uploaded(device):
    uploaded(device, 4, b"a new program")
    assert code(device, 20, COPY, 4, 0) == 0
    assert (device.frame(20, COPIED), device.frame(30, COPIED)) == (b"\x01", b"\x00")
    assert code(device, 40, READ, 1) == 0
    assert device.frame(40, INFORMATION)[:2] == b"\x01\x01"
    checksum = links.crc(BOOT.checksums["crc16"].crc, b"a new program").to_bytes(
        2, "little"
    )
    assert device.frame(50, INFORMATION) == bytes([1, 0, 13, 0, 0, 0]) + checksum


def test_copying_a_program_that_was_never_uploaded_fails(device):
    assert code(device, 0, COPY, 9, 0) == 0
    assert (device.frame(0, COPIED), device.frame(10, COPIED)) == (b"\x01", b"\x02")


def test_a_program_that_cannot_be_copied_and_a_destination_that_is_not_supported_are_refused(
    device,
):
    assert code(device, 0, COPY, 0, 0) == REASONS["value"]
    assert code(device, 0, INITIATE, 10, 0) == REASONS["value"]
    assert code(device, 0, FINALIZE, 10, 0, 0, 0, 0, 1, 0) == REASONS["value"]


def test_a_block_beyond_the_end_of_the_destination_is_not_committed(device):
    uploaded(device, 3, b"x")
    assert code(device, 0, FINALIZE, 3, 0xFF, 0xFF, 7, 0, 1, 0) == 0  # the last byte
    assert device.frame(20, FINALIZED) == b"\x00"
    assert code(device, 30, FINALIZE, 3, 0, 0, 8, 0, 1, 0) == 0
    assert device.frame(50, FINALIZED) == b"\x02"


def test_a_program_that_takes_no_uploads_refuses_their_telecommands():
    running = Computer(ICD, ICD.node("cubeacp"), SimulationSettings(), DeviceStorage())
    assert code(running, 0, INITIATE, 3, 0) == REASONS["unknown_id"]
    outcome = running.take(0, bytes([PACKET, 0, 0]) + bytes(20), "uart")
    assert (outcome.code, outcome.is_answered) == (REASONS["unknown_id"], False)
    assert running.storage.objects_of("program") == {}


@pytest.mark.parametrize(
    ("setting", "boots_at"), [(None, BOOT.boot_ms), (0, 0), (1, 1), (70, 70)]
)
def test_a_boot_program_starts_its_application_after_the_time_of_the_setting(
    setting, boots_at
):
    """Without a setting, after the time of the ICD."""
    settings = SimulationSettings(boot_ms=setting)
    booting = Computer(ICD, ICD.node("bootloader"), settings, DeviceStorage())
    assert booting.boot_at == booting.deadline == boots_at
    if boots_at:
        booting.tick(boots_at - 1)
        assert booting.program.node.name == "bootloader"
    booting.tick(boots_at)
    assert (booting.program.node.name, booting.boot_at) == ("cubeacp", None)
