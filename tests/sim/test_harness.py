"""The harness for clients of any language accepts correct clients and detects faulty
ones.
"""

from __future__ import annotations

import sys

from tests.sim import harness


def test_a_client_that_hangs_fails_or_reports_wrong_results_is_detected():
    assert (
        harness.run(
            [sys.executable, "-c", "import time; time.sleep(60)"], 10, "0", [], limit=2
        )
        == "hangs"
    )
    assert "ended with 3" in harness.run(
        [sys.executable, "-c", "raise SystemExit(3)"], 10, "0", []
    )
    assert "another one" in harness.run([sys.executable, "-c", ""], 10, "0", [])
