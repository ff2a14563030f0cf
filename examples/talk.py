"""Asks a node for its attitude, and switches it on. In another terminal: icdgen sim --node cubeacp --tcp 4000"""

import select
import socket
import sys

from icdgen_messages.cubeacp import LINK, AdcsRunMode, EstimatedAttitudeAngles, Identification, SetAdcsRunMode
from icdgen_messages.wire import Session, identify

with socket.create_connection(("127.0.0.1", int(sys.argv[1]))) as port:
    device = Session(LINK, port.sendall, lambda s: port.recv(4096) if select.select([port], [], [], s)[0] else b"")
    print(identify(LINK, device.get(Identification).to_bytes()))
    device.send(SetAdcsRunMode(enabled=AdcsRunMode.ENABLED))
    angles = device.get(EstimatedAttitudeAngles)
    print(f"roll {angles.estimated_roll_angle_deg:.2f} deg")
