"""Templates -> text, and the runtime's sources as they are.

Values come finished from the backends: a template holds loops, not decisions about bits.
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


class Named(Protocol):
    """A backend, as far as rendering goes; it may have ``templates`` and ``runtime``, too."""

    @property
    def name(self) -> str: ...


class Renderer:
    """Renders the templates of one backend and hands out its runtime; files in ``override`` (``--templates DIR``) win.

    ``templates`` and ``runtime`` are the folders of both, where they are not ours.
    ``looked_at`` tells of every file below ``override`` that was read or looked for, with its fingerprint as of just before.
    """

    def __init__(
        self, backend: str, override: Path | None = None, templates: Path | None = None, runtime: Path | None = None
    ) -> None:
        import jinja2

        self._own = [override / backend, override] if override else []
        self._runtime = runtime or shipped.runtimes() / backend
        self.looked_at: dict[Path, str] = {}
        self._environment = jinja2.Environment(
            loader=_loader(self._own, templates or shipped.templates() / backend, self.looked_at),
            bytecode_cache=_compiled(),
            undefined=jinja2.StrictUndefined,
            autoescape=lambda template: template is not None and template.endswith((".html.j2", ".xml.j2")),
            trim_blocks=True,
            lstrip_blocks=True,
            keep_trailing_newline=True,
            auto_reload=False,
        )
        self._environment.context_class = _context_class()

    @classmethod
    def of(cls, backend: Named, override: Path | None = None) -> Renderer:
        """The renderer of a backend, which may say where its templates and its runtime lie."""
        folders = (getattr(backend, "templates", None), getattr(backend, "runtime", None))
        return cls(backend.name, override, *folders)

    def __call__(self, template: str, **values: object) -> str:
        """The text of ``template`` (its file name, such as ``message.h.j2``). Raises `UserError` for a bad template."""
        from jinja2 import TemplateError, TemplateSyntaxError

        try:
            return self._environment.get_template(template).render(values)
        except TemplateSyntaxError as error:
            where = f"{error.filename or template}:{error.lineno}"
            raise UserError(f"{where}: {error.message}", "mend the template") from None
        except TemplateError as error:
            raise UserError(
                f"{_where(error, template)}: {error.message or type(error).__name__}", "mend the template"
            ) from None
        except Exception as error:  # whatever an expression in a template may do
            raise UserError(
                f"{_where(error, template)}: {type(error).__name__}: {error}", "mend the template"
            ) from error

    def runtime_files(self, folder: str = ".") -> list[str]:
        """The sources of the backend's runtime below ``folder``, as paths within the runtime; nothing that tools left there."""
        found = (path.relative_to(self._runtime) for path in (self._runtime / folder).rglob("*") if path.is_file())
        return sorted(path.as_posix() for path in found if not any(map(_is_left_by_tools, path.parts)))

    def source(self, file: str) -> str:
        """The text of a file of the runtime. Raises `UserError` if the user's own in its place cannot be read."""
        for folder in self._own:
            path = folder / file
            self.looked_at[path] = fingerprints.of_path(os.fspath(path))
            try:
                return path.read_text(encoding="utf-8")
            except (FileNotFoundError, NotADirectoryError):
                continue
            except (OSError, UnicodeDecodeError) as error:
                raise UserError(f"{path}: {error}", "mend the file") from None
        return (self._runtime / file).read_text(encoding="utf-8")


def _is_left_by_tools(name: str) -> bool:
    return name.startswith(".") or name in ("__pycache__", "target")


def _where(error: Exception, template: str) -> str:
    """File and line of the innermost template that an error went through."""
    found, trace = template, error.__traceback__
    while trace is not None:
        file = trace.tb_frame.f_code.co_filename
        if file.endswith(".j2"):
            found = f"{file}:{trace.tb_lineno}"
        trace = trace.tb_next
    return found


def _context_class() -> type[Context]:
    from jinja2.runtime import Context, Macro

    class PlainContext(Context):
        """Calls functions as they are: none of those that templates are given asks for the context, and they are called often."""

        def call(
            self, function: Callable[..., object], /, *args: object, _loop_vars: object = None, _block_vars: object = None,
            **named: object,
        ) -> object:  # fmt: skip
            return function(self.eval_ctx, *args, **named) if type(function) is Macro else function(*args, **named)

    return PlainContext


def _loader(own: list[Path], shipped: Path, looked_at: dict[Path, str]) -> BaseLoader:
    import jinja2
    from jinja2.loaders import split_template_path

    class Loader(jinja2.FileSystemLoader):
        def get_source(self, environment: Environment, template: str) -> tuple[str, str, Callable[[], bool]]:
            for folder in own:
                path = folder.joinpath(*split_template_path(template))
                looked_at[path] = fingerprints.of_path(os.fspath(path))
            return super().get_source(environment, template)

    return Loader([*own, shipped])


def _compiled() -> BytecodeCache:
    import jinja2

    class Compiled(jinja2.BytecodeCache):
        """Keeps the code of shipped templates where Python keeps that of modules, in ``__pycache__`` beside the source, and as
        it would: whoever can write there can write to the tool itself. That of others' templates is kept nowhere.
        """

        def get_cache_key(self, name: str, filename: str | None = None) -> str:
            is_ours = filename is not None and Path(filename).is_relative_to(shipped.templates())
            return cache_from_source(filename) if filename and is_ours and sys.implementation.cache_tag else ""

        def get_source_checksum(self, source: str) -> str:
            return sha256(f"{fingerprints.of_tool()}\0{source}".encode()).hexdigest()

        def load_bytecode(self, bucket: Bucket) -> None:
            try:
                made_of, _, code = SourceFileLoader("", bucket.key).get_data(bucket.key).partition(b"\n")
                bucket.code = marshal.loads(code) if made_of == bucket.checksum.encode() else None
            except (OSError, EOFError, ValueError, TypeError):
                return

        def dump_bytecode(self, bucket: Bucket) -> None:
            if bucket.key and not sys.dont_write_bytecode:
                data = bucket.checksum.encode() + b"\n" + marshal.dumps(bucket.code)
                SourceFileLoader("", bucket.key).set_data(bucket.key, data)  # whole or not at all, and never fails

    return Compiled()
