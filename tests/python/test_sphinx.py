"""Sphinx documents a generated package without warnings, with all attributes.

The tests build HTML pages with `sphinx.ext.autodoc` and search their text.
"""

from __future__ import annotations

import doctest
import html
import re
import subprocess
import sys

CONFIGURATION = """
import sys

sys.path.insert(0, {folder!r})
project = {package!r}
extensions = ["sphinx.ext.autodoc"]
autodoc_default_options = {{"members": True, "undoc-members": True, "show-inheritance": True}}
suppress_warnings = ["ref.python"]  # attributes may be called like built-in types: `type`, `bytes`
"""
SHIPPED = (
    "_enumeration", "_errors", "_types", "_fields", "_base", "_codec", "_columns", "cubewheel", "wire.async_session",
    "wire.can", "wire.client", "wire.events", "wire.files", "wire.link", "wire.logs", "wire.procedures", "wire.procedure_forms",
    "wire.session", "wire.times", "wire.uart", "cubeacp.procedures", "cubeacp._types.estimated_attitude_angles",
    "cubeacp._types.current_adcs_state", "cubeacp._types.con_mode_select",
    "cubewheel._types.wheel_speed",
)  # fmt: skip


def pages(package, modules, folder) -> str:
    """Build the page of some modules and return its text; fail if Sphinx warns."""
    source, out = folder / "source", folder / "out"
    source.mkdir()
    names = [package.name, *(f"{package.name}.{module}" for module in modules)]
    sections = [
        f"{name}\n{'=' * len(name)}\n\n.. automodule:: {name}\n" for name in names
    ]
    (source / "index.rst").write_text(
        "Messages\n########\n\n" + "\n".join(sections), encoding="utf-8"
    )
    configuration = CONFIGURATION.format(
        folder=str(package.folder), package=package.name
    )
    (source / "conf.py").write_text(configuration, encoding="utf-8")
    command = [
        sys.executable,
        "-m",
        "sphinx",
        "-q",
        "-W",
        "--keep-going",
        "-b",
        "html",
        str(source),
        str(out),
    ]
    done = subprocess.run(command, capture_output=True, text=True)
    assert done.returncode == 0, done.stdout + done.stderr
    return html.unescape(
        re.sub(r"<[^>]+>", "", (out / "index.html").read_text(encoding="utf-8"))
    )


def test_sphinx_makes_pages_of_the_shipped_package(shipped, tmp_path):
    text = pages(shipped, SHIPPED, tmp_path)
    assert "Estimated Roll Angle in deg: -327.68 to 327.67." in text
    assert "estimated_roll_angle_deg: float" in text
    assert "Request telemetry or read a configuration." in text


def test_examples_in_docstrings_pass_doctest(shipped):
    results = [doctest.testmod(shipped.module(name)) for name in ("_errors", "_codec")]
    assert [result.failed for result in results] == [0, 0] and all(
        result.attempted for result in results
    )


def test_sphinx_shows_hostile_descriptions_of_an_icd_as_text(odd, tmp_path):
    modules = [
        f"{node.name}._types.{path.stem}"
        for node in odd.icd.nodes
        for path in sorted(
            (odd.folder / odd.name / node.name / "_types").glob("[!_]*.py")
        )
    ]
    assert pages(odd, modules[:15], tmp_path)
