"""A cached model gives the same output as a newly loaded one."""

from __future__ import annotations

from tests.conftest import ROOT


def test_the_second_run_makes_the_same_code_as_the_first(icdgen, tmp_path):
    for link in ("wheel", "daly"):
        text = (ROOT / "examples" / "links" / f"{link}.yaml").read_text("utf-8")
        (tmp_path / f"{link}.yaml").write_text(f"{text}# {tmp_path}\n", "utf-8")
    for run in ("first", "second"):
        done = icdgen("generate", "-q", "-l", "c", "-o", run, "wheel.yaml", "daly.yaml")
        assert done.status == 0, done.out
    first, second = (
        {
            path.relative_to(tmp_path / run): path.read_bytes()
            for path in (tmp_path / run).rglob("link.c")
        }
        for run in ("first", "second")
    )
    assert len(first) == 2 and first == second
