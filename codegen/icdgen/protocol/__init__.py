"""Reference implementation of the protocol: framing, checksums, CAN packets, logs and
file transfer.

The code is written for clarity, not for speed, performs no I/O and depends only on the
protocol facts of the ICD. Tests compare generated protocol layers with it.
`icdgen.protocol.facts.of` returns the facts of a node.
"""
