"""A megabyte arrives byte for byte with any share of lost packets, in simulated time.

For a real port and clients of other languages: ``python -m tests.sim.harness``.
"""

from __future__ import annotations

from random import Random

import pytest
from icdgen_runtime.wire.procedures import Procedure
from icdgen_runtime.wire.session import Session

from tests.sim.device import ICD
from tests.sim.port import DevicePort

LOSSES = [0, 10, 30]  # per cent
LONGEST = 300  # seconds that a transfer takes at most


def transferred(node: str, name: str, data: bytes = b"", inputs=None, **options):
    """Run the procedure to its end, which must come in time."""
    port = DevicePort(ICD, node, **options)
    link = port.line.computer.program.link
    session = Session(link, port.write, port.read, clock=port.clock)
    procedure = session.run(Procedure(link, name, inputs, data))
    assert port.clock() < LONGEST
    return procedure


@pytest.mark.parametrize("loss", LOSSES)
def test_a_file_of_a_megabyte_is_downloaded(tmp_path, loss):
    data = Random(loss).randbytes(1 << 20)
    (tmp_path / "file").write_bytes(data)
    options = {"files": [f"2:1={tmp_path / 'file'}"], "seed": loss}
    if loss:
        options["faults"] = [f"drop={loss}%@packet"]
    inputs = {"type": 2, "counter": 1, "size": len(data)}
    procedure = transferred("cubeacp", "download", inputs=inputs, **options)
    assert procedure.data == data


@pytest.mark.parametrize("loss", LOSSES)
def test_a_program_that_fills_its_destination_is_uploaded(tmp_path, loss):
    data = Random(loss).randbytes(1 << 19)
    options = {"uploads": tmp_path, "boot": 10**9, "seed": loss}
    if loss:
        options["faults"] = [f"drop={loss}%@upload"]
    inputs = {"destination": 3}
    procedure = transferred("bootloader", "upload", data, inputs, **options)
    assert procedure.progress == (len(data), len(data))
    assert (tmp_path / "3.bin").read_bytes() == data
