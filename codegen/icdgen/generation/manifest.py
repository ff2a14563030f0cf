"""Manifest of a folder: the files that icdgen wrote there for a language, so that it
changes no other files.
"""

from __future__ import annotations

import hashlib
import json
from pathlib import Path


def path(out: Path, language: str) -> Path:
    """Return the path of the manifest of a language."""
    return out / f".icdgen-{language}.json"


def read(out: Path, language: str) -> dict[str, str]:
    """Return the SHA-256 of each file that icdgen wrote, by relative path; empty
    without a readable manifest.
    """
    try:
        data = json.loads(path(out, language).read_text(encoding="utf-8"))
        files = data["files"]
    except (OSError, ValueError, KeyError, TypeError, RecursionError):
        return {}
    if not isinstance(files, dict):
        return {}
    return {
        str(name): str(digest)
        for name, digest in files.items()
        if _is_inside(str(name))
    }


def text(files: dict[str, str]) -> str:
    """Return the text of a manifest; equal for equal files."""
    content = {"generator": "icdgen", "files": dict(sorted(files.items()))}
    return json.dumps(content, indent=1) + "\n"


def digest(data: bytes) -> str:
    """Return the SHA-256 of the content of a file, in hexadecimal."""
    return hashlib.sha256(data).hexdigest()


def _is_inside(name: str) -> bool:
    """Return whether a path of a manifest is in the folder; a manipulated manifest must
    not remove other files.
    """
    parts = Path(name).parts
    return (
        bool(parts)
        and "\0" not in name
        and ".." not in parts
        and not Path(name).is_absolute()
    )
