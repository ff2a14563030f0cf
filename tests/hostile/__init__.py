"""Devices that obey the syntax of a link and keep every procedure busy as long as they
can.

`devices` has the kinds of devices, `bounds` what the limits of an ICD add up to, and
`conversation` runs a procedure against a device in virtual time and records it.
"""
