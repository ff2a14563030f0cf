"""Measure the code size of generated Rust on a Cortex-M4: the dispatcher of all
telemetry, and a client that requests one frame.

Usage::

    rustup target add thumbv7em-none-eabihf && python bench/rust_sizes.py [--opt s]

Each program is a static library with link-time optimization. Functions of the compiler
(memcpy, division) are not counted, as in ``c_units.py``.
"""

from __future__ import annotations

import argparse
import subprocess
import tempfile
from pathlib import Path

from icdgen.backends.rust import RustBackend
from icdgen.loading import load
from icdgen.render import Renderer

BENCH = Path(__file__).parent
TARGET = "thumbv7em-none-eabihf"
HEAD = """\
#![no_std]
#[panic_handler]
fn panic(_: &core::panic::PanicInfo) -> ! {
    loop {}
}
"""
DISPATCHER = """\
#[no_mangle]
pub fn dispatch(id: u8, bytes: &[u8]) -> Result<icd::cubeacp::Telemetry, icd::Error> {
    icd::cubeacp::Telemetry::from_bytes(id, bytes)
}
"""
CLIENT = """\
use icd::cubeacp::{EstimatedAttitudeAngles, Node, LINK, LONGEST};
use icd::wire::{uart, Client, Error};

type Device = Client<Node, uart::Line<LONGEST>, 1>;

#[no_mangle]
pub fn unit_begin(client: &mut Option<Device>, now: u32) -> Result<(), Error> {
    client.insert(Client::uart(&LINK)?).request::<EstimatedAttitudeAngles>(now)
}

#[no_mangle]
pub fn unit_send<'a>(client: &mut Device, line: &'a mut [u8]) -> Option<&'a [u8]> {
    client.output(line).ok().flatten()
}

#[no_mangle]
pub fn unit_receive(client: &mut Device, now: u32, bytes: &[u8], roll: &mut i16) {
    client.received(now, bytes, |event| {
        if let Some(angles) = event.message::<EstimatedAttitudeAngles>() {
            *roll = angles.estimated_roll_angle;
        }
    });
}
"""
PROGRAMS = {"dispatcher": DISPATCHER, "client": CLIENT}


def compiled(folder: Path, opt: str, name: str, *more: str) -> None:
    """Compile ``name.rs`` of the folder, or the file among the options."""
    command = [
        "rustc",
        "--edition",
        "2021",
        "--target",
        TARGET,
        "-C",
        "panic=abort",
        "-C",
        f"opt-level={opt}",
    ]
    subprocess.run(
        [*command, "--crate-name", name, "--out-dir", str(folder), *more], check=True
    )


def text_bytes(folder: Path, name: str) -> int:
    """Return the bytes of code and constants of the program itself."""
    archive = folder / f"lib{name}.a"
    names = subprocess.run(
        ["arm-none-eabi-ar", "t", archive], check=True, capture_output=True, text=True
    ).stdout.split()
    own = next(
        member for member in names if member.removeprefix("lib").startswith(f"{name}.")
    )
    subprocess.run(["arm-none-eabi-ar", "x", archive, own], cwd=folder, check=True)
    size = subprocess.run(
        ["arm-none-eabi-size", folder / own], check=True, capture_output=True, text=True
    ).stdout
    return int(size.splitlines()[1].split()[0])


def main() -> None:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--opt", default="s")
    opt = parser.parse_args().opt
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        for path, text in RustBackend().files(
            load([BENCH.parent / "icd"], check=False).icd, Renderer("rust")
        ):
            (folder / path).parent.mkdir(parents=True, exist_ok=True)
            (folder / path).write_text(text, encoding="utf-8")
        compiled(
            folder, opt, "icd", "--crate-type", "lib", str(folder / "src" / "lib.rs")
        )
        for program, source in PROGRAMS.items():
            file = folder / f"{program}.rs"
            file.write_text(HEAD + source, encoding="utf-8")
            options = (
                "--crate-type",
                "staticlib",
                "-C",
                "lto=fat",
                "-C",
                "codegen-units=1",
            )
            compiled(
                folder,
                opt,
                program,
                *options,
                "--extern",
                f"icd={folder / 'libicd.rlib'}",
                str(file),
            )
            print(f"{program}: {text_bytes(folder, program)} bytes")


if __name__ == "__main__":
    main()
