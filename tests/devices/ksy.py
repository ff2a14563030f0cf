"""What the compiler of Kaitai Struct has made of a format, made a .ksy again:
`satnogs-decoders` carries only its Python.
"""

from __future__ import annotations

import ast
import re

_READ = re.compile(r"read_([usf][1248])(le|be)?\Z")
_RESOLVED = "KaitaiStream.resolve_enum"


def of(module: ast.Module, name: str) -> dict:
    """The definition.

    What is nothing of it that can be recognized stays as a size that no reader knows.
    """
    root = next(one for one in module.body if isinstance(one, ast.ClassDef))
    return {"meta": {"id": name}, **_type(root)}


def _type(made: ast.ClassDef) -> dict:
    found: dict = {"seq": []}
    for one in made.body:
        if isinstance(one, ast.FunctionDef) and one.name == "_read":
            found["seq"] = _sequence(one.body)
        elif isinstance(one, ast.FunctionDef) and one.decorator_list:
            value = [text for text in map(_instance, one.body) if text]
            found.setdefault("instances", {})[one.name] = (
                {"value": value[0]} if len(value) == 1 else {"pos": "unknown"}
            )
        elif isinstance(one, ast.ClassDef) and ast.unparse(one.bases[0]) == "Enum":
            members = {
                ast.literal_eval(each.value): each.targets[0].id  # type: ignore[attr-defined]
                for each in one.body
                if isinstance(each, ast.Assign)
            }
            found.setdefault("enums", {})[_snake(one.name)] = members
        elif isinstance(one, ast.ClassDef):
            found.setdefault("types", {})[_snake(one.name)] = _type(one)
    return found


def _sequence(statements: list[ast.stmt]) -> list[dict]:
    found: list[dict] = []
    switch = ""
    for one in statements:
        if isinstance(one, ast.If) and isinstance(one.body[0], ast.Raise):
            said = re.fullmatch(r"not self\.(\w+) == (b'.*')", ast.unparse(one.test))
            if said and found and found[-1]["id"] == said[1]:
                found[-1] = {"id": said[1], "contents": list(ast.literal_eval(said[2]))}
        elif isinstance(one, ast.If) and switch:
            found.append(_switched(one, switch))
            switch = ""
        elif isinstance(one, ast.If):
            found += [
                {**each, "if": _expression(one.test)} for each in _sequence(one.body)
            ]
        elif isinstance(one, ast.For) and found and isinstance(one.body[-1], ast.Expr):
            found[-1] = _repeated(one, found[-1]["id"])
        elif isinstance(one, ast.Assign):
            target = ast.unparse(one.targets[0])
            if target == "_on":
                switch = _expression(one.value)
            elif target.startswith("self."):
                name = re.sub(r"^self\.(_raw_)*", "", target)
                attribute = {"id": name, **_attribute(one.value)}
                if (
                    found and found[-1]["id"] == name
                ):  # bytes of which a type is read, or that are processed
                    attribute = {**found.pop(), **attribute}
                found.append(attribute)
    return found


def _attribute(value: ast.expr) -> dict:
    """Keys of an attribute but for its name."""
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
    found: dict = {}
    one: ast.stmt | None = chain
    while isinstance(one, ast.If):
        (inner,) = _sequence(one.body)[-1:]
        key = re.sub(r"^_on == ", "", ast.unparse(one.test))
        cases[
            int(key) if key.isdigit() else _expression(ast.parse(key, mode="eval").body)
        ] = inner.get("type", "")
        found |= {name: value for name, value in inner.items() if name != "type"}
        one, rest = (
            (one.orelse[0], [])
            if one.orelse and isinstance(one.orelse[0], ast.If)
            else (None, one.orelse)
        )
        for last in _sequence(rest)[-1:]:
            cases["_"] = last.get("type", "")
            found |= {name: value for name, value in last.items() if name != "type"}
    known = {key: of for key, of in cases.items() if of}  # others are bytes
    return {**found, "type": {"switch-on": switch, "cases": known}}


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
    """As Kaitai writes it."""
    text = re.sub(r"\bself\.", "", ast.unparse(value)).replace("//", "/")
    text = re.sub(
        r"\b[A-Z]\w*((?:\.[A-Z]\w*)+)\.([a-z]\w*)",
        lambda found: f"{_path('Root' + found[1])}::{found[2]}",
        text,
    )
    return text.replace("True", "true").replace("False", "false")


def _path(dotted: str) -> str:
    return "::".join(_snake(one) for one in dotted.split(".")[1:])


def _snake(name: str) -> str:
    return re.sub(r"(?<!^)(?=[A-Z])", "_", name).lower()
