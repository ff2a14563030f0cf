"""The repository keeps its own rules: generated code is current, Python is formatted,
linted and typed, and a wheel is complete.
"""

from __future__ import annotations

import ast
import re
import subprocess
import sys
from pathlib import Path

import pytest
import yaml

from tests.conftest import ROOT

PYTHON = [
    name
    for name in ("codegen", "tests", "bench", "examples", "scripts")
    if (ROOT / name).is_dir()
]
# Folders that tools create.
CACHES = {".ruff_cache", ".mypy_cache", ".pytest_cache", "__pycache__", "target"}


def test_generated_code_of_the_shipped_icds_is_current():
    command = [sys.executable, "-m", "icdgen", "--check", "--out", "generated"]
    command += [
        word for name in ("c", "python", "rust", "vectors") for word in ("--lang", name)
    ]
    result = subprocess.run([*command, "icd"], cwd=ROOT, capture_output=True, text=True)
    assert result.returncode == 0, (
        f"run scripts/regenerate\n{result.stdout}{result.stderr}"
    )


def test_the_generator_contains_no_name_of_a_device():
    names = set()
    for path in (ROOT / "icd").glob("*.yaml"):
        data = yaml.load(path.read_text(encoding="utf-8"), yaml.CSafeLoader)
        names |= {data["node"]["name"], *data.get("vocabulary", [])} - {
            "common",
            "bootloader",
        }
    word = re.compile(
        rf"(?<![a-z])(?:{'|'.join(sorted(names | {'CubeSpace'}))})", re.IGNORECASE
    )
    files = [
        p
        for top in ("codegen", "templates", "runtime")
        for p in (ROOT / top).rglob("*")
        if p.is_file() and p.suffix != ".pyc" and not CACHES.intersection(p.parts)
    ]
    assert [
        f"{p.relative_to(ROOT)}: {m.group()}"
        for p in files
        if (m := word.search(p.read_text("utf-8")))
    ] == []


@pytest.mark.parametrize("command", [["check"], ["format", "--check"]])
def test_python_is_linted_and_formatted(command):
    result = subprocess.run(
        [sys.executable, "-m", "ruff", *command, *PYTHON],
        cwd=ROOT,
        capture_output=True,
        text=True,
    )
    assert result.returncode == 0, result.stdout + result.stderr


def test_only_vectors_are_generated_from_the_reference_of_links():
    """Other tools use the runtime itself."""
    judging = {"reference", "operations", "scripts", "procedures", "request_keys"}
    importing = []
    for path in (ROOT / "codegen").rglob("*.py"):
        inside = path.relative_to(ROOT / "codegen/icdgen")
        if inside.parts[0] in ("runtime_objects", "vectors"):
            continue
        for node in ast.walk(ast.parse(path.read_text("utf-8"))):
            if isinstance(node, ast.ImportFrom) and node.module:
                names = {f"{node.module}.{alias.name}" for alias in node.names} | {
                    node.module
                }
            elif isinstance(node, ast.Import):
                names = {alias.name for alias in node.names}
            else:
                continue
            used = {
                name.split(".")[2]
                for name in names
                if name.startswith("icdgen.runtime_objects.")
            } & judging
            importing += [f"{path.relative_to(ROOT)}: {name}" for name in sorted(used)]
    assert importing == []


def test_python_is_typed():
    command = [sys.executable, "-m", "mypy", "--strict", "codegen/icdgen"]
    result = subprocess.run(command, cwd=ROOT, capture_output=True, text=True)
    assert result.returncode == 0, result.stdout + result.stderr


def test_no_source_file_has_more_than_700_lines():
    large = {
        str(p.relative_to(ROOT)): n
        for top in ("codegen", "templates", "runtime")
        for p in (ROOT / top).rglob("*")
        if p.suffix in (".py", ".j2", ".h", ".rs")
        and (n := len(p.read_text("utf-8").splitlines())) > 700
    }
    assert large == {}


def test_a_wheel_holds_templates_runtimes_icds_and_schemas_and_works_alone(tmp_path):
    subprocess.run(
        [
            sys.executable,
            "-m",
            "pip",
            "wheel",
            "--quiet",
            "--no-deps",
            "--wheel-dir",
            str(tmp_path),
            str(ROOT),
        ],
        check=True,
    )
    site = tmp_path / "site"
    wheel = next(tmp_path.glob("*.whl"))
    subprocess.run(
        [sys.executable, "-m", "zipfile", "-e", str(wheel), str(site)], check=True
    )
    code = f"import sys; sys.path.insert(0, {str(site)!r}); import icdgen; assert {str(site)!r} in icdgen.__file__; "
    code += "from icdgen.cli import main; main(sys.argv[1:])"
    command = [sys.executable, "-c", code, "--lang", "c", "--out", "out"]
    result = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True)
    assert result.returncode == 0, result.stderr
    assert (tmp_path / "out" / "cubeacp.h").is_file()
    assert Path(site, "icdgen", "icd", "schema.json").is_file()
    assert [path for path in site.rglob("*") if "testee" in path.name] == []
    result = subprocess.run(
        [*command[:3], "--examples-dir"], cwd=tmp_path, capture_output=True, text=True
    )
    assert (
        result.stdout.strip().startswith(str(site))
        and Path(result.stdout.strip(), "port.h").is_file()
    )
