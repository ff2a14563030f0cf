"""Reconstructs a .ksy file from the Python that the compiler of Kaitai Struct
generated.

`satnogs-decoders` contains only the generated Python.
"""

from __future__ import annotations

import ast
import re

_READ = re.compile(r"read_([usf][1248])(le|be)?\Z")
_RESOLVED = "KaitaiStream.resolve_enum"


def definition_of(module: ast.Module, name: str) -> dict:
    """Return the definition.

    A part that is not recognized becomes a size that no importer supports.
    """
    root = next(node for node in module.body if isinstance(node, ast.ClassDef))
    return {"meta": {"id": name}, **_type(root)}


def _type(compiled: ast.ClassDef) -> dict:
    definition: dict = {"seq": []}
    for node in compiled.body:
        if isinstance(node, ast.FunctionDef) and node.name == "_read":
            definition["seq"] = _sequence(node.body)
        elif isinstance(node, ast.FunctionDef) and node.decorator_list:
            value = [text for text in map(_instance, node.body) if text]
            definition.setdefault("instances", {})[node.name] = (
                {"value": value[0]} if len(value) == 1 else {"pos": "unknown"}
            )
        elif isinstance(node, ast.ClassDef) and ast.unparse(node.bases[0]) == "Enum":
            members = {
                ast.literal_eval(assignment.value): assignment.targets[0].id  # type: ignore[attr-defined]
                for assignment in node.body
                if isinstance(assignment, ast.Assign)
            }
            definition.setdefault("enums", {})[_snake(node.name)] = members
        elif isinstance(node, ast.ClassDef):
            definition.setdefault("types", {})[_snake(node.name)] = _type(node)
    return definition


def _sequence(statements: list[ast.stmt]) -> list[dict]:
    attributes: list[dict] = []
    switch = ""
    for statement in statements:
        if isinstance(statement, ast.If) and isinstance(statement.body[0], ast.Raise):
            match = re.fullmatch(
                r"not self\.(\w+) == (b'.*')", ast.unparse(statement.test)
            )
            if match and attributes and attributes[-1]["id"] == match[1]:
                attributes[-1] = {
                    "id": match[1],
                    "contents": list(ast.literal_eval(match[2])),
                }
        elif isinstance(statement, ast.If) and switch:
            attributes.append(_switched(statement, switch))
            switch = ""
        elif isinstance(statement, ast.If):
            attributes += [
                {**each, "if": _expression(statement.test)}
                for each in _sequence(statement.body)
            ]
        elif (
            isinstance(statement, ast.For)
            and attributes
            and isinstance(statement.body[-1], ast.Expr)
        ):
            attributes[-1] = _repeated(statement, attributes[-1]["id"])
        elif isinstance(statement, ast.Assign):
            target = ast.unparse(statement.targets[0])
            if target == "_on":
                switch = _expression(statement.value)
            elif target.startswith("self."):
                name = re.sub(r"^self\.(_raw_)*", "", target)
                attribute = {"id": name, **_attribute(statement.value)}
                if (
                    attributes and attributes[-1]["id"] == name
                ):  # bytes of which a type is read, or that are processed
                    attribute = {**attributes.pop(), **attribute}
                attributes.append(attribute)
    return attributes


def _attribute(value: ast.expr) -> dict:
    """Return the keys of an attribute except its name."""
    text = ast.unparse(value)
    if text.startswith(_RESOLVED) and isinstance(value, ast.Call):
        return {**_attribute(value.args[1]), "enum": _path(ast.unparse(value.args[0]))}
    if (
        bits := re.fullmatch(r"self\._io\.read_bits_int_(be|le)\((\d+)\)( != 0)?", text)
    ) is not None:
        return {"type": f"b{bits[2]}{bits[1]}"}
    if (
        number := re.fullmatch(r"self\._io\.read_([usf]\d(?:le|be)?)\(\)", text)
    ) is not None:
        return {"type": number[1]}
    if "KaitaiStream.process" in text:
        return {"process": "unknown"}
    kind = {"type": "str", "encoding": "ASCII"} if ".decode(" in text else {}
    if (size := re.search(r"self\._io\.read_bytes\((\d+)\)", text)) is not None:
        return {"size": int(size[1]), **kind}
    if "read_bytes_full()" in text:
        return {"size-eos": True, **kind}
    if (
        user := re.fullmatch(
            r"\w+((?:\.\w+)+)\((self\._io|_io__raw_\w+), self, self\._root\)", text
        )
    ) is not None:
        return {"type": _path(f"Root{user[1]}")}
    return {} if text == "[]" else {"size": "unknown", **kind}


def _repeated(loop: ast.For, name: str) -> dict:
    count = re.fullmatch(r"range\((.*)\)", ast.unparse(loop.iter))
    call = loop.body[-1].value  # type: ignore[attr-defined]
    assert isinstance(call, ast.Call)
    times = count[1] if count else "unknown"
    return {
        "id": name,
        "repeat": "expr",
        "repeat-expr": int(times) if times.isdigit() else times,
        **_attribute(call.args[0]),
    }


def _switched(chain: ast.If, switch: str) -> dict:
    cases: dict = {}
    keys: dict = {}
    statement: ast.stmt | None = chain
    while isinstance(statement, ast.If):
        (inner,) = _sequence(statement.body)[-1:]
        key = re.sub(r"^_on == ", "", ast.unparse(statement.test))
        cases[
            int(key) if key.isdigit() else _expression(ast.parse(key, mode="eval").body)
        ] = inner.get("type", "")
        keys |= {name: value for name, value in inner.items() if name != "type"}
        statement, otherwise = (
            (statement.orelse[0], [])
            if statement.orelse and isinstance(statement.orelse[0], ast.If)
            else (None, statement.orelse)
        )
        for last in _sequence(otherwise)[-1:]:
            cases["_"] = last.get("type", "")
            keys |= {name: value for name, value in last.items() if name != "type"}
    typed = {key: type_ for key, type_ in cases.items() if type_}  # others are bytes
    return {**keys, "type": {"switch-on": switch, "cases": typed}}


def _instance(statement: ast.stmt) -> str:
    text = ast.unparse(statement)
    if (
        not text.startswith("self._m_")
        or "self._io" in text
        or not isinstance(statement, ast.Assign)
    ):
        return ""
    return _expression(statement.value)


def _expression(value: ast.expr) -> str:
    """Return an expression in the notation of Kaitai Struct."""
    text = re.sub(r"\bself\.", "", ast.unparse(value)).replace("//", "/")
    text = re.sub(
        r"\b[A-Z]\w*((?:\.[A-Z]\w*)+)\.([a-z]\w*)",
        lambda match: f"{_path('Root' + match[1])}::{match[2]}",
        text,
    )
    return text.replace("True", "true").replace("False", "false")


def _path(dotted: str) -> str:
    return "::".join(_snake(part) for part in dotted.split(".")[1:])


def _snake(name: str) -> str:
    return re.sub(r"(?<!^)(?=[A-Z])", "_", name).lower()
