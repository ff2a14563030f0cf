"""The unit test of a driver that the guide to Rust shows compiles and passes."""

from __future__ import annotations

from tests import documents
from tests.conformance.icds import read_unchecked
from tests.conftest import ROOT
from tests.rust import harness
from tests.rust.tools import USED, Toolchain, run

TEST = "limits_are_written_refused_and_read"


def test_the_unit_test_of_the_guide_passes(tmp_path):
    page = documents.text("guides/rust")
    (code,) = documents.blocks(
        page.split("## Play the device in your tests")[1], "rust"
    )
    assert code.count(f"#[test]\nfn {TEST}()") == 1
    source = tmp_path / "meter.rs"
    source.write_text(
        code.replace("#[test]\n", "") + f"fn main() {{ {TEST}().unwrap() }}\n"
    )
    icd = read_unchecked(ROOT / "examples" / "links" / "modbus.yaml")
    tools, crate = Toolchain("default"), harness.generate(icd, tmp_path)
    library = tools.library(crate, *USED)
    assert run(tools.program(source, library, tmp_path / "meter")) == ""
