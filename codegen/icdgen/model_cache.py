"""Load ICDs with all checks, or read the model of an earlier run with unchanged files
from the cache.
"""

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
    """Load ICDs as `icdgen.loading.load` does.

    A model from the cache has no places and no texts.

    The cache is not used with plug-ins, because their names can depend on files that
    icdgen does not know.
    """
    if plug_ins or with_positions:
        from icdgen.loading import load

        return load(paths, plug_ins=plug_ins, languages=languages)
    from icdgen.icd import model_json

    name = cache.key(
        "model", os.getcwd(), *sorted(languages), "", *(str(path) for path in paths)
    )
    data = cache.recall(KIND, name)
    remembered = model_json.model_of_json(data) if data is not None else None
    if remembered is not None:
        return Loaded(remembered[0], [], remembered[1])
    from icdgen.loading import load

    loaded = load(paths, languages=languages)
    # Models with findings are not cached: the findings must be reported again in the
    # next run.
    if not loaded.findings:
        files = {
            os.path.abspath(path): fingerprint
            for path, fingerprint in loaded.inputs.items()
        }
        cache.remember(
            KIND, name, model_json.json_of_model(loaded.icd, loaded.inputs), files
        )
    return loaded
