"""A word that is special in a language, its modules, files or build is either refused
as a name, or the generated code compiles.
"""

from __future__ import annotations

import json
import re
import subprocess
import sys
from pathlib import Path

import pytest

from icdgen import backends
from icdgen.loading import load
from icdgen.render import Renderer
from tests.c.harness import WARNINGS

WORDS = tuple(dict.fromkeys("""
    lib mod main build bin test tests core std alloc crate wire types link enums support icdgen testee src target
    cargo setup init version con aux nul prn com1 lpt1 clock errors events name node message messages field kind id
    length raw physical any option result vec box string some none ok err self object type list dict set tuple sys
    os json struct dataclasses typing enum numpy pyarrow base codec columns floats lazy index time math signal
    stddef stdio windows errno linux unix assert status serde defmt u8 i32 f64 usize bool str default decode encode
    telemetry telecommand frame python rust c cmake generated package import module site array bytes take put flags
    scale error coded session client arm near far interrupt i386 vax sun hpux emit signals slots pascal min max abs
    minor major small huge asm inline restrict generator docs examples benches all dir iter next open print input
    getattr globals import_module sorted clone drop eq hash debug memset
    """.split()))  # fmt: skip
REFUSED_NODES = {
    "lib",
    "main",
    "bin",
    "mod",
    "std",
    "con",
    "aux",
    "nul",
    "prn",
    "com1",
    "lpt1",
    "wire",
    "support",
    "icdgen",
}


def icd(
    name: str, messages=("one",), fields=("x",), enumerations=("e",), members=("z",)
) -> dict:
    """Return an ICD with objects of these names."""
    enums = [
        {"name": enumeration, "members": [{"value": 0, "name": "zero"}]}
        for enumeration in enumerations
    ]
    enums.append(
        {
            "name": "holder",
            "members": [
                {"value": n, "name": member} for n, member in enumerate(members)
            ],
        }
    )
    numbers = [
        {"at": 8 * n, "bits": 8, "name": field, "type": "uint"}
        for n, field in enumerate(fields)
    ]
    users = [
        {"at": 8 * n, "bits": 8, "name": f"user {n}", "type": "enum", "enum": e["name"]}
        for n, e in enumerate(enums)
    ]
    scaled = [field | {"unit": "s", "formula": "raw*0.1"} for field in numbers]
    messages_of_icd = [
        {"name": message, "kind": "telemetry", "fields": scaled[:1]}
        for message in messages
    ]
    messages_of_icd += [
        {"name": "plain numbers", "kind": "telecommand", "fields": numbers},
        {"name": "scaled numbers", "kind": "telecommand", "fields": scaled},
        {"name": "users", "kind": "telecommand", "fields": users},
    ]
    for number, message in enumerate(messages_of_icd):
        message |= {"id": number, "length": len(message["fields"])}
    head = {"name": name, "title": "Words", "byte_order": "little", "bit_order": "lsb0"}
    return {"icdgen": 1, "node": head, "enums": enums, "messages": messages_of_icd}


def written(folder: Path, trees: dict[str, dict]) -> Path:
    folder.mkdir()
    for name, tree in trees.items():
        (folder / f"{name}.yaml").write_text(json.dumps(tree))
    return folder


def refused(folder: Path, tree: dict) -> bool:
    path = folder / "one.yaml"
    path.write_text(json.dumps(tree))
    return not load([path]).ok


@pytest.fixture(scope="module", params=("nodes", "names", "enumerations"))
def folder(request, tmp_path_factory) -> Path:
    """Return a folder with code generated from all words that are not refused: as node
    names, or as names within one node.
    """
    tmp = tmp_path_factory.mktemp("words")
    if request.param == "nodes":
        trees = {word: icd(word) for word in WORDS}
        accepted = {
            word: tree for word, tree in trees.items() if not refused(tmp, tree)
        }
        assert REFUSED_NODES.isdisjoint(accepted)
    else:
        kinds = (
            ("enumerations",)
            if request.param == "enumerations"
            else ("messages", "fields", "members")
        )
        accepted_names = {
            kind: [w for w in WORDS if not refused(tmp, icd("n", **{kind: [w]}))]
            for kind in kinds
        }
        accepted = {"n": icd("n", **accepted_names)}
    assert len(str(accepted)) > 10_000  # most words can be used
    loaded = load([written(tmp / "icd", accepted)])
    assert loaded.ok, [finding.message for finding in loaded.findings]
    for language in ("c", "python", "rust"):
        for path, text in backends.get(language).files(loaded.icd, Renderer(language)):
            target = tmp / language / path
            target.parent.mkdir(parents=True, exist_ok=True)
            target.write_text(text, encoding="utf-8")
    return tmp


def run(*command: str | Path, cwd: Path) -> None:
    done = subprocess.run(
        [str(word) for word in command], cwd=cwd, capture_output=True, text=True
    )
    assert done.returncode == 0, (done.stdout + done.stderr)[-4000:]


@pytest.mark.parametrize(
    "compiler", [("gcc", "c99"), ("clang", "gnu17"), ("g++", "gnu++17")]
)
def test_special_words_compile_in_c(folder, compiler):
    source = folder / ("all.cpp" if compiler[0] == "g++" else "all.c")
    headers = sorted(
        path.relative_to(folder / "c") for path in (folder / "c").rglob("*.h")
    )
    source.write_text("".join(f'#include "{header}"\n' for header in headers))
    run(
        compiler[0],
        f"-std={compiler[1]}",
        *WARNINGS,
        "-fsyntax-only",
        f"-I{folder / 'c'}",
        source,
        cwd=folder,
    )


def test_special_words_compile_in_rust(folder):
    manifest = folder / "rust/Cargo.toml"
    # Cargo must not use the network.
    text = re.sub(
        r"^[\w-]+ = \{.*optional = true.*\n", "", manifest.read_text(), flags=re.M
    )
    manifest.write_text(re.sub(r"\[\"dep:[\w-]+\"\]", "[]", text))
    run(
        "cargo",
        "check",
        "--offline",
        "--quiet",
        "--features",
        "std",
        cwd=folder / "rust",
    )


def test_special_words_can_be_used_in_python(folder):
    program = """
import icdgen_messages
from importlib import import_module
for name in icdgen_messages.NODES:
    node = import_module(f"icdgen_messages.{name}")
    assert getattr(icdgen_messages, name) is node
    for messages in (node.TELEMETRY, node.TELECOMMANDS):
        for id, message in messages.items():
            frame = bytes(message.LENGTH)
            assert message.from_bytes(frame).to_bytes() == frame == message().to_bytes()
            repr(message()), message().as_dict(physical=True)
"""
    run(sys.executable, "-c", program, cwd=folder / "python")


@pytest.mark.parametrize("name", ["con", "AUX", "nul", "Com 1", "lpt9"])
@pytest.mark.parametrize("kind", ["messages", "enumerations"])
def test_no_file_has_a_name_that_windows_reserves(tmp_path, kind, name):
    loaded_fine = not refused(tmp_path, icd("n", **{kind: [name]}))
    assert loaded_fine == (name == "Com 1")  # com_1
