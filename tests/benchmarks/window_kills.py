"""Killing the program at random moments of the tour: what is finished is whole, and the next start offers it.

Run by `make window-kills`; `--kills N` for another number than 20.
"""

from __future__ import annotations

import os
import random
import signal
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import psutil

from app.library.places import SESSIONS_VARIABLE
from core.session import Session
from core.session.record import folder_digest

KILLS = 20
LONGEST_S = 50.0
"""The tour takes about a minute; a kill after it would show nothing."""
_STAGES = ("scan", "reconstruction", "quality", "collision", "containability", "pouring", "motion")
_TOUR = """
from app.gui.main import make_application, open_window
from app.gui.tour import Tour
from app.gui.walk import Walk

window = open_window(make_application())
Tour(Walk(window), lambda line: print(line, flush=True)).run()
window.close_without_asking()
"""
_LOOK = """
from app.gui.main import make_application, open_window
from app.gui.walk import Walk

window = open_window(make_application())
print(window.messages.sentence)
walk = Walk(window)
if window.messages.sentence:
    walk.click("message_action")
    walk.wait(lambda: window.desk.workspace.session, "the session is open", 10)
    stages = window.desk.workspace.stages
    print(" ".join(f"{name}={state.value}" for name, state in stages.items()))
window.close_without_asking()
"""


def main() -> None:
    """Kill, look, tell; exit code 1 if anything was lost or left behind."""
    kills = int(sys.argv[sys.argv.index("--kills") + 1]) if "--kills" in sys.argv else KILLS
    pick = random.Random(0)
    failures = 0
    for number in range(1, kills + 1):
        after_s = pick.uniform(1.0, LONGEST_S)
        with tempfile.TemporaryDirectory() as home:
            problems, told = kill_once(Path(home), after_s)
        failures += bool(problems)
        print(
            f"{number:2}: killed after {after_s:4.1f} s; {told}{' PROBLEM: ' if problems else ''}{problems}"
        )
    print(f"{kills} kills, {failures} with a problem")
    sys.exit(bool(failures))


def kill_once(home: Path, after_s: float) -> tuple[str, str]:
    """Kill once; return what was wrong (empty if nothing) and what was found."""
    temporary = home / "temporary"
    temporary.mkdir()
    environment = os.environ | {
        "TMPDIR": str(temporary),
        "QT_QPA_PLATFORM": "offscreen",
        "XDG_CONFIG_HOME": str(home / "config"),
        SESSIONS_VARIABLE: str(home / "sessions"),
    }
    environment.pop("DISPLAY", None)
    program = subprocess.Popen([sys.executable, "-c", _TOUR], env=environment, stdout=subprocess.DEVNULL,
                               stderr=subprocess.DEVNULL)  # fmt: skip
    time.sleep(after_s)
    family = psutil.Process(program.pid).children(recursive=True) if program.poll() is None else []
    is_killed = program.poll() is None
    program.send_signal(signal.SIGKILL)
    program.wait()
    _, alive = psutil.wait_procs(family, timeout=8)
    problems = [f"{len(alive)} processes stayed"] if alive else []
    sessions = sorted((home / "sessions").glob("[!.]*")) if (home / "sessions").is_dir() else []
    for path in sessions:
        problems += _damages(path)
    offered, stages = _look(environment)
    if sessions and is_killed and "was ended while" not in offered:
        problems.append("the next start offered nothing")
    left = sorted(path.name for path in temporary.iterdir())
    if left:
        problems.append(f"left in the temporary folder: {', '.join(left)}")
    return "; ".join(problems), stages or "before a session"


def _damages(path: Path) -> list[str]:
    """Every stage that has a record must be exactly what was recorded."""
    with Session.open(path) as session:
        return [
            f"{stage} is damaged"
            for stage in _STAGES
            if (record := session.record(stage)) is not None and folder_digest(path / stage) != record.digest
        ]


def _look(environment: dict[str, str]) -> tuple[str, str]:
    """Start the program again; return what it offered and how the session stands."""
    done = subprocess.run([sys.executable, "-c", _LOOK], env=environment, capture_output=True, text=True,
                          timeout=120, check=False)  # fmt: skip
    lines = [*done.stdout.splitlines(), "", ""]
    return lines[0], lines[1]


if __name__ == "__main__":
    main()
