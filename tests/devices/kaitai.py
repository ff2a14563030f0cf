"""Frames of satellites that `satnogs-decoders` decodes, as `icdgen import` reads their
.ksy files, compared with kaitaistruct.
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
# Appended to a frame, because kaitaistruct can read on behind the imported fields.
_BEHIND = 4096  # bytes of zeros


def satellites() -> Iterator[Definitions]:
    """Yield a node for each format."""
    import kaitaistruct  # noqa: F401

    spec = find_spec("satnogsdecoders")
    if spec is None or not spec.submodule_search_locations:
        raise ImportError("satnogs-decoders is not installed")
    for name in FORMATS:
        definitions = node(
            Path(spec.submodule_search_locations[0], "decoder", f"{name}.py")
        )
        if definitions is not None:
            yield definitions


def node(path: Path) -> Definitions | None:
    """Return the messages of a compiled format; None if it cannot be imported."""
    module = ast.parse(path.read_text("utf-8"))
    definition = ksy.definition_of(module, path.stem)
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder, f"{path.stem}.ksy")
        file.write_text(yaml.safe_dump(definition, sort_keys=False), "utf-8")
        try:
            read = run.read(file, Kaitai())
        except Findings:
            return None
    (tree,) = read.trees.values()
    reference = _reference(module)
    missing = [
        finding.message
        for finding in read.definitions.import_findings
        if finding.code == "IMP070"
    ]
    orders = {key: tree["node"][key] for key in ("byte_order", "bit_order")}
    structs = [
        {**struct, "fields": [{**orders, **part} for part in struct["fields"]]}
        for struct in tree.get("structs", ())
    ]
    for message in tree["messages"]:
        # kaitaistruct may decode fields from variable-length bytes
        fields = message["fields"]
        message["fields"] = [part for part in fields if "up_to" not in part]
    messages = [
        _definition(reference, message, orders, structs) for message in tree["messages"]
    ]
    messages += [
        Definition(finding, 0, "telemetry", 0, [], cause=finding.split(": ", 1)[-1])
        for finding in missing
    ]
    return Definitions(tree["node"], messages, tree)


class _Unchecked(ast.NodeTransformer):
    """Removes validity checks and the decoding of text, so that any bytes are accepted."""

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


def _reference(module: ast.Module) -> Any:
    names: dict[str, Any] = {}
    exec(
        compile(
            ast.fix_missing_locations(_Unchecked().visit(module)), "<compiled>", "exec"
        ),
        names,
    )
    root = next(
        definition.name
        for definition in module.body
        if isinstance(definition, ast.ClassDef)
    )
    return names[root]


def _definition(
    reference: Any, message: dict, orders: dict, structs: list[dict]
) -> Definition:
    fields = [{**orders, **field} for field in message["fields"]]
    return Definition(
        message["name"],
        message["id"],
        "telemetry",
        message["length"],
        fields,
        raw=_reader(reference, fields),
        structs=structs,
    )


def _reader(reference: Any, fields: list[dict]) -> Callable[[bytes], Values]:
    from kaitaistruct import BytesIO, KaitaiStream

    def read(data: bytes) -> Values:
        try:  # it may read on behind fields that are imported as bytes
            decoded = _flat(reference(KaitaiStream(BytesIO(data + bytes(_BEHIND)))), ())
        except (EOFError, ValueError, AttributeError, KeyError, TypeError) as error:
            raise NotSupported(str(error)) from None
        values: Values = {}
        for part in fields:
            matches = [
                path
                for path in decoded
                if " ".join(path[-1 - part["name"].count(" ") :]) == part["name"]
            ]
            if len(matches) == 1:
                values |= _values(part, decoded[matches[0]])
            elif (
                part["type" if "type" in part else "struct"] != "bytes"
                and " bit" not in part["name"]
            ):
                raise NotSupported(f"there is no {part['name']}")
        return values

    return read


def _flat(owner: Any, path: tuple[str, ...]) -> dict[tuple[str, ...], Any]:
    values = {}
    for name, value in vars(owner).items():
        if name.startswith("_"):
            continue
        values |= (
            _flat(value, (*path, name))
            if hasattr(value, "_io")
            else {(*path, name): value}
        )
    return values


def _values(part: dict, value: Any) -> Values:
    if "struct" in part:
        return {
            f"{part['name']}[{index}].{' '.join(path)}": _plain(inner)
            for index, item in enumerate(value)
            for path, inner in _flat(item, ()).items()
        }
    if isinstance(value, bytes) and part["type"] == "uint":
        return {part["name"]: int.from_bytes(value, "big")}
    return {
        part["name"]: (
            [_plain(item) for item in value]
            if isinstance(value, list)
            else _plain(value)
        )
    }


def _plain(value: Any) -> Any:
    if isinstance(value, Enum):
        return value.value
    return int(value) if isinstance(value, bool) else value
