"""Files arrive byte for byte over a real port, whatever is lost.

Small files here; a megabyte each way is a command of its own, `tests.sim.harness`:
``python -m tests.sim.harness -- python -m tests.sim.client``.
"""

from __future__ import annotations

from random import Random

import pytest

from icdgen.protocol import files, transfer
from tests.sim.device import download, session

LOSSES = ["0", "1%", "10%", "30%"]


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
        assert download(client, 2, 7, len(stored)) == ("done", stored)
        upload = transfer.Upload(client.known, 3, image)
        assert (client.run(upload), upload.sent) == ("done", len(image))
    assert (tmp_path / "up" / "3.bin").read_bytes() == image


@pytest.mark.parametrize(
    "faults",
    [("late=20%@acknowledge",), ("drop=20%@acknowledge",), ("duplicate=30%@acknowledge,packet", "late=5%@packet"),
     ("cut=5%@packet", "noise=20%@packet,reply"), ("corrupt=0.3%@packet",), ("corrupt=0.3%@upload",)],
    ids=" ".join,
)  # fmt: skip
def test_files_survive_what_happens_to_acknowledges_and_packets(tmp_path, faults):
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
        assert download(client, 2, 7, len(stored)) == ("done", stored)
        assert client.run(transfer.Upload(client.known, 4, stored)) == "done"
    assert (tmp_path / "4.bin").read_bytes() == stored


def test_the_list_and_the_index_hold_every_file_until_they_are_erased(tmp_path):
    options = []
    for number in range(5):
        (tmp_path / str(number)).write_bytes(bytes([number]) * (100 + number))
        options += ["--file", f"2:{number}={tmp_path / str(number)}"]
    with session(*options, "--fault", "drop=10%@acknowledge") as client:
        listed = transfer.FileList(client.known)
        assert client.run(listed) == "done"
        assert [(e["counter"], e["size"]) for e in listed.entries] == [
            (n, 100 + n) for n in range(5)
        ]
        result, data = download(client, client.known.index.file_type, 0, None)
        entries, truncated = files.read_index(client.known, data)
        assert (result, truncated) == ("done", 0)
        assert [(e.counter, e.size, e.checksum) for e in entries] == [
            (e["counter"], e["size"], e["checksum"]) for e in listed.entries
        ]
        assert client.run(transfer.Erase(client.known, 2, 3, False)) == "done"
        left = transfer.FileList(client.known)
        client.run(left)
        assert [e["counter"] for e in left.entries] == [0, 1, 2, 4]
        assert client.run(transfer.Format(client.known)) == "done"
        left = transfer.FileList(client.known)
        assert (client.run(left), left.entries) == ("done", [])


def test_a_file_that_is_not_there_cannot_be_loaded():
    with session() as client:
        assert download(client, 2, 99, 100) == ("parameter", b"")
