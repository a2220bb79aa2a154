"""From starting the program to its window on the screen; see the make target `window-start`."""

from __future__ import annotations

import os
import subprocess
import sys
import tempfile

RUNS = 7
_PROGRAM = """
import time, psutil
from PySide6.QtCore import QEvent, QObject
from app.gui.main import make_application, open_window

class Watch(QObject):
    def eventFilter(self, watched, event):
        if event.type() == QEvent.Type.Paint and watched is window.centralWidget():
            print(time.time() - psutil.Process().create_time(), flush=True)
            application.removeEventFilter(self)
            window.close_without_asking()
        return False

import app.cli
application = make_application()
watch = Watch()
window = open_window(application)
application.installEventFilter(watch)
application.exec()
"""


def main() -> None:
    """Print each run and the median."""
    found = []
    for run in range(RUNS):
        with tempfile.TemporaryDirectory() as home:
            program = [sys.executable, "-c", _PROGRAM]
            at_home = os.environ | {"XDG_CONFIG_HOME": home}
            done = subprocess.run(
                program, env=at_home, capture_output=True, text=True, timeout=60, check=False
            )
        seconds = float(done.stdout.split()[0])
        found.append(seconds)
        print(f"run {run + 1}: window painted {seconds:.2f} s after the process was started")
    print(f"median {sorted(found)[RUNS // 2]:.2f} s, worst {max(found):.2f} s")


if __name__ == "__main__":
    main()
