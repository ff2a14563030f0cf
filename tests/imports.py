"""The graph of imports within packages, and checks of their direction.

It includes imports within functions and for type checkers, and calls of `import_module`
with a literal name.
"""

from __future__ import annotations

import ast
from collections.abc import Iterable, Iterator, Mapping
from pathlib import Path

Graph = Mapping[str, frozenset[str]]  # module -> modules that it imports


def graph(*folders: Path) -> Graph:
    """Return the modules of packages with their imports. Raises `SyntaxError`."""
    files = {
        _module(path, folder): path
        for folder in folders
        for path in sorted(folder.rglob("*.py"))
    }
    return {
        name: frozenset(_imports(name, path, files)) - {name}
        for name, path in files.items()
    }


def _module(path: Path, folder: Path) -> str:
    parts = path.relative_to(folder.parent).with_suffix("").parts
    return ".".join(parts[:-1] if parts[-1] == "__init__" else parts)


def _imports(name: str, path: Path, files: Mapping[str, Path]) -> Iterator[str]:
    home = name if path.name == "__init__.py" else name.rpartition(".")[0]
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if isinstance(node, ast.Import):
            yield from (alias.name for alias in node.names if alias.name in files)
        elif isinstance(node, ast.ImportFrom):
            base = node.module or ""
            if node.level:
                above = home.split(".")[: len(home.split(".")) - node.level + 1]
                base = ".".join([*above, *([base] if base else [])])
            for alias in node.names:
                inner = f"{base}.{alias.name}"
                if inner in files:
                    yield inner
                elif base in files:
                    yield base
        elif isinstance(node, ast.Call):
            yield from {_imported_by_call(node)} & files.keys()


def _imported_by_call(call: ast.Call) -> str:
    """Return the module that `import_module` or `__import__` loads; empty if the call
    is another one, or computes the name.
    """
    name = call.func.attr if isinstance(call.func, ast.Attribute) else ""
    name = call.func.id if isinstance(call.func, ast.Name) else name
    if name not in ("import_module", "__import__") or not call.args:
        return ""
    match call.args[0]:
        case ast.Constant(value=str(module)):
            return module
    return ""


def circles(graph: Graph) -> list[list[str]]:
    """Return groups of modules that import each other, directly or indirectly."""
    reached = {name: _reached(name, graph) for name in graph}
    groups = {
        frozenset(other for other in reached[name] if name in reached[other])
        for name in graph
    }
    return sorted(sorted(group) for group in groups if group)


def _reached(name: str, graph: Graph) -> set[str]:
    reached: set[str] = set()
    queue = list(graph[name])
    while queue:
        module = queue.pop()
        if module not in reached:
            reached.add(module)
            queue += graph[module]
    return reached


def folded(graph: Graph, places: Iterable[str]) -> Graph:
    """Return the graph with modules combined into places.

    A place is a module, or a package with everything in it; the longest place that
    matches a module counts. The outermost package contains only its own module.
    """
    ranked = sorted(places, key=len, reverse=True)

    def place(name: str) -> str:
        return next(
            (
                candidate
                for candidate in ranked
                if name == candidate
                or ("." in candidate and name.startswith(f"{candidate}."))
            ),
            name,
        )

    combined: dict[str, set[str]] = {}
    for name, imports in graph.items():
        combined.setdefault(place(name), set()).update(map(place, imports))
    return {name: frozenset(imports - {name}) for name, imports in combined.items()}


def upward(graph: Graph, layers: Iterable[Iterable[str]]) -> list[str]:
    """Return imports that do not lead to a lower layer, and places without a layer.

    ``layers`` go from the bottom to the top.
    """
    level = {place: number for number, layer in enumerate(layers) for place in layer}
    rows = folded(graph, level)
    wrong = [f"{name} is in no layer" for name in rows if name not in level]
    for name, imports in rows.items():
        for imported in sorted(imports):
            if name in level and imported in level and level[imported] >= level[name]:
                wrong.append(
                    f"{name} imports {imported}, which does not stand below it"
                )
    return sorted(wrong)


def reserved(graph: Graph, users: Mapping[str, Iterable[str]]) -> list[str]:
    """Return imports of a package by other packages than its ``users``.

    A user is a package with everything in it.
    """
    wrong = []
    for package, allowed in users.items():
        inside = (package, *allowed)
        for name, imports in graph.items():
            if any(_is_in(name, place) for place in inside):
                continue
            wrong += [
                f"{name} imports {other}"
                for other in sorted(imports)
                if _is_in(other, package)
            ]
    return sorted(wrong)


def _is_in(name: str, place: str) -> bool:
    return name == place or name.startswith(f"{place}.")
