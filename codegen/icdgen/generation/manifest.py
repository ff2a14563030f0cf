"""What we wrote into a folder, so that we can tell our files from others'. One manifest a language."""

from __future__ import annotations

import hashlib
import json
from pathlib import Path


def path(out: Path, language: str) -> Path:
    return out / f".icdgen-{language}.json"


def read(out: Path, language: str) -> dict[str, str]:
    """Relative path -> SHA-256 of each file that we wrote; empty where there is no (readable) manifest."""
    try:
        data = json.loads(path(out, language).read_text(encoding="utf-8"))
        files = data["files"]
    except (OSError, ValueError, KeyError, TypeError, RecursionError):
        return {}
    if not isinstance(files, dict):
        return {}
    return {str(name): str(digest) for name, digest in files.items() if _is_inside(str(name))}


def text(files: dict[str, str]) -> str:
    """The manifest's text; the same for the same files."""
    return json.dumps({"generator": "icdgen", "files": dict(sorted(files.items()))}, indent=1) + "\n"


def digest(data: bytes) -> str:
    return hashlib.sha256(data).hexdigest()


def _is_inside(name: str) -> bool:
    parts = Path(name).parts
    return bool(parts) and "\0" not in name and ".." not in parts and not Path(name).is_absolute()
