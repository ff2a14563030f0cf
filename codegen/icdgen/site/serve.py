"""HTTP server of the site, for this machine only.

It renders the site again if an ICD changes. `serve` takes the paths of ICDs and serves
the pages of `icdgen.site.make` from memory until Ctrl+C; it writes no files. Requests
for any host except localhost are refused. If the ICDs have errors, every page shows the
findings.
"""

from __future__ import annotations

import html
import os
from collections.abc import Callable
from contextlib import suppress
from http import HTTPStatus
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from pathlib import Path
from threading import Lock
from urllib.parse import unquote, urlsplit

from icdgen import fingerprints, reports
from icdgen.backends.packages import Packages
from icdgen.errors import UserError
from icdgen.site.make import Site, make_site

HOST = "127.0.0.1"
_NAMES = {HOST, "localhost"}
_TYPES = {
    ".html": "text/html", ".css": "text/css", ".js": "text/javascript", ".json": "application/json", ".svg": "image/svg+xml",
    ".txt": "text/plain",
}  # fmt: skip


class SiteSource:
    """The current site: rendered again on a request if an input file has changed."""

    def __init__(
        self,
        icds: list[Path],
        previous: str | None = None,
        templates: Path | None = None,
        packages: Packages | None = None,
    ) -> None:
        self._arguments = (icds, previous, templates, packages)
        self._lock = Lock()
        self._site: Site | None = None

    def site(self) -> Site:
        """Return the current site. Raises `UserError`."""
        with self._lock:
            inputs = self._site.inputs.items() if self._site else ()
            if self._site is None or any(
                fingerprints.of_path(os.fspath(path)) != old for path, old in inputs
            ):
                # If `make_site` raises, the next request tries again.
                self._site = None
                self._site = make_site(*self._arguments)
            return self._site


def handler(source: SiteSource) -> type[BaseHTTPRequestHandler]:
    """Return a request handler class that serves the site of ``source``."""

    class SiteHandler(BaseHTTPRequestHandler):
        """Serves pages, or the findings if the ICDs have errors."""

        server_version, sys_version = "icdgen", ""

        def do_GET(self) -> None:
            """Send a page, a redirection or an error."""
            # Only localhost: otherwise a web page could read the site by DNS rebinding.
            if (self.headers.get("Host") or "").rsplit(":", 1)[0] not in _NAMES:
                self._send(
                    HTTPStatus.FORBIDDEN,
                    ".txt",
                    "This server answers only to localhost.\n",
                )
                return
            name = unquote(urlsplit(self.path).path).lstrip("/")
            if not name or name.endswith("/"):
                name += "index.html"
            try:
                site = source.site()
            except UserError as error:
                self._send(
                    HTTPStatus.INTERNAL_SERVER_ERROR,
                    ".html",
                    _complaint(f"{error}\n{error.help}"),
                )
                return
            if not site.ok:
                report = reports.get("text")(site.findings, site.texts)
                self._send(
                    HTTPStatus.INTERNAL_SERVER_ERROR, ".html", _complaint(report)
                )
            elif f"{name}/index.html" in site.files:
                self._send(
                    HTTPStatus.MOVED_PERMANENTLY, ".txt", "", Location=f"/{name}/"
                )
            elif name in site.files:
                self._send(HTTPStatus.OK, os.path.splitext(name)[1], site.files[name])
            else:
                self._send(
                    HTTPStatus.NOT_FOUND,
                    ".html",
                    _complaint(f"There is no page {name}"),
                )

        do_HEAD = do_GET

        def handle(self) -> None:
            """Handle requests of a connection.

            Browsers close connections at any time, which is not an error.
            """
            try:
                super().handle()
            except ConnectionError:
                self.close_connection = True

        def finish(self) -> None:
            """Flush the output, unless the browser has closed the connection."""
            with suppress(ConnectionError):
                super().finish()

        def _send(
            self, status: HTTPStatus, suffix: str, text: str, **headers: str
        ) -> None:
            data = text.encode("utf-8")
            self.send_response(status)
            self.send_header(
                "Content-Type", f"{_TYPES.get(suffix, 'text/plain')}; charset=utf-8"
            )
            self.send_header("Content-Length", str(len(data)))
            # An ICD, and so every page, can change at any time.
            self.send_header("Cache-Control", "no-cache")
            for key, value in headers.items():
                self.send_header(key, value)
            self.send_header("X-Content-Type-Options", "nosniff")
            self.end_headers()
            if self.command != "HEAD":
                self.wfile.write(data)

        def log_message(self, format: str, *args: object) -> None:
            """Suppress the log of requests."""

    return SiteHandler


def _complaint(text: str) -> str:
    """Return a page with the reason why the site cannot be shown."""
    return (
        '<!DOCTYPE html><html lang="en"><meta charset="utf-8"><title>icdgen</title>'
        f"<body><h1>This site cannot be shown</h1><pre>{html.escape(text)}</pre></body></html>\n"
    )


def serve(
    icds: list[Path],
    previous: str | None,
    templates: Path | None,
    packages: Packages,
    port: int,
    say: Callable[[str], None],
) -> None:
    """Serve the site until Ctrl+C.

    ``say`` shows the address. Raises `UserError` if the port is in use.
    """
    source = SiteSource(icds, previous, templates, packages)
    try:
        server = ThreadingHTTPServer((HOST, port), handler(source))
    except OSError as error:
        raise UserError(
            f"cannot listen on port {port}: {error.strerror}",
            "choose another one with --port",
        ) from None
    with server:
        site = source.site()
        state = "the ICDs have errors: see the pages"
        if site.ok:
            state = f"{len(site.files)} files"
        say(f"http://localhost:{server.server_port}/ ({state}); Ctrl+C ends it")
        try:
            server.serve_forever()
        except KeyboardInterrupt:
            return
