"""The whole program without a screen: a new installation shows in a minute whether all of it works."""

from __future__ import annotations

import os
import sys
import tempfile
from pathlib import Path

from app.library.places import SESSIONS_VARIABLE
from core.errors import PoursightError


def check() -> int:
    """Click through the program, tell each step and the window's longest stall; return the exit code."""
    with tempfile.TemporaryDirectory(prefix="poursight-check-") as home:
        # Offscreen, and without a trace in the settings and the sessions of whoever runs it.
        os.environ["QT_QPA_PLATFORM"] = "offscreen"
        os.environ.pop("DISPLAY", None)
        os.environ["XDG_CONFIG_HOME"] = home
        os.environ[SESSIONS_VARIABLE] = str(Path(home) / "sessions")
        return _click_through()


def _click_through() -> int:
    from app.gui.heartbeat import Heartbeat
    from app.gui.main import make_application, open_window
    from app.gui.tour import Tour
    from app.gui.walk import Walk

    window = open_window(make_application())
    walk, heartbeat = Walk(window), Heartbeat(window)
    try:
        run = Tour(walk, lambda line: print(line, flush=True)).run()
    except PoursightError as error:
        print(f"poursight: {error}", file=sys.stderr)
        return 1
    finally:
        window.close_without_asking()
    said = run.outcome.sentence if run.outcome is not None else run.sentence
    print(
        f"{said} {walk.clicks} clicks; the window's longest stall was {1000 * heartbeat.worst_s:.0f} ms, "
        f"{1000 * heartbeat.worst_own_s:.0f} ms without what it waited for processor and disk."
    )
    return 0
