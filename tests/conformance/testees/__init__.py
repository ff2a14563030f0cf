"""The testees: programs that answer requests about the generated code of a language,
one backend each.

They are registered like backends of another package. They are not part of icdgen.
"""

from __future__ import annotations

from pathlib import Path

from icdgen import backends

TEMPLATES = Path(__file__).with_name("templates")
RUNTIME = Path(__file__).with_name("runtime")

for _name, _class in {
    "c-testee": "c:CTesteeBackend",
    "python-testee": "python:PythonTesteeBackend",
    "rust-testee": "rust:RustTesteeBackend",
    "js-testee": "javascript:JsTesteeBackend",
}.items():
    backends.register(_name, f"{__name__}.{_class}")
