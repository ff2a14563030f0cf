"""Rust: optimised, and with debug checks, where an integer overflow panics."""

from __future__ import annotations

from functools import partial
from pathlib import Path

from tests.conformance.build import BuildError, execute
from tests.conformance.languages import Language

BACKENDS = ("rust", "rust-testee")
QUICK = (("PANIC", "abort"), ("CODEGEN_UNITS", "2"))


def build(source: Path, out: Path, profile: str) -> list[str]:
    """Build the testee, a package next to the crate.

    Only the crate is compiled, but cargo resolves the versions of optional
    dependencies, so the first build may need the network. A panic ends the testee in
    any case. Without unwinding and with fewer codegen units the build takes three
    quarters of the time.
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
