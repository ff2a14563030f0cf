"""What a backend gets of its templates and its runtime."""

from __future__ import annotations

import pytest

from icdgen.render import Renderer


@pytest.mark.parametrize("left", [".mypy_cache/3.11/a.json", "__pycache__/a.pyc", "target/debug/a.rs", "src/.a.rs.swp"])
def test_what_tools_leave_beside_the_sources_of_a_runtime_is_not_generated(tmp_path, left):
    for name in ("src/a.rs", "Cargo.toml", left):
        (tmp_path / name).parent.mkdir(parents=True, exist_ok=True)
        (tmp_path / name).touch()
    assert Renderer("any", runtime=tmp_path).runtime_files() == ["Cargo.toml", "src/a.rs"]
