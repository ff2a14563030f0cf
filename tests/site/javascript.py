"""Results of JavaScript of the site. One process of Node.js runs all scripts of a test
process, since to start one takes longer than most scripts.
"""

from __future__ import annotations

import json
import subprocess
from functools import cache

from tests.site.conftest import program

# Each line of input is a script and its argument, each line of output a result. After
# it, global variables and modules are removed: the scripts of the site prefer such
# variables to `require`.
SERVER = """
    const { createInterface } = require("node:readline");
    const own = new Set(Reflect.ownKeys(globalThis));
    createInterface({ input: process.stdin }).on("line", (line) => {
        const [script, argument] = JSON.parse(line);
        let answer;
        try { answer = { result: new Function("require", "argument", script)(require, argument) }; }
        catch (error) { answer = { error: error.stack ?? String(error) }; }
        for (const key of Reflect.ownKeys(globalThis)) if (!own.has(key)) delete globalThis[key];
        for (const file of Object.keys(require.cache)) delete require.cache[file];
        process.stdout.write(JSON.stringify(answer) + "\\n");
    });
"""


@cache
def _server() -> subprocess.Popen[bytes]:
    return subprocess.Popen(
        [program("node"), "-e", SERVER], stdin=subprocess.PIPE, stdout=subprocess.PIPE
    )


def run_script(script: str, argument: object) -> object:
    """Return what a script returns as the body of a function of `argument`."""
    server = _server()
    assert server.stdin and server.stdout
    server.stdin.write(json.dumps([script, argument]).encode() + b"\n")
    server.stdin.flush()
    answer = json.loads(server.stdout.readline())
    assert "error" not in answer, answer["error"]
    return answer.get("result")
