"""Python backend: an installable, typed package with a subpackage per node and a module
per message or enumeration.

`PythonBackend.files` renders the templates of ``templates/python`` and copies the
modules of ``runtime/python``. Messages declare their fields by calls of the runtime
(`fields`), so that generated modules have little code.
"""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import PurePosixPath
from typing import TYPE_CHECKING

from icdgen import __version__
from icdgen.backends import Identifier
from icdgen.backends.origin import origin
from icdgen.backends.packages import Packages
from icdgen.backends.python import names
from icdgen.backends.python.symbols import PYTHON_NAMES, PythonNames
from icdgen.backends.template_functions import functions_by_name
from icdgen.describe import describe
from icdgen.describe.symbols import symbols
from icdgen.icd.model import Icd

if TYPE_CHECKING:
    from icdgen.render import Renderer

_RUNTIME = PurePosixPath("icdgen_runtime")
"""Package as which the code that all nodes share is developed.

Generated packages contain its modules.
"""


class PythonBackend:
    """Backend of ``icdgen --lang python``.

    The name in ``packages`` is the import name of the generated package.
    """

    name = "python"
    title = "Python"
    reserved = names.RESERVED

    def __init__(self, package: str = Packages.python) -> None:
        self.packages = Packages(python=package)

    @property
    def package(self) -> str:
        """Import name of the generated package."""
        return self.packages.python

    def files(self, icd: Icd, render: Renderer) -> Iterator[tuple[PurePosixPath, str]]:
        """List the files of the project, then of the package, then of each node."""
        # Imported late: rules on names do not need them.
        from icdgen.backends.python import literals, nodes, procedures
        from icdgen.describe.links import links_of
        from icdgen.link_calls import link_call

        description = describe(icd)
        root = PurePosixPath(self.package)
        common = {
            "origin": origin(),
            "package": self.package,
            "version": __version__,
            "project": self.package.replace("_", "-"),
            "nodes": description.nodes,
            "types": names.TYPES,
            **_template_functions(),
        }
        linked = links_of(description)
        yield PurePosixPath("pyproject.toml"), render("pyproject.toml.j2", **common)
        yield PurePosixPath("README.md"), render("README.md.j2", **common)
        yield (
            root / "__init__.py",
            render("package.py.j2", public=nodes.public(description.nodes), **common),
        )
        yield root / "py.typed", ""
        for name in render.runtime_files(str(_RUNTIME)):
            path = PurePosixPath(name).relative_to(_RUNTIME)
            # The generated package has an `__init__.py` of its own.
            if path != PurePosixPath("__init__.py"):
                yield root / path, f"# {origin()}\n{render.source(name)}"
        for node in description.nodes:
            folder = root / node.name
            shared = {**common, "origin": origin(node.model), "node": node}
            digested = {**shared, "origin": origin(node.model, with_digest=True)}
            yield folder / "__init__.py", render("node.py.j2", **digested)
            if node.name in linked:
                yield (
                    folder / "_link.py",
                    render(
                        "link.py.j2",
                        **shared,
                        link=literals.expression(link_call(linked[node.name])),
                    ),
                )
            if node.procedures:
                facts = linked[node.name].facts
                classes = procedures.procedure_classes(description, node, facts)
                yield (
                    folder / f"{names.PROCEDURES}.py",
                    render("procedures.py.j2", **shared, procedures=classes),
                )
            folder /= names.TYPES
            yield folder / "__init__.py", render("types.py.j2", **shared)
            for enum in node.enums:
                yield (
                    folder / f"{names.module_name(enum)}.py",
                    render("enum.py.j2", enum=enum, **shared),
                )
            for struct in node.structs:
                text = render("struct.py.j2", m=struct, **shared)
                yield folder / f"{names.module_name(struct)}.py", text
            for message in node.messages:
                text = render("message.py.j2", m=message, **shared)
                yield folder / f"{names.module_name(message)}.py", text

    def identifiers(self, icd: Icd) -> Iterator[Identifier]:
        """List every name that the generated files declare, for the rules on names."""
        return iter(symbols(describe(icd), PythonNames(self.package)))


def _template_functions() -> dict[str, object]:
    """Return the functions that templates call, by name."""
    from icdgen.backends.python import fields, nodes, procedures, text

    functions = (
        fields.annotation, fields.accessors, fields.constant_value, fields.declaration, fields.getter, fields.inner,
        fields.nested, fields.open_part, fields.physical, fields.view_info, names.accessors_in_python,
        names.constant_name, PYTHON_NAMES.symbol, nodes.by_id, nodes.declared, nodes.enum_classes, nodes.imports_of,
        nodes.listing, nodes.literals, nodes.mapping, nodes.node_docstring, nodes.public_of_node,
        procedures.procedure_imports, procedures.procedures_docstring, text.docstring, text.documented, text.literal, text.prose,
    )  # fmt: skip
    return functions_by_name(functions)
