from __future__ import annotations

import sys
from pathlib import Path

from tests.diff.release.make import make

print(make(Path(sys.argv[1])))
