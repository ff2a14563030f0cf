"""Loads ICDs with all checks, or takes the model of an earlier run over the very same files."""

from __future__ import annotations

import io
import os
import pickle
from hashlib import sha256
from pathlib import Path

from icdgen import cache
from icdgen.icd.loaded import Loaded
from icdgen.icd.located import Map

KIND = "models"


def load_checked(paths: list[Path]) -> Loaded:
    """Like `icdgen.icd.load.load`. A remembered model carries no positions and comes without texts."""
    name = cache.key("model", os.getcwd(), *(str(path) for path in paths))
    digest = cache.holds("inputs", name)
    data = cache.recall(KIND, digest) if digest else None
    if data is not None:
        icd, inputs = _Unpickler(io.BytesIO(data)).load()
        return Loaded(icd, [], inputs)
    from icdgen.icd.load import load

    loaded = load(paths)
    if not loaded.findings:
        buffer = io.BytesIO()
        _Pickler(buffer, protocol=5).dump((loaded.icd, loaded.inputs))
        data = buffer.getvalue()
        digest = sha256(data).hexdigest()
        cache.seal(KIND, digest, data)
        cache.remember("inputs", name, digest, {os.path.abspath(path): seen for path, seen in loaded.inputs.items()})
    return loaded


class _Pickler(pickle.Pickler):
    def persistent_id(self, item: object) -> object:
        return "source" if isinstance(item, Map) else None


class _Unpickler(pickle.Unpickler):
    def persistent_load(self, _pid: object) -> None:
        return None
