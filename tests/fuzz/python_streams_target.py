"""atheris harness on the stream decoders of a generated package.

The package must be on the import path. See README.md.

``python python_streams_target.py PACKAGE [libFuzzer options] [corpus]``
"""

from __future__ import annotations

import pkgutil
import sys
from importlib import import_module
from pathlib import Path

import atheris

sys.path.insert(0, str(Path(__file__).parent))
PACKAGE = sys.argv.pop(1)

with atheris.instrument_imports(include=[PACKAGE]):
    package = import_module(PACKAGE)
    for _info in pkgutil.walk_packages(package.__path__, f"{PACKAGE}."):
        if ".wire" in _info.name or _info.name.endswith("._link"):
            import_module(_info.name)
    from python_streams import Streams

    streams = Streams(package)

if __name__ == "__main__":
    atheris.Setup(sys.argv, streams.run)
    atheris.Fuzz()
