"""A Rust program runs a procedure over a link with header and trailer.

The simulator is the device. The program `upload.rs` prints the outcome.
"""

from __future__ import annotations

import subprocess
from binascii import crc32
from pathlib import Path
from urllib.parse import urlsplit

import pytest

from tests.conftest import ROOT
from tests.rust import harness
from tests.rust.tools import USED, Toolchain
from tests.sim.device import simulator

LOADER = ROOT / "examples" / "links" / "bootloader.yaml"
SIZE = 5000


@pytest.fixture(scope="module")
def client(tmp_path_factory) -> Path:
    folder, tools = tmp_path_factory.mktemp("client"), Toolchain("default")
    library = tools.library(
        harness.generate(harness.read_unchecked(LOADER), folder), *USED
    )
    main = Path(__file__).with_name("upload.rs")
    return tools.program(main, library, folder / "upload")


def upload_outcome(client: Path, *options: str) -> str:
    with simulator("--icd", str(LOADER), *options, "--tcp", "0") as (address, _):
        where = urlsplit(address)
        words = [client, str(where.hostname), str(where.port), str(SIZE)]
        done = subprocess.run(words, capture_output=True, text=True, timeout=60)
    assert done.returncode == 0, done.stderr
    return done.stdout.strip()


@pytest.mark.parametrize("faults", [(), ("--fault", "drop=10%")], ids=str)
def test_a_program_is_uploaded_over_a_line_that_loses_messages(client, faults):
    image = bytes(number % 251 for number in range(SIZE))
    assert upload_outcome(client, *faults) == str(crc32(image))


def test_a_refused_telecommand_ends_the_procedure(client):
    assert upload_outcome(client, "--fault", "nak=1:Locked") == "Refused"
