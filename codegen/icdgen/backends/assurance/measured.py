"""Measurements of a verification package, read from JSON files. Commands that run
compilers and tests write them.

``icd`` is the digest of the measured set of ICDs, and ``code`` the digest of the
measured code for each language. The package accepts a measurement only if both match
its own ICDs and code.
"""

from __future__ import annotations

import json
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from hashlib import sha256
from itertools import chain
from pathlib import Path, PurePosixPath
from typing import Any

from icdgen.errors import UserError
from icdgen.icd.model import Icd

FORMAT = 1
_KEYS = {"icdgen_measurement": int, "name": str, "title": str, "says": list, "icd": str, "code": dict, "made_by": list,
         "facts": list, "columns": list, "rows": list}  # fmt: skip
_AGAIN = "measure again, or leave it out: docs/guides/verification-package.md says how"


@dataclass(frozen=True, slots=True)
class Measurement:
    """Content of one measurement file.

    ``name``: name of its report. ``made_by``: command and tools.
    """

    name: str
    title: str
    says: tuple[str, ...]
    code: dict[str, str]  # language -> digest of the measured code
    made_by: tuple[str, ...]
    facts: tuple[tuple[str, str], ...]
    columns: tuple[str, ...]
    rows: list[list[str]]


def icd_digest(icd: Icd) -> str:
    """Return the digest of a set of ICDs, computed from the digests of its nodes,
    errata included.
    """
    return sha256(
        "".join(f"{node.name} {node.digest}\n" for node in icd.nodes).encode()
    ).hexdigest()


def code_digest(files: Iterable[tuple[PurePosixPath, str | bytes]]) -> str:
    """Return the digest of generated files, computed from their names and contents."""
    contents = (
        (path, content.encode() if isinstance(content, str) else content)
        for path, content in files
    )
    # Sorted, so that the digest does not depend on the order of generation.
    lines = sorted(f"{path} {sha256(data).hexdigest()}\n" for path, data in contents)
    return sha256("".join(lines).encode()).hexdigest()


def read_measurements(
    folder: Path, icd: Icd, code_of: Callable[[str], str]
) -> list[Measurement]:
    """Return the measurements of a folder, sorted by name.

    ``code_of``: function that returns the current digest of the code of a language.
    Raises `UserError` for an unreadable measurement and for a measurement of other ICDs
    or code.
    """
    try:
        paths = sorted(
            path
            for path in folder.iterdir()
            if path.suffix == ".json" and not path.name.startswith(".")
        )
    except OSError as error:
        text = f"{folder}: cannot be read: {error.strerror}"
        raise UserError(text, "--measured names a folder of measurements") from None
    measurements = []
    for path in paths:
        data = _checked_content(path)
        # A measurement of other code would be misleading evidence.
        ours = ("ICDs: the digest", data["icd"], icd_digest(icd))
        code = (
            (f"code: the digest of `{name}`", measured_digest, code_of(name))
            for name, measured_digest in data["code"].items()
        )
        for what, measured_digest, current_digest in chain([ours], code):
            if measured_digest != current_digest:
                text = f"{path}: it measures other {what} is {measured_digest[:16]} there and {current_digest[:16]} here"
                raise UserError(text, _AGAIN)
        rows = [[str(cell) for cell in row] for row in data["rows"]]
        facts = tuple((str(key), str(value)) for key, value in data["facts"])
        says, made_by, columns = (
            tuple(map(str, data[key])) for key in ("says", "made_by", "columns")
        )
        measurements.append(
            Measurement(
                data["name"],
                data["title"],
                says,
                data["code"],
                made_by,
                facts,
                columns,
                rows,
            )
        )
    return sorted(measurements, key=lambda measurement: measurement.name)


def _checked_content(path: Path) -> dict[str, Any]:
    """Return the content of a file.

    Raises `UserError` if it is no measurement.
    """
    try:
        data = json.loads(path.read_text(encoding="utf-8"))
    except (OSError, ValueError, RecursionError) as error:
        raise UserError(f"{path}: cannot be read: {error}", _AGAIN) from None
    if not isinstance(data, dict) or data.get("icdgen_measurement") != FORMAT:
        text = f"{path}: not a measurement (no `icdgen_measurement: {FORMAT}`)"
        raise UserError(text, "keep only measurements in that folder")
    for key, kind in _KEYS.items():
        if type(data.get(key)) is not kind:
            raise UserError(f"{path}: `{key}` is missing or not of its kind", _AGAIN)
    # JSON comes from other programs, so each part is checked before a page shows it.
    if any(type(fact) is not list or len(fact) != 2 for fact in data["facts"]):
        raise UserError(f"{path}: `facts` is missing or not of its kind", _AGAIN)
    width = len(data["columns"])
    if any(type(row) is not list or len(row) != width for row in data["rows"]):
        raise UserError(
            f"{path}: a row has not as many cells as there are columns", _AGAIN
        )
    if not data["name"].replace("-", "").isalnum() or not data["name"].isascii():
        raise UserError(
            f"{path}: `name` is no name for a file", "letters, digits and `-`"
        )
    return data
