"""Loads ICDs with all checks, or takes the model of an earlier run over the very same files."""

from __future__ import annotations

import os
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from icdgen import cache
from icdgen.icd.loaded import Loaded

if TYPE_CHECKING:
    from icdgen.icd.identifiers import Language

KIND = "models"


def load_checked(
    paths: list[Path],
    languages: Sequence[str],
    plug_ins: Sequence[Language] = (),
    with_positions: bool = False,
) -> Loaded:
    """Load ICDs as `icdgen.loading.load` does. A remembered model carries no positions and comes without texts.

    With plug-ins nothing is remembered: what they say of names may change with any file of theirs.
    """
    if plug_ins or with_positions:
        from icdgen.loading import load

        return load(paths, plug_ins=plug_ins, languages=languages)
    from icdgen.icd import model_json

    name = cache.key("model", os.getcwd(), *sorted(languages), "", *(str(path) for path in paths))
    data = cache.recall(KIND, name)
    remembered = model_json.read(data) if data is not None else None
    if remembered is not None:
        return Loaded(remembered[0], [], remembered[1])
    from icdgen.loading import load

    loaded = load(paths, languages=languages)
    if not loaded.findings:
        files = {os.path.abspath(path): seen for path, seen in loaded.inputs.items()}
        cache.remember(KIND, name, model_json.text(loaded.icd, loaded.inputs), files)
    return loaded
