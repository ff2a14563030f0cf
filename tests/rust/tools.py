"""Run the Rust tools of this machine: rustc, rustfmt, clippy and rustdoc.

The functions call the tools directly, without cargo, so no registry is needed.
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
# The edition with which rustdoc compiles all examples together, and the oldest Rust
# that supports it.
MERGING = "2024"
MERGES = (1, 85)
STD = ("--cfg", 'feature="std"')  # compiles the crate with its feature `std`
# Options of the crate for programs of tests. All tests use the same options, so that
# the crate is compiled once. Examples in documentation need a crate that can unwind.
USED = ("0", "-C", "panic=unwind", *STD)


def run(
    *command: str | Path, cwd: Path | None = None, **environment: str | Path
) -> str:
    """Run a tool and return its output; fail with its messages if it fails."""
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
    """Return the words before a tool's name, by toolchain.

    The toolchains are the default one of the machine, and the oldest supported one if
    it is installed.
    """
    commands: dict[str, tuple[str, ...]] = {"default": ()}
    if shutil.which("rustup") and _works("rustup", "run", OLDEST, "rustc", "--version"):
        commands[OLDEST] = ("rustup", "run", OLDEST)
    return commands


def _works(*command: str) -> bool:
    return subprocess.run(command, capture_output=True).returncode == 0


class Toolchain:
    """Tools of one toolchain."""

    def __init__(self, name: str) -> None:
        self.start = toolchains()[name]

    def formatted(self, file: Path) -> None:
        """Fail if rustfmt would change the crate of ``file``."""
        run(*self.start, "rustfmt", "--edition", "2021", "--check", file)

    def linted(self, file: Path, out: Path, *options: str) -> None:
        """Fail if clippy reports a warning; pedantic lints are enabled."""
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
        """Fail if rustdoc reports a warning."""
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
        """Major and minor version of the compiler."""
        major, minor = run(*self.start, "rustc", "--version").split()[1].split(".")[:2]
        return int(major), int(minor)

    @property
    def merges(self) -> bool:
        """Report whether rustdoc can compile all examples together (edition 2024)."""
        return self.version >= MERGES

    def tested(self, file: Path, library: Path, only: str = "") -> str:
        """Run the examples in the documentation of a crate; fail if an example fails.

        Returns the output of rustdoc. ``library`` must be compiled with `STD`. ``only``
        selects files whose path contains it. The edition is that of the examples, not
        that of the crate.
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
        """Compile the crate with a level of optimisation and return the library.

        The library comes from the cache if the crate was compiled before.
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
                new = out / "made"
                run(*command, "--out-dir", new, file)
                (new / "libicd.rlib").rename(out / "libicd.rlib")
        return out / "libicd.rlib"

    def program(self, file: Path, library: Path, out: Path) -> Path:
        """Compile a program that uses the library and return its path."""
        options = ("-C", "panic=abort", "--extern", f"icd={library}")
        run(*self._rustc("program"), *options, "-o", out, file)
        return out

    def freestanding(self, file: Path, library: Path, out: Path, level: str) -> Path:
        """Compile a static library with link-time optimisation; return the archive."""
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
        """Compile a static library of one file and return the archive."""
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
