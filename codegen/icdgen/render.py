"""Templates -> text. Values come finished from the backends: a template holds loops, not decisions about bits."""

from __future__ import annotations

import os
from pathlib import Path

from icdgen import fingerprints, shipped
from icdgen.errors import UserError


class Renderer:
    """Renders the templates of one backend; those in ``override`` (``--templates DIR``) win over the shipped ones.

    ``looked_at`` tells of every file below ``override`` that was read or looked for, with its fingerprint as of just before.
    """

    def __init__(self, backend: str, override: Path | None = None) -> None:
        import jinja2

        own = [override / backend, override] if override else []
        self.looked_at: dict[Path, str] = {}
        self._environment = jinja2.Environment(
            loader=_loader(own, shipped.templates() / backend, self.looked_at),
            undefined=jinja2.StrictUndefined,
            autoescape=lambda template: template is not None and template.endswith(".html.j2"),
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
            raise UserError(
                f"{_where(error, template)}: {error.message or type(error).__name__}", "mend the template"
            ) from None
        except Exception as error:  # whatever an expression in a template may do
            raise UserError(
                f"{_where(error, template)}: {type(error).__name__}: {error}", "mend the template"
            ) from error


def _where(error: Exception, template: str) -> str:
    """File and line of the innermost template that an error went through."""
    found, trace = template, error.__traceback__
    while trace is not None:
        file = trace.tb_frame.f_code.co_filename
        if file.endswith(".j2"):
            found = f"{file}:{trace.tb_lineno}"
        trace = trace.tb_next
    return found


def _loader(own: list[Path], shipped: Path, looked_at: dict[Path, str]):
    import jinja2
    from jinja2.loaders import split_template_path

    class Loader(jinja2.FileSystemLoader):
        def get_source(self, environment, template):
            for folder in own:
                path = folder.joinpath(*split_template_path(template))
                looked_at[path] = fingerprints.of_path(os.fspath(path))
            return super().get_source(environment, template)

    return Loader([*own, shipped])
