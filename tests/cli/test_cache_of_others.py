"""icdgen ignores caches that other users may have written, and never executes anything
from a cache.
"""

from __future__ import annotations

import marshal
import os
import pickle
import sys
from hashlib import sha256
from pathlib import Path

import pytest

from icdgen import __main__, cache


class _Runs:
    """An object that would run code when unpickled."""

    def __init__(self, mark: Path) -> None:
        self.mark = mark

    def __reduce__(self):
        return exec, (f"open({str(self.mark)!r}, 'w')",)


def entries() -> list[Path]:
    return [path for path in Path(cache.folder()).rglob("*") if path.is_file()]


@pytest.fixture
def generated(demo, tmp_path, monkeypatch, capsys):
    """Run the command and return the files that it wrote."""
    monkeypatch.chdir(tmp_path)

    def go() -> dict[str, bytes]:
        monkeypatch.setattr(
            "sys.argv", ["icdgen", "--lang", "c", "--out", "out", str(demo)]
        )
        with pytest.raises(SystemExit) as end:
            __main__.main()
        assert not end.value.code and capsys.readouterr().err == ""
        return {
            str(path): path.read_bytes()
            for path in Path("out").rglob("*")
            if path.is_file()
        }

    return go


def harmful(mark: Path) -> list[bytes]:
    code = compile(f"open({str(mark)!r}, 'w')", "planted", "exec")
    pickled = pickle.dumps(_Runs(mark), protocol=5)
    magic = (
        b"j2"
        + pickle.dumps(5, 2)
        + pickle.dumps((sys.version_info[0] << 24) | sys.version_info[1], 2)
    )
    # The form in which jinja2 stores compiled templates.
    template = magic + pickle.dumps("0" * 40, 2) + marshal.dumps(code)
    return [
        pickled,
        pickle.dumps((_Runs(mark), {}), protocol=5),
        marshal.dumps(code),
        template,
        b"",
        b"\0" * 100,
    ]


def test_no_planted_code_runs(generated, tmp_path):
    mark = tmp_path / "it-ran"
    good = generated()
    for data in harmful(mark):
        for inner in (data, b"\0" + data):
            for path in entries():
                path.write_bytes(sha256(inner).hexdigest().encode() + b"\n" + inner)
            assert generated() == good
    assert not mark.exists()


def test_no_compiled_template_is_stored_in_the_cache(generated, monkeypatch, tmp_path):
    monkeypatch.setattr(sys, "dont_write_bytecode", False)
    monkeypatch.setattr(sys, "pycache_prefix", str(tmp_path / "compiled"))
    generated()
    assert {path.parent.name for path in entries()} == {"models", "runs"}


@pytest.fixture
def record():
    cache.remember("models", "k", b"data", {})
    assert cache.recall("models", "k") == b"data"
    return Path(cache.folder(), "models", "k")


@pytest.mark.parametrize("mode", [0o620, 0o602, 0o666])
def test_a_record_that_others_may_write_is_ignored(record, mode):
    record.chmod(mode)
    assert cache.recall("models", "k") is None


@pytest.mark.parametrize("level", [0, 1])
@pytest.mark.parametrize("mode", [0o720, 0o702, 0o777, 0o1777])
def test_a_folder_that_others_may_write_is_ignored(record, mode, level):
    record.parents[level].chmod(mode)
    assert cache.recall("models", "k") is None
    cache.remember("models", "new", b"data", {})
    assert not record.with_name("new").exists()


def test_a_link_to_a_record_is_ignored(record, tmp_path):
    record.rename(tmp_path / "elsewhere")
    record.symlink_to(tmp_path / "elsewhere")
    assert cache.recall("models", "k") is None
    record.unlink()
    os.link(tmp_path / "elsewhere", record)
    assert cache.recall("models", "k") is None


@pytest.mark.parametrize("level", [0, 1])
def test_a_link_to_a_folder_is_ignored(record, tmp_path, level):
    folder = record.parents[level]
    folder.rename(tmp_path / "elsewhere")
    folder.symlink_to(tmp_path / "elsewhere")
    assert cache.recall("models", "k") is None


def test_a_record_that_is_no_file_is_ignored(record):
    record.unlink()
    os.mkfifo(record)
    assert cache.recall("models", "k") is None
    record.unlink()
    record.mkdir()
    assert cache.recall("models", "k") is None


@pytest.mark.parametrize("level", [-1, 0, 1])
def test_a_record_of_another_user_is_ignored(record, monkeypatch, level):
    other = os.getuid() + 1
    place = record if level < 0 else record.parents[level]
    if os.getuid() == 0:
        os.chown(place, other, -1)
    else:
        monkeypatch.setattr(os, "getuid", lambda: other)
    assert cache.recall("models", "k") is None


def test_the_cache_is_only_accessible_to_its_user(tmp_path, monkeypatch):
    monkeypatch.setenv("ICDGEN_CACHE", str(tmp_path / "above" / "cache"))
    cache.remember("models", "k", b"data", {})
    folders = [
        tmp_path / "above" / "cache" / path for path in (".", "models", "models/k")
    ]
    assert [path.stat().st_mode & 0o777 for path in folders] == [0o700, 0o700, 0o600]
