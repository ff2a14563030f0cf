"""Loads ICDs with all checks, or takes the model of an earlier run over the very same files."""

from __future__ import annotations

import io
import os
import pickle
from hashlib import sha256
from pathlib import Path

from icdgen import memo
from icdgen.icd.loaded import Loaded
from icdgen.icd.model import Icd
from icdgen.icd.tree import Map

KIND = "models"


def load_checked(paths: list[Path]) -> Loaded:
    """Like `icdgen.icd.load.load`. A remembered model carries no positions and comes without texts."""
    name = memo.key("model", os.getcwd(), *(str(path) for path in paths))
    note = memo.holds(KIND, name)
    remembered = _recall(note) if note else None
    if remembered is not None:
        return remembered
    from icdgen.icd.load import load

    loaded = load(paths)
    if not loaded.findings:
        _keep(name, paths, loaded)
    return loaded


def _keep(name: str, paths: list[Path], loaded: Loaded) -> None:
    buffer = io.BytesIO()
    _Pickler(buffer, protocol=5).dump((loaded.icd, [str(path) for path in loaded.inputs]))
    data = buffer.getvalue()
    digest = sha256(data).hexdigest()
    memo.keep(KIND, digest, data)
    files = {
        os.path.abspath(path): memo.ABSENT if content is None else sha256(content).hexdigest()
        for path, content in loaded.inputs.items()
    }
    files |= {os.path.abspath(path): memo.fingerprint(str(path)) for path in paths if path.is_dir()}
    memo.remember(KIND, name, digest, files)


def _recall(digest: str) -> Loaded | None:
    top = memo.folder()
    if top is None:
        return None
    try:
        with open(os.path.join(top, KIND, digest), "rb") as file:
            data = file.read()
    except OSError:
        return None
    if sha256(data).hexdigest() != digest:
        return None
    icd, inputs = _Unpickler(io.BytesIO(data)).load()
    assert isinstance(icd, Icd)
    return Loaded(icd, [], {Path(path): b"" for path in inputs})


class _Pickler(pickle.Pickler):
    def persistent_id(self, item: object) -> object:
        return "source" if isinstance(item, Map) else None


class _Unpickler(pickle.Unpickler):
    def persistent_load(self, _pid: object) -> None:
        return None
