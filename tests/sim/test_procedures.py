"""The simulated device supports every procedure of an ICD, also on a framed link."""

from __future__ import annotations

from binascii import crc32
from random import Random

import pytest
from icdgen_runtime.wire.failures import FailedError
from icdgen_runtime.wire.procedures import Procedure

from tests.sim.test_framed_line import talking

WRITE = 2
SETTINGS = {"node": "loader", "every": 0}


def uploaded(image: bytes, area: int = 1, **options):
    session, port, _ = talking(**SETTINGS, **options)
    procedure = Procedure(session.client.link, "upload", {"area": area}, image)
    return session.run(procedure), port


def programs(port) -> dict:
    """Return the stored programs by area."""
    objects = port.line.computer.storage.objects_of("upload")
    return {key: bytes(stored.data) for key, stored in objects.items()}


@pytest.mark.parametrize("size", [0, 1, 128, 1024, 1025, 20_000])
def test_a_program_is_stored_without_the_fill_of_its_last_packet(size, tmp_path):
    image = Random(size).randbytes(size)
    _, port = uploaded(image, uploads=tmp_path)
    assert programs(port) == {(1,): image}
    if image:
        assert (tmp_path / "1.bin").read_bytes() == image


@pytest.mark.parametrize(
    "faults",
    [["drop=20%"], ["drop=20%@upload"], ["corrupt=5%"], ["busy=20%"], ["duplicate=30%"], ["silence=10%"]],
    ids=" ".join,
)  # fmt: skip
def test_a_program_arrives_whatever_happens_to_messages(faults):
    image = Random(" ".join(faults)).randbytes(5_000)
    _, port = uploaded(image, faults=faults, seed=3)
    assert programs(port) == {(1,): image}


def test_the_device_reports_its_progress_and_checksums():
    session, port, _ = talking(**SETTINGS, busy=200)
    link = session.client.link
    image = bytes(range(200))
    session.run(Procedure(link, "upload", {"area": 0}, image))
    status, block, total = (link.TELEMETRY[id] for id in (0x81, 0x82, 0x83))
    assert session.get(total).checksum == session.get(block).checksum == crc32(image)
    assert not session.get(status).erasing
    session.send(link.TELECOMMANDS[1]())
    assert session.get(status).erasing
    assert programs(port) == {(0,): b""}
    port.now += 0.2
    assert not session.get(status).erasing


def test_a_refused_telecommand_ends_the_procedure():
    session, port, _ = talking(**SETTINGS, faults=["nak=1:Locked"])
    procedure = Procedure(session.client.link, "upload", {"area": 1}, bytes(100))
    with pytest.raises(FailedError, match="refused"):
        session.run(procedure)
    assert programs(port) == {}, "nothing is stored"
