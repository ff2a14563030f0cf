"""atheris harness on the dispatchers of the generated package, which must be on the
path.

See README.md.

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
    for _node in (
        dispatch.nodes
    ):  # types load on first use: load them while imports are instrumented
        for _messages in (_node.TELECOMMANDS, _node.TELEMETRY):
            for _message in (one for id in _messages for one in _messages.of(id)):
                _message()

if __name__ == "__main__":
    atheris.Setup(sys.argv, dispatch.one)
    atheris.Fuzz()
