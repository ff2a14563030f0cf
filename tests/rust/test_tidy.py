"""The generated crate passes Rust's own tools, pedantic ones included, with the newest
and the oldest toolchain.
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


def test_rustfmt_leaves_it_as_it_is(subject, toolchain):
    toolchain.formatted(subject.crate)
    toolchain.formatted(main_of_testee(subject.crate))


def test_rustfmt_leaves_names_of_all_lengths_as_they_are(toolchain, tmp_path):
    files = odd.write_names(tmp_path, odd.LENGTHS)
    toolchain.formatted(harness.generate(harness.read(*files), tmp_path))


def test_clippy_has_nothing_to_say(subject, toolchain, tmp_path):
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


def test_arrays_structs_and_parts_are_tidy(stories, tmp_path):
    tools = Toolchain("default")
    tools.formatted(stories.crate)
    tools.linted(stories.crate, tmp_path, "--crate-type", "lib", "--crate-name", "icd")
    tools.documented(stories.crate, tmp_path)


def test_nor_with_the_standard_library(toolchain, tmp_path):
    """Of a node that speaks on each bus; the messages of any node are the same without
    it.
    """
    board = ROOT / "tests" / "protocol" / "keys" / "board.yaml"
    crate = harness.generate(harness.read(board), tmp_path)
    options = ("--crate-type", "lib", "--crate-name", "icd", *STD)
    toolchain.linted(crate, tmp_path, *options)
    toolchain.documented(crate, tmp_path, *STD)


def test_rustdoc_has_nothing_to_say(subject, toolchain, tmp_path):
    toolchain.documented(subject.crate, tmp_path)


def test_rustdoc_takes_no_word_of_an_icd_for_markup(toolchain, tmp_path):
    crate = harness.generate(harness.read(hostile_words.write(tmp_path)), tmp_path)
    toolchain.documented(crate, tmp_path, "-D", "rustdoc::all")
    toolchain.formatted(crate)


def test_it_compiles_without_a_warning_and_with_names_of_any_length(
    toolchain, tmp_path
):
    folder = tmp_path / "icd"
    folder.mkdir()
    crate = harness.generate(harness.read(*odd.write_long(folder)), tmp_path)
    toolchain.library(crate, level="0")


def test_a_crate_that_needs_next_to_nothing_is_tidy_too(toolchain, tmp_path):
    crate = harness.generate(harness.read(odd.write_least(tmp_path)), tmp_path)
    toolchain.formatted(crate)
    toolchain.linted(crate, tmp_path, "--crate-type", "lib", "--crate-name", "icd")


def test_a_message_may_be_called_as_its_node_is(toolchain, tmp_path):
    (tmp_path / "pump.yaml").write_text(
        "icdgen: 1\nnode: {name: pump, title: Pump, byte_order: little, bit_order: lsb0}\nmessages:\n"
        "  - {name: Pump, id: 1, kind: telemetry, length: 1, fields: [{at: 0, bits: 8, name: Pump, type: uint}]}\n",
        encoding="utf-8",
    )
    crate = harness.generate(harness.read(tmp_path / "pump.yaml"), tmp_path)
    toolchain.formatted(crate)
    toolchain.linted(crate, tmp_path, "--crate-type", "lib", "--crate-name", "icd")


def test_the_tools_would_complain(toolchain, tmp_path):
    bad = tmp_path / "bad.rs"
    bad.write_text("//! [nothing]\npub fn f(x:u64)->u32{ x as u32 }\n")
    for check in (
        lambda: toolchain.formatted(bad),
        lambda: toolchain.linted(bad, tmp_path, "--crate-type", "lib"),
        lambda: toolchain.documented(bad, tmp_path),
    ):
        with pytest.raises(AssertionError):
            check()


def test_a_crate_for_a_framed_link_is_tidy_too(toolchain, tmp_path):
    wheel = ROOT / "examples" / "links" / "wheel.yaml"
    crate = harness.generate(harness.read(wheel), tmp_path)
    toolchain.formatted(crate)
    options = ("--crate-type", "lib", "--crate-name", "icd", *STD)
    toolchain.linted(crate, tmp_path, *options)
    toolchain.documented(crate, tmp_path, *STD)
