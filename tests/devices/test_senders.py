"""Senders of C, Rust and Python count sequence numbers and use the given header values
alike.

All three must send the same bytes.
"""

from __future__ import annotations

import subprocess

import pytest

from icdgen.protocol import facts
from icdgen.runtime_objects.links import link_of
from tests.c import harness as c
from tests.conformance.icds import icd_of
from tests.conftest import ROOT
from tests.rust import harness as rust
from tests.rust.tools import USED, Toolchain, run

ICD = icd_of([ROOT / "examples" / "links"])
C = """
#include "autopilot.h"
#include "payload.h"
#include <stdio.h>

static int put(const uint8_t *line, size_t size)
{
    for (size_t i = 0; i < size; ++i) {
        (void)printf("%02x", line[i]);
    }
    return printf("\\n") > 0 ? 0 : 1;
}

int main(void)
{
    icd_stream_sender_t sender;
    uint32_t sequences[AUTOPILOT_SEQUENCES + PAYLOAD_SEQUENCES];
    static const uint8_t seven[7] = {0};
    uint8_t data[AUTOPILOT_SET_MODE_LENGTH];
    uint8_t line[AUTOPILOT_LINE_BYTES];
    size_t size = 0;
    autopilot_set_mode_t mode;
    payload_set_exposure_t exposure;
    autopilot_set_mode_init(&mode);
    payload_set_exposure_init(&exposure);
    mode.target_system = 1;
    exposure.exposure = 7;
    if (icd_stream_sender_init(&sender, autopilot_link(), ICD_TELECOMMAND, sequences, AUTOPILOT_SEQUENCES) != ICD_OK) {
        return 1;
    }
    sender.values.of[ICD_FIELD_SOURCE] = 9;
    sender.values.of[ICD_FIELD_SEQUENCE] = 254;
    for (int i = 0; i < 3; ++i) {
        if (autopilot_set_mode_encode(&mode, data, sizeof data) != ICD_OK ||
            icd_stream_send(&sender, AUTOPILOT_SET_MODE_ID, data, sizeof data, line, sizeof line, &size) != ICD_OK ||
            put(line, size) != 0) {
            return 2;
        }
    }
    if (icd_stream_send(&sender, AUTOPILOT_SET_MODE_ID, seven, sizeof seven, line, sizeof line, &size) != ICD_ERROR_LENGTH ||
        icd_stream_sender_init(&sender, payload_link(), ICD_TELECOMMAND, sequences, PAYLOAD_SEQUENCES) != ICD_OK) {
        return 3;
    }
    for (int i = 0; i < 2; ++i) {
        if (payload_set_exposure_encode(&exposure, data, PAYLOAD_SET_EXPOSURE_LENGTH) != ICD_OK ||
            icd_stream_send(
                &sender, PAYLOAD_SET_EXPOSURE_ID, data, PAYLOAD_SET_EXPOSURE_LENGTH, line, sizeof line, &size) != ICD_OK ||
            put(line, size) != 0) {
            return 4;
        }
    }
    return 0;
}
"""
RUST = """
use icd::wire::stream::Sender;
use icd::wire::Error;
use icd::{autopilot, payload};

fn put(line: &[u8]) {
    let text: String = line.iter().map(|byte| format!("{byte:02x}")).collect();
    println!("{text}");
}

fn main() -> Result<(), Error> {
    let mut line = [0; 600];
    let mut sender = Sender::<autopilot::Node, { autopilot::SEQUENCES }>::new(&autopilot::LINK)?;
    sender.values.source = Some(9);
    sender.values.sequence = Some(254);
    let mut mode = autopilot::SetMode::default();
    mode.target_system = 1;
    for _ in 0..3 {
        let size = sender.send(&mode, &mut line)?;
        put(&line[..size]);
    }
    assert!(sender.put(11, &[0; 7], &mut line).is_err());
    let mut sender = Sender::<payload::Node, { payload::SEQUENCES }>::new(&payload::LINK)?;
    let mut exposure = payload::SetExposure::default();
    exposure.exposure = 7;
    for _ in 0..2 {
        let size = sender.send(&exposure, &mut line)?;
        put(&line[..size]);
    }
    Ok(())
}
"""


@pytest.fixture(scope="module")
def expected() -> list[str]:
    """The lines that Python sends."""
    from icdgen_runtime.wire.sender import Sender  # which `icdgen` makes importable

    def sender(node: str, **values: int) -> Sender:
        return Sender(
            link_of(ICD, facts.of(ICD, ICD.node(node))), "telecommand", values
        )

    mode, exposure = sender("autopilot", source=9, sequence=254), sender("payload")
    lines = [mode.encode(11, bytes([0, 0, 0, 0, 1, 0])) for _ in range(3)]
    assert [line[4] for line in lines] == [254, 255, 0] and {
        line[5] for line in lines
    } == {9}
    return [
        line.hex()
        for line in (*lines, *(exposure.encode(0x64, bytes([0, 7])) for _ in range(2)))
    ]


def test_c_counts_the_messages_that_it_sends(expected, tmp_path):
    folder = c.generate(ICD, tmp_path)
    (tmp_path / "send.c").write_text(C)
    options = ("-std=c99", *c.WARNINGS, *c.SANITIZERS, f"-I{folder}")
    program = c.compile(tmp_path / "send.c", *options, output=tmp_path / "send")
    done = subprocess.run([program], capture_output=True, text=True)
    assert (done.returncode, done.stdout.split()) == (0, expected), done.stderr


def test_rust_counts_the_messages_that_it_sends(expected, tmp_path):
    tools, crate = Toolchain("default"), rust.generate(ICD, tmp_path)
    (tmp_path / "send.rs").write_text(RUST)
    program = tools.program(
        tmp_path / "send.rs", tools.library(crate, *USED), tmp_path / "send"
    )
    assert run(program).split() == expected
