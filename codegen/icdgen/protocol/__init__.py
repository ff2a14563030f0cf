"""How messages travel: the reference implementation of framing, checksums, CAN packets, logs and file transfer.

Slow and obvious, without any I/O, and driven by the protocol facts of the ICD alone: the judge of the protocol layers
that are generated. `icdgen.protocol.facts.of` gives the facts of a node.
"""
