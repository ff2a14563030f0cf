"""``icdgen docs`` and the server of ``--serve``."""

from __future__ import annotations

import re
import signal
import socket
import struct
import subprocess
import sys
import threading
import time
from http.client import HTTPConnection
from http.server import ThreadingHTTPServer

import pytest

from icdgen.site.serve import HOST, SiteSource, handler
from tests.cli.conftest import icdgen  # noqa: F401


@pytest.fixture
def ask(demo):
    """Return a function ``ask("/demo/", Host=...)`` that returns status and body."""
    server = ThreadingHTTPServer((HOST, 0), handler(SiteSource([demo])))
    threading.Thread(target=server.serve_forever, daemon=True).start()

    def get(path: str, **headers: str) -> tuple[int, str]:
        connection = HTTPConnection(HOST, server.server_port, timeout=20)
        connection.request("GET", path, headers=headers)
        answer = connection.getresponse()
        return answer.status, answer.read().decode("utf-8")

    yield get
    server.shutdown()
    server.server_close()


def test_docs_writes_a_site_and_leaves_current_files_unchanged(
    icdgen,  # noqa: F811
    demo,
):
    first = icdgen("docs", demo)
    assert first.status == 0 and "Open site/index.html" in first.out
    second = icdgen("docs", demo)
    assert second.status == 0 and "files are current" in second.out
    assert icdgen("docs", "--check", demo).status == 0


def test_docs_check_reports_an_outdated_site(icdgen, demo):  # noqa: F811
    icdgen("docs", demo)
    demo.write_text(
        demo.read_text("utf-8").replace("Roll Angle", "Bank Angle"), "utf-8"
    )
    assert icdgen("docs", "--check", demo).status == 1
    icdgen("docs", demo)
    assert icdgen("docs", "--check", demo).status == 0


def test_docs_reports_an_invalid_icd_and_writes_nothing(
    icdgen,  # noqa: F811
    demo,
    tmp_path,
):
    demo.write_text(demo.read_text("utf-8").replace("bits: 16", "bits: 99"), "utf-8")
    result = icdgen("docs", demo)
    assert (
        result.status == 1
        and "demo.yaml" in result.err
        and not (tmp_path / "site").exists()
    )


def test_docs_of_a_release_lists_the_changes_since_the_older_one(
    icdgen,  # noqa: F811
    demo,
    tmp_path,
):
    older = tmp_path / "older.yaml"
    older.write_text(
        demo.read_text("utf-8").replace(
            "Roll Angle, type: int", "Roll Angle, type: uint"
        ),
        "utf-8",
    )
    older.write_text(demo.read_text("utf-8").replace("raw*0.01", "raw*0.1"), "utf-8")
    assert icdgen("docs", "--previous", older, demo).status == 0
    text = (tmp_path / "site" / "changes.html").read_text("utf-8")
    assert "Estimated Roll" in text and "major" in text
    assert "changes.html" in (tmp_path / "site" / "index.html").read_text("utf-8")
    result = icdgen("docs", "--previous", "no such", demo)
    assert result.status == 2 and "no such" in result.err


def test_docs_serve_takes_no_folder(icdgen, demo):  # noqa: F811
    assert icdgen("docs", "--serve", "--out", "x", demo).status == 2


def test_the_server_shows_the_current_icds(ask, demo):
    assert "Estimated Roll" in ask("/demo/")[1]
    demo.write_text(
        demo.read_text("utf-8").replace("Estimated Roll", "Measured Roll"), "utf-8"
    )
    assert "Measured Roll" in ask("/demo/index.html")[1]
    demo.write_text("nonsense: [", "utf-8")
    status, body = ask("/demo/")
    assert status == 500 and "demo.yaml" in body


def test_the_server_answers_only_this_machine_and_serves_only_the_site(ask):
    assert ask("/")[0] == 200
    assert ask("/demo")[0] == 301
    assert ask("/", Host="somewhere.example")[0] == 403
    for path in (
        "/../etc/passwd",
        "/..%2f..%2fetc/passwd",
        "//etc/passwd",
        "/demo.yaml",
        "/%00",
        "/no such",
    ):
        assert ask(path.replace(" ", "%20"))[0] == 404


def test_a_reset_connection_is_not_reported(demo, capsys):
    reset = struct.pack("ii", 1, 0)  # closing sends a reset instead of an end
    server = ThreadingHTTPServer((HOST, 0), handler(SiteSource([demo])))
    threading.Thread(target=server.serve_forever, daemon=True).start()
    try:
        for sent in (b"", b"GET / HT", b"GET / HTTP/1.1\r\nHost: localhost\r\n\r\n"):
            for wait in (0, 0.05):
                with socket.create_connection((HOST, server.server_port)) as browser:
                    browser.setsockopt(socket.SOL_SOCKET, socket.SO_LINGER, reset)
                    browser.sendall(sent)
                    time.sleep(wait)
        connection = HTTPConnection(HOST, server.server_port, timeout=20)
        connection.request("GET", "/", headers={"Host": "localhost"})
        assert connection.getresponse().status == 200
        time.sleep(0.2)
    finally:
        server.shutdown()
        server.server_close()
    assert capsys.readouterr().err == ""


def test_a_path_in_an_error_page_is_escaped(ask):
    status, body = ask("/%3Cscript%3Ealert(1)%3C/script%3E&amp;")
    assert status == 404 and "<script" not in body
    assert "&lt;script&gt;alert(1)&lt;/script&gt;&amp;amp;" in body


def test_docs_serve_serves_until_it_is_interrupted(demo):
    command = [
        sys.executable,
        "-m",
        "icdgen",
        "docs",
        "--serve",
        "--port",
        "0",
        str(demo),
    ]
    process = subprocess.Popen(
        command,
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
        # Tests that a shell runs in the background inherit that interrupts are ignored.
        preexec_fn=lambda: signal.signal(signal.SIGINT, signal.SIG_DFL),
    )
    try:
        line = process.stdout.readline()
        address = re.search(r"http://localhost:(\d+)/ \(\d+ files\)", line)
        assert address, line
        for _ in range(2):
            connection = HTTPConnection("127.0.0.1", int(address[1]), timeout=20)
            connection.request("GET", "/demo/")
            answer = connection.getresponse()
            assert answer.status == 200 and b"Estimated Roll" in answer.read()
            connection.close()
        assert process.poll() is None, "it serves until it is interrupted"
        process.send_signal(signal.SIGINT)
        assert process.wait(20) == 0
    finally:
        process.kill()
        process.communicate()


def test_a_port_that_is_in_use_is_an_error(icdgen, demo):  # noqa: F811
    with socket.create_server((HOST, 0)) as server:
        port = server.getsockname()[1]
        result = icdgen("docs", "--serve", "--port", port, demo)
    assert result.status == 2 and f"cannot listen on port {port}" in result.err
