"""Users can add the crate to a project with cargo, with and without its features.

The tests build and run small programs that depend on the crate.
"""

from __future__ import annotations

import subprocess
from pathlib import Path

import pytest

from tests.conformance.build import cache_folder
from tests.conftest import ROOT
from tests.rust import harness
from tests.rust.tools import Toolchain, run, toolchains

USER = Path(__file__).parent / "user.rs"
PORTS = Path(__file__).parent / "ports.rs"
NEWEST_FEATURES = (1, 85)  # oldest Rust that the current serde and defmt support

MANIFEST = """\
[package]
name = "user"
version = "0.1.0"
edition = "2021"

[workspace]
"""
SERDE = """\
use icd::cubeacp::{AdcsConfiguration, CurrentAdcsState, Telemetry};

fn main() {
    let frame: Vec<u8> = (0..504_u32).map(|n| (n % 63) as u8).collect();
    let configuration = AdcsConfiguration::from_bytes(&frame).unwrap();
    let text = serde_json::to_string(&configuration).unwrap();
    let decoded: AdcsConfiguration = serde_json::from_str(&text).unwrap();
    assert_eq!(decoded, configuration);
    let state = CurrentAdcsState::from_bytes(&[0xe2, 0, 0, 0, 0, 0]).unwrap();
    let value = serde_json::to_value(state).unwrap();
    assert_eq!(value["control_mode"], 14);
    assert_eq!(value["cubestar_enabled"], false);
    let telemetry = Telemetry::CurrentAdcsState(state);
    let text = serde_json::to_string(&telemetry).unwrap();
    assert_eq!(serde_json::from_str::<Telemetry>(&text).unwrap(), telemetry);
    let error: Box<dyn std::error::Error> = Box::new(CurrentAdcsState::from_bytes(&[]).unwrap_err());
    assert_eq!(error.to_string(), "6 bytes expected, 0 given");
}
"""


@pytest.mark.parametrize("name", list(toolchains()))
def test_cargo_add_adds_the_crate_without_a_registry(shipped, name, tmp_path):
    cargo = (*Toolchain(name).start, "cargo")
    (tmp_path / "src").mkdir()
    (tmp_path / "src" / "main.rs").write_text(USER.read_text())
    (tmp_path / "Cargo.toml").write_text(MANIFEST)
    own = {
        "CARGO_HOME": tmp_path / "home",
        "CARGO_TARGET_DIR": tmp_path / "target",
        "CARGO_NET_OFFLINE": "true",
    }
    run(
        *cargo,
        "add",
        "--quiet",
        "--path",
        shipped.crate.parent.parent,
        cwd=tmp_path,
        **own,
    )
    run(*cargo, "run", "--quiet", cwd=tmp_path, **own)


def test_the_features_std_serde_and_defmt_work(shipped, tmp_path):
    """The crates of `serde` and `defmt` come from a registry."""
    version = Toolchain("default").version
    if version < NEWEST_FEATURES:
        pytest.skip(
            f"the current serde and defmt need a newer Rust than {version[0]}.{version[1]}"
        )
    crate, target = shipped.crate.parent.parent, cache_folder() / "rust-features"
    (tmp_path / "src").mkdir()
    (tmp_path / "src" / "main.rs").write_text(SERDE)
    dependencies = f'[dependencies]\nicd = {{ path = "{crate}", features = ["std", "serde"] }}\nserde_json = "1"\n'
    (tmp_path / "Cargo.toml").write_text(MANIFEST + dependencies)
    fetched = subprocess.run(
        ["cargo", "fetch", "--quiet"], cwd=tmp_path, capture_output=True, text=True
    )
    if fetched.returncode:
        pytest.skip(f"no registry: {fetched.stderr[-200:]}")
    run("cargo", "run", "--quiet", "--target-dir", target, cwd=tmp_path)
    command = (
        "cargo",
        "clippy",
        "--quiet",
        "--all-features",
        "--target-dir",
        target,
        "--",
    )
    run(*command, "-D", "warnings", "-W", "clippy::pedantic", cwd=crate)


def test_clients_work_over_embedded_io_and_embedded_hal(shipped, tmp_path):
    """`embedded-io` and `embedded-hal` come from a registry."""
    receiver = harness.generate(
        harness.read_unchecked(ROOT / "examples" / "links" / "ubx.yaml"), tmp_path
    ).parent.parent
    manifest = receiver / "Cargo.toml"
    manifest.write_text(
        manifest.read_text().replace('name = "icd"', 'name = "receiver"')
    )
    user = tmp_path / "user"
    (user / "src").mkdir(parents=True)
    (user / "src" / "main.rs").write_text(PORTS.read_text())
    dependencies = f"""\
[dependencies]
icd = {{ path = "{shipped.crate.parent.parent}", features = ["embedded-io", "embedded-hal"] }}
receiver = {{ path = "{receiver}", features = ["embedded-io"] }}
embedded-io = "0.6"
embedded-hal = "1"
"""
    (user / "Cargo.toml").write_text(MANIFEST + dependencies)
    fetched = subprocess.run(
        ["cargo", "fetch", "--quiet"], cwd=user, capture_output=True, text=True
    )
    if fetched.returncode:
        pytest.skip(f"no registry: {fetched.stderr[-200:]}")
    run(
        "cargo",
        "run",
        "--quiet",
        "--target-dir",
        cache_folder() / "rust-features",
        cwd=user,
    )
