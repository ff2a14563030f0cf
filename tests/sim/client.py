"""The reference client of the harness: python -m tests.sim.client HOST PORT SIZE"""

from __future__ import annotations

import sys

from icdgen import codec
from icdgen.icd.model import CONFIGURATION
from icdgen.link.ports import open_port
from icdgen.link.session import Session
from icdgen.protocol import transfer
from icdgen.sim.values import fresh
from tests.sim.device import FAST, ICD, download, hasty

NODE = "cubeacp"


def main(host: str, port: str, size: str) -> int:
    with Session(ICD, ICD.node(NODE), open_port(f"tcp://{host}:{port}", {}), settings=FAST) as client:
        client.known = hasty(client.known)
        found = client.identify()
        if found is None or not found[1]:
            return 3
        for message in client.known.telemetry.values():
            if client.telemetry(message) is None:
                return fail(f"{message.name} is not answered")
        for message in client.known.telecommands.values():
            if message.kind == CONFIGURATION:
                raw = fresh(message) | {f.name: 1 for f in message.fields if f.type == "uint" and f.const is None}
                data = codec.encode(ICD.node(message.node), message, raw)
                outcome = client.telecommand(message, data)
                if outcome["event"] != "done" or client.telemetry(message) != data:
                    return fail(f"{message.name} is not what was set: {outcome}")
        log = next(m for m in client.known.telecommands.values() if m.name == log_message())
        client.telecommand(log, bytes(log.length))  # no logs during the transfers
        result, data = download(client, 2, 1, int(size))
        if result != "done":
            return fail(f"download: {result}")
        result = client.run(transfer.Upload(client.known, 3, data))
        return 0 if result == "done" else fail(f"upload: {result}")


def log_message() -> str:
    return ICD.protocol_of(ICD.node(NODE))["unsolicited_log"]["configured_by"]["message"]


def fail(text: str) -> int:
    print(text, file=sys.stderr)
    return 1


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))
