"""Loads one module of icdgen with a fault, in every Python process that a test starts.

Python imports this module at its start if the folder is in ``PYTHONPATH``. The variable
``ICDGEN_PLANTED`` contains the path of the module and that of its changed source; the
checkout itself is not changed. Programs that read the module as a file get the changed
source too: generated packages contain a copy of the runtime.
"""

import builtins
import io
import os
import sys
from importlib.machinery import PathFinder, SourceFileLoader

PLANTED = os.environ.get("ICDGEN_PLANTED", "")


class ChangedLoader(SourceFileLoader):
    def get_code(self, fullname):
        with open(PLANTED.split(os.pathsep)[1], encoding="utf-8") as changed:
            return compile(changed.read(), self.path, "exec")


class ChangedFinder:
    @staticmethod
    def find_spec(fullname, path=None, target=None):
        if not fullname.startswith("icdgen"):
            return None
        spec = PathFinder.find_spec(fullname, path, target)
        original = PLANTED.split(os.pathsep)[0]
        if spec and spec.origin and os.path.realpath(spec.origin) == original:
            spec.loader = ChangedLoader(fullname, spec.origin)
        return spec


def redirect_reads(original, changed, open_file=io.open):
    """Let programs that open the original read the changed file."""

    def open_redirected(file, *arguments, **keywords):
        if isinstance(file, str | os.PathLike) and os.path.realpath(file) == original:
            file = changed
        return open_file(file, *arguments, **keywords)

    io.open = builtins.open = open_redirected


if PLANTED:
    sys.meta_path.insert(0, ChangedFinder)
    redirect_reads(*PLANTED.split(os.pathsep))
