"""The renderer of a backend: its templates and its runtime."""

from __future__ import annotations

import sys

import pytest

from icdgen import fingerprints, shipped
from icdgen.render import Renderer


@pytest.mark.parametrize(
    "left",
    [
        ".mypy_cache/3.11/a.json",
        "__pycache__/a.pyc",
        "target/debug/a.rs",
        "src/.a.rs.swp",
    ],
)
def test_what_tools_leave_beside_the_sources_of_a_runtime_is_not_generated(
    tmp_path, left
):
    for name in ("src/a.rs", "Cargo.toml", left):
        (tmp_path / name).parent.mkdir(parents=True, exist_ok=True)
        (tmp_path / name).touch()
    assert Renderer("any", runtime=tmp_path).runtime_files() == [
        "Cargo.toml",
        "src/a.rs",
    ]


@pytest.fixture
def tool(tmp_path, monkeypatch):
    """Return the template folder of a tool with compiled templates."""
    monkeypatch.setattr(sys, "dont_write_bytecode", False)
    monkeypatch.setattr(sys, "pycache_prefix", None)
    monkeypatch.setattr(shipped, "templates", lambda: tmp_path / "templates")
    folder = tmp_path / "templates" / "any"
    folder.mkdir(parents=True)
    (folder / "a.j2").write_text("{{ 1 + 1 }}")
    assert Renderer("any")("a.j2") == "2"
    return folder


def compiled_files(top):
    return [path for path in top.rglob("*") if path.is_file() and path.suffix != ".j2"]


def test_a_shipped_template_is_compiled_once_next_to_compiled_modules(
    tool, tmp_path, monkeypatch
):
    assert [path.parent for path in compiled_files(tmp_path)] == [tool / "__pycache__"]
    monkeypatch.setattr(
        "jinja2.Environment.compile", lambda *_, **__: pytest.fail("compiled again")
    )
    assert Renderer("any")("a.j2") == "2"


def test_a_changed_template_is_compiled_again(tool):
    (tool / "a.j2").write_text("{{ 1 + 2 }}")  # the same length as before
    assert Renderer("any")("a.j2") == "3"


def test_a_changed_tool_compiles_again(tool, monkeypatch):
    (before,) = (path.read_bytes() for path in compiled_files(tool))
    monkeypatch.setattr(fingerprints, "of_tool", lambda: "another version")
    assert Renderer("any")("a.j2") == "2"
    assert before not in [path.read_bytes() for path in compiled_files(tool)]


@pytest.mark.parametrize("left", [b"", b"\0", slice(0, 65), slice(0, -1)])
def test_a_damaged_compiled_template_is_compiled_again(tool, left):
    (path,) = compiled_files(tool)
    path.write_bytes(path.read_bytes()[left] if isinstance(left, slice) else left)
    assert Renderer("any")("a.j2") == "2"


def test_compiled_templates_of_users_and_plug_ins_are_not_stored(tool, tmp_path):
    theirs = tmp_path / "theirs"
    theirs.mkdir()
    (theirs / "a.j2").write_text("{{ 2 + 2 }}")
    assert Renderer("any", override=theirs)("a.j2") == "4"
    assert Renderer("any", templates=theirs)("a.j2") == "4"
    assert compiled_files(theirs) == []


def test_without_bytecode_files_no_compiled_template_is_stored(tool, monkeypatch):
    for path in compiled_files(tool):
        path.unlink()
    monkeypatch.setattr(sys, "dont_write_bytecode", True)
    assert Renderer("any")("a.j2") == "2"
    assert compiled_files(tool) == []


def test_a_folder_that_cannot_be_written_is_no_error(tool):
    for path in compiled_files(tool):
        path.unlink()
    (tool / "__pycache__").rmdir()
    (tool / "__pycache__").touch()
    assert Renderer("any")("a.j2") == "2"
