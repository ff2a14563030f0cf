"""The Rust tools of this machine, without a registry: rustc, rustfmt, clippy and
rustdoc are called themselves.
"""

from __future__ import annotations

import hashlib
import os
import shutil
import subprocess
from functools import cache
from pathlib import Path

from tests.conformance.build import cache_folder, locked_folder

OLDEST = "1.63"
MERGING = "2024"
MERGES = (1, 85)  # the oldest that knows that edition
STD = ("--cfg", 'feature="std"')  # the crate with the feature
# How a crate is compiled for programs of tests, the same for all, so that it is
# compiled once. Examples in documentation need a crate that can unwind.
USED = ("0", "-C", "panic=unwind", *STD)


def run(
    *command: str | Path, cwd: Path | None = None, **environment: str | Path
) -> str:
    """Runs a tool; its output. Fails with what it says."""
    words = [str(word) for word in command]
    done = subprocess.run(
        words,
        cwd=cwd,
        env={**os.environ, **environment},
        capture_output=True,
        text=True,
    )
    assert done.returncode == 0, (
        f"{' '.join(words)}\n{(done.stdout + done.stderr)[:6000]}"
    )
    return done.stdout


@cache
def toolchains() -> dict[str, tuple[str, ...]]:
    """What to put before a tool's name: for the machine's own toolchain, and for the
    oldest supported one if it is there.
    """
    found: dict[str, tuple[str, ...]] = {"default": ()}
    if shutil.which("rustup") and _works("rustup", "run", OLDEST, "rustc", "--version"):
        found[OLDEST] = ("rustup", "run", OLDEST)
    return found


def _works(*command: str) -> bool:
    return subprocess.run(command, capture_output=True).returncode == 0


class Toolchain:
    """The tools of one toolchain."""

    def __init__(self, name: str) -> None:
        self.start = toolchains()[name]

    def formatted(self, file: Path) -> None:
        """Fails unless rustfmt would leave the crate of ``file`` as it is."""
        run(*self.start, "rustfmt", "--edition", "2021", "--check", file)

    def linted(self, file: Path, out: Path, *options: str) -> None:
        """Fails if clippy has anything to say, pedantic lints included."""
        lints = ("-D", "warnings", "-W", "clippy::pedantic")
        command = (
            *self.start,
            "clippy-driver",
            "--edition",
            "2021",
            "--emit",
            "metadata",
            "--out-dir",
            out,
            *options,
            *lints,
        )
        run(*command, file, CARGO_PKG_RUST_VERSION=OLDEST)

    def documented(self, file: Path, out: Path, *options: str) -> None:
        """Fails if rustdoc has anything to say."""
        command = (
            *self.start,
            "rustdoc",
            "--edition",
            "2021",
            "--crate-name",
            "icd",
            "-D",
            "warnings",
        )
        run(*command, *options, "-o", out, file)

    @property
    def version(self) -> tuple[int, int]:
        """Of the compiler: major and minor."""
        major, minor = run(*self.start, "rustc", "--version").split()[1].split(".")[:2]
        return int(major), int(minor)

    @property
    def merges(self) -> bool:
        """Whether rustdoc compiles all examples in one go, which it does as of the
        edition 2024 of theirs.
        """
        return self.version >= MERGES

    def tested(self, file: Path, library: Path, only: str = "") -> str:
        """Runs the examples in the documentation of a crate that was compiled with
        `STD`; what rustdoc says.

        Fails if one does.

        ``only`` is a part of the paths of the files that are looked at. The edition is
        the examples', not the crate's.
        """
        edition = MERGING if self.merges else "2021"
        command = (
            *self.start,
            "rustdoc",
            "--test",
            "--edition",
            edition,
            "--crate-name",
            "icd",
            "--test-args",
            only,
        )
        return run(*command, *STD, "--extern", f"icd={library}", file)

    def library(self, file: Path, level: str, *more: str) -> Path:
        """Compiles the crate, optimised to that level; its file.

        What was compiled before is taken from the cache.
        """
        options = (
            "--crate-type",
            "lib",
            "-C",
            "panic=abort",
            "-C",
            f"opt-level={level}",
        )
        command = (*self._rustc("icd"), *options, *more)
        digest = hashlib.sha256("\0".join([*command, *map(str, self.version)]).encode())
        for source in sorted(file.parent.rglob("*.rs")):
            digest.update(
                f"\0{source.relative_to(file.parent)}\0".encode() + source.read_bytes()
            )
        with locked_folder(
            cache_folder() / f"library-{digest.hexdigest()[:16]}"
        ) as out:
            if not (out / "libicd.rlib").exists():
                made = out / "made"
                run(*command, "--out-dir", made, file)
                (made / "libicd.rlib").rename(out / "libicd.rlib")
        return out / "libicd.rlib"

    def program(self, file: Path, library: Path, out: Path) -> Path:
        """Compiles a program that uses the library; its file."""
        options = ("-C", "panic=abort", "--extern", f"icd={library}")
        run(*self._rustc("program"), *options, "-o", out, file)
        return out

    def freestanding(self, file: Path, library: Path, out: Path, level: str) -> Path:
        """Compiles a library that stands alone, optimised as a whole; its archive."""
        options = (
            "--crate-type",
            "staticlib",
            "-C",
            "panic=abort",
            "-C",
            "lto=fat",
            "-C",
            "codegen-units=1",
        )
        start = self._rustc("everything")
        run(
            *start,
            *options,
            "-C",
            f"opt-level={level}",
            "--extern",
            f"icd={library}",
            "-o",
            out,
            file,
        )
        return out

    def alone(self, file: Path, out: Path) -> Path:
        """Compiles a library of one file that stands alone; its archive."""
        run(
            *self._rustc("alone"),
            "--crate-type",
            "staticlib",
            "-C",
            "panic=abort",
            "-o",
            out,
            file,
        )
        return out

    def _rustc(self, name: str) -> tuple[str, ...]:
        return (
            *self.start,
            "rustc",
            "--edition",
            "2021",
            "--crate-name",
            name,
            "-D",
            "warnings",
        )
