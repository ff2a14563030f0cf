"""Switches the loop of a node on and asks for its attitude. In another terminal: icdgen sim --node cubeacp --tcp 4000"""

import select
import socket

from icdgen_messages.cubeacp import LINK, AdcsRunMode, EstimatedAttitudeAngles, SetAdcsRunMode
from icdgen_messages.wire import Session

with socket.create_connection(("127.0.0.1", 4000)) as port:

    def read(seconds):
        return port.recv(4096) if select.select([port], [], [], seconds)[0] else b""

    device = Session(LINK, port.sendall, read)  # a port of pyserial: Session(LINK, *serial_port(port))
    device.send(SetAdcsRunMode(enabled=AdcsRunMode.ENABLED))  # returns when it is acknowledged
    angles = device.get(EstimatedAttitudeAngles)
    print(f"roll {angles.estimated_roll_angle_deg:.2f} deg")
