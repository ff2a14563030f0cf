"""Compare the packet decoder in Rust with the framer of the crate `sbp` of Swift
Navigation, on one stream.

Usage::

    python bench/stream_decoders_sbp.py [--messages 2000] [--noise 0.1]

The program needs cargo and its registry. Both get the same bytes and must find all
messages: icdgen by the packet format of `examples/links/sbp.yaml` with messages of 0 to
255 bytes, `sbp` with its check of the checksum, as in its message reader. Times are
processor times, taking turns, as the minimum of many rounds.
"""

from __future__ import annotations

import argparse
import random
import subprocess
import tempfile
from pathlib import Path

import yaml

from icdgen.backends.rust import RustBackend
from icdgen.loading import load
from icdgen.render import Renderer

ROOT = Path(__file__).parent.parent
IDS = range(0x0100, 0x0114)
MANIFEST = """\
[package]
name = "bench"
version = "0.0.0"
edition = "2021"
[dependencies]
icd = { path = "icd" }
sbp = "6"
[profile.release]
debug = false
[workspace]
"""
MAIN = """\
use icd::{positioner::{LINK, LONGEST}, wire::{stream::{Decoder, Event}, Direction}};
use std::io::Read;
extern "C" { fn clock() -> std::os::raw::c_long; }
fn ours(stream: &[u8]) -> usize {
    let mut decoder = Decoder::<LONGEST, 1>::new(&LINK, Direction::Telemetry).unwrap();
    let mut found = 0;
    for piece in stream.chunks(4096) {
        decoder.feed(piece, |event| found += usize::from(matches!(event, Event::Message { .. })));
    }
    found
}
fn theirs(stream: &[u8]) -> usize {
    sbp::iter_frames(stream).filter(|one| one.as_ref().map_or(false, |frame| frame.check_crc().is_ok())).count()
}
fn main() {
    let rounds: usize = std::env::args().nth(1).unwrap().parse().unwrap();
    let mut stream = Vec::new();
    std::io::stdin().read_to_end(&mut stream).unwrap();
    let (mut least, mut found) = ([i64::MAX; 2], [0; 2]);
    for _ in 0..rounds {
        for (which, decode) in [ours as fn(&[u8]) -> usize, theirs].into_iter().enumerate() {
            let begin = unsafe { clock() };
            for _ in 0..10 { found[which] = decode(&stream); }
            least[which] = least[which].min((unsafe { clock() } - begin) as i64);
        }
    }
    println!("{} {} {} {}", found[0], found[1], least[0], least[1]);
}
"""


def stream(messages: int, noise: float, chance: random.Random) -> bytes:
    """Return frames of random ids and data, with noise between some of them.

    No noise byte starts a frame.
    """
    output = bytearray()
    for _ in range(messages):
        data = chance.randbytes(chance.randrange(256))
        body = (
            chance.choice(IDS).to_bytes(2, "little")
            + b"\x42\0"
            + bytes([len(data)])
            + data
        )
        output += b"\x55" + body + _crc(body).to_bytes(2, "little")
        if chance.random() < noise:
            output += bytes(byte for byte in chance.randbytes(40) if byte != 0x55)
    return bytes(output)


def _crc(data: bytes) -> int:
    value = 0
    for byte in data:
        value ^= byte << 8
        for _ in range(8):
            value = (value << 1 ^ (0x1021 if value & 0x8000 else 0)) & 0xFFFF
    return value


def build(folder: Path) -> Path:
    """Build the program with both decoders, and return its path."""
    tree = yaml.safe_load(
        (ROOT / "examples" / "links" / "sbp.yaml").read_text(encoding="utf-8")
    )
    field = {"at": 0, "name": "Data", "type": "bytes", "size": "rest", "up_to": 255}
    tree["messages"] = [
        {
            "name": f"Message {id}",
            "id": id,
            "kind": "telemetry",
            "length": 0,
            "fields": [dict(field)],
        }
        for id in IDS
    ]
    (folder / "sbp.yaml").write_text(
        yaml.safe_dump(tree, sort_keys=False), encoding="utf-8"
    )
    loaded = load([folder / "sbp.yaml"])
    assert loaded.ok, loaded.findings
    for path, text in RustBackend().files(loaded.icd, Renderer("rust")):
        (folder / "icd" / path).parent.mkdir(parents=True, exist_ok=True)
        (folder / "icd" / path).write_text(text, encoding="utf-8")
    (folder / "src").mkdir()
    (folder / "src" / "main.rs").write_text(MAIN)
    (folder / "Cargo.toml").write_text(MANIFEST)
    subprocess.run(["cargo", "build", "--release", "--quiet"], cwd=folder, check=True)
    return folder / "target" / "release" / "bench"


def main() -> None:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--messages", type=int, default=2000)
    parser.add_argument(
        "--noise", type=float, default=0.1, help="after how many frames noise follows"
    )
    parser.add_argument("--rounds", type=int, default=50)
    options = parser.parse_args()
    data = stream(options.messages, options.noise, random.Random(1))
    with tempfile.TemporaryDirectory() as name:
        program = build(Path(name))
        words = subprocess.run(
            [program, str(options.rounds)], input=data, capture_output=True, check=True
        ).stdout
    ours, theirs, *least = (int(word) for word in words.split())
    print(
        f"{len(data):,} bytes, {options.messages:,} messages; found {ours} and {theirs}"
    )
    for title, spent in zip(("ours", "the crate sbp"), least, strict=True):
        speed = 10 * len(data) / spent
        print(f"{title}: {speed:.0f} MB/s, {least[1] / spent:.2f} times theirs")


if __name__ == "__main__":
    main()
