"""Loads ICDs with all checks, those of names in every language that icdgen generates included."""

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
    paths: list[Path], check: bool = True, plug_ins: Sequence[Language] = (), unsaved: Mapping[Path, bytes] | None = None
) -> Loaded:  # fmt: skip
    """Like `icdgen.icd.load.load`: names must do for the languages of icdgen and for ``plug_ins``."""
    languages: list[Language] = [*map(backends.get, backends.names()), *plug_ins] if check else []
    return icd_files.load(paths, check, languages, unsaved)
