"""What the window costs while nobody computes: memory after many pages, processor time when it stands.

Run by `make window-load`; `ROUNDS=` visits the pages more often.
"""

from __future__ import annotations

import os
import sys
import tempfile
import time
from pathlib import Path

import psutil

from app.gui.headless_check import ARM_S, READY_S, Heartbeat, Walk, let_work
from app.gui.main import make_application, open_window
from app.gui.pages.registry import OTHERS, WORK
from app.library.places import SESSIONS_VARIABLE
from core.child_process import SPAWN

_STANDS_S, _PAGE_S, _EVERY = 30.0, 0.7, 5
_MB = 1e6


def _standing(what: str) -> None:
    """Print the processor time of the window and of all its children while nothing is done."""
    me = psutil.Process()
    others = me.children(recursive=True)
    before = [_busy_s(one) for one in (me, *others)]
    began_s = time.monotonic()
    let_work(_STANDS_S)
    used = [_busy_s(one) - was for one, was in zip((me, *others), before, strict=True)]
    shares = [100 * seconds / (time.monotonic() - began_s) for seconds in used]
    rest = sum(shares[1:])
    print(f"{what}: window {shares[0]:.1f} % of a core, its {len(others)} processes {rest:.1f} %", flush=True)


def _busy_s(process: psutil.Process) -> float:
    try:
        times = process.cpu_times()
    except psutil.NoSuchProcess:
        return 0.0
    return float(times.user + times.system)


def _memory_mb() -> float:
    return float(psutil.Process().memory_info().rss) / _MB


def _session(folder: Path) -> Path:
    """Make a session in a process of its own: the window's has none of the libraries that this takes."""
    making = SPAWN.Process(target=_make, args=(folder,))
    making.start()
    making.join()
    return folder


def _make(folder: Path) -> None:
    from tests.app.sessions import make_session

    make_session(folder, "mug")


def main() -> None:
    """Visit the pages round after round, stand still, connect an arm, and stand again."""
    n_rounds = int(sys.argv[1])
    with tempfile.TemporaryDirectory() as home:
        os.environ["XDG_CONFIG_HOME"] = os.environ["XDG_DATA_HOME"] = home
        os.environ[SESSIONS_VARIABLE] = f"{home}/sessions"
        session = _session(Path(home) / "sessions" / "mug")
        began_s = time.monotonic()
        window = open_window(make_application())
        walk, ready = Walk(window), []
        window.ready.connect(lambda: ready.append(True))
        walk.wait(lambda: ready, "the window is ready", READY_S)
        print(f"ready: {_memory_mb():.0f} MB", flush=True)
        _standing("first page, standing")
        window.desk.open_session(session)
        heartbeat = Heartbeat(window)
        for number in range(1, n_rounds + 1):
            for key in (*WORK, *OTHERS):
                window.show_page(key)
                let_work(_PAGE_S)
            if number == 1 or number % _EVERY == 0:
                print(f"{number} times through all pages: {_memory_mb():.0f} MB", flush=True)
        print(f"longest stall: {1000 * heartbeat.worst_s:.0f} ms, own {1000 * heartbeat.worst_own_s:.0f} ms")
        heartbeat.deleteLater()  # it beats a hundred times a second
        window.show_page("imagination")
        let_work(2)
        _standing("Imagine, standing")
        window.show_page("robot")
        window.page("robot").press_primary()
        walk.wait_for_work("the arm is connected and the pour planned", ARM_S)
        let_work(2)
        _standing("arm connected, standing")
        print(f"after {(time.monotonic() - began_s) / 60:.1f} min: {_memory_mb():.0f} MB")
        window.close_without_asking()


if __name__ == "__main__":
    main()
