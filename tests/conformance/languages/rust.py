"""Rust: optimised, and with the checks of a debug build, where an overflow of integers
is a panic.
"""

from __future__ import annotations

from functools import partial
from pathlib import Path

from tests.conformance.build import BuildError, execute
from tests.conformance.languages import Language

BACKENDS = ("rust", "rust-testee")
QUICK = (("PANIC", "abort"), ("CODEGEN_UNITS", "2"))


def build(source: Path, out: Path, profile: str) -> list[str]:
    """Builds the testee, a package beside the crate.

    Nothing but the crate is compiled, but cargo wants to know the versions of what is
    optional, so the network may be needed once. A panic ends the testee either way;
    without code to unwind, in fewer units, it is compiled in three quarters of the time.
    """
    quick = {f"CARGO_PROFILE_{profile.upper()}_{key}": value for key, value in QUICK}
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
        execute(*command, "--offline", env=quick)
    except BuildError:
        execute(*command, env=quick)
    return [str(out / ("debug" if profile == "dev" else profile) / "testee")]


LANGUAGES = [
    Language("rust", BACKENDS, ("cargo", "rustc"), partial(build, profile="release")),
    Language("rust-debug", BACKENDS, ("cargo", "rustc"), partial(build, profile="dev")),
]
