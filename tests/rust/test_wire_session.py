"""Sessions of the crate over ports that fail, requests that are given up; and messages
of other nodes, which do not compile.
"""

from __future__ import annotations

import re
import subprocess
from pathlib import Path

import pytest

from tests import documents
from tests.conftest import ROOT
from tests.rust import harness
from tests.rust.tools import USED, Toolchain, run, toolchains

PROGRAM = Path(__file__).with_name("session.rs")
WHOLE = """\
use icd::cubeacp::{Node, LINK, LONGEST};

fn main() {
    let mut client = icd::wire::Client::<Node, icd::wire::uart::Line<LONGEST>, 1>::uart(&LINK).unwrap();
    %s;
}
"""
STATEMENTS = {
    "request": "client.request::<icd::%s::State>(0).unwrap()",
    "send": "client.send(0, &icd::%s::default()).unwrap()",
    "message": "client.tick(0, |event| assert!(event.message::<icd::%s::State>().is_none()))",
}
OWN = {"request": "cubeacp", "send": "cubeacp::ClearErrors", "message": "cubeacp"}
OTHERS = {
    "request": "bootloader",
    "send": "bootloader::SetBootIndex",
    "message": "bootloader",
}


def test_sessions_outlive_their_port_and_requests_are_given_up(shipped, tmp_path):
    tools = Toolchain("default")
    library = Toolchain("default").library(shipped.crate, *USED)
    run(tools.program(PROGRAM, library, tmp_path / "program"))


@pytest.mark.parametrize("name", list(toolchains()))
def test_sessions_over_framed_links_ask_again_listen_and_outlive_their_port(
    name, tmp_path
):
    tools = Toolchain(name)
    crate = harness.generate(
        harness.read(ROOT / "examples" / "links" / "ubx.yaml"), tmp_path
    )
    run(
        tools.program(
            PROGRAM.with_name("stream_session.rs"),
            tools.library(crate, *USED),
            tmp_path / "program",
        )
    )


DOCUMENTED = """\
use icd::wheel::enums::{Mode, NakReason};
use icd::wheel::{self, SetMode};
use icd::wire::{stream, Failure, Session};
use std::io::{Read, Write};

#[allow(dead_code)]
fn set<P: Read + Write>(
    session: &mut Session<wheel::Node, P, stream::Line<{ wheel::LONGEST }, { wheel::SEQUENCES }>>,
) -> Result<(), Failure> {
%s
    Ok(())
}

fn main() {}
"""


def test_the_documented_handling_of_a_reason_compiles(tmp_path):
    text = documents.text("reference/wire-framing")
    shown = re.search(r"```rust\n(match session\.send.*?)```", text, re.S)
    tools = Toolchain("default")
    crate = harness.generate(
        harness.read(ROOT / "examples" / "links" / "wheel.yaml"), tmp_path
    )
    (tmp_path / "user.rs").write_text(DOCUMENTED % shown[1])
    library = tools.library(crate, *USED)
    tools.program(tmp_path / "user.rs", library, tmp_path / "program")


@pytest.mark.parametrize("name", list(toolchains()))
def test_sessions_return_the_outcome_of_each_telecommand_with_its_reason(
    name, tmp_path
):
    tools = Toolchain(name)
    crate = harness.generate(
        harness.read(ROOT / "examples" / "links" / "wheel.yaml"), tmp_path
    )
    run(
        tools.program(
            PROGRAM.with_name("outcome_session.rs"),
            tools.library(crate, *USED),
            tmp_path / "program",
        )
    )


@pytest.mark.parametrize("name", list(toolchains()))
def test_a_message_of_another_node_does_not_compile(shipped, name, tmp_path):
    """Telemetry 132 is `State` on both nodes; it is refused where it is requested, and
    where it is taken from an event.
    """
    tools = Toolchain(name)
    library = Toolchain(name).library(shipped.crate, *USED)

    def compiled(text: str) -> str:
        source = tmp_path / "main.rs"
        source.write_text(WHOLE % text)
        command = (
            *tools.start,
            "rustc",
            "--edition",
            "2021",
            "--emit",
            "metadata",
            "-C",
            "panic=abort",
        )
        options = ("--extern", f"icd={library}", "--out-dir", tmp_path, source)
        return subprocess.run(
            [*command, *map(str, options)], capture_output=True, text=True
        ).stderr

    for use, statement in STATEMENTS.items():
        assert "error" not in compiled(statement % OWN[use]), use
        said = compiled(statement % OTHERS[use])
        assert (
            "error[E0277]" in said
            and "Of<icd::cubeacp::Node>` is not satisfied"
            in said.replace("Of<Node>", "Of<icd::cubeacp::Node>")
        ), (use, said)
