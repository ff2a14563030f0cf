"""Run the generated code of every language with the same requests and compare the
answers with the reference codec.
"""

from __future__ import annotations

import sys
from importlib.util import find_spec
from pathlib import Path

ROOT = Path(__file__).parent.parent.parent

if find_spec("icdgen") is None:  # run from a checkout where icdgen is not installed
    sys.path.insert(0, str(ROOT / "codegen"))
