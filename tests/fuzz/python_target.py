"""atheris harness on the dispatchers of a generated package.

The package must be on the import path. See README.md.

``python python_target.py PACKAGE [libFuzzer options] [corpus]``
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
        if not _info.name.endswith(("_columns", "testee")):
            import_module(_info.name)
    from python_dispatch import Dispatch

    dispatch = Dispatch(package)
    # Types load on first use: load them while imports are instrumented.
    for _node in dispatch.nodes:
        for _messages in (_node.TELECOMMANDS, _node.TELEMETRY):
            for _id in _messages:
                for _message in _messages.of(_id):
                    _message()

if __name__ == "__main__":
    atheris.Setup(sys.argv, dispatch.run)
    atheris.Fuzz()
