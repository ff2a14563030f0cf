"""Print the tests that cover files of icdgen: ``python -m tests.covering FILE ...``.

In: files of the repository. Out: test files and folders, the most specific first.
``scripts/test --for FILE`` runs them; `tests.mutation.tool` runs them on changed code.

Three sources are combined. `FIRST` names tests that are to run first. `COVERING` names
the tests of each folder, which mirror it or test it in all languages. Test modules that
import a module of icdgen are tests of it, unless so many import it that it is only a
tool for them.
"""

from __future__ import annotations

import ast
import sys
from functools import cache
from pathlib import Path, PurePosixPath

ROOT = Path(__file__).parent.parent

# A module that more test modules import is a tool of tests, such as `icdgen.loading`.
MOST_IMPORTING = 12

_LINKS = (
    "tests/conformance/test_wire.py",
    "tests/conformance/test_links.py",
    "tests/conformance/test_protocol.py",
    "tests/conformance/test_outcomes.py",
    "tests/conformance/test_hostile.py",
)
_MESSAGES = (
    "tests/every_language",
    "tests/conformance/test_languages.py",
    "tests/conformance/test_special_words.py",
)

# The longest path that begins the path of a file decides.
COVERING: dict[str, tuple[str, ...]] = {
    "codegen/icdgen/": ("tests/icd", "tests/values", "tests/cli/test_commands.py"),
    "codegen/icdgen/backends/": (
        "tests/generation",
        "tests/describe",
        "tests/test_symbols.py",
    ),
    "codegen/icdgen/backends/assurance/": ("tests/assurance",),
    "codegen/icdgen/backends/c/": (
        "tests/c",
        "tests/test_symbols.py",
        *_MESSAGES,
        *_LINKS,
    ),
    "codegen/icdgen/backends/c/links.py": (
        "tests/c/test_output.py",
        *_LINKS,
        "tests/c",
        "tests/test_symbols.py",
    ),
    "codegen/icdgen/backends/c_selftest/": (
        "tests/c/test_selftest.py",
        "tests/c/test_cmake.py",
        "tests/features",
    ),
    "codegen/icdgen/backends/html/": ("tests/site",),
    "codegen/icdgen/backends/python/": (
        "tests/python",
        "tests/test_symbols.py",
        *_MESSAGES,
        *_LINKS,
    ),
    "codegen/icdgen/backends/rust/": (
        "tests/rust",
        "tests/test_symbols.py",
        *_MESSAGES,
        *_LINKS,
    ),
    "codegen/icdgen/backends/rust/streams.py": (
        "tests/rust/test_wire.py",
        *_LINKS,
        "tests/rust",
    ),
    "codegen/icdgen/backends/tables/": ("tests/show", "tests/features"),
    "codegen/icdgen/backends/vectors.py": ("tests/vectors",),
    "codegen/icdgen/backends/xtce/": ("tests/xtce",),
    "codegen/icdgen/cache.py": ("tests/cli/test_cached_models.py", "tests/generation"),
    "codegen/icdgen/cli.py": ("tests/cli",),
    "codegen/icdgen/codec.py": ("tests/values", "tests/vectors", "tests/devices"),
    "codegen/icdgen/commands/": ("tests/cli",),
    "codegen/icdgen/commands/diff.py": ("tests/diff",),
    "codegen/icdgen/commands/import_.py": ("tests/importer", "tests/definitions"),
    "codegen/icdgen/commands/log.py": ("tests/log",),
    "codegen/icdgen/commands/monitor.py": ("tests/sim", "tests/devices"),
    "codegen/icdgen/commands/send.py": ("tests/sim", "tests/devices"),
    "codegen/icdgen/commands/show.py": ("tests/show",),
    "codegen/icdgen/commands/sim.py": ("tests/sim",),
    "codegen/icdgen/config.py": ("tests/generation", "tests/cli/test_generate.py"),
    "codegen/icdgen/definitions/": ("tests/definitions", "tests/devices"),
    "codegen/icdgen/describe/": ("tests/describe", "tests/generation", *_MESSAGES),
    "codegen/icdgen/diagnostics.py": ("tests/reports", "tests/wrong"),
    "codegen/icdgen/diff/": ("tests/diff",),
    "codegen/icdgen/fingerprints.py": ("tests/cli/test_cached_models.py",),
    "codegen/icdgen/frozen.py": ("tests/test_frozen.py",),
    "codegen/icdgen/generation/": ("tests/generation", "tests/cli/test_generate.py"),
    "codegen/icdgen/icd/": ("tests/icd", "tests/wrong", "tests/values"),
    "codegen/icdgen/icd/fmt/": ("tests/fmt", "tests/cli/test_format_page.py"),
    "codegen/icdgen/icd/layout_copies.py": (
        "tests/icd/test_layout.py",
        "tests/diff/test_attributes.py",
        "tests/assurance",
    ),
    "codegen/icdgen/icd/rules/": ("tests/wrong", "tests/icd"),
    "codegen/icdgen/import_results/": ("tests/importer", "tests/definitions"),
    "codegen/icdgen/importer/": ("tests/importer",),
    "codegen/icdgen/link/": ("tests/sim", "tests/devices"),
    "codegen/icdgen/link_calls.py": ("tests/protocol", *_LINKS),
    "codegen/icdgen/logfile/": ("tests/log",),
    "codegen/icdgen/model_cache.py": ("tests/cli/test_cached_models.py",),
    "codegen/icdgen/naming.py": ("tests/test_naming.py", "tests/test_symbols.py"),
    "codegen/icdgen/procedures/": ("tests/procedures", "tests/sim", "tests/vectors"),
    "codegen/icdgen/protocol/": ("tests/protocol", "tests/vectors", *_LINKS),
    "codegen/icdgen/recognize/": ("tests/recognize", "tests/log"),
    "codegen/icdgen/render.py": ("tests/generation",),
    "codegen/icdgen/reports/": ("tests/reports", "tests/wrong"),
    "codegen/icdgen/runtime_objects/": (
        "tests/runtime_objects",
        "tests/protocol",
        "tests/vectors",
        *_LINKS,
    ),
    "codegen/icdgen/show/": ("tests/show",),
    "codegen/icdgen/sim/": ("tests/sim", "tests/procedures", "tests/devices"),
    "codegen/icdgen/site/": ("tests/site",),
    "codegen/icdgen/starter/": ("tests/cli/test_first_device.py", "tests/cli"),
    "codegen/icdgen/suggest.py": ("tests/test_suggest.py",),
    "codegen/icdgen/values/": ("tests/values", "tests/recognize", "tests/log"),
    "codegen/icdgen/vectors/": ("tests/vectors", "tests/conformance"),
    "docs/": ("tests/test_documents.py", "tests/cli", "tests/fmt"),
    "examples/": ("tests/icd/test_examples.py", "tests/devices"),
    "icd/": ("tests/icd/test_shipped.py", "tests/vectors", "tests/conformance"),
    "runtime/c/": ("tests/c", "tests/runtime", *_MESSAGES, *_LINKS, "tests/hostile"),
    "runtime/c/wire/": (
        "tests/c/test_bus_client.py",
        *_LINKS,
        "tests/c",
        "tests/runtime",
        "tests/every_language",
        "tests/hostile",
    ),
    "runtime/c/wire/crc.c": (
        "tests/runtime/test_checksums.py",
        "tests/c/test_checksums.py",
        *_LINKS,
    ),
    "runtime/c-selftest/": (
        "tests/c/test_selftest.py",
        "tests/c/test_cmake.py",
        "tests/features",
    ),
    "runtime/python/": (
        "tests/python",
        "tests/protocol",
        *_MESSAGES,
        *_LINKS,
        "tests/sim",
    ),
    "runtime/python/icdgen_runtime/_conditions.py": (
        "tests/python/test_optional_fields.py",
        "tests/python",
        *_MESSAGES,
    ),
    "runtime/python/icdgen_runtime/wire/": (
        "tests/protocol",
        *_LINKS,
        "tests/python",
        "tests/every_language",
        "tests/sim",
    ),
    "runtime/rust/src/support/": (
        "tests/rust/test_equivalence.py",
        "tests/rust",
        "tests/runtime",
        *_MESSAGES,
    ),
    "runtime/rust/": ("tests/rust", "tests/runtime", *_MESSAGES, *_LINKS),
    "runtime/rust/src/wire/": (
        "tests/rust/test_wire.py",
        "tests/rust/test_stream_client.py",
        *_LINKS,
        "tests/rust",
        "tests/every_language",
    ),
    "scripts/": ("tests/cli/test_readme.py", "tests/test_house.py"),
    "templates/assurance/": ("tests/assurance",),
    "templates/c/accessors.h.j2": (
        "tests/every_language/test_stories.py",
        "tests/c",
        *_MESSAGES,
    ),
    "templates/c/": ("tests/c", *_MESSAGES, *_LINKS),
    "templates/c-selftest/": (
        "tests/c/test_selftest.py",
        "tests/c/test_cmake.py",
        "tests/features",
    ),
    "templates/diff/": ("tests/diff",),
    "templates/html/": ("tests/site",),
    "templates/init/": ("tests/cli/test_first_device.py", "tests/cli"),
    "templates/python/": ("tests/python", *_MESSAGES, *_LINKS),
    "templates/rust/": ("tests/rust", *_MESSAGES, *_LINKS),
    "templates/xtce/": ("tests/xtce",),
}


# Tests of a file or folder in a file with another name, which are to run first.
FIRST: dict[str, str] = {
    "codegen/icdgen/backends/c/__init__.py": "tests/c/test_output.py",
    "codegen/icdgen/backends/c/physical.py": "tests/c/test_accessors.py",
    "codegen/icdgen/backends/html/errata.py": "tests/site/test_long_lists.py",
    "codegen/icdgen/backends/html/protocol.py": "tests/site/test_protocol_values.py",
    "codegen/icdgen/backends/html/repeats.py": "tests/site/test_represented_arrays.py",
    "codegen/icdgen/backends/html/packet_formats.py": "tests/site/test_packets.py",
    "codegen/icdgen/backends/html/units.py": "tests/site/test_long_lists.py",
    "codegen/icdgen/backends/rust/examples.py": "tests/rust/test_example_text.py",
    "codegen/icdgen/backends/rust/procedures.py": "tests/rust/test_procedure_text.py",
    "codegen/icdgen/diff/change.py": "tests/diff/test_reports.py",
    "codegen/icdgen/diff/changes/": "tests/diff/test_rules.py",
    "codegen/icdgen/diff/reports/": "tests/diff/test_reports.py",
    "codegen/icdgen/generation/generate.py": "tests/cli/test_generate.py",
    "codegen/icdgen/icd/frames.py": "tests/icd/test_layout.py",
    "codegen/icdgen/icd/rules/duplicates.py": "tests/icd/test_rules.py",
    "codegen/icdgen/importer/reading/pdf.py": "tests/importer/test_bad_pdf.py",
    "codegen/icdgen/importer/reading/spreadsheet.py": "tests/importer/rules/test_sources.py",
    "codegen/icdgen/importer/rules/attach.py": "tests/importer/rules/test_enumerations.py",
    "codegen/icdgen/protocol/procedure_steps.py": "tests/protocol/test_procedure_reader.py",
}


@cache
def _test_modules() -> dict[str, set[str]]:
    """Return the test modules that import each module of icdgen, by dotted name."""
    importing: dict[str, set[str]] = {}
    for path in sorted((ROOT / "tests").rglob("test_*.py")):
        test = path.relative_to(ROOT).as_posix()
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
            if isinstance(node, ast.ImportFrom) and node.module:
                modules = [node.module]
                modules += [f"{node.module}.{alias.name}" for alias in node.names]
            elif isinstance(node, ast.Import):
                modules = [alias.name for alias in node.names]
            else:
                continue
            for module in modules:
                importing.setdefault(module, set()).add(test)
    return importing


def _importing(file: PurePosixPath) -> list[str]:
    if file.suffix != ".py" or file.parts[0] not in ("codegen", "runtime"):
        return []
    start = 1 if file.parts[0] == "codegen" else 2
    module = ".".join(file.with_suffix("").parts[start:]).removesuffix(".__init__")
    tests = sorted(_test_modules().get(module, ()))
    return tests if len(tests) <= MOST_IMPORTING else []


def covering_tests(file: str) -> list[str]:
    """Return the tests of a file, as paths below the top of the repository.

    They are the tests in `FIRST`, those with its name, tests that import it, and the
    tests in `COVERING`.
    A test covers itself. Raises `KeyError` if a file has no tests.
    """
    path = PurePosixPath(file)
    if path.parts[0] == "tests" and path.name.startswith("test_"):
        return [file]
    prefix = max(
        (start for start in COVERING if file.startswith(start)), key=len, default=None
    )
    if prefix is None:
        raise KeyError(file)
    places = COVERING[prefix]
    first = [test for start, test in FIRST.items() if file.startswith(start)]
    namesakes = []
    for place in places:
        if place.endswith(".py"):
            continue
        name = f"test_{path.stem.strip('_')}.py"
        namesakes += sorted(
            test.relative_to(ROOT).as_posix() for test in (ROOT / place).rglob(name)
        )
    return list(dict.fromkeys([*first, *namesakes, *_importing(path), *places]))


def main(files: list[str]) -> int:
    tests: dict[str, None] = {}
    for file in files:
        path = Path(file).resolve()
        try:
            tests |= dict.fromkeys(covering_tests(path.relative_to(ROOT).as_posix()))
        except (KeyError, ValueError):
            print(f"{file}: no tests are known for it; see tests/README.md")
            return 2
    print("\n".join(tests))
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
