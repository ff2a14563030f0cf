"""Measure a message of variable length, UBX NAV-SAT with 32 satellites: generated code,
hand-written code, Kaitai Struct and pyubx2.

Usage::

    pip install kaitaistruct pyubx2 && python bench/nav_sat.py [--rounds 40]

C and Rust are measured in instructions (valgrind), compared with hand-written code;
both check length and count. Python is measured in time: each round calls all candidates
in turn, and the result is the median of the rounds' ratios. The hand-written Python
code uses `struct` and returns objects with the same attributes. The Kaitai class is
equal to the output of its compiler. pyubx2 decodes the payload without searching for it
in a stream.
"""

from __future__ import annotations

import argparse
import os
import random
import re
import struct
import subprocess
import sys
import tempfile
from importlib import import_module
from pathlib import Path
from timeit import Timer
from typing import Any

from icdgen.backends.c import CBackend
from icdgen.backends.python import PythonBackend
from icdgen.backends.rust import RustBackend
from icdgen.loading import load
from icdgen.render import Renderer

BENCH = Path(__file__).parent
sys.path.insert(0, str(BENCH))
from python_decode import PACKAGE, in_turn, is_installed, ratio  # noqa: E402
from python_others import by_kaitaistruct  # noqa: E402
from rust_instructions import MANIFEST, counts  # noqa: E402

SATELLITES, CALLS = 32, 100

C_CALLS = """\
#include "ublox.h"
icd_status_t ours_decode(ublox_nav_sat_t *m, const uint8_t *b, size_t n);
icd_status_t ours_encode(const ublox_nav_sat_t *m, uint8_t *b, size_t n);
icd_status_t ours_decode(ublox_nav_sat_t *m, const uint8_t *b, size_t n) { return ublox_nav_sat_decode(m, b, n); }
icd_status_t ours_encode(const ublox_nav_sat_t *m, uint8_t *b, size_t n) { return ublox_nav_sat_encode(m, b, n); }
"""
C_MAIN = """\
#include "ublox.h"
#include <stdio.h>
#include <stdlib.h>
icd_status_t ours_decode(ublox_nav_sat_t *m, const uint8_t *b, size_t n);
icd_status_t ours_encode(const ublox_nav_sat_t *m, uint8_t *b, size_t n);
int hand_decode(ublox_nav_sat_t *m, const uint8_t *b, size_t n);
void hand_encode(const ublox_nav_sat_t *m, uint8_t *b);
int main(void)
{
    static uint8_t frame[] = {%s}, again[sizeof frame], other[sizeof frame];
    static ublox_nav_sat_t generated, by_hand;
    for (int n = 0; n < %d; ++n) {
        if (ours_decode(&generated, frame, sizeof frame) != ICD_OK || hand_decode(&by_hand, frame, sizeof frame) != 0 ||
            memcmp(&generated, &by_hand, sizeof generated) != 0) {
            abort();
        }
        hand_encode(&by_hand, other);
        if (ours_encode(&generated, again, sizeof again) != ICD_OK || memcmp(again, other, sizeof again) != 0) {
            abort();
        }
    }
    return 0;
}
"""
RUST_MAIN = """\
#[path = "{by_hand}"]
pub mod by_hand;

#[inline(never)]
pub fn generated_1(bytes: &[u8]) -> Result<icd::ublox::NavSat, icd::Error> {{
    icd::ublox::NavSat::from_bytes(bytes)
}}

#[inline(never)]
pub fn by_hand_1(bytes: &[u8]) -> Result<by_hand::NavSat, by_hand::WrongLength> {{
    by_hand::decode(bytes)
}}

fn main() {{
    let frame = std::hint::black_box([{frame}_u8]);
    for _ in 0..{calls} {{
        let _ = std::hint::black_box(generated_1(&frame));
        let _ = std::hint::black_box(by_hand_1(&frame));
    }}
}}
"""


def frame_of(count: int) -> bytes:
    """Return a frame with valid systems, equal in every run."""
    source = random.Random(count)
    systems = [
        bytes([source.randrange(8)]) + source.randbytes(7) + source.randbytes(3) + b"\3"
        for _ in range(count)
    ]
    flags = [
        satellite[:9] + bytes([satellite[9] & 0x7F]) + satellite[10:]
        for satellite in systems
    ]  # a bit is reserved
    return struct.pack("<IBBxx", 123456789, 1, count) + b"".join(flags)


def generate(folder: Path, backend: Any) -> Path:
    icd = load([BENCH.parent / "examples" / "devices" / "ublox"]).icd
    for path, text in backend.files(icd, Renderer(backend.name)):
        file = folder / backend.name / path
        file.parent.mkdir(parents=True, exist_ok=True)
        file.write_text(text, encoding="utf-8")
    return folder / backend.name


def c(folder: Path, frame: bytes) -> dict[str, float]:
    """Return the instructions per call of each C function."""
    source = generate(folder, CBackend())
    (folder / "main.c").write_text(C_MAIN % (", ".join(map(str, frame)), CALLS))
    (folder / "ours.c").write_text(C_CALLS)
    objects = []
    for file in (folder / "main.c", folder / "ours.c", BENCH / "nav_sat_by_hand.c"):
        objects.append(folder / f"{file.stem}.o")
        subprocess.run(
            ["gcc", "-std=c99", "-O2", f"-I{source}", "-c", file, "-o", objects[-1]],
            check=True,
        )
    subprocess.run(["gcc", *objects, "-o", folder / "bench"], check=True)
    out = folder / "counts"
    valgrind = [
        "valgrind",
        "--tool=callgrind",
        f"--callgrind-out-file={out}",
        folder / "bench",
    ]
    subprocess.run(valgrind, check=True, capture_output=True)
    annotate = ["callgrind_annotate", "--inclusive=yes", "--threshold=100", out]
    text = subprocess.run(annotate, check=True, capture_output=True, text=True).stdout
    lines = re.findall(r"^\s*([\d,]+) .*?:((?:hand|ours)_(?:de|en)code)\b", text, re.M)
    return {name: int(count.replace(",", "")) / CALLS for count, name in lines}


def rust(folder: Path, frame: bytes) -> dict[str, float]:
    """Return the instructions per call of each Rust decoder."""
    generate(folder, RustBackend())
    home = folder / "program"
    (home / "src").mkdir(parents=True)
    by_hand = (BENCH / "nav_sat_by_hand.rs").resolve()
    text = RUST_MAIN.format(
        by_hand=by_hand, frame="_u8, ".join(map(str, frame)), calls=CALLS
    )
    (home / "src" / "main.rs").write_text(text, encoding="utf-8")
    (home / "Cargo.toml").write_text(MANIFEST.format(opt=3), encoding="utf-8")
    target = Path(os.environ.get("CARGO_TARGET_DIR", folder / "target"))
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
    return counts(target / "release" / "bench", folder)


class Satellite:
    """Satellite as in hand-written code, with its flags as attributes."""

    __slots__ = (
        "gnss_id", "sv_id", "cno", "elev", "azim", "pr_res", "quality_ind", "sv_used", "health", "diff_corr", "smoothed",
        "orbit_source", "eph_avail", "alm_avail", "ano_avail", "aop_avail", "sbas_corr_used", "rtcm_corr_used",
        "slas_corr_used", "spartn_corr_used", "pr_corr_used", "cr_corr_used", "do_corr_used", "clas_corr_used",
        "lpp_corr_used", "has_corr_used",
    )  # fmt: skip

    def __init__(self, fields: tuple[int, ...]) -> None:
        self.gnss_id, self.sv_id, self.cno, self.elev, self.azim, self.pr_res, flags = (
            fields
        )
        self.quality_ind = flags & 7
        self.sv_used = bool(flags >> 3 & 1)
        self.health = flags >> 4 & 3
        self.diff_corr = bool(flags >> 6 & 1)
        self.smoothed = bool(flags >> 7 & 1)
        self.orbit_source = flags >> 8 & 7
        self.eph_avail = bool(flags >> 11 & 1)
        self.alm_avail = bool(flags >> 12 & 1)
        self.ano_avail = bool(flags >> 13 & 1)
        self.aop_avail = bool(flags >> 14 & 1)
        self.sbas_corr_used = bool(flags >> 16 & 1)
        self.rtcm_corr_used = bool(flags >> 17 & 1)
        self.slas_corr_used = bool(flags >> 18 & 1)
        self.spartn_corr_used = bool(flags >> 19 & 1)
        self.pr_corr_used = bool(flags >> 20 & 1)
        self.cr_corr_used = bool(flags >> 21 & 1)
        self.do_corr_used = bool(flags >> 22 & 1)
        self.clas_corr_used = bool(flags >> 23 & 1)
        self.lpp_corr_used = bool(flags >> 24 & 1)
        self.has_corr_used = bool(flags >> 25 & 1)


def by_hand(frame: bytes) -> tuple[int, int, list[Satellite]]:
    """Decode a frame into time, version and satellites."""
    time, version, count = struct.unpack_from("<IBB", frame)
    if len(frame) != 8 + 12 * count:
        raise ValueError("length")
    return (
        time,
        version,
        [Satellite(fields) for fields in struct.iter_unpack("<BBBbhhI", frame[8:])],
    )


def python(folder: Path, frame: bytes, rounds: int) -> dict[str, list[float]]:
    """Return the seconds per call of each candidate, by round."""
    sys.path.insert(0, str(generate(folder, PythonBackend())))
    cls = import_module(f"{PACKAGE}.ublox").NavSat
    calls = {"ours": cls.from_bytes, "by hand": by_hand}
    if is_installed("kaitaistruct"):
        calls["Kaitai"] = by_kaitaistruct(cls)
    if is_installed("pyubx2"):
        from pyubx2 import GET, UBXMessage

        calls["pyubx2"] = lambda frame: UBXMessage(b"\x01", b"\x35", GET, payload=frame)
    read = cls.from_bytes(frame)
    expected = [
        (
            satellite.sv_id,
            satellite.azim,
            satellite.quality_ind,
            satellite.has_corr_used,
        )
        for satellite in read.satellites
    ]
    assert expected == [
        (
            satellite.sv_id,
            satellite.azim,
            satellite.quality_ind,
            satellite.has_corr_used,
        )
        for satellite in by_hand(frame)[2]
    ]
    if "Kaitai" in calls:
        assert expected == [
            (
                satellite.sv_id,
                satellite.azim,
                satellite.quality_ind,
                satellite.has_corr_used,
            )
            for satellite in calls["Kaitai"](frame).satellites
        ]
    timers = {
        name: Timer("call(frame)", globals={"call": call, "frame": frame})
        for name, call in calls.items()
    }
    timers["ours, encode"] = Timer("call()", globals={"call": read.to_bytes})
    return in_turn(timers, rounds)


def main() -> None:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--rounds", type=int, default=40)
    options = parser.parse_args()
    frame = frame_of(SATELLITES)
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        counted = c(folder, frame)
        in_rust = rust(folder, frame)
        times = python(folder, frame, options.rounds)
    print("| instructions | generated | by hand | ratio |\n|---|---|---|---|")
    rows = {
        f"C, {what}": (counted[f"ours_{what}"], counted[f"hand_{what}"])
        for what in ("decode", "encode")
    }
    rows["Rust, decode"] = in_rust["generated_1"], in_rust["by_hand_1"]
    for name, (ours, theirs) in rows.items():
        print(f"| {name} | {ours:.0f} | {theirs:.0f} | {ours / theirs:.2f} |")
    print("\n| Python | us | times generated decoding |\n|---|---|---|")
    for name, seconds in times.items():
        print(
            f"| {name} | {sorted(seconds)[len(seconds) // 2] * 1e6:.1f} | {ratio(seconds, times['ours']):.2f} |"
        )


if __name__ == "__main__":
    main()
