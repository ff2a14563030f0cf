"""Templates -> text. Values come finished from the backends: a template holds loops, not decisions about bits."""

from __future__ import annotations

from pathlib import Path

from icdgen import places
from icdgen.errors import UserError


class Renderer:
    """Renders the templates of one backend; those in ``override`` (``--templates DIR``) win over the shipped ones."""

    def __init__(self, backend: str, override: Path | None = None, cache: Path | None = None) -> None:
        import jinja2

        folders = [override / backend, override] if override else []
        folders.append(places.templates() / backend)
        bytecode = None
        if cache is not None:
            cache.mkdir(parents=True, exist_ok=True)
            bytecode = jinja2.FileSystemBytecodeCache(str(cache))
        self._environment = jinja2.Environment(
            loader=jinja2.FileSystemLoader(folders),
            bytecode_cache=bytecode,
            undefined=jinja2.StrictUndefined,
            trim_blocks=True,
            lstrip_blocks=True,
            keep_trailing_newline=True,
            auto_reload=False,
        )

    def __call__(self, template: str, **values: object) -> str:
        """The text of ``template`` (its file name, such as ``message.h.j2``). Raises `UserError` for a bad template."""
        from jinja2 import TemplateError, TemplateSyntaxError

        try:
            return self._environment.get_template(template).render(values)
        except TemplateSyntaxError as error:
            where = f"{error.filename or template}:{error.lineno}"
            raise UserError(f"{where}: {error.message}", "mend the template") from None
        except TemplateError as error:
            raise UserError(f"{_where(error, template)}: {error.message or type(error).__name__}", "mend the template") from None


def _where(error: Exception, template: str) -> str:
    """File and line of the innermost template that an error went through."""
    found, trace = template, error.__traceback__
    while trace is not None:
        file = trace.tb_frame.f_code.co_filename
        if file.endswith(".j2"):
            found = f"{file}:{trace.tb_lineno}"
        trace = trace.tb_next
    return found
