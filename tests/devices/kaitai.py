"""Frames of satellites that `satnogs-decoders` reads, as `icdgen import` reads their
.ksy; what kaitaistruct runs judges.
"""

from __future__ import annotations

import ast
import tempfile
from collections.abc import Callable, Iterator
from enum import Enum
from importlib.util import find_spec
from pathlib import Path
from typing import Any

import yaml

from icdgen.definitions import run
from icdgen.definitions.kaitai import Kaitai
from icdgen.diagnostics import Findings
from tests.devices import ksy
from tests.devices.definition import Definition, Definitions, NotSupported, Values

FORMATS = (
    "co65",
    "cas4",
    "connectat11",
    "us6",
    "cubebel1",
    "armadillo",
    "acrux1",
    "catsat",
    "bisonsat",
    "cas5a",
    "cosmo",
    "cas9",
)
_BEHIND = 4096  # bytes of zeros


def satellites() -> Iterator[Definitions]:
    """A node for each format."""
    import kaitaistruct  # noqa: F401

    spec = find_spec("satnogsdecoders")
    if spec is None or not spec.submodule_search_locations:
        raise ImportError("satnogs-decoders is not installed")
    for name in FORMATS:
        made = node(Path(spec.submodule_search_locations[0], "decoder", f"{name}.py"))
        if made is not None:
            yield made


def node(path: Path) -> Definitions | None:
    """The messages of a compiled format; None if nothing of it is held."""
    module = ast.parse(path.read_text("utf-8"))
    definition = ksy.of(module, path.stem)
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder, f"{path.stem}.ksy")
        file.write_text(yaml.safe_dump(definition, sort_keys=False), "utf-8")
        try:
            read = run.read(file, Kaitai())
        except Findings:
            return None
    (tree,) = read.trees.values()
    judge = _judge(module)
    missing = [
        one.message for one in read.definitions.import_findings if one.code == "IMP070"
    ]
    orders = {key: tree["node"][key] for key in ("byte_order", "bit_order")}
    structs = [
        {**one, "fields": [{**orders, **part} for part in one["fields"]]}
        for one in tree.get("structs", ())
    ]
    for one in tree["messages"]:  # of bytes of any number the judge may make something
        one["fields"] = [part for part in one["fields"] if "up_to" not in part]
    messages = [_definition(judge, one, orders, structs) for one in tree["messages"]]
    messages += [
        Definition(said, 0, "telemetry", 0, [], cause=said.split(": ", 1)[-1])
        for said in missing
    ]
    return Definitions(tree["node"], messages, tree)


class _Unchecked(ast.NodeTransformer):
    """Reads any bytes: without the checks of what is valid, and text as its bytes."""

    def visit_If(self, node: ast.If) -> ast.AST | None:
        self.generic_visit(node)
        return (
            None
            if isinstance(node.body[0], ast.Raise)
            and "Validation" in ast.unparse(node.body[0])
            else node
        )

    def visit_Call(self, node: ast.Call) -> ast.AST:
        self.generic_visit(node)
        return (
            node.func.value
            if isinstance(node.func, ast.Attribute) and node.func.attr == "decode"
            else node
        )


def _judge(module: ast.Module) -> Any:
    names: dict[str, Any] = {}
    exec(
        compile(
            ast.fix_missing_locations(_Unchecked().visit(module)), "<compiled>", "exec"
        ),
        names,
    )
    root = next(one.name for one in module.body if isinstance(one, ast.ClassDef))
    return names[root]


def _definition(
    judge: Any, held: dict, orders: dict, structs: list[dict]
) -> Definition:
    fields = [{**orders, **one} for one in held["fields"]]
    return Definition(
        held["name"],
        held["id"],
        "telemetry",
        held["length"],
        fields,
        raw=_reader(judge, fields),
        structs=structs,
    )


def _reader(judge: Any, fields: list[dict]) -> Callable[[bytes], Values]:
    from kaitaistruct import BytesIO, KaitaiStream

    def read(data: bytes) -> Values:
        try:  # behind the bytes that are held as such it reads on
            found = _flat(judge(KaitaiStream(BytesIO(data + bytes(_BEHIND)))), ())
        except (EOFError, ValueError, AttributeError, KeyError, TypeError) as error:
            raise NotSupported(str(error)) from None
        made: Values = {}
        for part in fields:
            same = [
                path
                for path in found
                if " ".join(path[-1 - part["name"].count(" ") :]) == part["name"]
            ]
            if len(same) == 1:
                made |= _values(part, found[same[0]])
            elif (
                part["type" if "type" in part else "struct"] != "bytes"
                and " bit" not in part["name"]
            ):
                raise NotSupported(f"there is no {part['name']}")
        return made

    return read


def _flat(owner: Any, path: tuple[str, ...]) -> dict[tuple[str, ...], Any]:
    found = {}
    for name, value in vars(owner).items():
        if name.startswith("_"):
            continue
        found |= (
            _flat(value, (*path, name))
            if hasattr(value, "_io")
            else {(*path, name): value}
        )
    return found


def _values(part: dict, value: Any) -> Values:
    if "struct" in part:
        return {
            f"{part['name']}[{index}].{' '.join(path)}": _plain(inner)
            for index, one in enumerate(value)
            for path, inner in _flat(one, ()).items()
        }
    if isinstance(value, bytes) and part["type"] == "uint":
        return {part["name"]: int.from_bytes(value, "big")}
    return {
        part["name"]: (
            [_plain(one) for one in value] if isinstance(value, list) else _plain(value)
        )
    }


def _plain(value: Any) -> Any:
    return (
        value.value
        if isinstance(value, Enum)
        else int(value)
        if isinstance(value, bool)
        else value
    )
