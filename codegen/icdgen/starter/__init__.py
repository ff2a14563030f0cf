"""A first ICD: a commented device that is ready to check, generate and simulate."""

from __future__ import annotations

import os
import re
from pathlib import Path
from typing import TYPE_CHECKING

from icdgen import config, shipped
from icdgen.errors import UserError
from icdgen.generation.write import replace
from icdgen.naming import latin

if TYPE_CHECKING:
    from icdgen.starter.style import Style

_NAME = re.compile(r"[a-z][a-z0-9_]{0,63}")
_CONFIG = 'icds = ["icd"]\nout = "generated"\n'


def write(folder: Path, name: str, style: Style | None = None, origin: str = "") -> list[Path]:
    """Writes ``icd/NAME.yaml``, its errata file and, unless there is one, ``icdgen.toml``; what is there already stays.

    ``style`` is that of the node ``origin``, if it is to be taken over.
    Raises `UserError`, before anything is written, if the name cannot be a node's or a file of that name is there.
    """
    if not _NAME.fullmatch(name):
        proposal = re.sub(r"[^a-z0-9]+", "_", latin(name).lower()).strip("_").lstrip("0123456789_")[:64]
        help = f"for instance `icdgen init {proposal or 'battery'}`"
        raise UserError(f"`{name}` cannot name a node: lower-case letters, digits and _, a letter first", help)
    device = _filled("device.yaml", name)
    if style is not None:
        from icdgen.starter.style import in_style

        device = in_style(device, style, origin)
    files = {
        folder / "icd" / f"{name}.yaml": device,
        folder / "icd" / "errata" / f"{name}.yaml": _filled("errata.yaml", name),
    }
    for path in files:
        if os.path.lexists(path):
            raise UserError(f"{path.relative_to(folder)} is there already", "take another name, or move the file away")
    if not os.path.lexists(folder / config.NAME):
        files[folder / config.NAME] = _CONFIG
    for path, text in files.items():
        replace(path, text.encode())
    return [path.relative_to(folder) for path in files]


def _filled(template: str, name: str) -> str:
    text = (shipped.templates() / "init" / template).read_text(encoding="utf-8")
    return text.replace("{{ name }}", name).replace("{{ title }}", name.replace("_", " ").capitalize())
