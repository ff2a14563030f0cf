"""Small ICDs of what the shipped ones do not have: other bit orders, odd widths, scaled
64-bit fields, odd names.
"""

from __future__ import annotations

import shutil
from pathlib import Path

from tests.conftest import ROOT

FOLDER = Path(__file__).parent / "odd_icds"
_VARIABLE = ("common", "apart", "open", "mux")


def write(folder: Path) -> Path:
    """The folder, with the ICDs in it."""
    shutil.copytree(FOLDER, folder, dirs_exist_ok=True)
    return folder


def variable(folder: Path) -> list[Path]:
    """Files of messages of variable length, shared ids and conditions: odd ones, and
    devices of others.
    """
    write(folder)
    devices = ROOT / "examples" / "devices"
    return [
        *(folder / f"{name}.yaml" for name in _VARIABLE),
        *(devices / name / f"{name}.yaml" for name in ("mavlink", "ublox")),
    ]
