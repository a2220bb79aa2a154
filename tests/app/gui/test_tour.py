"""The whole program by clicks: from a new session to the recorded outcome of a simulated pour."""

from __future__ import annotations

import os
import subprocess
import sys

import psutil
import pytest

LONGEST_STALL_MS = 100


@pytest.mark.slow
@pytest.mark.gl  # not for drawing: it runs alone then, so that the stall is the program's own
def test_a_newcomer_pours_into_the_mug_the_window_never_stalls_and_nothing_is_left(tmp_path, capsys):
    environment = os.environ | {"TMPDIR": str(tmp_path)}
    done = subprocess.run(
        [sys.executable, "-m", "app.cli", "--headless-check"],
        env=environment,
        capture_output=True,
        text=True,
        timeout=400,
        check=False,
    )
    assert done.returncode == 0, done.stderr
    told = done.stdout.splitlines()[-1]
    with capsys.disabled():
        print(f"\n{told}")
    assert "0 of 60 candies were spilled" in told
    assert " 6 clicks" in told, "'Scan the mug' and five more"
    stall_ms = float(told.split("longest stall was ")[1].split(" ms")[0])
    assert stall_ms < LONGEST_STALL_MS
    left = [
        process
        for process in psutil.process_iter(["environ"])
        if (process.info["environ"] or {}).get("TMPDIR") == str(tmp_path)
    ]
    assert left == []
    assert [path.name for path in tmp_path.iterdir() if path.name.startswith("poursight-check")] == []
