"""The ICDs of a folder and of the folders below it."""

from __future__ import annotations

import os
import re
from dataclasses import dataclass, field
from pathlib import Path

from icdgen.diagnostics import Findings
from icdgen.icd import source

MOST_FOLDERS = 5000  # of one search: `icdgen check /` is a slip

# Folders of tools, of their output and of ours. What a user names itself is searched, whatever it is called.
_SKIPPED = frozenset(
    {"__pycache__", "_build", "build", "dist", "errata", "generated", "node_modules", "site", "target", "venv"}
)
_ENVIRONMENT = "pyvenv.cfg"  # what a virtual environment has, whatever it is called

_KEY = re.compile(r"""^(?:\{\s*)?["']?([A-Za-z_][\w.-]*)["']?\s*:""", re.MULTILINE)


@dataclass
class Search:
    """The result of a search: the ICDs, and each folder and file that was looked at to find them."""

    icds: list[Path] = field(default_factory=list)
    folders: list[Path] = field(default_factory=list)
    overlays: list[Path] = field(default_factory=list)  # errata overlays in the folder itself
    others: list[Path] = field(default_factory=list)  # other files *.yaml
    is_complete: bool = True  # whether the search ended before `MOST_FOLDERS`


def search(top: Path) -> Search:
    """Return the ICDs of a folder, and those in the folders below it, in the order of their paths.

    A file *.yaml below is an ICD if it has the key `icdgen`. Of the folder itself also such files are taken that are meant
    as ICDs but lack the key, so that they are reported. Errata overlays and other YAML files are not ICDs. Hidden folders,
    virtual environments and folders of build output are skipped, and links to folders are not followed.
    """
    result = Search()
    queue = [top]
    while queue:
        folder = queue.pop(0)
        if len(result.folders) == MOST_FOLDERS:
            result.is_complete = False
            break
        files, below = _entries(folder)
        if folder != top and _ENVIRONMENT in files:
            continue
        result.folders.append(folder)
        for name in files:
            if name.endswith(".yaml") and not name.startswith("."):
                path = folder / name
                _list_of(result, path, is_direct=folder == top).append(path)
        queue += (folder / name for name in below if name not in _SKIPPED and not name.startswith("."))
    result.icds.sort(key=lambda path: (len(path.parts), path))
    return result


def _entries(folder: Path) -> tuple[list[str], list[str]]:
    """Names of the files and of the folders in a folder; none if it cannot be read."""
    files: list[str] = []
    folders: list[str] = []
    try:
        with os.scandir(folder) as entries:
            for entry in sorted(entries, key=lambda entry: entry.name):
                (folders if entry.is_dir(follow_symlinks=False) else files).append(entry.name)
    except OSError:
        return [], []
    return files, folders


def _list_of(result: Search, path: Path, is_direct: bool) -> list[Path]:
    """The list of the result to which a file belongs."""
    if path.is_dir() or not (is_direct or path.is_file()):  # a link to a folder, or what cannot be read like a file
        return result.others
    try:
        text = source.contents(path, str(path)).decode("utf-8", "replace")
    except Findings:
        return result.icds if is_direct else result.others  # reported when it is read as an ICD
    keys = set(_KEY.findall(text))
    if "icdgen" in keys:
        return result.icds
    if not is_direct:
        return result.others
    if "errata" in keys:
        return result.overlays
    # Empty files, and those in another encoding, have no keys at all.
    return result.icds if not keys or "messages" in keys else result.others
