"""Talking to a device: ports, and a session that runs the client and the procedures of `icdgen.protocol` over them."""
