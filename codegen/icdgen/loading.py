"""Load ICDs with all checks, including the checks of names in generated code.

`icdgen.icd.load` reads the files and checks the rules, but does not depend on the
backends. This module passes it the languages of the backends. Commands that generate
code call `icdgen.model_cache` instead, which calls this module if a file has changed.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from icdgen import backends
from icdgen.icd import load as icd_files
from icdgen.icd.loaded import Loaded

if TYPE_CHECKING:
    from icdgen.icd.identifiers import Language


def load(
    paths: list[Path],
    check: bool = True,
    plug_ins: Sequence[Language] = (),
    unsaved: Mapping[Path, bytes] | None = None,
    languages: Sequence[str] | None = None,
) -> Loaded:
    """Load ICDs as `icdgen.icd.load.load` does, and check the names that generated code
    declares.

    Names are checked for `plug_ins` and for the built-in `languages`, by default for
    all of them. Computing the names of one language takes about as long as all other
    rules together, so commands pass only the languages that they generate.
    """
    built_in = backends.names() if languages is None else languages
    checked: list[Language] = [*map(backends.get, built_in), *plug_ins] if check else []
    return icd_files.load(paths, check, checked, unsaved)
