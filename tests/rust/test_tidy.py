"""The generated crate passes rustfmt, pedantic clippy and rustdoc without warnings.

The tests use the newest and the oldest supported toolchain.
"""

from __future__ import annotations

import pytest

from tests.conftest import ROOT
from tests.icd import hostile_words
from tests.rust import harness, odd
from tests.rust.harness import main_of_testee
from tests.rust.tools import STD, Toolchain, toolchains


@pytest.fixture(params=list(toolchains()))
def toolchain(request) -> Toolchain:
    return Toolchain(request.param)


def test_rustfmt_leaves_the_crate_unchanged(subject, toolchain):
    toolchain.formatted(subject.crate)
    toolchain.formatted(main_of_testee(subject.crate))


def test_rustfmt_leaves_names_of_all_lengths_unchanged(toolchain, tmp_path):
    files = odd.write_names(tmp_path, odd.LENGTHS)
    toolchain.formatted(harness.generate(harness.read_unchecked(*files), tmp_path))


def test_clippy_reports_no_warnings(subject, toolchain, tmp_path):
    toolchain.linted(
        subject.crate, tmp_path, "--crate-type", "lib", "--crate-name", "icd"
    )
    library = f"icd={tmp_path / 'libicd.rmeta'}"
    toolchain.linted(
        main_of_testee(subject.crate),
        tmp_path,
        "--crate-name",
        "testee",
        "--extern",
        library,
    )


def test_arrays_structs_and_parts_pass_all_tools(stories, tmp_path):
    tools = Toolchain("default")
    tools.formatted(stories.crate)
    tools.linted(stories.crate, tmp_path, "--crate-type", "lib", "--crate-name", "icd")
    tools.documented(stories.crate, tmp_path)


def test_the_feature_std_passes_clippy_and_rustdoc(toolchain, tmp_path):
    """The feature adds code for each bus, so the node supports all of them."""
    board = ROOT / "tests" / "protocol" / "keys" / "board.yaml"
    crate = harness.generate(harness.read_unchecked(board), tmp_path)
    options = ("--crate-type", "lib", "--crate-name", "icd", *STD)
    toolchain.linted(crate, tmp_path, *options)
    toolchain.documented(crate, tmp_path, *STD)


def test_rustdoc_reports_no_warnings(subject, toolchain, tmp_path):
    toolchain.documented(subject.crate, tmp_path)


def test_rustdoc_treats_text_of_an_icd_as_text(toolchain, tmp_path):
    crate = harness.generate(
        harness.read_unchecked(hostile_words.write(tmp_path)), tmp_path
    )
    toolchain.documented(crate, tmp_path, "-D", "rustdoc::all")
    toolchain.formatted(crate)


def test_names_of_any_length_compile_without_a_warning(toolchain, tmp_path):
    folder = tmp_path / "icd"
    folder.mkdir()
    crate = harness.generate(harness.read_unchecked(*odd.write_long(folder)), tmp_path)
    toolchain.library(crate, level="0")


def test_a_crate_of_one_empty_message_passes_all_tools(toolchain, tmp_path):
    crate = harness.generate(
        harness.read_unchecked(odd.write_least(tmp_path)), tmp_path
    )
    toolchain.formatted(crate)
    toolchain.linted(crate, tmp_path, "--crate-type", "lib", "--crate-name", "icd")


def test_a_message_may_have_the_name_of_its_node(toolchain, tmp_path):
    (tmp_path / "pump.yaml").write_text(
        "icdgen: 1\nnode: {name: pump, title: Pump, byte_order: little, bit_order: lsb0}\nmessages:\n"
        "  - {name: Pump, id: 1, kind: telemetry, length: 1, fields: [{at: 0, bits: 8, name: Pump, type: uint}]}\n",
        encoding="utf-8",
    )
    crate = harness.generate(harness.read_unchecked(tmp_path / "pump.yaml"), tmp_path)
    toolchain.formatted(crate)
    toolchain.linted(crate, tmp_path, "--crate-type", "lib", "--crate-name", "icd")


def test_the_tools_report_faults(toolchain, tmp_path):
    bad = tmp_path / "bad.rs"
    bad.write_text("//! [nothing]\npub fn f(x:u64)->u32{ x as u32 }\n")
    for check in (
        lambda: toolchain.formatted(bad),
        lambda: toolchain.linted(bad, tmp_path, "--crate-type", "lib"),
        lambda: toolchain.documented(bad, tmp_path),
    ):
        with pytest.raises(AssertionError):
            check()


def test_a_crate_for_a_framed_link_passes_all_tools(toolchain, tmp_path):
    wheel = ROOT / "examples" / "links" / "wheel.yaml"
    crate = harness.generate(harness.read_unchecked(wheel), tmp_path)
    toolchain.formatted(crate)
    options = ("--crate-type", "lib", "--crate-name", "icd", *STD)
    toolchain.linted(crate, tmp_path, *options)
    toolchain.documented(crate, tmp_path, *STD)
