"""Names with the same first 63 characters are shortened to unique names in C.

C99 does not distinguish them. Other names stay unchanged.
"""

from __future__ import annotations

import re
import subprocess

import pytest

from icdgen.backends.c.short_names import SIGNIFICANT, short_names
from icdgen.icd.identifiers import Identifier
from tests.conftest import ROOT

LONG = "Temperature of the cooling water behind the second heat exchanger"
ICD = f"""\
icdgen: 1
node: {{name: engine, title: Engine, byte_order: little, bit_order: lsb0}}
messages:
  - name: Status
    id: 1
    kind: telemetry
    length: 3
    fields:
      - {{at: 0, bits: 8, name: {LONG} inlet, type: uint, unit: C, formula: raw*0.5}}
      - {{at: 8, bits: 8, name: {LONG} outlet, type: uint, unit: C, formula: raw*0.5}}
      - {{at: 16, bits: 8, name: Speed, type: uint}}
"""


def test_only_names_with_the_same_beginning_are_shortened_to_unique_names():
    texts = [
        "a" * 70 + "_x",
        "a" * 70 + "_y",
        "B" * 70 + "_X",
        "B" * 70 + "_Y",
        "c" * 90,
        "short",
    ]
    short = short_names(Identifier("C", text, "", None) for text in texts)
    assert set(short) == set(texts[:4])
    assert (
        len({text[:SIGNIFICANT] for text in short.values()}) == 4
        and max(map(len, short.values())) <= SIGNIFICANT
    )
    assert all(name.isupper() == text.isupper() for text, name in short.items())


@pytest.mark.needs("gcc")
def test_generated_c_with_long_names_has_unique_names_and_passes_its_self_test(
    tmp_path,
):
    import sys

    (tmp_path / "engine.yaml").write_text(ICD)
    for lang in ("c", "c-selftest"):
        command = [
            sys.executable,
            "-m",
            "icdgen",
            "--lang",
            lang,
            "--out",
            str(tmp_path / lang),
            str(tmp_path / "engine.yaml"),
        ]
        result = subprocess.run(command, capture_output=True, text=True, cwd=ROOT)
        assert result.returncode == 0, result.stdout + result.stderr
    text = "".join(path.read_text() for path in (tmp_path / "c").rglob("*.h"))
    names = set(
        re.findall(
            r"\b[A-Za-z_]\w*",
            re.sub(r"/\*.*?\*/|#include.*", "", text, flags=re.DOTALL | re.NOFLAG),
        )
    )
    assert len({name[:SIGNIFICANT] for name in names}) == len(names)
    assert "engine_status_speed" in text or "speed;" in text
    sources = [str(path) for path in (tmp_path / "c-selftest").rglob("*.c")]
    includes = [f"-I{tmp_path / 'c'}", f"-I{tmp_path / 'c-selftest'}"]
    command = [
        "gcc",
        "-std=c99",
        "-Wall",
        "-Wextra",
        "-Werror",
        "-c",
        *includes,
        *sources,
    ]
    result = subprocess.run(command, capture_output=True, text=True, cwd=tmp_path)
    assert result.returncode == 0, result.stderr[:2000]
