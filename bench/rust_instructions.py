"""Count the instructions per call of the generated Rust decoders and of hand-written
code (``rust_by_hand.rs``).

Usage::

    python bench/rust_instructions.py [--opt 3] [--check]

The counts come from valgrind --tool=callgrind and do not depend on the load of the
machine. Both sides check the length and return a ``Result``. The generated side also
converts raw values to enumerations; the hand-written side leaves them as bytes. Rust
1.66 or later is required (``black_box``). With ``--check``, the exit status is 1 if a
limit is exceeded.
"""

from __future__ import annotations

import argparse
import os
import re
import subprocess
import sys
import tempfile
from pathlib import Path

from icdgen.backends.rust import RustBackend
from icdgen.loading import load
from icdgen.render import Renderer

BENCH = Path(__file__).parent
CALLS = 100
# Telemetry id -> type, and the instructions of hand-written code on one x86-64 machine.
FRAMES = {
    132: ("CurrentAdcsState", 100),
    190: ("AdcsState", 130),
    206: ("AdcsConfiguration", 211),
    207: ("Sgp4OrbitParameters", 13),
    146: ("EstimatedAttitudeAngles", 9),
}

MANIFEST = """\
[package]
name = "bench"
version = "0.0.0"
edition = "2021"

[dependencies]
icd = {{ path = "../rust" }}

[profile.release]
opt-level = {opt}
panic = "abort"
debug = 1

[workspace]
"""
FUNCTIONS = """
#[inline(never)]
pub fn generated_{id}(bytes: &[u8]) -> Result<icd::cubeacp::{type}, icd::Error> {{
    icd::cubeacp::{type}::from_bytes(bytes)
}}

#[inline(never)]
pub fn by_hand_{id}(bytes: &[u8]) -> Result<by_hand::Hand{id}, by_hand::WrongLength> {{
    by_hand::decode_{id}(bytes)
}}
"""
CALL = """
        let frame = std::hint::black_box(&bytes[..icd::cubeacp::{type}::LENGTH]);
        let _ = std::hint::black_box(generated_{id}(frame));
        let _ = std::hint::black_box(by_hand_{id}(frame));
"""
PROGRAM = """\
#[path = "{by_hand}"]
pub mod by_hand;
{functions}
fn main() {{
    let mut bytes = [0_u8; 1024];
    let mut state = 1_u32;
    for _ in 0..{calls} {{
        for byte in &mut bytes {{
            state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            *byte = (state >> 24) as u8;
        }}
{calls_of_all}
    }}
}}
"""


def build(folder: Path, opt: str, target: Path) -> Path:
    """Build the program with both decoders of each frame, and return its path."""
    icd = load([BENCH.parent / "icd"], check=False).icd
    for path, text in RustBackend().files(icd, Renderer("rust")):
        file = folder / "rust" / path
        file.parent.mkdir(parents=True, exist_ok=True)
        file.write_text(text, encoding="utf-8")
    functions = "".join(
        FUNCTIONS.format(id=id, type=type) for id, (type, _) in FRAMES.items()
    )
    calls = "".join(CALL.format(id=id, type=type) for id, (type, _) in FRAMES.items())
    by_hand = (BENCH / "rust_by_hand.rs").resolve()
    # Next to the crate: inside of it, cargo would need the crate's optional
    # dependencies
    home = folder / "program"
    (home / "src").mkdir(parents=True, exist_ok=True)
    program = PROGRAM.format(
        functions=functions, calls=CALLS, calls_of_all=calls, by_hand=by_hand
    )
    (home / "src" / "main.rs").write_text(program, encoding="utf-8")
    (home / "Cargo.toml").write_text(MANIFEST.format(opt=opt), encoding="utf-8")
    command = [
        "cargo",
        "build",
        "--quiet",
        "--offline",
        "--release",
        "--target-dir",
        str(target),
    ]
    subprocess.run(command, cwd=home, check=True)
    return target / "release" / "bench"


def counts(program: Path, folder: Path) -> dict[str, float]:
    """Return the instructions per call of each decoder, called functions included."""
    file = folder / "callgrind.out"
    command = [
        "valgrind",
        "--tool=callgrind",
        "--quiet",
        f"--callgrind-out-file={file}",
        str(program),
    ]
    subprocess.run(command, check=True, stderr=subprocess.DEVNULL)
    cost_by_function: dict[str, int] = {}
    names: dict[str, str] = {}
    current = ""
    for line in file.read_text().splitlines():
        if line.startswith(("fn=", "cfn=")):
            number, _, name = line.partition("=")[2].partition(" ")
            name = names.setdefault(number, name)
            current = name if line.startswith("fn=") else current
        elif re.match(r"[-+*0-9]", line):
            # Own instructions, or after `calls=` those of the called function
            cost_by_function[current] = cost_by_function.get(current, 0) + int(
                line.split()[1]
            )
    return {
        match.group(1): cost / CALLS
        for name, cost in cost_by_function.items()
        if (match := re.search(r"((?:generated|by_hand)_\d+)", name))
    }


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument(
        "--opt", default="3", help="opt-level: 3 (default), 2, '\"s\"' ..."
    )
    parser.add_argument("--check", action="store_true")
    options = parser.parse_args()
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        target = Path(os.environ.get("CARGO_TARGET_DIR", folder / "target"))
        measured = counts(build(folder, options.opt, target), folder)
    print("| frame | generated | by hand | ratio | limit |\n|---|---|---|---|---|")
    missed = False
    for id, (_, limit) in FRAMES.items():
        ours, theirs = measured[f"generated_{id}"], measured[f"by_hand_{id}"]
        missed |= ours > limit
        print(f"| {id} | {ours:.0f} | {theirs:.0f} | {ours / theirs:.2f} | {limit} |")
    sys.exit(options.check and missed)


if __name__ == "__main__":
    main()
