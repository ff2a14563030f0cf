"""The example of the guide that talks to a simulated node, as the guide shows it."""

from __future__ import annotations

import shutil
from urllib.parse import urlsplit

from tests import documents
from tests.conftest import ROOT
from tests.rust import harness
from tests.rust.tools import run
from tests.sim.device import simulator

EXAMPLES = ROOT / "examples" / "rust"
REQUEST = "src/bin/request.rs"
PORT = "127.0.0.1:4000"


def test_the_guide_shows_the_example():
    _, code = (EXAMPLES / REQUEST).read_text().split("\n", 1)
    assert f"```rust\n{code}```\n" in documents.text("guides/rust")


def test_it_talks_to_the_simulator_of_the_command_line(tmp_path):
    folder = tmp_path / "examples" / "rust"
    shutil.copytree(EXAMPLES, folder, ignore=shutil.ignore_patterns("target"))
    harness.generate(harness.shipped(), tmp_path / "build" / "quickstart")
    code = (folder / REQUEST).read_text()
    assert code.count(PORT) == 1
    told = ("--set", "Estimated Attitude Angles", "roll=-12.34")
    with simulator("--node", "cubeacp", "--tcp", "0", *told) as (place, _):
        (folder / REQUEST).write_text(code.replace(PORT, urlsplit(place).netloc))
        cargo = ("cargo", "run", "--quiet", "--offline", "--bin", "request")
        own = {
            "CARGO_HOME": tmp_path / "home",
            "CARGO_TARGET_DIR": tmp_path / "target",
            "RUSTFLAGS": "-D warnings",
        }
        assert run(*cargo, cwd=folder, **own) == "roll -12.34 deg\n"
