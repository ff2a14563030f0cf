"""The statements of the verification package are true."""
