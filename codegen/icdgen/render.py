"""Rendering of templates, and access to the sources of runtimes.

Backends compute all values. A template has loops, but no decisions about bits.
"""

from __future__ import annotations

import marshal
import os
import sys
from collections.abc import Callable
from hashlib import sha256
from importlib.machinery import SourceFileLoader
from importlib.util import cache_from_source
from pathlib import Path
from typing import TYPE_CHECKING, Protocol

from icdgen import fingerprints, shipped
from icdgen.errors import UserError

if TYPE_CHECKING:
    from jinja2 import BaseLoader, BytecodeCache, Environment
    from jinja2.bccache import Bucket
    from jinja2.runtime import Context


class RenderedBackend(Protocol):
    """A backend, as far as `Renderer` needs it.

    It can also have the attributes ``templates`` and ``runtime``.
    """

    @property
    def name(self) -> str: ...


class Renderer:
    """Renders the templates of a backend and reads the files of its runtime.

    Files in ``override`` (``--templates DIR``) replace both. ``templates`` and
    ``runtime`` are the folders of a plug-in, by default the shipped folders.
    ``looked_at`` has the fingerprint of each file in ``override`` that was read or
    absent.
    """

    def __init__(
        self,
        backend: str,
        override: Path | None = None,
        templates: Path | None = None,
        runtime: Path | None = None,
    ) -> None:
        import jinja2

        self._own = [override / backend, override] if override else []
        self._runtime = runtime or shipped.runtimes() / backend
        self.looked_at: dict[Path, str] = {}
        self._environment = jinja2.Environment(
            loader=_loader(
                self._own, templates or shipped.templates() / backend, self.looked_at
            ),
            bytecode_cache=_bytecode_cache(),
            undefined=jinja2.StrictUndefined,
            autoescape=lambda template: (
                template is not None and template.endswith((".html.j2", ".xml.j2"))
            ),
            trim_blocks=True,
            lstrip_blocks=True,
            keep_trailing_newline=True,
            # Saves a look at the disk for each use of a template.
            auto_reload=False,
        )
        self._environment.context_class = _context_class()

    @classmethod
    def of_backend(
        cls, backend: RenderedBackend, override: Path | None = None
    ) -> Renderer:
        """Return the renderer of a backend, with its own folders of templates and
        runtime if it has them.
        """
        folders = (
            getattr(backend, "templates", None),
            getattr(backend, "runtime", None),
        )
        return cls(backend.name, override, *folders)

    def __call__(self, template: str, **values: object) -> str:
        """Render a template, given by its file name, such as ``message.h.j2``.

        Raises `UserError` for an error in it.
        """
        from jinja2 import TemplateError, TemplateSyntaxError

        try:
            return self._environment.get_template(template).render(values)
        except TemplateSyntaxError as error:
            where = f"{error.filename or template}:{error.lineno}"
            raise UserError(
                f"{where}: {error.message}", "correct the template"
            ) from None
        except TemplateError as error:
            raise UserError(
                f"{_place_of_error(error, template)}: {error.message or type(error).__name__}",
                "correct the template",
            ) from None
        except Exception as error:  # an expression of a template can raise anything
            raise UserError(
                f"{_place_of_error(error, template)}: {type(error).__name__}: {error}",
                "correct the template",
            ) from error

    def runtime_files(self, folder: str = ".") -> list[str]:
        """Return the source files of the runtime below ``folder``, as paths relative to
        the runtime.
        """
        files = (
            path.relative_to(self._runtime)
            for path in (self._runtime / folder).rglob("*")
            if path.is_file()
        )
        return sorted(
            path.as_posix()
            for path in files
            if not any(map(_is_output_of_tools, path.parts))
        )

    def source(self, file: str) -> str:
        """Return the text of a file of the runtime, or of its replacement.

        Raises `UserError` if that cannot be read.
        """
        for folder in self._own:
            path = folder / file
            self.looked_at[path] = fingerprints.of_path(os.fspath(path))
            try:
                return path.read_text(encoding="utf-8")
            except (FileNotFoundError, NotADirectoryError):
                continue
            except (OSError, UnicodeDecodeError) as error:
                raise UserError(f"{path}: {error}", "correct the file") from None
        return (self._runtime / file).read_text(encoding="utf-8")


def _is_output_of_tools(name: str) -> bool:
    """Return whether a file or folder is hidden, or written by Python or Cargo."""
    return name.startswith(".") or name in ("__pycache__", "target")


def _place_of_error(error: Exception, template: str) -> str:
    """Return file and line of the innermost template in the traceback of an error."""
    place, trace = template, error.__traceback__
    while trace is not None:
        file = trace.tb_frame.f_code.co_filename
        if file.endswith(".j2"):
            place = f"{file}:{trace.tb_lineno}"
        trace = trace.tb_next
    return place


def _context_class() -> type[Context]:
    """Return a class of contexts with fast calls."""
    from jinja2.runtime import Context, Macro

    class PlainContext(Context):
        """Context that calls functions directly.

        Jinja's own `call` first checks whether a function needs the context.
        """

        def call(
            self, function: Callable[..., object], /, *args: object, _loop_vars: object = None, _block_vars: object = None,
            **named: object,
        ) -> object:  # fmt: skip
            return (
                # `Macro.__call__` of Jinja is marked to take the evaluation context.
                function(self.eval_ctx, *args, **named)
                if type(function) is Macro
                else function(*args, **named)
            )

    return PlainContext


def _loader(own: list[Path], shipped: Path, looked_at: dict[Path, str]) -> BaseLoader:
    """Return a loader of templates from the folders ``own`` and ``shipped``."""
    import jinja2
    from jinja2.loaders import split_template_path

    class Loader(jinja2.FileSystemLoader):
        """Adds the fingerprints of templates in ``own`` to ``looked_at``."""

        def get_source(
            self, environment: Environment, template: str
        ) -> tuple[str, str, Callable[[], bool]]:
            for folder in own:
                path = folder.joinpath(*split_template_path(template))
                looked_at[path] = fingerprints.of_path(os.fspath(path))
            return super().get_source(environment, template)

    return Loader([*own, shipped])


def _bytecode_cache() -> BytecodeCache:
    """Return the cache of compiled templates."""
    import jinja2

    class Compiled(jinja2.BytecodeCache):
        """Stores the compiled code of shipped templates in ``__pycache__`` in the
        folder of their source, like Python.

        Loading code from there is safe: anyone who can write to that folder can change
        icdgen itself. The code of other templates is not stored.
        """

        def get_cache_key(self, name: str, filename: str | None = None) -> str:
            """Return the path of the compiled code; empty for a template that is not
            shipped.
            """
            is_shipped = filename is not None and Path(filename).is_relative_to(
                shipped.templates()
            )
            return (
                cache_from_source(filename)
                if filename and is_shipped and sys.implementation.cache_tag
                else ""
            )

        def get_source_checksum(self, source: str) -> str:
            """Return a checksum of the template and of icdgen, with which stored code
            must agree.
            """
            return sha256(f"{fingerprints.of_tool()}\0{source}".encode()).hexdigest()

        def load_bytecode(self, bucket: Bucket) -> None:
            """Load the code of a template, if it is stored and current."""
            try:
                checksum, _, code = (
                    SourceFileLoader("", bucket.key)
                    .get_data(bucket.key)
                    .partition(b"\n")
                )
                bucket.code = (
                    marshal.loads(code)
                    if checksum == bucket.checksum.encode()
                    else None
                )
            except (OSError, EOFError, ValueError, TypeError):
                return

        def dump_bytecode(self, bucket: Bucket) -> None:
            """Store the code of a template.

            `set_data` writes atomically, and ignores errors.
            """
            if bucket.key and not sys.dont_write_bytecode:
                data = bucket.checksum.encode() + b"\n" + marshal.dumps(bucket.code)
                SourceFileLoader("", bucket.key).set_data(bucket.key, data)

    return Compiled()
