"""A simulated device runs one program at a time and starts the next one."""

from __future__ import annotations

import pytest

from icdgen import codec
from icdgen.protocol import facts
from icdgen.sim.computer import Computer
from icdgen.sim.settings import SimulationSettings
from icdgen.sim.storage import DeviceStorage
from icdgen.sim.values import allowed_values
from tests.conformance.icds import icd_of

ICD = icd_of()
BOOT, APPLICATION = ICD.node("bootloader"), ICD.node("cubeacp")
PROTOCOL = ICD.protocol_of(BOOT)


def computer(node: str, boot_ms: int | None = 100) -> Computer:
    settings = SimulationSettings(boot_ms=boot_ms)
    return Computer(ICD, ICD.node(node), settings, DeviceStorage())


def running(device: Computer) -> str:
    return device.program.node.name


def message(device: Computer, name: str) -> bytes:
    """Return a telecommand with allowed values."""
    command = next(
        m for m in device.program.facts.telecommands.values() if m.name == name
    )
    raw = allowed_values(ICD, command)
    data = codec.encode(ICD.node(command.node), command, raw)
    return bytes([command.telecommand_id]) + data


def reset_of(device: Computer) -> bytes:
    """Return a telecommand that restarts the device with its boot program."""
    names = [
        m.name for m in device.program.facts.telecommands.values() if m.expects_reset
    ]
    return message(
        device, next(n for n in names if n != PROTOCOL["program_start"]["message"])
    )


def test_only_a_boot_program_starts_another_one():
    device = computer("cubeacp", 0)
    assert (device.boot_at, device.deadline) == (None, None)
    device.tick(10**9)
    assert running(device) == "cubeacp"


def test_a_restart_begins_with_the_boot_program_of_the_running_one():
    device = computer("cubeacp")
    device.restart(40)
    assert (running(device), device.boot_at) == ("bootloader", 140)
    device.restart(60)  # the boot program itself
    assert (running(device), device.boot_at) == ("bootloader", 160)
    device.tick(160)
    assert (running(device), device.boot_at) == ("cubeacp", None)


def test_a_reset_restarts_and_a_program_start_runs_the_application():
    device = computer("cubeacp")
    outcome = device.take(10, reset_of(device), "uart")
    assert (outcome.is_answered, running(device), device.boot_at) == (
        False,
        "bootloader",
        110,
    )
    device.take(20, reset_of(device), "uart")
    assert (running(device), device.boot_at) == ("bootloader", 120)
    device.take(30, message(device, PROTOCOL["program_start"]["message"]), "uart")
    assert (running(device), device.boot_at) == ("cubeacp", None)


def test_a_telecommand_without_a_reset_starts_no_program():
    device = computer("cubeacp")
    program = device.program
    assert device.take(0, bytes([17]) + bytes(6), "uart").code == 0
    assert device.program is program
    assert device.take(0, b"\x63", "uart").code == program.facts.reasons["unknown_id"]
    assert device.program is program


def test_only_the_request_for_the_identification_stops_the_boot_program():
    stop = PROTOCOL["boot"]["stop_request"]
    telemetry = facts.of(ICD, BOOT).telemetry
    (stop_id,) = (id for id, each in telemetry.items() if each.name == stop)
    other_id = next(id for id in telemetry if id != stop_id)
    device = computer("bootloader")
    assert device.frame(0, other_id) is not None
    assert device.frame(0, 255) is None
    assert (device.boot_at, device.deadline) == (100, 100)
    assert device.frame(0, stop_id) is not None
    assert (device.boot_at, device.deadline) == (None, None)
    device.tick(10**9)
    assert running(device) == "bootloader"


@pytest.mark.parametrize(
    ("boot_at", "log_at", "expected"),
    [(None, None, None), (5, None, 5), (None, 7, 7), (5, 7, 5), (7, 5, 5), (0, 5, 0)],
)
def test_the_deadline_is_that_of_the_boot_or_of_the_next_log(boot_at, log_at, expected):
    device = computer("cubeacp")
    device.boot_at, device.program.log_at = boot_at, log_at
    assert device.deadline == expected


def test_the_application_starts_with_new_statistics_and_the_stored_objects():
    device = computer("bootloader")
    first = device.program
    first.count("requests")
    device.tick(100)
    assert device.program is not first and device.program.counts == {}
    assert device.program.free_at == 100
    assert device.storage is not None
