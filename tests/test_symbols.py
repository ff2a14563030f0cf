"""The symbol table has every identifier that generated code declares, and no other."""

from __future__ import annotations

import ast
import re
from collections import defaultdict
from functools import wraps
from pathlib import Path

import pytest

from icdgen import backends
from icdgen.backends.c.names import PROCEDURE_PARAMETERS
from icdgen.backends.c.short_names import short_names
from icdgen.backends.python.names import IN_MESSAGE
from icdgen.describe import describe
from icdgen.describe.symbols import NamingPolicy
from icdgen.loading import load
from icdgen.render import Renderer

ROOT = Path(__file__).parent.parent
SETS = {
    "shipped": ROOT / "icd",
    "features": ROOT / "tests/conformance/odd_icds",
    "strange texts": ROOT / "tests/python/odd",
    "links": ROOT / "examples/links",
    "devices": ROOT / "examples/devices",
}

Names = dict[str, set[str]]  # scope -> texts


@pytest.fixture(scope="module", params=SETS)
def icd(request):
    return load([SETS[request.param]], check=False).icd


def table(icd, language: str) -> Names:
    """Return the symbol table by scope."""
    names = defaultdict(set)
    for symbol in backends.get(language).identifiers(icd):
        names[symbol.scope].add(symbol.text)
    return names


def generate(icd, language: str) -> dict[str, str]:
    files = backends.get(language).files(icd, Renderer(language))
    return {str(path): text for path, text in files if isinstance(text, str)}


def differences(left: Names, right: Names) -> list[tuple[str, str]]:
    return sorted(
        (scope, text)
        for scope in left
        for text in left[scope] - right.get(scope, set())
    )


def names_in_c(icd) -> Names:
    """Return the names that the generated C declares, by scope.

    Short names are replaced by the long names of the symbol table.
    """
    names = defaultdict(set)
    long_names = {
        short: text
        for text, short in short_names(backends.get("c").identifiers(icd)).items()
    }
    for path, text in generate(icd, "c").items():
        names["C header files"].add(path)
        if path.startswith("icdgen"):
            continue
        code = re.sub(r'/\*.*?\*/|"(?:\\.|[^"\\])*"', "", text, flags=re.S)
        code = re.sub(r"\w+", lambda word: long_names.get(word[0], word[0]), code)
        at_file_scope = re.findall(r"^#define (\w+)", code, re.M)
        at_file_scope += re.findall(
            r"^(?:static inline|ICDGEN_API) [\w \n*]*?(\w+)\(", code, re.M
        )
        at_file_scope += re.findall(r"^(?:typedef \w+|\}) (\w+);", code, re.M)
        at_file_scope += re.findall(r"^    (\w+) = -?\w+,?$", code, re.M)
        names["C names at file scope"].update(at_file_scope)
        for body, type in re.findall(
            r"^typedef struct \{(.*?)^\} (\w+);", code, re.M | re.S
        ):
            is_client = type.endswith(("_client_t", "_sender_t"))
            members = re.findall(r"(\w+)(?:\[\w+\])*;", body)
            if not is_client:
                names[f"members of {type}"].update(members)
        for name, parameters in re.findall(
            r"^static inline icd_status_t (\w+)\(\s*(icd_procedure_t \*[^)]*)\)",
            code,
            re.M,
        ):
            names[f"parameters of {name}"].update(
                re.findall(r"(\w+)(?:,|\Z)", parameters.strip())
            )
    return names


RESERVED_IN_C = re.compile(
    # The name of a macro that only some nodes have, or a type or function for a
    # direction without messages or without messages of variable length, stays reserved:
    # the user's next version of the ICD may need it.
    r"\w+_(NODE_TYPE|INTERFACE_VERSION|\w*BYTES|SEQUENCES|LONGEST)"
    r"|\w+_(telemetry|telecommand)_(t|name|length|size|decode|encode)"
    r"|\w+_client_(uart|i2c|can)|\w+_(sender_t|sender_init|refusal|(ask|put|send|request)_\w+)"
    r"|ICD_\w+|icd_status_t|ICDGEN_SHARED|icdgen(_wide|_wire)?\.[hc]"
)


def test_c_declares_the_names_of_the_table(icd):
    in_table, in_code = table(icd, "c"), names_in_c(icd)
    of_directions = {
        scope
        for scope in in_table
        if re.fullmatch(r"members of \w+_(telemetry|telecommand)_t", scope)
    }
    for scope in of_directions:  # besides the union of the messages
        in_code[scope] -= {"id", "which", "as"}
    for texts in in_code.values():
        texts.discard("empty")  # C has no empty structs
    assert in_code["C names at file scope"]
    assert differences(in_code, in_table) == []
    missing = differences(in_table, in_code)
    unused = [
        (scope, text)
        for scope, text in missing
        if scope.startswith("parameters of ") and text in PROCEDURE_PARAMETERS
    ]
    assert [
        name
        for name in missing
        if not RESERVED_IN_C.fullmatch(name[1]) and name not in unused
    ] == []


def names_in_python(icd) -> Names:
    names = defaultdict(set)
    for path, text in generate(icd, "python").items():
        parts = path.split("/")
        if parts[2:] == ["procedures.py"] and parts[1] != "wire":
            _add_procedures(names, f"{parts[0]}.{parts[1]}.procedures", text)
        if len(parts) < 4 or parts[2] != "_types" or parts[3] == "__init__.py":
            continue
        package = ".".join(parts[:2])
        for declared in ast.parse(text).body:
            if isinstance(declared, ast.ClassDef):
                names[f"module {package}"].add(declared.name)
                names[f"members of {package}.{declared.name}"].update(
                    _members_of_class(declared)
                )
    return names


def _add_procedures(names: Names, module: str, text: str) -> None:
    """Add the procedures of a module, their parameters and their outputs."""
    for declared in ast.parse(text).body:
        if not isinstance(declared, ast.ClassDef):
            continue
        names[f"module {module}"].add(declared.name)
        functions = [
            each for each in declared.body if isinstance(each, ast.FunctionDef)
        ]
        arguments = functions[0].args
        names[f"parameters of {module}.{declared.name}"].update(
            each.arg for each in (*arguments.args[1:], *arguments.kwonlyargs)
        )
        names[f"members of {module}.{declared.name}"].update(
            each.name for each in functions[1:] if each.name != "entries"
        )


def _members_of_class(declared: ast.ClassDef) -> set[str]:
    members = set()
    for statement in declared.body:
        if isinstance(statement, ast.AnnAssign):
            members.add(statement.target.id)
        elif isinstance(statement, ast.Assign):
            members.update(target.id for target in statement.targets)
        elif isinstance(statement, ast.FunctionDef):
            members.add(statement.name)
    return members


USED_IN_PYTHON = {
    *IN_MESSAGE,
    "ENDS_EARLY",
    "CONDITIONAL",
    "TAIL",
    "INNER",
    "NESTED",
    "__ranges__",
}


def test_python_declares_the_names_of_the_table(icd):
    in_table, in_code = table(icd, "python"), names_in_python(icd)
    for scope, texts in in_code.items():
        if scope.startswith("members of "):
            texts -= USED_IN_PYTHON - in_table.get(scope, set())
    assert differences(in_code, in_table) == []
    described = {
        scope: texts
        for scope, texts in in_table.items()
        if scope.startswith("members of ")
    }
    assert described
    assert differences(described, in_code) == []


METHOD = re.compile(r"^    pub (?:const )?fn\s+((?:r#)?\w+)", re.M)
FIELD = re.compile(r"^    pub ((?:r#)?\w+):", re.M)
CONSTANT = re.compile(r"^    pub const (\w+):", re.M)
OF_EVERY_TYPE = {"raw", "name", "write_to", "id", "length"}
OF_EVERY_MESSAGE = {
    "from_bytes",
    "from_array",
    "to_bytes",
    "default",
    "from_longest",
    "size",
    "inner",
    "fit",
    "rows",
}
CONSTANTS_OF_EVERY_MESSAGE = {"NAME", "LENGTH", "ID", "SET_ID", "GET_ID", "FIELDS"}


def test_rust_declares_the_names_of_the_table(icd):
    in_table, texts = table(icd, "rust"), generate(icd, "rust")
    in_code, expected = defaultdict(set), defaultdict(set)
    for node in describe(icd).nodes:
        for composite in node.composites:
            code = texts[f"src/{node.name}/{composite.name}.rs"]
            scope = f"{node.name}::{composite.model.name}"
            in_code[f"types of {node.name}"].update(
                re.findall(r"^pub struct (\w+)", code, re.M)
            )
            for kind, pattern in (
                ("methods", METHOD),
                ("fields", FIELD),
                ("constants", CONSTANT),
            ):
                in_code[f"{kind} of {scope}"].update(pattern.findall(code))
            in_code[f"methods of {scope}"].update(
                re.findall(r"^    fn\s(read_\w+|write_\w+)", code, re.M)
            )
        if node.enums:
            code = texts[f"src/{node.name}/enums.rs"]
            in_code[f"enumerations of {node.name}"].update(
                re.findall(r"^pub enum (\w+)", code, re.M)
            )
            variants = dict(
                re.findall(r"^pub enum (\w+) \{\n(.*?)^\}", code, re.M | re.S)
            )
            for enum in node.enums:
                body = variants["".join(word.capitalize() for word in enum.words)]
                scope = f"variants of {node.name}::{enum.model.name}"
                in_code[scope].update(
                    re.findall(r"^    (\w+)(?:\(\w+\))?(?: = -?\w+)?,$", body, re.M)
                )
    fixed = OF_EVERY_TYPE | OF_EVERY_MESSAGE | CONSTANTS_OF_EVERY_MESSAGE
    for scope, names in in_code.items():
        expected[scope] = in_table[scope]
        if scope.startswith(("methods of ", "constants of ")):
            # What the generated code declares itself stands in the table only so that
            # names of the ICD are compared with it.
            own = {symbol for symbol in in_table[scope] if symbol not in fixed}
            expected[scope], in_code[scope] = own, names - (fixed - own)
        elif scope.startswith(("types of ", "enumerations of ")):
            expected[scope] = in_table[scope] - _used_in_rust()
    assert differences(in_code, in_table) == []
    assert differences(expected, in_code) == []


def _used_in_rust() -> set[str]:
    from icdgen.backends.rust import names

    return {*names.USED_TYPES, "Option", "From", "Enumeration"}


@pytest.mark.parametrize(
    ("language", "comments"),
    [("python", r'"""(?:\\.|[^\\])*?"""|#.*'), ("rust", r"//.*")],
)
def test_types_have_their_name_from_the_table_wherever_code_uses_them(
    monkeypatch, language, comments
):
    icd = load([SETS["shipped"]], check=False).icd
    original, names = NamingPolicy.symbol, set()

    @wraps(original)
    def symbol(policy, part, role):
        text = original(policy, part, role)
        if role not in ("class", "type", "variant"):
            return text
        # Variants can have names of Rust's own, such as `None`.
        names.update((text,) if role != "variant" else ())
        return f"{text}Marked"

    monkeypatch.setattr(NamingPolicy, "symbol", symbol)
    files = {
        path: text
        for path, text in generate(icd, language).items()
        if "cubemag" in path
    }
    unmarked = set()
    for text in files.values():
        code = re.sub(rf'{comments}|"(?:\\.|[^"\\])*"', "", text)
        unmarked.update(names.intersection(re.findall(r"(?<!\.)\b\w+\b", code)))
    assert files and names
    assert unmarked == set()
