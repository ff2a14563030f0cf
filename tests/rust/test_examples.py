"""The examples in the documentation of a generated crate compile and pass.

The tests run them with `rustdoc --test`.
"""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from tests.rust import harness
from tests.rust.tools import USED, Toolchain

DECLARED = re.compile(r"^pub (?:struct|enum|trait) (\w+)", re.MULTILINE)
EXAMPLE = re.compile(r"^ *//[/!] ```$", re.MULTILINE)
PASSED = re.compile(r"test result: ok. (\d+) passed; 0 failed; 0 ignored")


def examples(crate: Path, only: str = "") -> int:
    """Count the examples in files whose path contains ``only``."""
    files = (file for file in crate.parent.rglob("*.rs") if only in file.as_posix())
    return sum(len(EXAMPLE.findall(file.read_text())) for file in files) // 2


def test_all_examples_pass(subject):
    """An old rustdoc compiles each example as a program of its own, which is slow.

    With it, the test runs only the examples of the node with the fewest messages.
    """
    library, tools = (
        Toolchain("default").library(subject.crate, *USED),
        Toolchain("default"),
    )
    least = min(subject.icd.nodes, key=lambda node: len(node.messages))
    only = "" if tools.merges else f"/{least.name}/"
    output = tools.tested(subject.crate, library, only)
    assert sum(map(int, PASSED.findall(output))) == examples(subject.crate, only) > 0


def test_every_message_enumeration_and_direction_has_an_example(subject):
    for node in subject.icd.nodes:
        for file in (subject.crate.parent / node.name).glob("*.rs"):
            parts = DECLARED.split(file.read_text())
            for before, name in zip(parts[:-1:2], parts[1::2], strict=True):
                comment = before.rsplit("\n\n", 1)[-1]
                assert name == "Node" or len(EXAMPLE.findall(comment)) == 2, (
                    f"{file.name}: {name}"
                )


def test_every_node_with_a_client_has_an_example_of_it(shipped):
    for node in shipped.icd.nodes:
        text = (shipped.crate.parent / node.name / "mod.rs").read_text()
        assert ("//! ```" in text) == (
            "pub use crate::wire::links" in text and "pub enum Telemetry" in text
        ), node.name


def test_an_example_with_a_wrong_value_fails(shipped, tmp_path):
    library = Toolchain("default").library(shipped.crate, *USED)
    text = harness.texts(shipped.icd)["src/cubeacp/estimated_attitude_angles.rs"]
    start = text.index("/// ```")
    example = text[start : text.index("#[derive", start)]
    wrong = tmp_path / "wrong.rs"
    wrong.write_text(example.replace("12.34)", "12.35)") + "pub struct Shown;\n")
    with pytest.raises(AssertionError, match=r"12\.35"):
        Toolchain("default").tested(wrong, library)
    wrong.write_text(f"{example}pub struct Shown;\n")
    assert PASSED.search(Toolchain("default").tested(wrong, library))
