"""Search for ICDs in a folder and its subfolders.

`search` tells ICDs from errata overlays and other YAML files by their keys, without
parsing them. `icdgen.icd.load` calls it for each folder that a user names.
"""

from __future__ import annotations

import os
import re
from dataclasses import dataclass, field
from pathlib import Path

from icdgen.diagnostics import Findings
from icdgen.icd import source

MOST_FOLDERS = 5000  # limit of one search, to stop `icdgen check /`

# Subfolders with build output or with files of tools. A folder that the user names is
# searched whatever its name is.
_SKIPPED = frozenset(
    {
        "__pycache__",
        "_build",
        "build",
        "dist",
        "errata",
        "generated",
        "node_modules",
        "site",
        "target",
        "venv",
    }
)
_ENVIRONMENT = "pyvenv.cfg"  # marks a virtual environment of any name

# Keys at the start of a line, or behind the brace of a file in JSON. A search that
# parsed each YAML file of a folder would take seconds.
_KEY = re.compile(r"""^(?:\{\s*)?["']?([A-Za-z_][\w.-]*)["']?\s*:""", re.MULTILINE)


@dataclass
class Search:
    """Result of a search: the ICDs, and all folders and YAML files that were examined."""

    icds: list[Path] = field(default_factory=list)
    folders: list[Path] = field(default_factory=list)
    # Errata overlays in the folder itself.
    overlays: list[Path] = field(default_factory=list)
    other_files: list[Path] = field(default_factory=list)  # other *.yaml files
    is_complete: bool = True  # whether the search ended before `MOST_FOLDERS`


def search(top: Path) -> Search:
    """Return the ICDs of a folder and its subfolders, in the order of their paths.

    A file *.yaml is an ICD if it has the key `icdgen`. In the folder itself, a file is
    also an ICD if it has no keys at all or the key `messages`, so that `icdgen check`
    can report what it lacks. Errata overlays and other YAML files are not ICDs. Hidden
    folders, virtual environments and folders of build output are skipped. Links to
    folders are not followed.
    """
    result = Search()
    queue = [top]
    while queue:
        folder = queue.pop(0)
        if len(result.folders) == MOST_FOLDERS:
            result.is_complete = False
            break
        files, subfolders = _entries(folder)
        if folder != top and _ENVIRONMENT in files:
            continue
        result.folders.append(folder)
        for name in files:
            if name.endswith(".yaml") and not name.startswith("."):
                path = folder / name
                _list_of(result, path, is_direct=folder == top).append(path)
        queue += (
            folder / name
            for name in subfolders
            if name not in _SKIPPED and not name.startswith(".")
        )
    result.icds.sort(key=lambda path: (len(path.parts), path))
    return result


def icds_of_project(folder: Path) -> list[Path]:
    """Return the ICDs directly in a folder, and its subfolder ``icd`` if it has ICDs."""
    result = Search()
    for name in _entries(folder)[0]:
        if name.endswith(".yaml") and not name.startswith("."):
            _list_of(result, folder / name, is_direct=False).append(folder / name)
    usual = folder / "icd"
    return [*result.icds, *([usual] if search(usual).icds else [])]


def _entries(folder: Path) -> tuple[list[str], list[str]]:
    """Return the names of the files and of the subfolders of a folder; empty lists if
    it cannot be read.
    """
    files: list[str] = []
    folders: list[str] = []
    try:
        with os.scandir(folder) as entries:
            for entry in sorted(entries, key=lambda entry: entry.name):
                (folders if entry.is_dir(follow_symlinks=False) else files).append(
                    entry.name
                )
    except OSError:
        return [], []
    return files, folders


def _list_of(result: Search, path: Path, is_direct: bool) -> list[Path]:
    """Return the list of the result that a file belongs to."""
    # Links to folders, pipes and devices.
    if path.is_dir() or not (is_direct or path.is_file()):
        return result.other_files
    try:
        text = source.contents(path, str(path)).decode("utf-8", "replace")
    except Findings:
        # Loading it as an ICD reports why it cannot be read.
        return result.icds if is_direct else result.other_files
    keys = set(_KEY.findall(text))
    if "icdgen" in keys:
        return result.icds
    if not is_direct:
        return result.other_files
    if "errata" in keys:
        return result.overlays
    # Empty files, and files in another encoding, have no keys at all.
    return result.icds if not keys or "messages" in keys else result.other_files
