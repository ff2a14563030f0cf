"""Answers of the server of the site, without sockets."""

from __future__ import annotations

import importlib
import io
from types import SimpleNamespace

import pytest

from icdgen.diagnostics import Finding, Place
from icdgen.errors import UserError
from icdgen.site.make import Site
from icdgen.site.serve import SiteSource, handler

# The package has a function of the same name.
serve = importlib.import_module("icdgen.site.serve")
FILES = {
    "index.html": "<p>Grüße</p>",
    "demo/index.html": "node",
    "demo/a b.html": "message",
    "style.css": "css",
    "find.js": "js",
    "icd.json": "{}",
    "icon.svg": "svg",
    "llms.txt": "text",
    "demo/data.csv": "other",
}


class Connection:
    """A socket that gets one request and keeps the bytes of the answer."""

    def __init__(self, request: str) -> None:
        self.request, self.answer = request, b""

    def makefile(self, mode: str, size: int) -> io.BytesIO:
        return io.BytesIO(self.request.encode())

    def sendall(self, data: bytes) -> None:
        self.answer += bytes(data)


def answer_of(source, path: str, host: str | None = "localhost", method: str = "GET"):
    """Return status, headers and body of the answer to a request."""
    lines = [f"{method} {path} HTTP/1.0", *([f"Host: {host}"] if host else []), "", ""]
    connection = Connection("\r\n".join(lines))
    handler(source)(connection, ("127.0.0.1", 1), SimpleNamespace())
    head, _, body = connection.answer.partition(b"\r\n\r\n")
    status, *rows = head.decode().split("\r\n")
    headers = dict(row.split(": ", 1) for row in rows)
    assert headers["Content-Length"] == str(len(body)) or method == "HEAD"
    assert headers["X-Content-Type-Options"] == "nosniff"
    assert headers["Cache-Control"] == "no-cache"
    assert headers["Server"].strip() == "icdgen"
    return int(status.split()[1]), headers, body.decode("utf-8")


def source_of(site: Site):
    return SimpleNamespace(site=lambda: site)


SITE = source_of(Site(True, [], {}, FILES))


@pytest.mark.parametrize(
    ("path", "name", "kind"),
    [
        ("/", "index.html", "text/html"),
        ("//", "index.html", "text/html"),
        ("/?q=1#x", "index.html", "text/html"),
        ("/demo/", "demo/index.html", "text/html"),
        ("/demo/index.html?x", "demo/index.html", "text/html"),
        ("/demo/a%20b.html", "demo/a b.html", "text/html"),
        ("/style.css", "style.css", "text/css"),
        ("/find.js", "find.js", "text/javascript"),
        ("/icd.json", "icd.json", "application/json"),
        ("/icon.svg", "icon.svg", "image/svg+xml"),
        ("/llms.txt", "llms.txt", "text/plain"),
        ("/demo/data.csv", "demo/data.csv", "text/plain"),
    ],
)
def test_a_file_is_sent_with_its_type(path, name, kind):
    status, headers, body = answer_of(SITE, path)
    assert (status, body) == (200, FILES[name])
    assert headers["Content-Type"] == f"{kind}; charset=utf-8"
    assert "Location" not in headers


def test_the_head_of_a_page_has_no_body_but_its_length():
    status, headers, body = answer_of(SITE, "/", method="HEAD")
    assert (status, body) == (200, "")
    assert headers["Content-Length"] == str(len(FILES["index.html"].encode()))


def test_a_folder_is_redirected_to_its_page():
    status, headers, body = answer_of(SITE, "/demo")
    assert (status, headers["Location"], body) == (301, "/demo/", "")


def test_a_page_that_does_not_exist_is_named():
    status, headers, body = answer_of(SITE, "/demo/x%3Cy")
    assert status == 404 and headers["Content-Type"].startswith("text/html")
    assert "<pre>There is no page demo/x&lt;y</pre>" in body


@pytest.mark.parametrize(
    ("host", "status"),
    [
        ("localhost", 200),
        ("localhost:8000", 200),
        ("127.0.0.1", 200),
        ("127.0.0.1:1", 200),
        ("localhost.example", 403),
        ("example:localhost", 403),
        ("127.0.0.11", 403),
        ("localhost:1:2", 403),
        (None, 403),
    ],
)
def test_only_requests_for_this_machine_are_answered(host, status):
    shown = answer_of(SITE, "/", host)
    assert shown[0] == status
    if status == 403:
        assert shown[2] == "This server answers only to localhost.\n"


def test_errors_of_the_icds_are_on_every_page():
    finding = Finding("ICD001", "bad <name>", Place("demo.yaml", 3, 7, 6))
    broken = source_of(
        Site(False, [finding], {"demo.yaml": "a\nb\nc: <name>\n"}, FILES)
    )
    status, headers, body = answer_of(broken, "/style.css")
    assert status == 500 and headers["Content-Type"].startswith("text/html")
    assert "demo.yaml:3:7" in body and "bad &lt;name&gt;" in body

    def unreadable():
        raise UserError("cannot read a&b", "check the path")

    status, _, body = answer_of(SimpleNamespace(site=unreadable), "/")
    assert status == 500
    assert "<pre>cannot read a&amp;b\ncheck the path</pre>" in body


def test_the_site_is_rendered_again_if_a_file_has_changed(monkeypatch, tmp_path):
    prints, made = {"a": "1", "b": "1"}, []
    arguments = ([tmp_path], "old", None, None)

    def make_site(*given):
        assert given == arguments
        made.append(prints["a"])
        if prints["a"] == "bad":
            raise UserError("bad")
        return Site(True, [], {}, inputs=dict(prints))

    monkeypatch.setattr(serve, "make_site", make_site)
    monkeypatch.setattr(serve.fingerprints, "of_path", prints.__getitem__)
    source = SiteSource(*arguments)
    first = source.site()
    assert source.site() is first and made == ["1"]
    prints["b"] = "2"  # the last file
    second = source.site()
    assert second is not first and source.site() is second
    prints["a"] = "bad"
    for _ in range(2):
        with pytest.raises(UserError):
            source.site()
    prints["a"] = "1"
    third = source.site()
    assert source.site() is third
    assert made == ["1", "1", "bad", "bad", "1"]


@pytest.mark.parametrize(
    ("is_valid", "state"),
    [(True, "9 files"), (False, "the ICDs have errors: see the pages")],
)
def test_the_address_is_said_with_the_state_of_the_site(monkeypatch, is_valid, state):
    class Server:
        server_port = 8123

        def __init__(self, address, handler_class):
            assert address == ("127.0.0.1", 5)

        def __enter__(self):
            return self

        def __exit__(self, *error):
            said.append("closed")

        def serve_forever(self):
            raise KeyboardInterrupt

    said = []
    monkeypatch.setattr(serve, "ThreadingHTTPServer", Server)
    site = Site(is_valid, [], {}, FILES)
    monkeypatch.setattr(serve, "make_site", lambda *arguments: site)
    serve.serve([], None, None, None, 5, said.append)
    assert said == [f"http://localhost:8123/ ({state}); Ctrl+C ends it", "closed"]
