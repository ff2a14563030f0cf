"""Files arrive byte for byte over a real port with any losses.

The files are small. `tests.sim.harness` transfers a megabyte each way:
``PYTHONPATH=generated/python python -m tests.sim.harness -- python -m
tests.python.sim_client``.
"""

from __future__ import annotations

from random import Random

import pytest
from icdgen_runtime.wire.failures import FailedError
from icdgen_runtime.wire.files import read_index
from icdgen_runtime.wire.procedures import Procedure

from icdgen import codec
from tests.sim.device import session

LOSSES = ["0", "1%", "10%", "30%"]
NAMES = ("File Ctr", "File Size", "File CRC16 Checksum", "File Date and Time")


def ran(client, name, data=b"", **inputs) -> Procedure:
    return client.run(Procedure(client.link, name, inputs, data))


def downloaded(client, type, counter, size) -> bytes:
    return ran(client, "download", type=type, counter=counter, size=size).data


def listed(client) -> list[dict[str, int]]:
    """Return the fields of the entries of the file list."""
    message = client.node_facts.telemetry[client.link.procedures["list"].entry]
    frames = ran(client, "list").frames
    return [codec.decode(client.node, message, frame) for frame in frames]


@pytest.mark.parametrize("way", [("--tcp", "0"), ("--pty",)], ids=lambda way: way[0])
@pytest.mark.parametrize("loss", LOSSES)
def test_a_file_is_downloaded_and_a_program_uploaded(tmp_path, loss, way):
    source = Random(loss)
    stored, image = source.randbytes(25_003), source.randbytes(24_001)
    (tmp_path / "stored").write_bytes(stored)
    options = (
        "--file",
        f"2:7={tmp_path / 'stored'}",
        "--uploads",
        str(tmp_path / "up"),
        "--loss",
        loss,
        "--boot",
        "100000",
    )
    with session(*way, *options, "--seed", "5", node="bootloader") as client:
        assert downloaded(client, 2, 7, len(stored)) == stored
        upload = ran(client, "upload", image, destination=3)
        assert upload.progress == (len(image), len(image))
    assert (tmp_path / "up" / "3.bin").read_bytes() == image


@pytest.mark.parametrize(
    "faults",
    [("late=20%@acknowledge",), ("drop=20%@acknowledge",), ("duplicate=30%@acknowledge,packet", "late=5%@packet"),
     ("cut=5%@packet", "noise=20%@packet,reply"), ("corrupt=0.3%@packet",), ("corrupt=0.3%@upload",)],
    ids=" ".join,
)  # fmt: skip
def test_files_survive_faults_of_acknowledges_and_packets(tmp_path, faults):
    stored = Random(1).randbytes(6_001)
    (tmp_path / "stored").write_bytes(stored)
    options = [word for fault in faults for word in ("--fault", fault)]
    with session(
        "--file",
        f"2:7={tmp_path / 'stored'}",
        "--uploads",
        str(tmp_path),
        "--late",
        "250",
        "--boot",
        "100000",
        *options,
        node="bootloader",
    ) as client:
        assert downloaded(client, 2, 7, len(stored)) == stored
        ran(client, "upload", stored, destination=4)
    assert (tmp_path / "4.bin").read_bytes() == stored


def test_the_list_and_the_index_hold_every_file_until_they_are_erased(tmp_path):
    options = []
    for number in range(5):
        (tmp_path / str(number)).write_bytes(bytes([number]) * (100 + number))
        options += ["--file", f"2:{number}={tmp_path / str(number)}"]
    with session(*options, "--fault", "drop=10%@acknowledge") as client:
        entries = listed(client)
        assert [(e["File Ctr"], e["File Size"]) for e in entries] == [
            (n, 100 + n) for n in range(5)
        ]
        assert all(e["File Date and Time"] for e in entries)
        data = downloaded(client, client.link.index_file.file_type, 0, None)
        index, truncated = read_index(client.link, data)
        assert truncated == 0
        assert [(e.counter, e.size, e.checksum, e.time) for e in index] == [
            tuple(entry[name] for name in NAMES) for entry in entries
        ]
        ran(client, "erase", type=2, counter=3, all=0)
        assert [e["File Ctr"] for e in listed(client)] == [0, 1, 2, 4]
        ran(client, "erase", type=0, counter=0, all=1)
        assert listed(client) == []


def test_a_formatted_device_has_no_files(tmp_path):
    (tmp_path / "file").write_bytes(b"content")
    with session("--file", f"2:1={tmp_path / 'file'}") as client:
        assert len(listed(client)) == 1
        ran(client, "format")
        assert listed(client) == []


def test_a_file_that_is_not_there_cannot_be_loaded():
    with session() as client, pytest.raises(FailedError) as caught:
        downloaded(client, 2, 99, 100)
    assert caught.value.result == "failed"
