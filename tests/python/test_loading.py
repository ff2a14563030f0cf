"""Modules of a generated package are loaded when they are first used.

Most tests run a short program in a new interpreter and list the modules it has loaded.
"""

from __future__ import annotations

import ast
import subprocess
import sys
from importlib import import_module
from pathlib import Path

import pytest


def run(package, code: str) -> str:
    """Run code in a new interpreter and return its output."""
    code = f"import sys; sys.dont_write_bytecode = True\n{code}"
    done = subprocess.run(
        [sys.executable, "-c", code], cwd=package.folder, capture_output=True, text=True
    )
    assert not done.returncode, done.stderr
    return done.stdout.strip()


LOADED = "print(sorted(name.partition('.')[2] for name in sys.modules if name.startswith('icdgen_messages.')))"


def test_importing_the_package_loads_no_node(shipped):
    assert run(shipped, f"import icdgen_messages\n{LOADED}") == "['_errors']"


def test_importing_a_node_loads_no_message(shipped):
    assert (
        run(shipped, f"import icdgen_messages.cubeacp\n{LOADED}")
        == "['_errors', '_lazy', 'cubeacp']"
    )


def test_a_star_import_brings_all_public_names_of_a_node(shipped):
    code = (
        "from icdgen_messages.cubeacp import *\nfrom icdgen_messages import cubeacp\n"
    )
    output = run(
        shipped,
        f"{code}print(EstimatedAttitudeAngles.ID, TELEMETRY[146] is EstimatedAttitudeAngles, NAME)",
    )
    assert output == "146 True cubeacp"
    missing = "print([n for n in dir(cubeacp) if n[0] != '_' and n not in globals()])"
    assert run(shipped, f"{code}{missing}") == "['TYPE_CHECKING', 'annotations']"


def test_every_public_module_lists_its_names_as_a_literal(package):
    """Type checkers and editors read ``__all__``. Every name in it can be imported."""
    files = [
        file
        for file in (package.folder / package.name).rglob("*.py")
        if _is_public(file)
    ]
    for file in files:
        tree = ast.parse(file.read_text(encoding="utf-8"))
        (names,) = (
            ast.literal_eval(node.value)
            for node in tree.body
            if _assigns(node, "__all__")
        )
        defined = {
            node.name
            for node in tree.body
            if isinstance(node, (ast.ClassDef, ast.FunctionDef))
        }
        assert {name for name in defined if name[0] != "_"} <= {*names} and len(
            {*names}
        ) == len(names), file
        path = ".".join(
            file.relative_to(package.folder).with_suffix("").parts
        ).removesuffix(".__init__")
        module = import_module(path)
        assert all(hasattr(module, name) for name in names), file
    assert len(files) > len(package.icd.nodes) + 10


def _is_public(file: Path) -> bool:
    """Report whether users import from a file: the package, a node, the wire layer.

    This includes the modules that define the types and links of a node.
    """
    return file.name == "_link.py" or (file.parent.name == "_types") != (
        file.name == "__init__.py"
    )


def _assigns(statement: ast.stmt, name: str) -> bool:
    return (
        isinstance(statement, ast.Assign) and ast.unparse(statement.targets[0]) == name
    )


def test_the_wire_layer_is_loaded_when_it_is_used(shipped):
    code = "from icdgen_messages import cubeacp, wire\n"
    assert "wire.link" not in run(shipped, f"{code}{LOADED}")
    assert "wire.link" in run(shipped, f"{code}cubeacp.LINK\n{LOADED}")
    loaded = run(shipped, f"{code}wire.UartDecoder(cubeacp.LINK)\n{LOADED}")
    assert (
        "wire.uart" in loaded
        and "wire.client" not in loaded
        and "_types" not in loaded.replace("'cubeacp._types'", "")
    )


def test_every_listed_name_of_the_wire_layer_exists(shipped):
    wire = shipped.module("wire")
    assert {*wire._HOME} == {*wire.__all__}
    for name in wire.__all__:
        assert name in dir(wire)
        assert getattr(wire, name) is not None
    with pytest.raises(AttributeError, match="nonsense"):
        _ = wire.nonsense


def test_only_nodes_with_a_protocol_have_a_link(shipped, ordered):
    assert {node.name for node in shipped.icd.nodes if hasattr(shipped.module(node.name), "LINK")} == {
        "bootloader", "common", "cubeacp",
    }  # fmt: skip
    for node in ordered.icd.nodes:
        assert not hasattr(ordered.module(node.name), "LINK")


def test_importing_a_node_loads_no_slow_modules(shipped):
    code = (
        "before = set(sys.modules)\nimport icdgen_messages.cubeacp\n"
        "print({'typing', 'dataclasses', 'enum', 'inspect', 're'} & (set(sys.modules) - before))"
    )
    assert run(shipped, code) == "set()"


def test_a_message_loads_itself_and_its_enumerations(shipped):
    code = f"from icdgen_messages.cubeacp import EstimatedAttitudeAngles\n{LOADED}"
    assert "cubeacp._types.estimated_attitude_angles" in run(shipped, code)
    assert "cubeacp._types.current_adcs_state" not in run(shipped, code)


def test_dispatch_loads_only_the_message_of_the_id(shipped):
    code = f"from icdgen_messages import cubeacp\ncubeacp.decode_telemetry(146, bytes(6))\n{LOADED}"
    assert "cubeacp._types.estimated_attitude_angles" in run(shipped, code)
    assert "cubeacp._types.adcs_configuration" not in run(shipped, code)


def test_numpy_is_not_needed_until_columns_are(shipped):
    code = "import icdgen_messages.cubeacp as acp\nacp.EstimatedAttitudeAngles.from_bytes(bytes(6))\nprint('numpy' in sys.modules)"
    assert run(shipped, code) == "False"


def test_a_node_type_and_an_interface_version_of_zero_are_constants(odd):
    node = odd.module("odd")
    assert (node.NODE_TYPE, node.INTERFACE_VERSION) == (0, 0)


def test_every_listed_name_of_a_node_exists(package):
    for node in package.icd.nodes:
        module = package.module(node.name)
        for name in module._HOMES:
            assert name in dir(module)
            assert name == "LINK" or getattr(module, name).__name__ == name


def test_a_missing_name_is_an_attribute_error(shipped):
    with pytest.raises(AttributeError, match="Nonsense"):
        _ = shipped.module("cubeacp").Nonsense
    with pytest.raises(AttributeError, match="nonsense"):
        _ = shipped.module().nonsense


def test_included_messages_are_the_same_class_in_every_node(shipped):
    assert shipped.module("cubeacp").Reset is shipped.module("common").Reset
    assert shipped.module("bootloader").Reset is shipped.module().common.Reset
