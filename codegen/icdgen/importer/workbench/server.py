"""HTTP server of the workbench, for this machine only.

It serves the page and passes requests, as JSON, to a `Session`.
"""

from __future__ import annotations

import json
from collections.abc import Callable
from http import HTTPStatus
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from pathlib import Path
from typing import Any
from urllib.parse import urlsplit

from icdgen.diagnostics import Findings
from icdgen.errors import UserError
from icdgen.importer.workbench import rule_text
from icdgen.importer.workbench.session import Session

HOST = "127.0.0.1"
MOST_BYTES = 1_000_000  # of a request
_NAMES = {HOST, "localhost"}
_FILES = {
    "/": ("page.html", "text/html"),
    "/page.css": ("page.css", "text/css"),
    "/page.js": ("page.js", "text/javascript"),
}
_MARK = "X-Icdgen"  # a header that no page of another site can send without asking


def serve(session: Session, port: int = 0) -> ThreadingHTTPServer:
    """Return a server on a port of this machine; ``port`` 0: any that is free.

    `serve_forever` runs it.
    """
    return ThreadingHTTPServer((HOST, port), handler(session))


def handler(session: Session) -> type[BaseHTTPRequestHandler]:
    """A request handler for one session."""

    class WorkbenchHandler(BaseHTTPRequestHandler):
        server_version, sys_version = "icdgen", ""

        def do_GET(self) -> None:
            path = urlsplit(self.path).path
            # A page of another site can give its own name the address 127.0.0.1 (DNS
            # rebinding).
            if (self.headers.get("Host") or "").rsplit(":", 1)[0] not in _NAMES:
                self.send_text(
                    HTTPStatus.FORBIDDEN, "This server answers only to localhost.\n"
                )
            elif path in _FILES:
                name, kind = _FILES[path]
                self.send(
                    HTTPStatus.OK,
                    f"{kind}; charset=utf-8",
                    Path(__file__).with_name(name).read_bytes(),
                )
            elif path == "/api/state":
                self.send_json(session.state())
            elif (
                path.startswith(("/api/table/", "/picture/"))
                and (last := path.rsplit("/", 1)[1]).isdigit()
            ):
                try:
                    if path.startswith("/picture/"):
                        self.send(
                            HTTPStatus.OK, "image/png", session.picture(int(last))
                        )
                    else:
                        self.send_json(session.table(int(last)))
                except KeyError:
                    self.send_text(
                        HTTPStatus.NOT_FOUND,
                        f"There is nothing with the number {last}.\n",
                    )
            else:
                self.send_text(HTTPStatus.NOT_FOUND, f"There is no {path}.\n")

        def do_POST(self) -> None:
            actions: dict[str, Callable[[Any], Any]] = {
                "/api/rule": lambda data: session.set_rule(
                    data["index"], data["rule"], data.get("behind")
                ),
                "/api/rule-text": lambda data: session.set_rule(
                    data["index"], rule_text.parse_rule(data["text"])
                ),
                "/api/node": lambda data: session.set_node(data),
                "/api/undo": lambda data: session.undo(),
                "/api/redo": lambda data: session.redo(),
                "/api/read": lambda data: session.read_document(),
                "/api/save": lambda data: session.save(
                    overwrite=bool(data and data.get("overwrite"))
                ),
                "/api/reload": lambda data: session.reload(),
            }
            action = actions.get(urlsplit(self.path).path)
            length = self.headers.get("Content-Length") or ""
            # A form of another site can send a POST here, but no header of its own,
            # without a preflight request (CORS) that this server does not answer.
            if (self.headers.get("Host") or "").rsplit(":", 1)[
                0
            ] not in _NAMES or self.headers.get(_MARK) is None:
                self.send_text(
                    HTTPStatus.FORBIDDEN,
                    "Only the page of the workbench may change anything.\n",
                )
                return
            if action is None or not length.isdigit() or int(length) > MOST_BYTES:
                self.send_text(HTTPStatus.BAD_REQUEST, "There is no such action.\n")
                return
            try:
                done = action(json.loads(self.rfile.read(int(length)) or b"null"))
                self.send_json({"done": done, "state": session.state()})
            except Findings as error:
                refused = [
                    {"message": f.message, "help": f.help, "line": f.place.line}
                    for f in error.findings
                ]
                self.send_json({"refused": refused})
            except UserError as error:
                self.send_json(
                    {
                        "refused": [
                            {"message": str(error), "help": error.help, "line": None}
                        ]
                    }
                )
            except (KeyError, TypeError, ValueError, AttributeError) as error:
                self.send_text(
                    HTTPStatus.BAD_REQUEST, f"The request is not right: {error}\n"
                )

        def send_json(self, data: Any) -> None:
            self.send(
                HTTPStatus.OK,
                "application/json",
                json.dumps(data, ensure_ascii=False).encode("utf-8"),
            )

        def send_text(self, status: HTTPStatus, text: str) -> None:
            self.send(status, "text/plain; charset=utf-8", text.encode("utf-8"))

        def send(self, status: HTTPStatus, kind: str, data: bytes) -> None:
            self.send_response(status)
            self.send_header("Content-Type", kind)
            self.send_header("Content-Length", str(len(data)))
            self.send_header("Cache-Control", "no-store")
            self.send_header(
                "Content-Security-Policy",
                "default-src 'self'; img-src 'self' data:; style-src 'self' 'unsafe-inline'",
            )
            self.end_headers()
            self.wfile.write(data)

        def log_message(self, format: str, *arguments: Any) -> None:
            """Requests are not logged: the terminal shows the address only."""

    return WorkbenchHandler
