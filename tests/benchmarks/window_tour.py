"""The tour in a real window, with 3D views: how long each step takes and how long the window ever stalls.

Run by `make window-tour`. On a virtual screen the processor draws, which takes more than 100 ms at times.
"""

from __future__ import annotations

import os
import tempfile

from app.gui.headless_check import Heartbeat, Tour, Walk
from app.gui.main import make_application, open_window
from app.library.places import SESSIONS_VARIABLE


def main() -> None:
    """Click through and print."""
    with tempfile.TemporaryDirectory() as home:
        os.environ["XDG_CONFIG_HOME"] = home
        os.environ[SESSIONS_VARIABLE] = f"{home}/sessions"
        window = open_window(make_application())
        walk, heartbeat = Walk(window), Heartbeat(window)
        run = Tour(walk, print).run()
        print(run.outcome.sentence if run.outcome is not None else run.sentence)
        print(
            f"{walk.clicks} clicks; longest stall {1000 * heartbeat.worst_s:.0f} ms, "
            f"{heartbeat.worst_at_s:.0f} s after the start, "
            f"{1000 * heartbeat.worst_own_s:.0f} ms without what it waited for processor and disk"
        )
        window.close_without_asking()


if __name__ == "__main__":
    main()
