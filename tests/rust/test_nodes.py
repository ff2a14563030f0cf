"""Modules of nodes in Rust: their documentation, and tests of frames of a shared id."""

from __future__ import annotations

import pytest

from icdgen.backends.rust.nodes import about, guarded, summary, typed
from icdgen.describe import describe
from icdgen.loading import load
from tests.icd.files import loaded


@pytest.mark.parametrize(
    ("value", "text"),
    [
        (0, "u8 = 0"),
        (255, "u8 = 255"),
        (256, "u16 = 256"),
        (65_535, "u16 = 65_535"),
        (65_536, "u32 = 65_536"),
    ],
)
def test_a_number_has_the_smallest_type(value, text):
    assert typed(value) == text


SHARED = """\
messages:
  - {name: Fixed, id: 255, kind: telemetry, length: 3, fields: [
      {at: 0, bits: 8, name: Kind, type: uint, const: 0},
      {at: 12, bits: 4, name: Part, type: uint, const: 9}]}
  - {name: Words, id: 255, kind: telemetry, length: 1, fields: [
      {at: 0, bits: 8, name: Kind, type: uint, const: 1},
      {at: 8, bits: 16, name: Words, type: uint, count: rest, up_to: 3}]}
  - {name: Bytes, id: 255, kind: telemetry, length: 1, fields: [
      {at: 0, bits: 8, name: Kind, type: uint, const: 2},
      {at: 8, name: Bytes, type: bytes, size: rest, up_to: 3}]}
  - {name: Early, id: 255, kind: telemetry, length: 3, may_end_early: zeros, fields: [
      {at: 0, bits: 8, name: Kind, type: uint, const: 3},
      {at: 20, bits: 4, name: Part, type: uint, const: 5}]}
  - {name: Open, id: 255, kind: telemetry, length: 0, fields: [
      {at: 0, bits: 16, name: Words, type: uint, count: rest, up_to: 3}]}
  - {name: Limit, set_id: 0, get_id: 7, kind: configuration, length: 2, fields: [
      {at: 0, bits: 8, name: Kind, type: uint, const: 4}]}
  - {name: Other Limit, id: 7, kind: telemetry, length: 2, fields: [
      {at: 0, bits: 8, name: Kind, type: uint, const: 5}]}
"""
GUARDS = {
    "Fixed": "M::ID if bytes.len() == M::LENGTH && bytes[0] == 0x00 && bytes[1] & 0xf0 == 0x90",
    "Words": "M::ID if (1..=M::LENGTH).contains(&bytes.len()) && (bytes.len() - 1) % 2 == 0 && bytes[0] == 0x01",
    "Bytes": "M::ID if (1..=M::LENGTH).contains(&bytes.len()) && bytes[0] == 0x02",
    "Early": "M::ID if (1..=M::LENGTH).contains(&bytes.len()) && bytes[0] == 0x03"
    " && bytes.get(2).map_or(0, |byte| *byte) & 0xf0 == 0x50",
    "Open": "M::ID if bytes.len() <= M::LENGTH && bytes.len() % 2 == 0",
    "Limit": "M::GET_ID if bytes.len() == M::LENGTH && bytes[0] == 0x04",
}


@pytest.fixture
def candidates(tmp_path):
    """Return the messages that share an id, by name."""
    result = loaded(tmp_path, SHARED)
    (node,) = describe(result.icd).nodes
    return {
        each.message.model.name: each
        for group in node.ids("telemetry")
        for each in group.messages
    }


@pytest.mark.parametrize("name", GUARDS)
def test_a_frame_is_compared_with_the_length_and_constants(candidates, name):
    text = guarded(candidates[name], "M")
    assert " ".join(text.split()) == GUARDS[name]


def test_a_long_guard_has_a_line_for_each_test(candidates):
    assert guarded(candidates["Words"], "M").splitlines() == [
        "            M::ID",
        "                if (1..=M::LENGTH).contains(&bytes.len())",
        "                    && (bytes.len() - 1) % 2 == 0",
        "                    && bytes[0] == 0x01",
    ]
    # The arm ends with ` => {`, which counts for the width of 100.
    line = "            M::GET_ID if bytes.len() == M::LENGTH && bytes[0] == 0x04 => {"
    path = "M" * (1 + (100 - len(line)) // 2)
    assert (100 - len(line)) % 2 == 0
    assert "\n" not in guarded(candidates["Limit"], path)
    assert "\n" in guarded(candidates["Limit"], f"{path}M")


BASE = """\
icdgen: 1
node:
  name: base
  title: Base *unit*
  byte_order: little
  bit_order: lsb0
messages:
  - {name: Reset, id: 1, kind: telecommand, length: 0}
"""
USER = """\
icdgen: 1
node:
  name: user
  title: User
  summary: Uses the base.
  byte_order: little
  bit_order: lsb0
  source: {document: Some manual, version: "7.2", section: "6.3"}
include: [base.yaml]
messages:
  - {name: Stop, id: 2, kind: telecommand, length: 0}
"""


def test_a_module_names_its_source_and_included_nodes(tmp_path):
    for name, text in (("base", BASE), ("user", USER)):
        (tmp_path / f"{name}.yaml").write_text(text, encoding="utf-8")
    result = load([tmp_path])
    assert result.ok, [finding.message for finding in result.findings]
    base, user = describe(result.icd).nodes
    assert about(base) == "//! Base \\*unit\\*."
    assert about(user) == (
        "//! User. Uses the base.\n"
        "//!\n"
        "//! Source: document Some manual, version 7.2, section 6.3.\n"
        "//!\n"
        "//! It also speaks the messages of [`base`](crate::base)."
    )
    assert summary(base.model) == "//! - [`base`], Base \\*unit\\*."
    assert summary(user.model) == "//! - [`user`], User. Uses the base."


def test_the_entry_of_a_node_is_wrapped_like_an_item_of_a_list(tmp_path):
    summary_text = " ".join(["word"] * 30)
    text = BASE.replace("Base *unit*", "Base").replace(
        "  byte_order", f"  summary: {summary_text}\n  byte_order"
    )
    (node,) = loaded(tmp_path, text).icd.nodes
    first, second = summary(node).splitlines()
    assert first.startswith("//! - [`base`], Base. ") and len(first) <= 100
    assert second.startswith("//!   word")
