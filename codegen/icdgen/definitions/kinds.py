"""Kinds of definitions, their readers, and the detection of the kind of a file.

A reader is loaded only when it is needed. `model.DefinitionReader` is the interface
that readers implement, also those of plug-ins.
"""

from __future__ import annotations

import os
from collections.abc import Sequence
from importlib import import_module
from importlib.util import find_spec
from pathlib import Path
from typing import cast

from icdgen.definitions.model import (
    DefinitionReader,
    Definitions,
    SourceFile,
    unreadable,
)
from icdgen.diagnostics import Findings
from icdgen.errors import UserError

GROUP = "icdgen.definitions"
# readers need up to about a gigabyte of memory for a file of this size
MAX_BYTES = 8_000_000
_START = 65_536  # bytes that identify the kind of a file

_BUILT_IN = {
    "dbc": "icdgen.definitions.can:Dbc",
    "kcd": "icdgen.definitions.can:Kcd",
    "sym": "icdgen.definitions.can:Sym",
    "arxml": "icdgen.definitions.can:Arxml",
    "mavlink": "icdgen.definitions.mavlink:MavLink2",
    "mavlink1": "icdgen.definitions.mavlink:MavLink1",
    "xtce": "icdgen.definitions.xtce:Xtce",
    "eds": "icdgen.definitions.eds:Eds",
    "ksy": "icdgen.definitions.kaitai:Kaitai",
    "sunspec": "icdgen.definitions.sunspec:SunSpec",
}


def names() -> list[str]:
    """Return the names of all kinds: built-in ones first, then plug-ins."""
    return [*_BUILT_IN, *sorted(_plug_ins())]


def reader_of_kind(name: str) -> DefinitionReader:
    """Return the reader of a kind.

    Raises `UserError` if the kind is unknown or its reader cannot be loaded.
    """
    target = (_plug_ins() | _BUILT_IN).get(name)
    if target is None:
        raise UserError(
            f"there is no kind of definition `{name}`",
            f"there are {', '.join(names())}",
        )
    module, _, attribute = target.partition(":")
    try:
        return cast(DefinitionReader, getattr(import_module(module), attribute)())
    except (ImportError, AttributeError) as error:
        raise UserError(
            f"the reader of `{name}`, {target}, cannot be loaded: {error}"
        ) from None


def reader_of_file(path: Path) -> DefinitionReader | None:
    """Return the reader that recognizes a file by its beginning, or else by its suffix.

    Returns None for manuals and unreadable files.
    """
    try:
        with open(path, "rb") as file:
            start = file.read(_START)
    except OSError:
        return None
    if start.startswith(b"%PDF"):  # a manual, which other modules import
        return None
    text = start.decode("utf-8-sig", "replace")
    readers = [reader_of_kind(name) for name in names()]
    # The suffix decides only if no reader recognizes the content.
    by_suffix = (
        reader for reader in readers if path.suffix.lower() == f".{reader.name}"
    )
    return next(
        (reader for reader in readers if reader.knows(text)), next(by_suffix, None)
    )


def within(folder: Path) -> list[tuple[Path, DefinitionReader]]:
    """Return the definitions in a folder and its subfolders, by path.

    Other files and hidden folders are ignored.
    """
    definitions: list[tuple[Path, DefinitionReader]] = []
    for where, folders, files in os.walk(folder):
        folders[:] = sorted(
            subfolder for subfolder in folders if not subfolder.startswith(".")
        )
        for name in sorted(files):
            path = Path(where, name)
            if path.is_file() and (reader := reader_of_file(path)) is not None:
                definitions.append((path, reader))
    return sorted(definitions, key=lambda pair: pair[0])


def read_set(paths: Sequence[Path], reader: DefinitionReader) -> list[Definitions]:
    """Read files of one kind, together if they may refer to each other.

    An unreadable file is reported in its own definitions. Raises `UserError` if a
    library is missing.
    """
    _check_libraries(reader)
    most = getattr(reader, "most_bytes", MAX_BYTES)
    result: list[Definitions] = []
    sources: list[SourceFile] = []
    for path in paths:
        try:
            sources.append(SourceFile(str(path), contents(path, most)))
        except Findings as error:
            result.append(Definitions(str(path)))
            result[-1].refuse(error)
    if (together := getattr(reader, "read_set", None)) is not None:
        return [*result, *together(sources)]
    for source in sources:
        try:
            result.append(reader.read(*source))
        except Findings as error:
            result.append(Definitions(source.file))
            result[-1].refuse(error)
    return result


def read(path: Path, reader: DefinitionReader) -> Definitions:
    """Read a file.

    Raises `Findings` if the file cannot be read, and `UserError` if a library is
    missing.
    """
    _check_libraries(reader)
    return reader.read(
        str(path), contents(path, getattr(reader, "most_bytes", MAX_BYTES))
    )


def _check_libraries(reader: DefinitionReader) -> None:
    """Raise `UserError` if a library of a reader is missing."""
    missing = [module for module in reader.needs if find_spec(module) is None]
    if missing:
        raise UserError(
            f"reading {reader.title} takes {' and '.join(missing)}, which {'is' if len(missing) == 1 else 'are'} not installed",
            "pip install 'icdgen[definitions]'",
        )


def contents(path: Path, most: int = MAX_BYTES) -> bytes:
    """Return the bytes of a file.

    Raises `Findings` if it cannot be read or has more than ``most`` bytes.
    """
    try:
        with open(path, "rb") as file:
            data = file.read(most + 1)
    except OSError as error:
        raise unreadable(
            str(path), f"cannot read the file: {error.strerror}", "check the path"
        ) from None
    if len(data) > most:
        raise unreadable(
            str(path),
            f"the file has more than the {most:,} bytes allowed",
            "import it in parts",
        )
    return data


def _plug_ins() -> dict[str, str]:
    """Return the readers of other packages by kind.

    Plug-ins with a built-in name are ignored.
    """
    from importlib.metadata import entry_points

    return {
        point.name: point.value
        for point in entry_points(group=GROUP)
        if point.name not in _BUILT_IN
    }
