"""Sessions of the crate survive errors of their port and cancelled requests.

Messages of other nodes do not compile. The programs that the tests run are files of
this folder.
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
PROGRAM_OF_STATEMENT = """\
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
OWN_NODE = {"request": "cubeacp", "send": "cubeacp::ClearErrors", "message": "cubeacp"}
OTHER_NODE = {
    "request": "bootloader",
    "send": "bootloader::SetBootIndex",
    "message": "bootloader",
}


def test_sessions_survive_errors_of_their_port_and_cancelled_requests(
    shipped, tmp_path
):
    tools = Toolchain("default")
    library = Toolchain("default").library(shipped.crate, *USED)
    run(tools.program(PROGRAM, library, tmp_path / "program"))


@pytest.mark.parametrize("name", list(toolchains()))
def test_sessions_over_framed_links_repeat_requests_receive_and_survive_errors(
    name, tmp_path
):
    tools = Toolchain(name)
    crate = harness.generate(
        harness.read_unchecked(ROOT / "examples" / "links" / "ubx.yaml"), tmp_path
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
    example = re.search(r"```rust\n(match session\.send.*?)```", text, re.S)
    tools = Toolchain("default")
    crate = harness.generate(
        harness.read_unchecked(ROOT / "examples" / "links" / "wheel.yaml"), tmp_path
    )
    (tmp_path / "user.rs").write_text(DOCUMENTED % example[1])
    library = tools.library(crate, *USED)
    tools.program(tmp_path / "user.rs", library, tmp_path / "program")


@pytest.mark.parametrize("name", list(toolchains()))
def test_sessions_return_the_outcome_of_each_telecommand_with_its_reason(
    name, tmp_path
):
    tools = Toolchain(name)
    crate = harness.generate(
        harness.read_unchecked(ROOT / "examples" / "links" / "wheel.yaml"), tmp_path
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
    """Telemetry 132 is `State` on both nodes.

    The compiler refuses a request for it, and access to it in an event.
    """
    tools = Toolchain(name)
    library = Toolchain(name).library(shipped.crate, *USED)

    def compiler_errors(text: str) -> str:
        source = tmp_path / "main.rs"
        source.write_text(PROGRAM_OF_STATEMENT % text)
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
        assert "error" not in compiler_errors(statement % OWN_NODE[use]), use
        diagnostics = compiler_errors(statement % OTHER_NODE[use])
        assert (
            "error[E0277]" in diagnostics
            and "Of<icd::cubeacp::Node>` is not satisfied"
            in diagnostics.replace("Of<Node>", "Of<icd::cubeacp::Node>")
        ), (use, diagnostics)
