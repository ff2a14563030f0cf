"""Rust: optimised, and with the checks of a debug build, where an overflow of integers
is a panic.
"""

from __future__ import annotations

from functools import partial
from pathlib import Path

from tests.conformance.build import BuildError, execute
from tests.conformance.languages import Language

BACKENDS = ("rust", "rust-testee")


def build(source: Path, out: Path, profile: str) -> list[str]:
    """Builds the testee, a package beside the crate.

    Nothing but the crate is compiled, but cargo wants to know the versions of what is
    optional, so the network may be needed once.
    """
    manifest = source / "rust-testee" / "Cargo.toml"
    command = [
        "cargo",
        "build",
        "--quiet",
        "--profile",
        profile,
        "--manifest-path",
        manifest,
        "--target-dir",
        out,
    ]
    try:
        execute(*command, "--offline")
    except BuildError:
        execute(*command)
    return [str(out / ("debug" if profile == "dev" else profile) / "testee")]


LANGUAGES = [
    Language("rust", BACKENDS, ("cargo", "rustc"), partial(build, profile="release")),
    Language("rust-debug", BACKENDS, ("cargo", "rustc"), partial(build, profile="dev")),
]
