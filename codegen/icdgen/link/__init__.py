"""Communication with devices: ports, and sessions of the Python runtime.

`ports.open_port` opens a port by its text, `options.open_session` a session with a node
on it. ``live`` and ``screen`` are the table of `icdgen monitor`; ``outcomes`` and
``line_statistics`` describe results for `icdgen monitor` and `icdgen send`.

Importing this package makes the runtime importable.
"""

from icdgen import shipped

shipped.provide_runtime()
