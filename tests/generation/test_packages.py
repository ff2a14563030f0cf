"""Names of the generated packages: two projects can be installed together."""

from __future__ import annotations

import re
import shutil
import subprocess
import sys
import tomllib
from pathlib import Path

import pytest

from icdgen import config
from icdgen.backends import packages
from icdgen.errors import UserError
from tests.limits import assert_limits

PROJECTS = ("alpha", "beta")
ICD = """\
icdgen: 1
node: {{name: battery, title: Battery, byte_order: little, bit_order: lsb0}}
messages:
  - {{name: Status, id: 1, kind: telemetry, length: {0}, fields: [{{at: 0, bits: {1}, name: Voltage, type: uint}}]}}
"""


def run(*words: object, cwd: Path) -> str:
    done = subprocess.run(
        list(map(str, words)), cwd=cwd, capture_output=True, text=True, timeout=300
    )
    assert done.returncode == 0, done.stdout + done.stderr
    return done.stdout


@pytest.fixture(scope="module")
def projects(tmp_path_factory) -> Path:
    """Write two projects whose nodes have the same name, with messages of one and two
    bytes.
    """
    top = tmp_path_factory.mktemp("projects")
    for size, name in enumerate(PROJECTS, 1):
        folder = top / name
        (folder / "icd").mkdir(parents=True)
        (folder / "icd" / "battery.yaml").write_text(ICD.format(size, 8 * size))
        (folder / "icdgen.toml").write_text(
            f'name = "{name}"\nicds = ["icd"]\n[c]\nprefix = "{name}"\n'
        )
        languages = [
            word
            for language in ("c", "c-selftest", "python", "rust")
            for word in ("--lang", language)
        ]
        run(sys.executable, "-m", "icdgen", *languages, cwd=folder)
    return top


def test_python_packages_of_two_projects_are_installed_side_by_side(projects, tmp_path):
    target, distributions = tmp_path / "site", set()
    for name in PROJECTS:
        source = tmp_path / f"{name}-source"
        shutil.copytree(projects / name / "generated" / "python", source)
        # As pip does, but without a network: setuptools collects the packages of
        # pyproject.toml.
        run(
            sys.executable,
            "-c",
            "import setuptools; setuptools.setup()",
            "build",
            "--build-lib",
            target,
            cwd=source,
        )
        distributions.add(
            tomllib.loads((source / "pyproject.toml").read_text())["project"]["name"]
        )
    assert distributions == set(PROJECTS) and {
        path.name for path in target.iterdir()
    } == set(PROJECTS)
    code = (
        "from alpha.battery import Status as A\nfrom beta.battery import Status as B\n"
        "print(A.LENGTH, B.LENGTH, A.from_bytes(b'\\x05').voltage, B.from_bytes(b'\\x01\\x01').voltage)"
    )
    assert (
        run(
            sys.executable,
            "-S",
            "-c",
            f"import sys; sys.path.insert(0, {str(target)!r})\n{code}",
            cwd=tmp_path,
        )
        == "1 2 5 257\n"
    )


@pytest.mark.needs("cargo")
def test_a_program_uses_the_crates_of_two_projects(projects, tmp_path):
    needs = "".join(
        f'{name} = {{ path = "{projects / name / "generated" / "rust"}" }}\n'
        for name in PROJECTS
    )
    (tmp_path / "Cargo.toml").write_text(
        f'[package]\nname = "program"\nversion = "0.1.0"\nedition = "2021"\n[dependencies]\n{needs}'
    )
    (tmp_path / "src").mkdir()
    (tmp_path / "src" / "main.rs").write_text(
        "fn main() {\n"
        "    let a = alpha::battery::Status::from_bytes(&[5]).unwrap();\n"
        "    let b = beta::battery::Status::from_bytes(&[1, 1]).unwrap();\n"
        '    println!("{} {}", a.voltage, b.voltage);\n}\n'
    )
    assert run("cargo", "run", "--quiet", "--offline", cwd=tmp_path) == "5 257\n"


@pytest.mark.needs("cc")
def test_a_program_in_c_uses_nodes_of_one_name_of_two_projects(projects, tmp_path):
    (tmp_path / "main.c").write_text(
        '#include <stdio.h>\n#include "alpha_battery.h"\n#include "beta_battery.h"\n'
        "int main(void)\n{\n    const uint8_t bytes[] = {1, 1};\n"
        "    alpha_battery_status_t a;\n    beta_battery_status_t b;\n"
        "    if (alpha_battery_status_decode(&a, bytes, ALPHA_BATTERY_STATUS_LENGTH) != ICD_OK) return 1;\n"
        "    if (beta_battery_status_decode(&b, bytes, BETA_BATTERY_STATUS_LENGTH) != ICD_OK) return 1;\n"
        '    printf("%u %u\\n", (unsigned)a.voltage, (unsigned)b.voltage);\n    return 0;\n}\n'
    )
    folders = [f"-I{projects / name / 'generated' / 'c'}" for name in PROJECTS]
    run(
        "cc",
        "-std=c99",
        "-Wall",
        "-Wextra",
        "-Werror",
        *folders,
        "main.c",
        "-o",
        "main",
        cwd=tmp_path,
    )
    assert run(tmp_path / "main", cwd=tmp_path) == "1 257\n"


def test_nothing_that_an_icd_names_is_without_the_prefix_in_c(projects):
    for language in ("c", "c-selftest"):
        for path in (projects / "alpha" / "generated" / language).rglob("*.[ch]"):
            text = re.sub(r"/\*.*?\*/", "", path.read_text(), flags=re.DOTALL)
            assert re.findall(r"(?i)(?<![a-z_])battery_\w+|\"battery", text) == [], path


@pytest.mark.needs("cc")
def test_the_self_test_of_prefixed_c_passes(projects, tmp_path):
    generated = projects / "beta" / "generated"
    sources = sorted((generated / "c-selftest").rglob("*.c"))
    (tmp_path / "main.c").write_text(
        '#include "icdgen_selftest.h"\nint main(void)\n{\n    icdgen_selftest_totals_t totals = {0};\n'
        "    icdgen_selftest(icdgen_selftest_nodes[0], &totals, NULL, NULL);\n"
        "    return totals.failures == 0u && totals.checks > 0u ? 0 : 1;\n}\n"
    )
    includes = [f"-I{generated / 'c'}", f"-I{generated / 'c-selftest'}"]
    run(
        "cc",
        "-std=c99",
        *includes,
        *sources,
        "main.c",
        "-lm",
        "-o",
        "main",
        cwd=tmp_path,
    )
    run(tmp_path / "main", cwd=tmp_path)


@pytest.mark.parametrize(
    ("text", "place", "words"),
    [
        (
            'icds = ["icd"]\n[python]\npackage = "class"\n',
            "3:1",
            "`package` cannot be `class`: it is a reserved word of Python",
        ),
        (
            '[python]\n  package = "json"\n',
            "2:3",
            "is a module of Python's standard library",
        ),
        (
            '[python]\npackage = "My-Package"\n',
            "2:1",
            "takes lower-case letters, digits and _",
        ),
        ('rust.crate = "match"\n', "1:1", "is a reserved word of Rust"),
        ('[rust]\ncrate = "std"\n', "2:1", "is a crate that comes with the compiler"),
        (
            '[c]\nprefix = "icd"\n',
            "2:1",
            "is the beginning of the names of the support layer",
        ),
        ('[c]\nprefix = "1a"\n', "2:1", "a letter first"),
        ('[c]\nprefix = "a_"\n', "2:1", "ends with _, which is added"),
        ('icds = []\nname = "a b"\n', "2:1", "`name` cannot be `a b`"),
        ('name = "select"\n', "1:1", "give `package` in [python]"),
        ('icds = []\n\n[rust]\nname = "a"\n', "4:1", "unknown key `name` in [rust]"),
        ('[go]\nmodule = "a"\n', "1:2", "unknown key `go`"),
        ('icds = []\npython = "a"\n', "2:1", "`python` must be a section"),
        ("[c]\nprefix = 1\n", "2:1", "`prefix` must be a text"),
    ],
)
def test_a_name_that_cannot_be_used_is_an_error_with_its_place(
    icdgen, tmp_path, text, place, words
):
    (tmp_path / "icdgen.toml").write_text(text)
    for command in (["check"], ["generate", "--lang", "python"]):
        result = icdgen(*command)
        assert result.status == 2 and words in result.err, result.err
        assert f"icdgen.toml:{place}: " in result.err


@pytest.mark.parametrize(
    ("text", "names"),
    [
        ("icds = []", ("icdgen_messages", "icd", "")),
        ('name = "Red-Pump"', ("red_pump", "red_pump", "")),
        ('name = "pump"\npython.package = "a"', ("a", "pump", "")),
        ('name = "pump"\nc.prefix = "a"', ("pump", "pump", "a_")),
        ('name = "json"\npython.package = "a"', ("a", "json", "")),
        ('name = "match"\nrust.crate = "a"', ("match", "a", "")),
        (
            'name = "class"\npython.package = "a"\nrust.crate = "class"',
            ("a", "class", ""),
        ),
        (
            'name = "icdgen"\npython.package = "a"\nrust.crate = "b"',
            ("a", "b", ""),
        ),
    ],
)
def test_an_explicit_package_name_replaces_that_of_the_project(tmp_path, text, names):
    """A project can have a name that a language reserves if `icdgen.toml` gives the
    name of the package in that language.
    """
    (tmp_path / "icdgen.toml").write_text(text)
    generated = packages.of_project(config.find(tmp_path))
    assert (generated.python, generated.rust, generated.c_prefix) == names


@pytest.mark.parametrize("key", ["name", "python.package", "rust.crate", "c.prefix"])
def test_the_name_of_a_package_has_at_most_40_characters(tmp_path, key):
    def is_accepted(length: int) -> bool:
        (tmp_path / "icdgen.toml").write_text(f'{key} = "{"a" * length}"')
        try:
            packages.of_project(config.find(tmp_path))
        except UserError as error:
            assert "has more than 40 characters" in str(error) or not length
            return False
        return True

    assert_limits(is_accepted, most=40)


def test_the_site_shows_the_names_of_the_project(projects):
    folder = projects / "alpha"
    run(sys.executable, "-m", "icdgen", "docs", cwd=folder)
    page = next((folder / "site").rglob("status.html")).read_text()
    for words in ("alpha_battery_status_t", "from <b>alpha", "alpha::battery"):
        assert re_text(words) in re_text(page), words


def re_text(text: str) -> str:
    return re.sub(r"<[^>]*>", "", text)


def test_without_a_project_the_names_stay_the_same(tmp_path):
    (tmp_path / "battery.yaml").write_text(ICD.format(1, 8))
    run(
        sys.executable,
        "-m",
        "icdgen",
        "--lang",
        "python",
        "--lang",
        "rust",
        "battery.yaml",
        cwd=tmp_path,
    )
    assert (tmp_path / "generated" / "python" / "icdgen_messages").is_dir()
    assert (
        'name = "icd"' in (tmp_path / "generated" / "rust" / "Cargo.toml").read_text()
    )
